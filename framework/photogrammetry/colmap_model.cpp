// SPDX-License-Identifier: Apache-2.0
#include "framework/photogrammetry/colmap_model.h"

#include <algorithm>
#include <cctype>

#include "framework/core/files.h"
#include "framework/photogrammetry/colmap_fields.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr std::size_t kLargest = std::size_t{2} << 30;  // bytes of a file

// Of the turn and the shift that take the model to the camera.
template <class Fields>
Pose pose_of(const double (&q)[4], const Vector3d& t, const Fields& fields) {
  const Eigen::Quaterniond turn(q[0], q[1], q[2], q[3]);
  if (!(turn.norm() > 1e-6)) fields.fail("the rotation of the image is no quaternion");
  const Eigen::Quaterniond to_camera = turn.normalized();
  return {to_camera.conjugate() * -t, to_camera.conjugate()};
}

template <class Fields>
ColmapImage posed_image(std::uint32_t id, Fields& fields) {
  ColmapImage image;
  image.id = id;
  double q[4];
  for (double& value : q) value = fields.number();
  Vector3d t;
  for (int axis = 0; axis < 3; ++axis) t[axis] = fields.number();
  image.pose = pose_of(q, t, fields);
  return image;
}

template <class Camera, class Fields>
void keep(std::map<std::uint32_t, ColmapCamera>& cameras, Camera camera, const std::string& name,
          const Fields& fields) {
  check_camera(camera, "'" + name + "', camera " + std::to_string(camera.id));
  const std::uint32_t id = camera.id;
  if (!cameras.emplace(id, std::move(camera)).second)
    fields.fail("the camera " + std::to_string(id) + " is there twice");
}

int pixels(std::uint64_t count) {
  return static_cast<int>(std::min<std::uint64_t>(count, 1'000'000));
}

std::map<std::uint32_t, ColmapCamera> binary_cameras(std::string_view bytes,
                                                     const std::string& name) {
  BinaryFields fields(bytes, name);
  std::map<std::uint32_t, ColmapCamera> cameras;
  for (std::size_t left = fields.count(24); left > 0; --left) {
    ColmapCamera camera;
    camera.id = fields.take<std::uint32_t>();
    const auto model = fields.take<std::int32_t>();
    camera.model = name_of_model(model);
    if (camera.model.empty()) fields.fail("a camera model of number " + std::to_string(model));
    camera.width = pixels(fields.take<std::uint64_t>());
    camera.height = pixels(fields.take<std::uint64_t>());
    const std::size_t count = parameters_of_model(camera.model, "'" + name + "'");
    for (std::size_t k = 0; k < count; ++k) camera.parameters.push_back(fields.number());
    keep(cameras, std::move(camera), name, fields);
  }
  if (!fields.ended()) fields.fail("more bytes than its cameras take");
  return cameras;
}

std::map<std::uint32_t, ColmapCamera> text_cameras(std::string_view bytes,
                                                   const std::string& name) {
  TextFields fields(bytes, name);
  std::map<std::uint32_t, ColmapCamera> cameras;
  while (fields.next_line()) {
    ColmapCamera camera;
    camera.id = fields.whole<std::uint32_t>();
    camera.model = std::string(fields.word());
    camera.width = pixels(fields.whole<std::uint64_t>());
    camera.height = pixels(fields.whole<std::uint64_t>());
    while (fields.has_word()) camera.parameters.push_back(fields.number());
    keep(cameras, std::move(camera), name, fields);
  }
  return cameras;
}

std::vector<ColmapImage> binary_images(std::string_view bytes, const std::string& name) {
  BinaryFields fields(bytes, name);
  std::vector<ColmapImage> images;
  for (std::size_t left = fields.count(73); left > 0; --left) {
    ColmapImage image = posed_image(fields.take<std::uint32_t>(), fields);
    image.camera = fields.take<std::uint32_t>();
    image.name = fields.text();
    for (std::size_t k = fields.count(24); k > 0; --k) {
      ColmapFeature feature;
      feature.pixel.x() = fields.number();
      feature.pixel.y() = fields.number();
      feature.point = fields.take<std::int64_t>();
      image.features.push_back(feature);
    }
    images.push_back(std::move(image));
  }
  if (!fields.ended()) fields.fail("more bytes than its images take");
  return images;
}

std::vector<ColmapImage> text_images(std::string_view bytes, const std::string& name) {
  TextFields fields(bytes, name);
  std::vector<ColmapImage> images;
  while (fields.next_line()) {
    ColmapImage image = posed_image(fields.whole<std::uint32_t>(), fields);
    image.camera = fields.whole<std::uint32_t>();
    if (!fields.has_word()) fields.fail("the image has no name");
    image.name = fields.rest();
    if (!fields.next_line(true)) fields.fail("the line of the features of the image is missing");
    while (fields.has_word()) {
      ColmapFeature feature;
      feature.pixel.x() = fields.number();
      feature.pixel.y() = fields.number();
      feature.point = fields.whole<std::int64_t>();
      image.features.push_back(feature);
    }
    images.push_back(std::move(image));
  }
  return images;
}

