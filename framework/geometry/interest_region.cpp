// SPDX-License-Identifier: Apache-2.0
#include "framework/geometry/interest_region.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/geometry/polygon.h"

namespace lapwing {

bool RegionPrism::contains(const Eigen::Vector2d& p) const {
  return polygon_contains(outline, p) &&
         std::none_of(holes.begin(), holes.end(),
                      [&](const GroundPolygon& hole) { return polygon_contains(hole, p); });
}

double RegionPrism::area() const {
  double area = polygon_area(outline);
  for (const GroundPolygon& hole : holes) area -= polygon_area(hole);
  return area;
}

Eigen::AlignedBox3d RegionPrism::bounds() const {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector2d& p : outline) {
    box.extend(Eigen::Vector3d(p.x(), p.y(), low));
    box.extend(Eigen::Vector3d(p.x(), p.y(), high));
  }
  return box;
}

std::string RegionPrism::label(std::size_t number) const {
  return name.empty() ? "region " + std::to_string(number) : "region '" + name + "'";
}

std::string region_fault(const RegionPrism& prism) {
  constexpr double kFarthest = 1e6;  // m
  const auto far = [](const GroundPolygon& corners) {
    return std::any_of(corners.begin(), corners.end(), [](const Eigen::Vector2d& p) {
      return !(p.cwiseAbs().maxCoeff() <= kFarthest);
    });
  };
  if (far(prism.outline) || std::any_of(prism.holes.begin(), prism.holes.end(), far))
    return "a corner lies more than 1e6 m from the origin of the world";
  if (const std::string fault = polygon_fault(prism.outline); !fault.empty()) return fault;
  for (std::size_t k = 0; k < prism.holes.size(); ++k) {
    const std::string hole = "hole " + std::to_string(k + 1) + ": ";
    if (const std::string fault = polygon_fault(prism.holes[k]); !fault.empty())
      return hole + fault;
    if (const std::string fault = fault_within(prism.holes[k], prism.outline); !fault.empty())
      return hole + "it must lie within the outline, and " + fault;
  }
  if (!(std::abs(prism.low) <= kFarthest && std::abs(prism.high) <= kFarthest &&
        prism.low < prism.high))
    return "its lower end must be below its upper one: " + plain_number(prism.low) + " m and " +
           plain_number(prism.high) + " m";
  if (!(prism.weight > 0 && prism.weight <= 1e6))
    return "its weight must be above 0 and at most 1e6, not " + plain_number(prism.weight);
  return "";
}

InterestRegion::InterestRegion(const Eigen::AlignedBox3d& box) : bounds_(box) {}

InterestRegion::InterestRegion(std::vector<RegionPrism> prisms) : prisms_(std::move(prisms)) {
  if (prisms_.empty()) throw InputError("a region of interest needs a prism");
  for (std::size_t k = 0; k < prisms_.size(); ++k) {
    if (const std::string fault = region_fault(prisms_[k]); !fault.empty())
      throw InputError(prisms_[k].label(k + 1) + ": " + fault);
    bounds_.extend(prisms_[k].bounds());
  }
}

double InterestRegion::weight(const Eigen::Vector3d& p) const {
  if (!bounds_.contains(p)) return 0;
  if (is_box()) return 1;
  double weight = 0;
  for (const RegionPrism& prism : prisms_)
    if (prism.weight > weight && p.z() >= prism.low && p.z() <= prism.high &&
        prism.contains(p.head<2>()))
      weight = prism.weight;
  return weight;
}

bool InterestRegion::contains(const Eigen::Vector3d& p) const {
  return weight(p) > 0;
}

std::optional<std::pair<double, double>> InterestRegion::heights_at(
    const Eigen::Vector2d& p) const {
  if (is_empty()) return std::nullopt;
  if (is_box()) {
    if (!bounds_.contains(Eigen::Vector3d(p.x(), p.y(), bounds_.min().z()))) return std::nullopt;
    return std::pair(bounds_.min().z(), bounds_.max().z());
  }
  std::optional<std::pair<double, double>> heights;
  for (const RegionPrism& prism : prisms_) {
    if (!prism.contains(p)) continue;
    if (!heights) heights.emplace(prism.low, prism.high);
    heights->first = std::min(heights->first, prism.low);
    heights->second = std::max(heights->second, prism.high);
  }
  return heights;
}

double InterestRegion::largest_weight() const {
  double largest = is_box() ? 1 : 0;
  for (const RegionPrism& prism : prisms_) largest = std::max(largest, prism.weight);
  return largest;
}

double InterestRegion::area() const {
  if (is_empty()) return 0;
  if (is_box()) return bounds_.sizes().x() * bounds_.sizes().y();
  double area = 0;
  for (const RegionPrism& prism : prisms_) area += prism.area();
  return area;
}

}  // namespace lapwing
