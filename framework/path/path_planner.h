// SPDX-License-Identifier: Apache-2.0
// A path planner: a free way between two places for a body that is a box (thesis 2.1). The plugin
// kind `path_planner`.
//
// The path is a list of points joined by straight lines; the body keeps its orientation. A planner
// reports, it never throws for what happens inside a search. Its work limit counts iterations, so
// that results repeat; the same problem, parameters and seed give the same path.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/plugin_object.h"
#include "framework/core/progress.h"
#include "framework/core/value.h"
#include "framework/path/free_space.h"

namespace lapwing {

struct PathProblem {
  const FreeSpace* space = nullptr;                 // outlives the call
  Eigen::Vector3d start = Eigen::Vector3d::Zero();  // m, world: of the body's middle
  Eigen::Vector3d goal = Eigen::Vector3d::Zero();
  Eigen::Vector3d half = Eigen::Vector3d::Zero();  // m, half edges of the body; at least 0
  Eigen::AlignedBox3d bounds;                      // the body's middle stays inside
};

struct PathRequest {
  std::uint64_t seed = 1;
  // Absent: the planner's own parameter.
  std::optional<std::int64_t> iteration_limit = std::nullopt;
  std::optional<double> wall_clock_guard = std::nullopt;  // s
  const CancellationToken* cancellation = nullptr;
};

enum class PathStatus {
  found,
  start_blocked,    // the body cannot be at the start, or it lies out of bounds
  goal_blocked,     // likewise
  iteration_limit,  // no path within the work allowed; there may be none
  time_limit,
  cancelled,
  unsupported,  // a problem that is none: numbers that are not finite, empty bounds
  failed,       // the planner broke its promise or threw; `message` says how
};
const char* to_string(PathStatus status);

struct PathReport {
  PathStatus status = PathStatus::failed;
  std::string message;          // one sentence
  bool straight = false;        // the straight line was free
  std::int64_t iterations = 0;  // 0 for a straight line
  double length = 0;            // m
  double seconds = 0;           // wall clock; never written into plan.json
};
// Without the wall-clock figure.
Value to_value(const PathReport& report, const std::string& planner_name);

struct PathResult {
  PathReport report;
  std::vector<Eigen::Vector3d> points;  // from start to goal; empty unless found
};

class PathPlanner : public PluginObject {
 public:
  using Interface = PathPlanner;
  static constexpr const char* kKind = "path_planner";
  virtual ~PathPlanner() = default;

  // Checks the problem, tries the straight line, then searches; every segment of what a search
  // returns is checked again, and corners that the way can do without are left out. Thread-safe.
  PathResult plan(const PathProblem& problem, const PathRequest& request = {}) const;

 protected:
  struct Search {
    PathStatus status = PathStatus::iteration_limit;
    std::string message;
    std::int64_t iterations = 0;
    std::vector<Eigen::Vector3d> points;  // start and goal included, where found
  };
  // The straight line is blocked; start and goal are free and in bounds.
  virtual Search search(const PathProblem& problem, const PathRequest& request) const = 0;
};

// The points without those that a straight way passes by: from each point on to the farthest one
// that can be reached from it. Never longer than before.
std::vector<Eigen::Vector3d> without_detours(const PathProblem& problem,
                                             std::vector<Eigen::Vector3d> points);

// m.
double path_length(const std::vector<Eigen::Vector3d>& points);

}  // namespace lapwing
