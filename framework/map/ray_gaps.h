// SPDX-License-Identifier: Apache-2.0
// How wide the gaps are that the rays of depth images leave between them.
#pragma once

#include <array>
#include <vector>

#include "framework/geometry/camera_view.h"
#include "framework/geometry/mesh_scene.h"
#include "framework/geometry/pose.h"

namespace lapwing {

// A depth image whose rays measured a map.
struct MeasuringImage {
  Pose camera;
  Pinhole pinhole;
  double range = 0;  // m, along the optical axis
};

// The rays that measured a map.
struct MapRays {
  std::vector<MeasuringImage> images;
  double elsewhere = 0;  // m; width of gaps where none of the images looks
};

// The widest sphere that the rays through neighbouring pixels leave room for, m: the diagonal of
// four of them, `depth` metres along the optical axis.
double gap_between_rays(const Pinhole& pinhole, double depth);

// The gap at a place: that of the nearest image that sees it. An image sees a place that it has
// within its frame and its range, with nothing of the mesh (which may be null) in between. Where
// the mesh hides a place from all images, the nearest one that has it in its frame counts, for the
// place may lie within the surface; where there is none, `elsewhere` is the gap.
double gap_at(const Eigen::Vector3d& place, const MapRays& rays, const MeshScene* mesh);

// Places in rows along x, y and z.
struct PlaceLattice {
  Eigen::Vector3d first = Eigen::Vector3d::Zero();  // m, world
  double spacing = 1;                               // m
  std::array<int, 3> size{};                        // places along each axis

  std::size_t place(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(size[1]) +
            static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(size[0]) +
           static_cast<std::size_t>(x);
  }
};

// Of every place, x fastest: the widest gap at it and at those beside it, m. The edge of an
// image's frame, or of what it sees, may lie between two of them. The same for any number of
// threads.
std::vector<double> widest_gaps(const PlaceLattice& lattice, const MapRays& rays,
                                const MeshScene* mesh, int threads);

}  // namespace lapwing
