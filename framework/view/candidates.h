// SPDX-License-Identifier: Apache-2.0
// Viewpoints worth considering around a region of interest (thesis 4.4.4, 4.8, algorithm 3;
// readings 4.5, 4.11).
#pragma once

#include <cstdint>
#include <vector>

#include "framework/core/progress.h"
#include "framework/path/free_space.h"
#include "framework/view/viewpoint.h"

namespace lapwing {

// A part of the region that views look at: one of several, drawn by their shares.
struct ViewAim {
  Eigen::AlignedBox3d box;
  double share = 1;  // above 0, in any unit
};

// Where no view is taken.
struct ViewlessBall {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  double radius = 1;  // m
};

struct CandidateSettings {
  Eigen::AlignedBox3d region;          // of interest, all of it
  std::vector<ViewAim> aims = {};      // empty: views look at all of the region
  Eigen::AlignedBox3d allowed;         // where the body's middle may be
  Eigen::Vector3d half = {1, 1, 0.5};  // m, half edges of the vehicle's box
  double step = 1.5;                   // m between neighbours at the region
  double step_growth = 0.2;            // m more for every metre away from it
  // Two candidates are apart by one of these at least: a place has several that look elsewhere.
  double distance_apart = 1;                       // m
  double angle_apart = 15 * 0.017453292519943295;  // rad
  // The camera's own limits (thesis: a gimbal that does not look up).
  double pitch_min = -1.5707963267948966, pitch_max = 0;  // rad
  int most = 5000;
  std::vector<ViewlessBall> viewless = {};  // the given viewpoints may lie there
  int directions = 3;             // of each place, where there is room for so many within `most`
  int least = 0;                  // where growing finds fewer, free places are drawn as well
  int most_failed_draws = 10000;  // of those, in a row
};

// Why there is no candidate at a place.
enum class PlaceLoss : std::uint8_t {
  outside,   // of the box that is allowed
  blocked,   // the body's box is not free there
  viewless,  // it lies in a ball without views
  thinned,   // there are more places than `most` candidates can have
};
struct LostPlace {
  Eigen::Vector3d position;
  PlaceLoss why;
};

struct Candidates {
  std::vector<Viewpoint> viewpoints;  // the given ones first
  int given = 0;
  std::int64_t blocked = 0, crowded = 0;  // places that were refused, and why
  std::int64_t grown = 0;                 // free places that were found
  std::int64_t places = 0;                // of them, those that have candidates
  // Places where growing stopped, no two of which are nearer than `distance_apart`, and places that
  // were left out afterwards. Of more than so many the number alone.
  static constexpr std::size_t kMostLost = 200000;
  std::vector<LostPlace> lost;
  std::int64_t lost_beyond = 0;
};

// Whether a place lies in one of the balls.
bool is_viewless(const std::vector<ViewlessBall>& balls, const Eigen::Vector3d& place);

// Places grow from the given viewpoints along the axes, in random order, until there is nothing
// new. Where they are more than `most` candidates can have, places are left out evenly, so that the
// farthest corner that the steps led to keeps its share. Each place then has as many views as
// `most` allows, which look towards the middle of the region or of one of its parts, turned by a
// normal error as wide as half the angle that its box takes. A pitch beyond the camera's limits is
// drawn again. The same seed gives the same candidates.
//
// InputError: no given viewpoint, one whose box is not free or lies outside `allowed` (naming it),
// an empty region, settings that make no sense. Cancelled when told to stop.
Candidates generate_candidates(const FreeSpace& space, const std::vector<Viewpoint>& given,
                               const CandidateSettings& settings, std::uint64_t seed,
                               const CancellationToken* cancellation = nullptr);

}  // namespace lapwing
