// SPDX-License-Identifier: Apache-2.0
// A pinhole camera at a place: where points of the world fall in its image.
//
// Pixel coordinates count from the centre of the upper left pixel, x right and y down, so that the
// image covers [-0.5, width - 0.5) x [-0.5, height - 0.5).
#pragma once

#include <optional>

#include <Eigen/Core>

#include "framework/geometry/camera_axes.h"

namespace lapwing {

struct Pinhole {
  int width = 0, height = 0;                // pixels
  double focal_x = 0, focal_y = 0;          // pixels
  double principal_x = 0, principal_y = 0;  // pixels

  // The same view with as many pixels as fit, at least 1 each way, to the rounding.
  Pinhole fitted(int most_across, int most_down) const;
};

// Square pixels, the axis through the middle; `across` is the angle between the left and the right
// edge, rad, in (0, pi).
Pinhole centered_pinhole(int width, int height, double across);

// The smallest box of an image, in pixels, that holds a thing; it may reach beyond the image.
struct ImageBox {
  double left = 0, top = 0, right = 0, bottom = 0;
};

struct CameraView {
  Pinhole pinhole;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m, world
  CameraAxes<double> axes;

  // The pixel of a point in the world; nothing when it is not in front of the camera.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p_W) const;
  // Whether the point is in front and inside the image.
  bool sees(const Eigen::Vector3d& p_W) const;
  // The unit vector in the world towards a pixel.
  Eigen::Vector3d ray(double x, double y) const;

  // The box of an upright cylinder; a height or width of 0 is a line or a point. Nothing when a
  // part of it is not in front.
  std::optional<ImageBox> box_of(const Eigen::Vector3d& middle, double height, double width) const;
};

}  // namespace lapwing
