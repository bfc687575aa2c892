// SPDX-License-Identifier: Apache-2.0
// The coarse part of the alignment of a flight. Internal to this room.
#pragma once

#include <vector>

#include "framework/flight_review/flight_alignment.h"

namespace lapwing {

// A clock offset with the best offset and turn at it.
struct ClockCandidate {
  double clock = 0;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  double turn = 0;
  double cost = 1;  // mean of the bounded loss over the plan, 0 to 1
};

// m: a distance at which the loss is half of its bound.
double loss_scale(const Trajectory& plan);

// The best few of all clock offsets, the best first; neighbours within 2 s count as one.
std::vector<ClockCandidate> search_clocks(const Trajectory& plan, const FlownSeries& flown,
                                          const AlignmentRequest& asked);

// Of a flight that took another time than the plan: its places in order against those of the plan
// (dynamic time warping with free ends). `clock` is that of the beginning, `end` the log's time at
// the end of the plan; `cost` as above, `offset` the median one where `estimate_offset`.
struct WarpedMatch {
  double start = 0, end = 0;  // s of the log's clock
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  double cost = 1;
};
WarpedMatch search_places(const Trajectory& plan, const FlownSeries& flown, double from, double to,
                          const Eigen::Vector3d& offset, double turn, bool estimate_offset);

}  // namespace lapwing
