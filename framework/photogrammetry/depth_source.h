// SPDX-License-Identifier: Apache-2.0
// Depth images whose cameras are known, wherever they come from.
#pragma once

#include <memory>
#include <string>

#include "framework/geometry/depth_folder.h"
#include "framework/photogrammetry/similarity.h"

namespace lapwing {

// Immutable; reads are thread-safe.
class DepthSource {
 public:
  virtual ~DepthSource() = default;
  virtual std::size_t size() const = 0;
  virtual std::string name(std::size_t image) const = 0;
  virtual Pose camera(std::size_t image) const = 0;
  virtual Pinhole pinhole(std::size_t image) const = 0;
  // Throws InputError naming the file that cannot be read.
  virtual PosedDepthImage read(std::size_t image) const = 0;
};

// Of a folder of depth images.
std::shared_ptr<const DepthSource> depth_of_folder(DepthFolder folder);
// The same images with their cameras and depths in another frame.
std::shared_ptr<const DepthSource> placed(std::shared_ptr<const DepthSource> source,
                                          const Similarity& to_world);

}  // namespace lapwing
