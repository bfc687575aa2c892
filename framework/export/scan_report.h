// SPDX-License-Identifier: Apache-2.0
// The report of a scan: what was known, what was considered, what was chosen, what it shows.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/value.h"
#include "framework/export/report.h"
#include "framework/geometry/mesh_scene.h"
#include "framework/map/known_surface.h"
#include "framework/map/unknown_edge.h"
#include "framework/photogrammetry/surface_prediction.h"
#include "framework/picture/mesh_picture.h"
#include "framework/trajectory/plan.h"

namespace lapwing {

// m^2 of the surface that was flown in, in simulation alone.
struct TrueAreas {
  double open = 0;   // that who flies could see from somewhere
  double first = 0;  // of it, seen before the tour
  double seen = 0;   // of it, seen by the tour
};

// What the images of a tour will show of the prior mesh.
struct ScanPrediction {
  std::shared_ptr<const MeshScene> surface;
  std::vector<char> counted;                  // of its triangles, whether they are in the region
  std::vector<TrianglePrediction> triangles;  // of all of them
  std::vector<SurfaceHole> holes;             // the largest first
  double pixel_error = 0;                     // pixels, of a point in an image
};

// What a scan was planned on, beside what its plan holds. Shared, not copied.
struct ScanRecord {
  std::optional<SceneView> scene;          // the scene that was flown in, where there was one
  std::shared_ptr<const Map> map;          // what the first flight knew
  std::shared_ptr<const MeshScene> prior;  // likewise
  bool surveyed = false;  // map and mesh are of a surveyor's data, not of a first flight
  std::vector<Eigen::Vector3d> first_views;
  std::vector<std::vector<Eigen::Vector2d>> footprints;  // of those, on the region's lowest level
  std::vector<Eigen::Vector3d> candidates;
  std::vector<double> alone;                 // score of each candidate by itself
  std::vector<std::pair<int, int>> motions;  // between candidates
  PlannedView shown;                         // one view of the tour
  std::vector<VoxelShare> told;              // what it tells of each voxel, 1 at most
  std::vector<VoxelShare> coverage;          // of all voxels that any candidate tells of
  std::vector<float> shares;                 // of the prior's triangles, see shares_of_triangles
  SurfaceAreas areas;                        // of those
  std::vector<Opening> openings;             // to what nobody saw, largest first
  double body_width = 0;                     // m; what passes through passable ones
  int tours = 1;                             // whose views these are of
  std::optional<TrueAreas> truth;
  std::optional<ScanPrediction> prediction;  // none of a tour of which nothing was predicted
  std::vector<double> seconds, score;        // after every view of the tour
  double reachable = 0;                      // score of all views within the budget
  double upper_bound = 0;                    // no tour scores more
};

// m^2 of all openings: a lower bound of the surface behind them.
double unknown_area(const ScanRecord& record);
// The areas in words: what is known, visible and seen, and what is not known and so not counted,
// with the largest opening to it. A second sentence where that is more than a tenth of what is
// known, or where the vehicle's box would pass through an opening: a view from there shows what is
// behind it, and that may be far larger than the opening.
std::string areas_in_words(const ScanRecord& record);
// The same of the true surface; "" where there is none.
std::string truth_in_words(const ScanRecord& record);
// For --json: m^2 and shares.
Value areas_as_value(const ScanRecord& record);

// Sections on the scene, map and prior; candidates; one view's rays; the tour; coverage; score over
// budget. The plan is that of a scan.
std::vector<Section> scan_sections(const Plan& plan, const ScanRecord& record);
// The parts of it that are of one tour of several, and of all of them: there the plan is any one of
// the fleet.
std::vector<Section> tour_sections(const Plan& plan, const ScanRecord& record);
std::vector<Section> fleet_sections(const Plan& plan, const ScanRecord& record);

}  // namespace lapwing
