// SPDX-License-Identifier: Apache-2.0
// Depth images of a real sensor, from a folder:
//
//   camera-intrinsics.txt   3 x 3 numbers: focal lengths and principal point in pixels
//   NAME.depth.png          16-bit grey, depth along the optical axis in millimetres, 0
//                           and 65535 are none
//   NAME.pose.txt           4 x 4 numbers: camera (x right, y down, z forward) to world, metres
//
// A DepthLayout states other names, units and conventions. Frames are in the order of their names.
// Their world need not have z up.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "framework/geometry/depth_image.h"

namespace lapwing {

// How the files of a folder are named and what their numbers mean.
struct DepthLayout {
  // Names with one `*`, which stands for the name of the frame; a folder may precede it
  // ("depth/*.png").
  std::string depth = "*.depth.png", pose = "*.pose.txt";
  std::string intrinsics = "camera-intrinsics.txt";  // 3 x 3 or 4 x 4 numbers
  // Focal lengths x and y and principal point x and y in pixels, in place of that file.
  std::optional<Eigen::Vector4d> camera;
  double unit = 0.001;           // m that 1 in a depth image is
  bool poses_to_camera = false;  // poses take the world to the camera
};

class DepthFolder {
 public:
  // Reads camera, poses and the size of the first image. Throws InputError naming the file: none
  // there, numbers missing or not finite, focal lengths not above 0, a pose that is no rotation (to
  // 1e-3) with a translation, an image without a pose, a pose without an image; for a layout whose
  // names have not one `*` each or whose unit is not above 0.
  explicit DepthFolder(const std::filesystem::path& folder, const DepthLayout& layout = {});

  std::size_t size() const { return names_.size(); }
  const std::string& name(std::size_t frame) const { return names_[frame]; }
  const Pinhole& pinhole() const { return pinhole_; }
  const Pose& pose(std::size_t frame) const { return poses_[frame]; }

  // Throws InputError for an image that cannot be read or has another size than the first.
  // Thread-safe.
  PosedDepthImage read(std::size_t frame) const;

 private:
  std::filesystem::path image_path(std::size_t frame) const;

  std::filesystem::path folder_;
  DepthLayout layout_;
  std::vector<std::string> names_;
  std::vector<Pose> poses_;
  Pinhole pinhole_;
};

// Writes one frame so that DepthFolder reads it back, depth to the nearest millimetre: infinite and
// larger depths than 65.534 m become 0. Files appear whole or not at all.
void write_depth_frame(const std::filesystem::path& folder, const std::string& name,
                       const PosedDepthImage& frame);

}  // namespace lapwing
