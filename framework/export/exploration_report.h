// SPDX-License-Identifier: Apache-2.0
// What the report of an exploration shows beside its flight.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "framework/export/report.h"
#include "framework/picture/render.h"

namespace lapwing {

struct ExplorationMoment {
  int images = 0;                  // taken so far
  Picture map;                     // from above; of all moments the same frame and colours
  double lowest = 0, highest = 0;  // m, heights at both ends of the colours
};

struct ExplorationCandidate {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();    // m, world
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  // unit
  double value = 0;
};

struct ExplorationImage {
  double time = 0;                                     // s
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m, world
  double yaw = 0, pitch = 0;                           // rad
  double value = 0;                                    // of the utility, when it was chosen
  int scored = 0;                                      // views that were scored for it
};

// A voxel of the map at the end that is occupied, and the image after which it was so first.
struct GrownVoxel {
  Eigen::Vector3f middle;   // m, world
  std::uint32_t image = 0;  // from 1 on
};

// A slice at the camera's height of what a learned utility is shown around a view, as figures 5.4
// to 5.7 of the thesis have them: one grid of so many points along its edges, at several scales.
struct GridSlices {
  int points = 0;
  std::vector<Picture> occupancy, certainty;  // by level, the finest first; white is 1; ahead is up
  std::vector<double> edges;                  // m, of the grid at each level
};

// A ray of a view through the map, to where it is occupied or the range of the camera ends.
struct ExplorationRay {
  Eigen::Vector3f end;        // m, world
  float unknown_from = 1;     // share of its length at which it first meets an unknown voxel
  std::uint32_t unknown = 0;  // voxels
};

// What a view was chosen by: the map around it before its image.
struct ExplorationSight {
  GridSlices grid;
  std::vector<ExplorationRay> rays;
};

// An image while the exploration goes on.
struct TakenImage {
  std::string utility;
  int image = 0, asked = 0;  // from 1 on; of so many
  double surface = 0;        // voxels there are to find
  double resolution = 0;     // m, of the map
  ExplorationImage taken;
  std::optional<double> observed;      // (5.2); with a noisy camera it is known at the end
  std::vector<Eigen::Vector3f> grown;  // middles of voxels that are occupied for the first time
  ExplorationSight sight;
};

struct ExplorationRecord {
  std::string utility;
  std::string end;                         // a sentence
  double surface = 0;                      // voxels there were to find
  double efficiency = 0;                   // (5.6)
  double oracle_efficiency = 0;            // 0: not compared
  std::string oracle_end;                  // a sentence where it took fewer images; else empty
  double length = 0;                       // m
  std::vector<double> observed;            // (5.2), after each image
  std::vector<double> oracle;              // likewise, of the oracle; empty where not compared
  std::vector<Eigen::Vector3d> path;       // m, world
  std::vector<double> path_images;         // taken so far, at each place of the path
  std::vector<ExplorationMoment> moments;  // in time
  std::optional<double> cut;               // m, height above which they leave all out
  std::vector<ExplorationCandidate> candidates;  // at the end
  std::vector<ExplorationImage> images;
  std::vector<GrownVoxel> growth;        // by image; empty where it was not asked for
  std::vector<ExplorationSight> sights;  // of each image; likewise
  double resolution = 0;                 // m, of the map
  std::vector<GridSlices> grids;         // around the last view
};

// Summary, growth of the map, path, observed surface over images, candidates.
std::vector<Section> exploration_sections(const ExplorationRecord& record);

}  // namespace lapwing
