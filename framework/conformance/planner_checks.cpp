// What every path planner must pass.
#include <cmath>

#include "framework/conformance/every_case.h"
#include "framework/conformance/path_worlds.h"

namespace lapwing {
namespace {

constexpr std::int64_t kIterations = 6000;

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
      PathProblem problem = world.problem;
      problem.space = &world.space;
      PathRequest request;
      request.iteration_limit = right ? kIterations : 300;
      if (!answers && !options_.wants("repeatable")) {
        stops(world, problem);
        continue;
      }
      const PathResult result = planner_.plan(problem, request);
      honest(world, problem, result, *request.iteration_limit);
      if (!right) continue;
      findings_.expect("answers", result.report.status == world.answer, [&] {
        return world.name + ": says " + to_string(result.report.status) + " (" +
               result.report.message + "), not " + to_string(world.answer);
      });
      if (options_.wants("repeatable")) repeatable(world, problem, request, result);
      if (options_.wants_any({"cancellation", "wall clock"})) stops(world, problem);
    }
  }

 private:
  void honest(const PathWorld& world, const PathProblem& problem, const PathResult& result,
              std::int64_t limit) {
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
    path(world, problem, result);
  }

  void path(const PathWorld& world, const PathProblem& problem, const PathResult& result) {
    const auto& points = result.points;
    const bool ends = points.front() == problem.start && points.back() == problem.goal;
    findings_.expect("paths", ends, [&] { return world.name + ": does not join start and goal"; });
    double length = 0;
    for (std::size_t i = 1; i < points.size(); ++i) {
      length += (points[i] - points[i - 1]).norm();
      const bool free = problem.bounds.contains(points[i]) &&
                        problem.space->swept_box_free(points[i - 1], points[i], problem.half);
      findings_.expect("paths", free, [&] {
        return world.name + ": segment " + std::to_string(i) + " is blocked or out of bounds";
      });
    }
    findings_.expect("paths", std::abs(length - result.report.length) <= 1e-9 * (1 + length), [&] {
      return world.name + ": says " + std::to_string(result.report.length) + " m of a path of " +
             std::to_string(length) + " m";
    });
    findings_.expect("paths", length >= world.shortest - 1e-6, [&] {
      return world.name + ": a path of " + std::to_string(length) +
             " m is shorter than the shortest, " + std::to_string(world.shortest) + " m";
    });
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
    request.wall_clock_guard = 0;
    const PathStatus late = planner_.plan(problem, request).report.status;
    findings_.expect("wall clock", late == PathStatus::time_limit,
                     [&] { return world.name + ": out of time, says " + to_string(late); });
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
