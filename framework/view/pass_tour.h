// SPDX-License-Identifier: Apache-2.0
// Which passes to fly, which way and in which order, so that their images show most within a
// budget of seconds.
//
// Legs of directed passes are not symmetric, and a pass is taken whole, so that solvers of tours
// (tour_solver.h) do not take this problem. The search is a greedy one with ruin and recreation (G.
// Schrimpf and others, "Record breaking optimization results using the ruin and recreate
// principle", J. Comput. Phys. 159, 2000): passes are inserted by what they add to the score over
// what they add to the time, where that is least; the order is shortened by moving, turning and
// reversing; some are taken out again, and what fills the time is kept where it shows more.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "framework/core/progress.h"
#include "framework/view/passes.h"
#include "framework/view/tour_solver.h"

namespace lapwing {

struct PassTour {
  TourReport report;  // of images and views; the upper bound is what all possible passes show
  std::vector<DirectedPass> order;
};

struct PassRequest {
  double budget = 0;  // s, leads at both ends included
  std::optional<int> image_limit = std::nullopt;
  std::int64_t iterations = 200;  // of ruin and recreation
  std::uint64_t seed = 1;
  const CancellationToken* cancellation = nullptr;
  Progress* progress = nullptr;
};

// The same problem and request give the same tour, unless it is cancelled. `infeasible` with its
// reason where no pass fits or none shows anything.
PassTour find_pass_tour(const PassProblem& problem, const PassRequest& request);

}  // namespace lapwing
