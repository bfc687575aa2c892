// SPDX-License-Identifier: Apache-2.0
// What surveyors' data make of a site: points and voxels in the world frame.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "framework/geometry/height_grid.h"
#include "framework/geometry/triangle_mesh.h"
#include "framework/map/sky_columns.h"
#include "framework/mission/map_work.h"
#include "framework/surface/cloud_surface.h"
#include "framework/survey/cloud_reader.h"
#include "framework/survey/site_reference.h"

namespace lapwing {

// A site as data show it: by points with normals, or by a mesh and what is solid beneath it.
struct Site {
  std::string name;                       // of the file
  std::string description;                // "LAS 1.4, point format 6, 1000 points"
  std::vector<std::string> notes;         // sentences for the user
  Eigen::AlignedBox3d bounds;             // m, world, of all that is kept
  double resolution = 0;                  // m, of the voxels
  double spacing = 0;                     // m, between points of the surface
  std::vector<FusedPoint> points;         // of a cloud
  std::vector<VoxelKey> measured;         // voxels with points, in the order of keys
  std::vector<Eigen::Vector3d> scanners;  // m, world
  std::optional<TriangleMesh> mesh;       // in place of points
  std::optional<SkyColumns> solid;        // of a surface model: what is under it
  // Heights of the terrain, of a surface model; those of the surface where there are no others.
  std::shared_ptr<const HeightGrid> ground;
  std::optional<GeodeticOrigin> origin;  // of the world, where the data tell and the mission not
};

struct CloudRequest {
  std::filesystem::path file;
  CloudFileOptions options;
  StatedReference reference;              // without what the data say; its name stands in messages
  std::set<int> without;                  // classes that are left out
  std::vector<Eigen::Vector3d> scanners;  // in the cloud's coordinates
  std::optional<Eigen::AlignedBox2d> only;  // m, world: what lies outside is left out
  double resolution = 0.2, spacing = 0.4;   // m
  std::size_t most = 20'000'000;            // voxels with points
};

// Reads the cloud point by point; what is kept is thinned to one point a voxel. Points that are not
// finite, that the file withholds or of a class in `without` are left out, and a note counts them.
// InputError, naming the file: all that the reader and refer_site refuse, no points, a point more
// than kFarthestSite away, more voxels than `most`, and what surface_of_cloud refuses. Cancelled.
Site read_site_cloud(const CloudRequest& request, const MapWork& work);

// How the air of a site becomes free.
struct SiteAir {
  bool sky = true;       // above the highest occupied voxel of each column that has one
  bool scanners = true;  // along lines from scanners to points
  double ceiling = 0;    // m, world: the open sky is free up to there
  double range = 0;      // m, longest line from a scanner
};

// Voxels of the site with its mesh into the map: first what is free, then what is occupied. Voxels
// that are neither stay as they are.
void map_site(const Site& site, const TriangleMesh& mesh, const SiteAir& air, Map& map);

}  // namespace lapwing
