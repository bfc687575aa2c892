// The report of a scan: what was known, what was considered, what was chosen, what it shows.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "framework/export/report.h"
#include "framework/geometry/mesh_scene.h"
#include "framework/geometry/render.h"
#include "framework/map/map.h"
#include "framework/trajectory/plan.h"

namespace lapwing {

// What a voxel of the map has, from 0 to 1.
struct VoxelShare {
  VoxelKey voxel;
  float share = 0;
};

// What a scan was planned on, beside what its plan holds. Shared, not copied.
struct ScanRecord {
  std::optional<Picture> scene;            // the scene that was flown in, where there was one
  std::shared_ptr<const Map> map;          // what the first flight knew
  std::shared_ptr<const MeshScene> prior;  // likewise
  std::vector<Eigen::Vector3d> first_views;
  std::vector<Eigen::Vector3d> candidates;
  std::vector<std::pair<int, int>> motions;  // between candidates
  PlannedView shown;                         // one view of the tour
  std::vector<VoxelShare> told;              // what it tells of each voxel, 1 at most
  std::vector<VoxelShare> coverage;          // of all voxels that any candidate tells of
  std::vector<double> seconds, score;        // after every view of the tour
  double reachable = 0;                      // score of all views within the budget
  double upper_bound = 0;                    // no tour scores more
};

// Sections on the scene, map and prior; candidates; one view's rays; the tour; coverage; score over
// budget. The plan is that of a scan.
std::vector<Section> scan_sections(const Plan& plan, const ScanRecord& record);

}  // namespace lapwing
