// SPDX-License-Identifier: Apache-2.0
// Where a model of photographs is in the world, and how large: from positions of its cameras, from
// distances, or from a scale.
#pragma once

#include <string>
#include <vector>

#include "framework/photogrammetry/similarity.h"

namespace lapwing {

struct PlacedPoint {
  std::string name;
  Eigen::Vector3d model = Eigen::Vector3d::Zero();  // units of the model
  Eigen::Vector3d world = Eigen::Vector3d::Zero();  // m, measured
};

struct PlacementFit {
  Similarity to_world;
  std::size_t used = 0, given = 0;
  double residual = 0;                // m, root of the mean square of those used
  double largest = 0;                 // m, of those used
  std::vector<std::string> left_out;  // names of those farther than three times the accuracy
};

// The similarity with the least sum of squares (Umeyama 1991) over the points that fit: of all
// triples, or 2000 of them by a fixed seed, that with most points within three times `accuracy`
// (m) begins. InputError for fewer than three points, an accuracy that is not above 0, points that
// lie nearly in one line (which leaves the turn about it open), and where fewer than half of the
// points agree.
PlacementFit fit_placement(const std::vector<PlacedPoint>& points, double accuracy);

struct StatedDistance {
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = Eigen::Vector3d::Zero();  // model
  double metres = 0;
};

struct ScaleFit {
  double scale = 1;  // m per unit
  double worst = 0;  // largest error of a distance, as a share of it
};

// Least squares. InputError for no distance, one that is not above 0 m, two points that coincide,
// and distances that disagree by more than 5 %.
ScaleFit fit_scale(const std::vector<StatedDistance>& distances);

}  // namespace lapwing
