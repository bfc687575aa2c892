// SPDX-License-Identifier: Apache-2.0
// Models of COLMAP, in text and in binary: cameras, images with poses, points
// (https://colmap.github.io/format.html).
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "framework/geometry/pose.h"
#include "framework/geometry/triangle_mesh.h"
#include "framework/photogrammetry/colmap_camera.h"

namespace lapwing {

struct ColmapFeature {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  // COLMAP's
  std::int64_t point = -1;                          // id; -1 for none
};

struct ColmapImage {
  std::uint32_t id = 0, camera = 0;
  std::string name;
  Pose pose;  // camera to the frame of the model; position in its units
  std::vector<ColmapFeature> features;
};

struct ColmapPoint {
  std::int64_t id = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // units of the model
  Rgb color{};
  double error = 0;                   // pixels, mean reprojection
  std::vector<std::uint32_t> images;  // ids of those that see it, as the file lists them
};

struct ColmapModel {
  std::map<std::uint32_t, ColmapCamera> cameras;
  std::vector<ColmapImage> images;  // in the order of their names
  std::vector<ColmapPoint> points;  // in the order of their ids
  std::filesystem::path folder;     // in which its files are

  const ColmapCamera& camera_of(const ColmapImage& image) const { return cameras.at(image.camera); }
};

// The folder of a model: this one, its `sparse` or its `sparse/0`, whichever holds cameras.bin or
// cameras.txt. InputError that says what was looked for.
std::filesystem::path find_colmap_model(const std::filesystem::path& folder);

// Reads the binary files where they are, else the texts. InputError naming the file, and the line
// of a text: what is cut short or too long for its counts, numbers that are not finite, a rotation
// of length 0, ids that are used twice, an image of a camera or a point of an image that is not
// there, a model of another camera, no image.
ColmapModel read_colmap_model(const std::filesystem::path& folder);

// The parts, from the bytes of a file; `name` begins the messages.
std::map<std::uint32_t, ColmapCamera> colmap_cameras(std::string_view bytes, bool binary,
                                                     const std::string& name);
std::vector<ColmapImage> colmap_images(std::string_view bytes, bool binary,
                                       const std::string& name);
std::vector<ColmapPoint> colmap_points(std::string_view bytes, bool binary,
                                       const std::string& name);

}  // namespace lapwing
