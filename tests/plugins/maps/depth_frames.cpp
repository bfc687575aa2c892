#include "tests/plugins/maps/depth_frames.h"

#include <png.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "framework/core/error.h"
#include "framework/core/random.h"
#include "framework/geometry/scene.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

std::vector<std::uint16_t> read_gray16(const fs::path& path, int& width, int& height) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&png, path.c_str())) throw Error(path.string());
  png_image_free(&png);
  // The simplified reader would take the numbers for linear light and change nothing of them only
  // in this format.
  std::FILE* file = std::fopen(path.c_str(), "rb");
  png_structp read = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(read);
  png_init_io(read, file);
  png_read_png(read, info, PNG_TRANSFORM_SWAP_ENDIAN, nullptr);
  width = static_cast<int>(png_get_image_width(read, info));
  height = static_cast<int>(png_get_image_height(read, info));
  std::vector<std::uint16_t> pixels;
  png_bytepp rows = png_get_rows(read, info);
  for (int y = 0; y < height; ++y) {
    const auto* row = reinterpret_cast<const std::uint16_t*>(rows[y]);
    pixels.insert(pixels.end(), row, row + width);
  }
  png_destroy_read_struct(&read, &info, nullptr);
  std::fclose(file);
  return pixels;
}

PosedDepthImage real_frame(const fs::path& stem) {
  PosedDepthImage frame;
  Pinhole& pinhole = frame.image.pinhole;
  const auto millimetres = read_gray16(stem.string() + ".depth.png", pinhole.width, pinhole.height);
  pinhole.focal_x = pinhole.focal_y = 585;
  pinhole.principal_x = 320;
  pinhole.principal_y = 240;
  for (const std::uint16_t depth : millimetres)
    frame.image.depth.push_back(depth == 65535 ? 0.0f : static_cast<float>(depth) / 1000.0f);
  std::ifstream poses(stem.string() + ".pose.txt");
  Eigen::Matrix4d T_WC;
  for (int k = 0; k < 16; ++k) poses >> T_WC(k / 4, k % 4);
  frame.camera.position = T_WC.topRightCorner<3, 1>();
  frame.camera.orientation =
      Eigen::Quaterniond(Eigen::Matrix3d(T_WC.topLeftCorner<3, 3>())).normalized();
  return frame;
}

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
  for (int k = 0; k < count; ++k)
    frames.push_back(
        real_frame(*data_folder() / "depth" / ("frame-000" + std::to_string(150 + k))));
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
