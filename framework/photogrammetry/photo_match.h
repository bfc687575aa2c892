// SPDX-License-Identifier: Apache-2.0
// Which photographs were taken at which planned views.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace lapwing {

struct WantedView {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m, world
  Eigen::Vector3d ahead = Eigen::Vector3d::UnitX();    // unit, world: the camera's axis
};

struct TakenPhoto {
  std::string name;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();   // m, world
  std::optional<Eigen::Vector3d> ahead = std::nullopt;  // unit; absent: not known
};

struct MatchLimits {
  double distance = 3;  // m, between view and photograph
  double angle = 0.26;  // rad, between their axes, where that of the photograph is known
};

struct PhotoMatch {
  std::vector<int> photo_of_view;  // its place in the list; -1: none
  std::vector<int> unmatched;      // photographs of no view, in their order
  double distance = 0;             // m, root of the mean square over pairs
  double farthest = 0;             // m, of a pair
};

// Pairs each view with at most one photograph and each photograph with at most one view, within the
// limits: as many pairs as can be, and of those choices the one with the least sum of distances and
// angles, each as a share of its limit (successive shortest augmenting paths). Deterministic.
// InputError for limits that are not above 0 and for more than 20 million pairs within them.
PhotoMatch match_photos(const std::vector<WantedView>& views, const std::vector<TakenPhoto>& photos,
                        const MatchLimits& limits);

// m that the photographs lie higher than the views, by a constant: altitudes of cameras have other
// references than plans. Of all pairs that are near each other seen from above, the offset that
// most of them agree on, where each view and each photograph has one vote, the smaller with the
// distance from the offset; of those with 98 % of the most votes the one nearest to 0. Layers of
// views above each other are told apart as long as the offset is less than half their spacing. 0
// where no pair is near.
double common_height_offset(const std::vector<WantedView>& views,
                            const std::vector<TakenPhoto>& photos, double distance);

}  // namespace lapwing
