// SPDX-License-Identifier: Apache-2.0
// A raster beneath the scene: an orthophoto, a hill shading or heights of the ground, at the place
// that its reference system and the origin of the plan give it. Nothing is planned by it. Internal
// to this room.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "framework/geometry/geodetic_origin.h"
#include "framework/survey/height_raster.h"
#include "framework/trajectory/plan.h"

namespace lapwing {

// A picture of part of a raster, and where it lies.
struct PlacedPicture {
  int width = 0, height = 0;            // pixels
  std::vector<std::uint8_t> colours;    // red, green, blue, opacity, rows from the top
  double pixel = 0, pixel_of_file = 0;  // m, edges
  // World places (x and y, m) of the corners of `cells` by `cells` equal rectangles of the picture,
  // rows from the top. Between them, along two triangles each, the error is below a tenth of a
  // pixel, or the cells are as small as they get.
  int cells = 0;
  std::vector<Eigen::Vector2d> corners;
};

// InputError, naming the file, where it can be no backdrop of any plan: no raster, no
// georeferencing, no reference system, or one that PROJ does not know.
RasterLook backdrop_look(const std::filesystem::path& file);

// The part of the raster around a box of the world (m). InputError, naming the file, as above and
// where the raster does not reach into the box.
PlacedPicture placed_picture(const std::filesystem::path& file, const GeodeticOrigin& origin,
                             const Eigen::AlignedBox2d& around);

// The flight and what is at it; its parts that reach to infinity left out.
Eigen::AlignedBox2d box_of_scene(const Plan& plan);

// Remembers what it showed last.
class Backdrop {
 public:
  struct Shown {
    std::string members;  // of the message, as JSON without braces
    std::string picture;  // blob
  };
  // Of the plan on display; nothing where it is as it was shown last. InputError: of a plan without
  // an origin, with what to state, and as placed_picture.
  std::optional<Shown> shown_for(const std::filesystem::path& file, const Plan& plan);

 private:
  std::string looks_;  // of the file
  std::optional<GeodeticOrigin> origin_;
  Eigen::AlignedBox2d around_;
};

}  // namespace lapwing
