// SPDX-License-Identifier: Apache-2.0
#include "framework/export/region_drawing.h"

#include <cmath>

#include "framework/core/number_text.h"

namespace lapwing {
namespace {

void add_prism_edges(const GroundPolygon& corners, double low, double high, Polyline& line) {
  const Eigen::Vector3d gap = Eigen::Vector3d::Constant(std::nan(""));
  for (const double height : {low, high}) {
    for (std::size_t i = 0; i <= corners.size(); ++i) {
      const Eigen::Vector2d& corner = corners[i % corners.size()];
      line.points.emplace_back(corner.x(), corner.y(), height);
    }
    line.points.push_back(gap);
  }
  for (const Eigen::Vector2d& corner : corners) {
    line.points.emplace_back(corner.x(), corner.y(), low);
    line.points.emplace_back(corner.x(), corner.y(), high);
    line.points.push_back(gap);
  }
}

}  // namespace

void add_region(const InterestRegion& region, Drawing& drawing) {
  if (region.is_empty()) return;
  if (region.is_box()) {
    const Eigen::Vector3d &low = region.bounds().min(), &high = region.bounds().max();
    Polyline line{"region", {}, {}, {}};
    add_prism_edges(
        {{low.x(), low.y()}, {high.x(), low.y()}, {high.x(), high.y()}, {low.x(), high.y()}},
        low.z(), high.z(), line);
    drawing.lines.push_back(std::move(line));
    return;
  }
  std::size_t number = 0;
  for (const RegionPrism& prism : region.prisms()) {
    Polyline line{prism.label(++number), {}, {}, {}};
    if (prism.weight != 1) line.name += ", weight " + plain_number(prism.weight);
    add_prism_edges(prism.outline, prism.low, prism.high, line);
    for (const GroundPolygon& hole : prism.holes)
      add_prism_edges(hole, prism.low, prism.high, line);
    drawing.lines.push_back(std::move(line));
  }
}

}  // namespace lapwing