std::vector<ColmapPoint> binary_points(std::string_view bytes, const std::string& name) {
  BinaryFields fields(bytes, name);
  std::vector<ColmapPoint> points;
  for (std::size_t left = fields.count(51); left > 0; --left) {
    ColmapPoint point;
    point.id = fields.take<std::int64_t>();
    for (int axis = 0; axis < 3; ++axis) point.position[axis] = fields.number();
    for (std::uint8_t& channel : point.color) channel = fields.take<std::uint8_t>();
    point.error = fields.number();
    for (std::size_t k = fields.count(8); k > 0; --k) {
      point.images.push_back(fields.take<std::uint32_t>());
      fields.take<std::uint32_t>();
    }
    points.push_back(std::move(point));
  }
  if (!fields.ended()) fields.fail("more bytes than its points take");
  return points;
}

std::vector<ColmapPoint> text_points(std::string_view bytes, const std::string& name) {
  TextFields fields(bytes, name);
  std::vector<ColmapPoint> points;
  while (fields.next_line()) {
    ColmapPoint point;
    point.id = fields.whole<std::int64_t>();
    for (int axis = 0; axis < 3; ++axis) point.position[axis] = fields.number();
    for (std::uint8_t& channel : point.color) channel = fields.whole<std::uint8_t>();
    point.error = fields.number();
    while (fields.has_word()) {
      point.images.push_back(fields.whole<std::uint32_t>());
      fields.whole<std::uint32_t>();
    }
    points.push_back(std::move(point));
  }
  return points;
}

// What belongs to what.
void check_links(const ColmapModel& model) {
  const auto fail = [&](const std::string& why) {
    throw InputError("'" + model.folder.string() + "': " + why);
  };
  if (model.images.empty()) fail("the COLMAP model has no image with a pose");
  std::map<std::uint32_t, const ColmapImage*> images;
  for (const ColmapImage& image : model.images) {
    if (!images.emplace(image.id, &image).second)
      fail("the image " + std::to_string(image.id) + " is there twice");
    if (!model.cameras.contains(image.camera))
      fail("the camera " + std::to_string(image.camera) + " of the image '" + image.name +
           "' is missing");
  }
  for (std::size_t k = 0; k < model.points.size(); ++k) {
    const ColmapPoint& point = model.points[k];
    if (k > 0 && model.points[k - 1].id == point.id)
      fail("the point " + std::to_string(point.id) + " is there twice");
    for (const std::uint32_t image : point.images)
      if (!images.contains(image))
        fail("the image " + std::to_string(image) + " of the point " + std::to_string(point.id) +
             " is missing");
  }
}

}  // namespace

std::map<std::uint32_t, ColmapCamera> colmap_cameras(std::string_view bytes, bool binary,
                                                     const std::string& name) {
  return binary ? binary_cameras(bytes, name) : text_cameras(bytes, name);
}

std::vector<ColmapImage> colmap_images(std::string_view bytes, bool binary,
                                       const std::string& name) {
  return binary ? binary_images(bytes, name) : text_images(bytes, name);
}

std::vector<ColmapPoint> colmap_points(std::string_view bytes, bool binary,
                                       const std::string& name) {
  return binary ? binary_points(bytes, name) : text_points(bytes, name);
}

fs::path find_colmap_model(const fs::path& folder) {
  for (const fs::path& place : {folder, folder / "sparse", folder / "sparse" / "0"})
    if (fs::exists(place / "cameras.bin") || fs::exists(place / "cameras.txt")) return place;
  throw InputError("'" + folder.string() +
                   "' holds no COLMAP model: cameras, images and points3D as .bin or .txt, here, "
                   "in 'sparse' or in 'sparse/0'");
}

ColmapModel read_colmap_model(const fs::path& folder) {
  ColmapModel model;
  model.folder = find_colmap_model(folder);
  const bool binary = fs::exists(model.folder / "cameras.bin");
  const auto file = [&](const char* name) {
    return model.folder / (name + std::string(binary ? ".bin" : ".txt"));
  };
  const fs::path cameras = file("cameras"), images = file("images"), points = file("points3D");
  model.cameras = colmap_cameras(read_file(cameras, kLargest), binary, cameras.string());
  model.images = colmap_images(read_file(images, kLargest), binary, images.string());
  model.points = colmap_points(read_file(points, kLargest), binary, points.string());
  std::stable_sort(model.images.begin(), model.images.end(),
                   [](const ColmapImage& a, const ColmapImage& b) { return a.name < b.name; });
  std::stable_sort(model.points.begin(), model.points.end(),
                   [](const ColmapPoint& a, const ColmapPoint& b) { return a.id < b.id; });
  check_links(model);
  return model;
}

}  // namespace lapwing
