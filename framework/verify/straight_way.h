// SPDX-License-Identifier: Apache-2.0
// Whether a straight way that is no part of a plan keeps clear of the plan's surroundings, by the
// distances of the check `clearance`. World frame, metres.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "framework/trajectory/environment.h"

namespace lapwing {

class JudgedShape;

class StraightWay {
 public:
  // Keeps a reference. Files of meshes and maps are read from `folder`; a map is known within
  // `around` metres of `place`. Throws InputError for a file that is not there or not as it was.
  StraightWay(const Environment& environment, const std::filesystem::path& folder,
              const Eigen::Vector3d& place, double around);
  ~StraightWay();
  StraightWay(StraightWay&&) noexcept;

  // What of the surroundings, as they are at `time`, is nearer to the way than the margin, or than
  // a subject asks for, and how near; empty where nothing is. Distances are never overestimated.
  // 5 cm are forgiven, which vehicles that stand at the start of a plan do not know.
  std::string blocked(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double time) const;

 private:
  const Environment& environment_;
  std::vector<std::unique_ptr<JudgedShape>> shapes_;
};

}  // namespace lapwing
