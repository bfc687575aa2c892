// SPDX-License-Identifier: Apache-2.0
#include "framework/photogrammetry/colmap_depth.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <unordered_map>

#include "framework/core/error.h"
#include "framework/core/files.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

constexpr int kMostAcross = 160;                           // pixels, of images of points
constexpr std::size_t kLargestMap = std::size_t{1} << 30;  // bytes
constexpr int kMostPixels = 30'000;                        // along an edge of a depth map

// A view of fewer pixels, of a camera without distortion.
Pinhole scaled(const Pinhole& p, int width, int height) {
  const double x = static_cast<double>(width) / p.width, y = static_cast<double>(height) / p.height;
  return {width,
          height,
          x * p.focal_x,
          y * p.focal_y,
          x * (p.principal_x + 0.5) - 0.5,
          y * (p.principal_y + 0.5) - 0.5};
}

class PointDepth final : public DepthSource {
 public:
  explicit PointDepth(const ColmapModel& model) {
    std::map<std::uint32_t, std::size_t> places;
    for (const ColmapImage& image : model.images) {
      places[image.id] = images_.size();
      const Pinhole whole = model.camera_of(image).pinhole();
      images_.push_back({image.name, image.pose, whole.fitted(kMostAcross, kMostAcross), {}});
    }
    for (const ColmapPoint& point : model.points)
      for (const std::uint32_t image : point.images)
        images_[places.at(image)].points.push_back(point.position);
    std::erase_if(images_, [](const Image& image) { return image.points.empty(); });
  }
  std::size_t size() const override { return images_.size(); }
  std::string name(std::size_t image) const override { return images_[image].name; }
  Pose camera(std::size_t image) const override { return images_[image].pose; }
  Pinhole pinhole(std::size_t image) const override { return images_[image].pinhole; }
  PosedDepthImage read(std::size_t image) const override {
    const Image& from = images_[image];
    const Pinhole& p = from.pinhole;
    PosedDepthImage made{from.pose, {p, {}}};
    made.image.depth.assign(static_cast<std::size_t>(p.width) * static_cast<std::size_t>(p.height),
                            0.0f);
    for (const Eigen::Vector3d& point : from.points) {
      const Eigen::Vector3d q = from.pose.orientation.conjugate() * (point - from.pose.position);
      if (!(q.z() > 0)) continue;
      const double x = std::round(p.focal_x * q.x() / q.z() + p.principal_x);
      const double y = std::round(p.focal_y * q.y() / q.z() + p.principal_y);
      if (!(x >= 0 && y >= 0 && x < p.width && y < p.height)) continue;
      float& depth =
          made.image.depth[static_cast<std::size_t>(y) * static_cast<std::size_t>(p.width) +
                           static_cast<std::size_t>(x)];
      const auto here = static_cast<float>(q.z());
      if (depth == 0 || here < depth) depth = here;
    }
    return made;
  }

 private:
  struct Image {
    std::string name;
    Pose pose;
    Pinhole pinhole;
    std::vector<Eigen::Vector3d> points;
  };
  std::vector<Image> images_;
};

class MapDepth final : public DepthSource {
 public:
  struct Image {
    ColmapCamera camera;
    std::string name;
    Pose pose;
    fs::path file;
    int width = 0, height = 0;  // of the depth map
  };
  explicit MapDepth(std::vector<Image> images) : images_(std::move(images)) {}
  std::size_t size() const override { return images_.size(); }
  std::string name(std::size_t image) const override { return images_[image].name; }
  Pose camera(std::size_t image) const override { return images_[image].pose; }
  Pinhole pinhole(std::size_t image) const override {
    const Image& from = images_[image];
    return scaled(from.camera.pinhole(), from.width, from.height);
  }
  PosedDepthImage read(std::size_t image) const override {
    const Image& from = images_[image];
    ColmapDepthMap map =
        read_colmap_depth_map(read_file(from.file, kLargestMap), "'" + from.file.string() + "'");
    if (map.width != from.width || map.height != from.height)
      throw InputError("'" + from.file.string() + "' has changed while it was read");
    PosedDepthImage made{from.pose, {pinhole(image), std::move(map.depth)}};
    for (float& depth : made.image.depth)
      if (!(depth > 0 && std::isfinite(depth))) depth = 0;
    if (from.camera.distorts()) undo_distortion(from, made.image);
    return made;
  }

