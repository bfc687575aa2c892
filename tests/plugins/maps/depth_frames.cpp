#include "tests/plugins/maps/depth_frames.h"

#include <cstdlib>

#include "framework/core/random.h"
#include "framework/geometry/depth_folder.h"
#include "framework/geometry/scene.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

Scene made_street() {
  std::vector<Shape> shapes{GroundShape{0}};
  Random random(5);
  for (const double side : {-1.0, 1.0})
    for (double x = -60; x < 60;) {
      const double width = random.uniform(6, 14), height = random.uniform(5, 16);
      const double front = side * random.uniform(6, 8);
      const Eigen::Vector3d a(x, front, 0), b(x + width, front + side * 10, height);
      shapes.push_back(BlockShape{a.cwiseMin(b), a.cwiseMax(b)});
      for (double door = x + 1; door + 1.5 < x + width; door += 2.5) {  // bays and balconies
        const double z = random.uniform(0, height - 2);
        const Eigen::Vector3d c(door, front, z), d(door + 1.5, front - side * 0.8, z + 1.2);
        shapes.push_back(BlockShape{c.cwiseMin(d), c.cwiseMax(d)});
      }
      x += width + (random.uniform() < 0.2 ? 2 : 0);
    }
  for (int k = 0; k < 30; ++k) {
    const double x = random.uniform(-60, 60), y = random.uniform() < 0.5 ? -4.5 : 4.5;
    shapes.push_back(UprightCylinderShape{{x, y, 1.5}, 3, 0.3});
    shapes.push_back(BallShape{{x, y, 4}, random.uniform(0.8, 1.6)});
    const double car = random.uniform(-60, 60), lane = random.uniform() < 0.5 ? -2.2 : 2.2;
    shapes.push_back(BlockShape{{car, lane - 0.9, 0.2}, {car + 4, lane + 0.9, 1.5}});
  }
  return Scene(std::move(shapes));
}

}  // namespace

std::optional<fs::path> data_folder() {
  const char* named = std::getenv("LAPWING_DATA");
  const fs::path folder = named ? fs::path(named) : fs::path(LAPWING_SOURCE_DIR "/../shared/data");
  if (fs::is_directory(folder)) return folder;
  return std::nullopt;
}

std::vector<PosedDepthImage> real_frames(int count) {
  std::vector<PosedDepthImage> frames;
  const DepthFolder folder(*data_folder() / "depth");
  for (int k = 0; k < count; ++k) frames.push_back(folder.read(static_cast<std::size_t>(k)));
  return frames;
}

std::vector<PosedDepthImage> street_frames(int count, int width, int height) {
  static const Scene street = made_street();
  constexpr double kReach = 60;
  std::vector<PosedDepthImage> frames;
  for (int k = 0; k < count; ++k) {
    PosedDepthImage frame;
    Pinhole& pinhole = frame.image.pinhole;
    pinhole = {width, height, width / 2.0, width / 2.0, (width - 1) / 2.0, (height - 1) / 2.0};
    CameraView view;
    view.pinhole = pinhole;
    view.position = {-55 + 110.0 * k / count, 3 * std::sin(1.7 * k), 1.5 + k % 5 * 3.0};
    view.axes = camera_axes(2.4 * k, -0.2 - 0.1 * (k % 5));
    frame.camera.position = view.position;
    Eigen::Matrix3d R_WC;
    R_WC << view.axes.right, view.axes.down, view.axes.forward;
    frame.camera.orientation = Eigen::Quaterniond(R_WC);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const Eigen::Vector3d ray = view.ray(x, y);
        const auto hit = street.cast(view.position, ray, kReach);
        frame.image.depth.push_back(
            hit ? static_cast<float>(hit->distance * ray.dot(view.axes.forward))
                : std::numeric_limits<float>::infinity());
      }
    frames.push_back(std::move(frame));
  }
  return frames;
}

}  // namespace lapwing
