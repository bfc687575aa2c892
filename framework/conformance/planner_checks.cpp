// SPDX-License-Identifier: Apache-2.0
// What every path planner must pass.
#include <atomic>
#include <chrono>
#include <cmath>

#include "framework/conformance/differences.h"
#include "framework/conformance/every_case.h"
#include "framework/conformance/path_worlds.h"

namespace lapwing {
namespace {

constexpr std::int64_t kIterations = 6000;

// Asks a planner's own search, before the kernel looks at what comes back and mends it.
class OwnPath : public PathPlanner {
 public:
  using Answer = Search;
  static Answer of(const PathPlanner& planner, const PathProblem& problem,
                   const PathRequest& request) {
    return (planner.*(&OwnPath::search))(problem, request);
  }
};

// Cancels when it has been asked so often.
class WatchedSpace final : public FreeSpace {
 public:
  WatchedSpace(const FreeSpace& space, CancellationToken& token, int cancel_after)
      : space_(space), token_(token), cancel_after_(cancel_after) {}
  bool point_free(const Eigen::Vector3d& p) const override { return watch(), space_.point_free(p); }
  bool segment_free(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const override {
    return watch(), space_.segment_free(from, to);
  }
  bool swept_box_free(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                      const Eigen::Vector3d& half) const override {
    return watch(), space_.swept_box_free(from, to, half);
  }
  Eigen::AlignedBox3d bounds() const override { return space_.bounds(); }
  int asked() const { return asked_; }

 private:
  void watch() const {
    if (++asked_ == cancel_after_) token_.cancel();
  }
  const FreeSpace& space_;
  CancellationToken& token_;
  int cancel_after_;
  mutable std::atomic<int> asked_ = 0;
};

// What is wrong with a way, looked at every centimetre; "" when nothing is.
std::string fault_of_way(const PathProblem& problem, const std::vector<Eigen::AlignedBox3d>& blocks,
                         const std::vector<Eigen::Vector3d>& way) {
  constexpr double kTouch = 1e-6;  // m
  if (way.size() < 2 || way.front() != problem.start || way.back() != problem.goal)
    return "does not join start and goal";
  for (std::size_t i = 1; i < way.size(); ++i) {
    const std::string segment = "segment " + std::to_string(i);
    const int steps = 1 + static_cast<int>((way[i] - way[i - 1]).norm() / 0.01);
    for (int s = 0; s <= steps; ++s) {
      const Eigen::Vector3d p = way[i - 1] + (way[i] - way[i - 1]) * s / steps;
      for (int a = 0; a < 3; ++a)
        if (!(p[a] >= problem.bounds.min()[a] - kTouch && p[a] <= problem.bounds.max()[a] + kTouch))
          return segment + " leaves the bounds";
      for (const Eigen::AlignedBox3d& block : blocks) {
        bool inside = true;
        for (int a = 0; a < 3; ++a)
          inside &= p[a] + problem.half[a] > block.min()[a] + kTouch &&
                    p[a] - problem.half[a] < block.max()[a] - kTouch;
        if (inside) return segment + " runs through a block";
      }
    }
  }
  return "";
}

class PlannerCheck {
 public:
  PlannerCheck(const PathPlanner& planner, const CheckOptions& options, Findings& findings)
      : planner_(planner), options_(options), findings_(findings) {}

  // Whether answers must be right: with a parameter at the end of its range a path may stay
  // unfound, but what is said must be true.
  void run(bool right) {
    const bool answers =
        options_.wants_any({"answers", "honest", "messages", "paths", "work limit"});
    if (!right && !answers) return;
    for (const PathWorld& world : path_worlds()) {
      if (findings_.settled()) return;
      PathProblem problem = world.problem;
      problem.space = &world.space;
      PathRequest request;
      request.iteration_limit = right ? kIterations : 300;
      if (!answers && !options_.wants("repeatable")) {
        stops(world, problem);
        continue;
      }
      const PathResult result = planner_.plan(problem, request);
      honest(world, result, *request.iteration_limit);
      if (!right) continue;
      if (options_.wants("paths")) own_path(world, problem);
      findings_.expect("answers", result.report.status == world.answer, [&] {
        return world.name + ": says " + to_string(result.report.status) + " (" +
               result.report.message + "), not " + to_string(world.answer);
      });
      if (options_.wants("repeatable")) repeatable(world, problem, request, result);
      if (options_.wants_any({"cancellation", "wall clock"})) stops(world, problem);
    }
  }

