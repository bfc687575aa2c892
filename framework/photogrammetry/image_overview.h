// SPDX-License-Identifier: Apache-2.0
// What depth images show as a whole: how far, how large, and which way is up.
#pragma once

#include <vector>

#include "framework/core/progress.h"
#include "framework/photogrammetry/depth_source.h"

namespace lapwing {

struct ImageOverview {
  std::size_t images = 0;
  std::size_t empty = 0;     // of them, those without any measurement
  std::int64_t samples = 0;  // measurements that the figures are of
  double median_depth = 0;   // m
  double far_depth = 0;      // m, of all but 2 % of the samples
  // Holds all but 1 % of the samples at either side of each axis, m, frame of the images.
  Eigen::AlignedBox3d surface;
  Eigen::AlignedBox3d cameras;  // places of the cameras, m
};

// Every `stride`-th pixel of every such row. InputError where no image has a measurement, and as
// DepthSource::read; Cancelled when told to stop. The same for any number of threads.
ImageOverview overview_of(const DepthSource& source, int stride, int threads,
                          const CancellationToken* cancellation = nullptr);

struct UpEstimate {
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  // unit, frame of the images
  std::size_t cameras = 0;
  // Samples whose normals agree with `up` to 10 degrees, as a share of all; 0: it is from the
  // cameras alone.
  double level_share = 0;
};

// Up is at right angles to the cameras' x axes as well as can be, because cameras are held level
// (Brown and Lowe 2007, 3.4), on the side of the upper edges of the images. Where all cameras look
// the same way that does not determine it, and the mean of the upward axes of the images is used.
// The most frequent normal within 30 degrees of it replaces it where it is that of 5 % of the
// surface: floors, tables and grounds are level. InputError for no camera.
UpEstimate estimate_up(const DepthSource& source, int stride, int threads,
                       const CancellationToken* cancellation = nullptr);
// From cameras and normals alone; normals are unit.
UpEstimate estimate_up(const std::vector<Pose>& cameras,
                       const std::vector<Eigen::Vector3d>& normals);

}  // namespace lapwing
