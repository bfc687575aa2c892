// SPDX-License-Identifier: Apache-2.0
// Regions of interest: what of a place is to be seen, and what each part of it counts.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

namespace lapwing {

using GroundPolygon = std::vector<Eigen::Vector2d>;  // x, y of its corners, m, world

// All points above a polygon with holes, between two heights.
struct RegionPrism {
  std::string name;  // in messages; may be empty
  GroundPolygon outline;
  std::vector<GroundPolygon> holes;
  double low = 0, high = 0;  // m, world
  double weight = 1;         // what a voxel of it counts, above 0

  bool contains(const Eigen::Vector2d& p) const;  // heights apart
  double area() const;                            // m^2 on the ground, without its holes
  Eigen::AlignedBox3d bounds() const;
  bool operator==(const RegionPrism&) const = default;
  // Of messages: "region 'yard'", or with its number in the list (from 1) where it has no name.
  std::string label(std::size_t number) const;
};

// A box, or a set of prisms. Where prisms overlap, the largest of their weights counts; outside all
// of them the weight is 0.
class InterestRegion {
 public:
  InterestRegion() = default;  // empty
  // A box counts 1 everywhere. Not checked.
  InterestRegion(const Eigen::AlignedBox3d& box);  // NOLINT(google-explicit-constructor)
  // InputError, which names the prism, for what region_fault finds.
  explicit InterestRegion(std::vector<RegionPrism> prisms);

  bool operator==(const InterestRegion& other) const {
    return bounds_.min() == other.bounds_.min() && bounds_.max() == other.bounds_.max() &&
           prisms_ == other.prisms_;
  }
  bool is_box() const { return prisms_.empty(); }
  bool is_empty() const { return bounds_.isEmpty(); }
  const Eigen::AlignedBox3d& bounds() const { return bounds_; }
  // Of a box none.
  const std::vector<RegionPrism>& prisms() const { return prisms_; }

  double weight(const Eigen::Vector3d& p) const;
  bool contains(const Eigen::Vector3d& p) const;
  // The lowest and the highest point of the region over a place on the ground; nothing beside it.
  std::optional<std::pair<double, double>> heights_at(const Eigen::Vector2d& p) const;
  double largest_weight() const;
  // m^2 on the ground, of all prisms; where they overlap more than once.
  double area() const;

 private:
  Eigen::AlignedBox3d bounds_;
  std::vector<RegionPrism> prisms_;
};

// What is wrong with a prism, in words: a polygon that crosses itself or has no area, a hole
// outside of the outline, heights or a weight that make no sense; "" where nothing is.
std::string region_fault(const RegionPrism& prism);

}  // namespace lapwing
