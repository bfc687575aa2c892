// SPDX-License-Identifier: Apache-2.0
// Small worlds of blocks in which path planners are checked. Internal to the room.
#pragma once

#include <string>
#include <vector>

#include "framework/path/path_planner.h"

namespace lapwing {

// Blocks parallel to the axes in empty space, exact.
class BlockSpace final : public FreeSpace {
 public:
  explicit BlockSpace(std::vector<Eigen::AlignedBox3d> blocks) : blocks_(std::move(blocks)) {}

  bool point_free(const Eigen::Vector3d& p) const override { return segment_free(p, p); }
  bool segment_free(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const override {
    return swept_box_free(from, to, Eigen::Vector3d::Zero());
  }
  bool swept_box_free(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                      const Eigen::Vector3d& half) const override;
  Eigen::AlignedBox3d bounds() const override;
  const std::vector<Eigen::AlignedBox3d>& blocks() const { return blocks_; }

 private:
  std::vector<Eigen::AlignedBox3d> blocks_;
};

struct PathWorld {
  std::string name;
  BlockSpace space;
  PathProblem problem;  // its `space` is set where it is used: worlds may move
  PathStatus answer = PathStatus::found;
  double shortest = 0;  // m, no path is shorter; 0 where there is none
};

std::vector<PathWorld> path_worlds();

}  // namespace lapwing
