// SPDX-License-Identifier: Apache-2.0
// Cameras of COLMAP and the distortion of their lenses.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "framework/geometry/camera_view.h"

namespace lapwing {

// Formulas: COLMAP's source, src/base/camera_models.h. Pixels of COLMAP count from the corner of
// the upper left one, those of Pinhole from its centre.
struct ColmapCamera {
  std::uint32_t id = 0;
  std::string model;  // "PINHOLE"
  int width = 0, height = 0;
  std::vector<double> parameters;

  // The same view without distortion: focal lengths and principal point are kept.
  Pinhole pinhole() const;
  bool distorts() const;
  // Of a direction (x / z, y / z), x right and y down, with the distortion of the lens: COLMAP's
  // pixel.
  Eigen::Vector2d pixel(const Eigen::Vector2d& direction) const;
  // The inverse, to 1e-9; nothing where no direction has the pixel.
  std::optional<Eigen::Vector2d> direction(const Eigen::Vector2d& pixel) const;
};

// The number of parameters of a model; InputError, naming `what` and the models that there are, for
// another one than SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV and OPENCV_FISHEYE.
std::size_t parameters_of_model(const std::string& model, const std::string& what);
// The name of a model in binary files; "" for a number that COLMAP 3.8 does not have.
std::string name_of_model(std::int64_t number);
// InputError, naming `what`, for a camera that has no pixels, numbers that are not finite, focal
// lengths not above 0 or another number of parameters.
void check_camera(const ColmapCamera& camera, const std::string& what);

}  // namespace lapwing
