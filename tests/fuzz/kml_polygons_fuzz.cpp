// SPDX-License-Identifier: Apache-2.0
// KML polygons; the first byte says whether one name alone is read.
#include <cmath>
#include <cstdlib>
#include <string>

#include "framework/core/error.h"
#include "framework/survey/polygon_file.h"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    const auto file = lapwing::read_kml(text, data[0] == 'n' ? "yard" : "", "input");
    if (file.polygons.empty()) std::abort();
    for (const lapwing::SurveyPolygon& polygon : file.polygons) {
      if (polygon.outline.size() < 3) std::abort();
      for (const Eigen::Vector2d& corner : polygon.outline)
        if (!corner.allFinite()) std::abort();
      for (const auto& hole : polygon.holes)
        if (hole.size() < 3) std::abort();
    }
  } catch (const lapwing::InputError&) {
  }
  return 0;
}
