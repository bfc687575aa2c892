// SPDX-License-Identifier: Apache-2.0
// What a viewer asks about a scan that was planned: a voxel, the places that were left out, a view.
// All is what planning itself goes by; thread-safe, as the graph does not change any more.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "framework/map/known_surface.h"
#include "framework/mission/scan_objects.h"

namespace lapwing {

// One tour of a plan, and what it was chosen from.
struct KeptTour {
  std::shared_ptr<const ScanWork> work;
  std::vector<int> images;     // of the plan's views, in their order: their numbers in the graph
  std::vector<int> reachable;  // as of TourObject
};

// An image in which a voxel is seen.
struct ImageOfVoxel {
  std::size_t tour = 0, image = 0;  // from 0; of the plan's views
  VoxelSight sight;
  float told = 0;  // of the voxel, by this image alone, 1 at most
};

struct VoxelLook {
  VoxelReading reading;
  double weight = 0;                 // what it counts; 0 outside of the region
  std::vector<ImageOfVoxel> images;  // tour by tour
  float share = 0;                   // what all of them tell, 1 at most: the report's coverage
};

// `tours` are one plan's, one at least.
VoxelLook look_at_voxel(std::span<const KeptTour> tours, const VoxelKey& voxel, int threads);

// Why no image is taken at a place, or from a candidate. The first that holds.
enum class LeftOutReason : std::uint8_t {
  outside,      // of the space of the tour
  obstacle,     // the vehicle's box meets an occupied voxel or the prior mesh
  unknown,      // it meets unknown voxels
  close,        // it is nearer to the prior mesh than planning keeps
  no_fly,       // it meets a no-fly zone, with the margin
  flight_zone,  // it leaves a flight zone, with the margin
  pilot,        // the pilot does not see it
  forbidden,    // the user forbids views there
  thinned,      // places were left out evenly, because there were too many
  nothing,      // the candidate sees nothing of use
  apart,        // no motions join the candidate to the tour
  budget,       // no tour within the budget passes the candidate
  not_chosen,   // other views tell more within the budget
};
inline constexpr int kLeftOutReasons = 13;
const char* to_string(LeftOutReason reason);  // "no_fly"

struct LeftOutPlace {
  Eigen::Vector3d position;
  LeftOutReason why;
};

struct LeftOut {
  std::vector<LeftOutPlace> places;  // those without candidates first, then candidates
  std::int64_t beyond = 0;           // places without candidates that are not listed
};

LeftOut left_out_of(std::span<const KeptTour> tours, int threads);

// A motion from a view to another one.
struct WayToView {
  int view = 0;                         // the other one
  std::vector<Eigen::Vector3d> points;  // from the view to it
  double seconds = 0;                   // as the tour counts it, the other view included
};

struct ViewLook {
  Viewpoint view;
  double score = 0;              // by itself
  std::vector<WayToView> ways;   // to its neighbours
  std::vector<VoxelShare> told;  // by this view alone, of each voxel that it tells of, 1 at most
};

// `view` is a number in the graph.
ViewLook look_from_view(const ScanWork& work, int view);

// bytes that a plan's graph and map take.
std::size_t bytes_of(const ScanWork& work);

}  // namespace lapwing
