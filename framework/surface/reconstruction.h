// SPDX-License-Identifier: Apache-2.0
// What images of a surface would make of it: points that enough of them agree on, and how well
// those cover the surface (thesis 4.5.1, 4.5.4; readings 4.7, 4.11).
//
// Depth is rendered from the true surface. A measurement counts up to a distance and an angle of
// incidence; space is cut into small cubes, and a cube in which enough images measure something is
// reconstructed: the images agree there. Its measurements, averaged on a finer grid, are the
// points.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "framework/core/progress.h"
#include "framework/geometry/depth_camera.h"

namespace lapwing {

struct ReconstructionSettings {
  Eigen::AlignedBox3d region;  // of interest, m
  double grid = 0.05;          // m, of points of both kinds: half of `near` (reading 4.7)
  double near = 0.1;           // m, within which a point is close to another; edge of the cubes, a
                               // whole multiple of `grid`
  int images = 3;              // that must agree
  double range = 30;           // m of depth (reading 4.11)
  double incidence = 1.3089969389957472;  // rad, 75 degrees
};

// Points of one grid, in the order of their places; each is the mean of what fell there.
using GridPoints = std::vector<Eigen::Vector3f>;

struct ReconstructionScore {
  double precision = 0;  // share of reconstructed points that are close to the surface
  double recall = 0;  // share of the counted surface points that are close to a reconstructed one
  double f = 0;       // their harmonic mean; 0 where one of them is
  std::int64_t points = 0, surface_points = 0;
};

// Whether the surface at a point with a unit normal counts; asked by several threads at once.
using SurfaceCounts =
    std::function<bool(const Eigen::Vector3d& point, const Eigen::Vector3d& normal)>;

// The surface's points: triangles are cut until each has less than 0.25 m^2, each of those gives
// 100 points, and those are averaged on the grid. Thread-safe but for `count_only`.
class SurfaceSample {
 public:
  // InputError for settings that make no sense, a region without surface, or one of more than 2^20
  // grid places along an edge.
  SurfaceSample(const TriangleMesh& mesh, const ReconstructionSettings& settings, int threads);
  ~SurfaceSample();
  SurfaceSample(SurfaceSample&&) noexcept;

  const GridPoints& points() const;  // within the region

  // Which of `points` have a part of the surface that counts: a quarter of a cut triangle does if
  // its middle does. The same for any number of threads.
  std::vector<bool> counted(const TriangleMesh& mesh, const SurfaceCounts& counts,
                            int threads) const;
  // From now on recall is measured against these of `points` alone; precision stays against all.
  // InputError unless there is one entry for each point and at least one of them counts.
  void count_only(const std::vector<bool>& counted);
  double counted_share() const;  // of `points`; 1 unless `count_only` said otherwise
  // Points outside the region are left out. The same for any number of threads.
  ReconstructionScore score(const GridPoints& reconstructed, int threads) const;

 private:
  struct Index;
  std::unique_ptr<const Index> index_;
};

// Grows image by image. Copyable, so that two ways to go on share what they have in common.
class Reconstruction {
 public:
  explicit Reconstruction(const ReconstructionSettings& settings);  // InputError as above
  ~Reconstruction();
  Reconstruction(const Reconstruction& other);
  Reconstruction& operator=(const Reconstruction& other);

  // Depth of `scene` from every camera, ideal or with noise, which belongs to the seed and the
  // image's number in the whole. Normals are the surface's. The same for any number of threads, in
  // whatever parts images are added. InputError as check_camera; Cancelled when told to stop.
  void add(const MeshScene& scene, std::span<const Pose> cameras, const Pinhole& pinhole,
           const std::optional<DepthNoise>& noise, std::uint64_t seed, int threads,
           const CancellationToken* cancellation = nullptr);

  int images() const;
  GridPoints points(int threads) const;  // that enough images agree on

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace lapwing
