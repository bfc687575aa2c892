// SPDX-License-Identifier: Apache-2.0
// Pictures of simple bodies by daylight, for previews: what a planned camera would film.
//
// One sun with hard shadows, a sky, a checkered ground that fades into haze at the horizon. The
// same input gives the same bytes.
#pragma once

#include <vector>

#include "framework/core/png.h"
#include "framework/geometry/camera_view.h"
#include "framework/geometry/scene.h"

namespace lapwing {

struct Color {
  double red = 0, green = 0, blue = 0;  // sRGB, 0 to 1
};

struct Body {
  BodyShape shape;
  Color color;               // of ground: the mean of its squares, which are 1 m and 10 m wide
  bool see_through = false;  // tints what is behind it and casts no shadow
};

class Renderer {
 public:
  // Throws as Scene does.
  explicit Renderer(const std::vector<Body>& bodies);

  // What the camera sees. Throws InputError when the view has no pixel or more than 100 million.
  // Thread-safe.
  Picture picture(const CameraView& view) const;

 private:
  Scene solid_, see_through_;
  std::vector<Color> solid_colors_, see_through_colors_;  // linear light, as the scenes' shapes
};

}  // namespace lapwing