 private:
  void honest(const PathWorld& world, const PathResult& result, std::int64_t limit) {
    const PathReport& report = result.report;
    const bool found = report.status == PathStatus::found;
    findings_.expect("honest", found == !result.points.empty(), [&] {
      return world.name + ": says " + to_string(report.status) + " and returns " +
             std::to_string(result.points.size()) + " points";
    });
    findings_.expect("honest", report.status != PathStatus::failed,
                     [&] { return world.name + ": " + report.message; });
    findings_.expect("messages", !report.message.empty(),
                     [&] { return world.name + ": gives no reason"; });
    findings_.expect("work limit", report.iterations <= limit, [&] {
      return world.name + ": took " + std::to_string(report.iterations) + " iterations of " +
             std::to_string(limit);
    });
    if (!found) return;
    findings_.expect("honest", world.answer == PathStatus::found,
                     [&] { return world.name + ": finds a path where there is none"; });
    length(world, result);
  }

  void length(const PathWorld& world, const PathResult& result) {
    double length = 0;
    for (std::size_t i = 1; i < result.points.size(); ++i)
      length += (result.points[i] - result.points[i - 1]).norm();
    findings_.expect("honest", length >= world.shortest - 1e-6, [&] {
      return world.name + ": a path of " + text_of(length) + " m is shorter than the shortest, " +
             text_of(world.shortest) + " m";
    });
  }

  // The way that the search itself returns. It is asked only where the straight line is blocked.
  void own_path(const PathWorld& world, const PathProblem& problem) {
    const bool blocked = !problem.space->swept_box_free(problem.start, problem.goal, problem.half);
    const bool searched = world.answer == PathStatus::found && blocked;
    if (!searched && world.answer != PathStatus::iteration_limit) return;
    PathRequest request;
    request.iteration_limit = 1000;
    const OwnPath::Answer answer = OwnPath::of(planner_, problem, request);
    if (answer.status != PathStatus::found) return;
    const std::string fault = fault_of_way(problem, world.space.blocks(), answer.points);
    findings_.expect("paths", fault.empty(), [&] { return world.name + ": " + fault; });
  }

  void repeatable(const PathWorld& world, const PathProblem& problem, PathRequest request,
                  const PathResult& first) {
    const PathResult again = planner_.plan(problem, request);
    const bool same = again.points == first.points && again.report.status == first.report.status &&
                      again.report.iterations == first.report.iterations;
    findings_.expect("repeatable", same,
                     [&] { return world.name + ": another answer the second time"; });
  }

  void stops(const PathWorld& world, const PathProblem& problem) {
    if (world.answer != PathStatus::iteration_limit) return;
    CancellationToken token;
    token.cancel();
    PathRequest request;
    request.iteration_limit = kIterations;
    request.cancellation = &token;
    const PathStatus status = planner_.plan(problem, request).report.status;
    findings_.expect("cancellation", status == PathStatus::cancelled, [&] {
      return world.name + ": cancelled before it began, says " + to_string(status);
    });
    request.cancellation = nullptr;
    if (options_.wants("wall clock")) out_of_time(world, problem, request);
    if (options_.wants("cancellation")) cancelled_within(world, problem);
  }

  // The quickest of some tries, since other work may hold one up.
  void out_of_time(const PathWorld& world, const PathProblem& problem, PathRequest request) {
    constexpr double kLate = 0.2;  // s, after a guard of none at all
    request.wall_clock_guard = 0;
    double quickest = HUGE_VAL;
    for (int turn = 0; turn < 4 && quickest > kLate; ++turn) {
      const auto began = std::chrono::steady_clock::now();
      const PathStatus late = planner_.plan(problem, request).report.status;
      const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
      quickest = std::min(quickest, took.count());
      findings_.expect("wall clock", late == PathStatus::time_limit,
                       [&] { return world.name + ": out of time, says " + to_string(late); });
    }
    findings_.expect("wall clock", quickest <= kLate, [&] {
      return world.name + ": without any time it takes " + text_of(quickest) + " s";
    });
  }

  // Cancelled by the space that it asks, after the search has begun: it may ask a little more.
  void cancelled_within(const PathWorld& world, const PathProblem& problem) {
    constexpr int kBegun = 50, kMore = 2000;
    CancellationToken token;
    const WatchedSpace space(*problem.space, token, kBegun);
    PathProblem watched = problem;
    watched.space = &space;
    PathRequest request;
    request.iteration_limit = kIterations;
    request.cancellation = &token;
    const PathStatus status = planner_.plan(watched, request).report.status;
    const int more = space.asked() - kBegun;
    if (more < 0) return;
    findings_.expect("cancellation", status == PathStatus::cancelled && more <= kMore, [&] {
      return world.name + ": cancelled within its search, it asks the space " +
             std::to_string(more) + " times more and says " + to_string(status);
    });
  }

  const PathPlanner& planner_;
  const CheckOptions& options_;
  Findings& findings_;
};

}  // namespace

std::vector<CheckResult> check_path_planner(const Specimen<PathPlanner>& subject,
                                            const CheckOptions& options) {
  return check_every_case(subject, options, "a search",
                          [&](const PathPlanner& planner, Findings& findings, bool first) {
                            PlannerCheck(planner, options, findings).run(first);
                          });
}

}  // namespace lapwing