 private:
  // The nearest pixel of the distorted image.
  static void undo_distortion(const Image& from, DepthImage& image) {
    const std::vector<float> distorted = image.depth;
    const Pinhole& p = image.pinhole;
    for (int y = 0; y < p.height; ++y)
      for (int x = 0; x < p.width; ++x) {
        const Eigen::Vector2d pixel =
            from.camera.pixel({(x - p.principal_x) / p.focal_x, (y - p.principal_y) / p.focal_y});
        const double u = std::floor(pixel.x() * p.width / from.camera.width);
        const double v = std::floor(pixel.y() * p.height / from.camera.height);
        const bool within = u >= 0 && v >= 0 && u < p.width && v < p.height;
        image.depth[static_cast<std::size_t>(y) * static_cast<std::size_t>(p.width) +
                    static_cast<std::size_t>(x)] =
            within ? distorted[static_cast<std::size_t>(v) * static_cast<std::size_t>(p.width) +
                               static_cast<std::size_t>(u)]
                   : 0.0f;
      }
  }

  std::vector<Image> images_;
};

// Images whose depth maps end so, with the sizes of these.
std::vector<MapDepth::Image> mapped_images(const ColmapModel& model, const fs::path& maps,
                                           const std::string& end) {
  std::vector<MapDepth::Image> images;
  for (const ColmapImage& image : model.images) {
    const fs::path file = maps / (image.name + end);
    if (!fs::is_regular_file(file)) continue;
    const ColmapDepthMap map =
        read_colmap_depth_map(read_file(file, kLargestMap), "'" + file.string() + "'");
    images.push_back({model.camera_of(image), image.name, image.pose, file, map.width, map.height});
  }
  return images;
}

}  // namespace

ColmapDepthMap read_colmap_depth_map(std::string_view bytes, const std::string& name) {
  const auto fail = [&](const std::string& why) -> void { throw InputError(name + ": " + why); };
  int sizes[3] = {};
  std::size_t at = 0;
  for (int& size : sizes) {
    const std::size_t end = std::min(bytes.find('&', at), bytes.size());
    const auto [stop, error] = std::from_chars(bytes.data() + at, bytes.data() + end, size);
    if (end == bytes.size() || error != std::errc{} || stop != bytes.data() + end)
      fail("is no depth map of COLMAP, which begins with width&height&1&");
    at = end + 1;
  }
  if (sizes[0] < 1 || sizes[1] < 1 || sizes[0] > kMostPixels || sizes[1] > kMostPixels ||
      sizes[2] != 1)
    fail("a depth map of " + std::to_string(sizes[0]) + " by " + std::to_string(sizes[1]) +
         " pixels of " + std::to_string(sizes[2]) + " numbers");
  const std::size_t count = static_cast<std::size_t>(sizes[0]) * static_cast<std::size_t>(sizes[1]);
  if (bytes.size() - at != 4 * count)
    fail("has " + std::to_string(bytes.size() - at) + " bytes of depth in place of " +
         std::to_string(4 * count));
  ColmapDepthMap map{sizes[0], sizes[1], std::vector<float>(count)};
  std::memcpy(map.depth.data(), bytes.data() + at, 4 * count);
  return map;
}

ColmapDepth depth_of_colmap(const ColmapModel& model, const fs::path& folder) {
  const fs::path maps = folder / "stereo" / "depth_maps";
  for (const char* kind : {"geometric", "photometric"}) {
    auto images = mapped_images(model, maps, std::string(".") + kind + ".bin");
    if (images.empty()) continue;
    const std::string described = std::to_string(images.size()) + " " + kind + " depth maps of " +
                                  std::to_string(model.images.size()) + " images";
    return {std::make_shared<MapDepth>(std::move(images)), true, described};
  }
  auto source = std::make_shared<PointDepth>(model);
  if (source->size() == 0) return {};
  return {source, false,
          std::to_string(model.points.size()) + " sparse points in " +
              std::to_string(source->size()) + " images"};
}

}  // namespace lapwing
