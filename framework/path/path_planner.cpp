// SPDX-License-Identifier: Apache-2.0
#include "framework/path/path_planner.h"

#include <chrono>
#include <cmath>

#include "framework/core/error.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::string text_of(const Vector3d& p) {
  char text[96];
  std::snprintf(text, sizeof text, "(%.2f, %.2f, %.2f)", p.x(), p.y(), p.z());
  return text;
}

// What is wrong with the problem itself; empty when nothing is.
std::string problem_of(const PathProblem& problem) {
  if (!problem.space) return "there is no space";
  if (!problem.start.allFinite() || !problem.goal.allFinite()) {
    return "start and goal must be finite";
  }
  if (!(problem.half.minCoeff() >= 0) || !problem.half.allFinite()) {
    return "the body's half edges must be finite and at least 0 m";
  }
  if (problem.bounds.isEmpty() || !problem.bounds.min().allFinite() ||
      !problem.bounds.max().allFinite()) {
    return "the bounds must be a finite box";
  }
  return "";
}

// Why the body cannot be there; empty when it can.
std::string hindrance(const PathProblem& problem, const Vector3d& p, const char* which) {
  const std::string place = std::string("the ") + which + " " + text_of(p);
  if (!problem.bounds.contains(p)) return place + " lies outside the bounds of the search";
  if (problem.space->swept_box_free(p, p, problem.half)) return "";
  return place + " is blocked for a body of " + text_of(2 * problem.half) + " m";
}

std::optional<std::size_t> blocked_segment(const PathProblem& problem,
                                           const std::vector<Vector3d>& points) {
  for (std::size_t i = 1; i < points.size(); ++i) {
    const bool inside = problem.bounds.contains(points[i]) && points[i].allFinite();
    if (!inside || !problem.space->swept_box_free(points[i - 1], points[i], problem.half)) {
      return i;
    }
  }
  return std::nullopt;
}

}  // namespace

const char* to_string(PathStatus status) {
  switch (status) {
    case PathStatus::found:
      return "found";
    case PathStatus::start_blocked:
      return "start_blocked";
    case PathStatus::goal_blocked:
      return "goal_blocked";
    case PathStatus::iteration_limit:
      return "iteration_limit";
    case PathStatus::time_limit:
      return "time_limit";
    case PathStatus::cancelled:
      return "cancelled";
    case PathStatus::unsupported:
      return "unsupported";
    case PathStatus::failed:
      break;
  }
  return "failed";
}

Value to_value(const PathReport& report, const std::string& planner_name) {
  Value value = Value::map();
  value.set("name", planner_name);
  value.set("status", to_string(report.status));
  value.set("message", report.message);
  value.set("straight", report.straight);
  value.set("iterations", report.iterations);
  value.set("length", report.length);
  return value;
}

double path_length(const std::vector<Vector3d>& points) {
  double length = 0;
  for (std::size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
  return length;
}

std::vector<Vector3d> without_detours(const PathProblem& problem, std::vector<Vector3d> points) {
  if (points.size() < 3) return points;
  std::vector<Vector3d> kept{points.front()};
  for (std::size_t at = 0; at + 1 < points.size();) {
    std::size_t next = points.size() - 1;
    while (next > at + 1 &&
           !problem.space->swept_box_free(points[at], points[next], problem.half)) {
      --next;
    }
    kept.push_back(points[next]);
    at = next;
  }
  return kept;
}

PathResult PathPlanner::plan(const PathProblem& problem, const PathRequest& request) const {
  const double began = now();
  PathResult result;
  PathReport& report = result.report;
  const auto finish = [&](PathStatus status, std::string message) {
    report.status = status;
    report.message = std::move(message);
    report.length = path_length(result.points);
    report.seconds = now() - began;
    return result;
  };
  const auto broken = [&](const std::string& promise) {
    const char* const name = plugin_name();
    return finish(PathStatus::failed,
                  name ? plugin_failure(name, "search", promise).what() : promise);
  };
  try {
    std::string wrong = problem_of(problem);
    if (!wrong.empty()) return finish(PathStatus::unsupported, wrong);
    wrong = hindrance(problem, problem.start, "start");
    if (!wrong.empty()) return finish(PathStatus::start_blocked, wrong);
    wrong = hindrance(problem, problem.goal, "goal");
    if (!wrong.empty()) return finish(PathStatus::goal_blocked, wrong);
    if (problem.space->swept_box_free(problem.start, problem.goal, problem.half)) {
      result.points = {problem.start, problem.goal};
      report.straight = true;
      return finish(PathStatus::found, "the straight line is free");
    }
    Search searched = in_plugin(
        *this, "search", [&] { return search(problem, request); }, CallLength::lengthy);
    report.iterations = searched.iterations;
    if (searched.status != PathStatus::found) return finish(searched.status, searched.message);
    const bool ends = searched.points.size() >= 2 && searched.points.front() == problem.start &&
                      searched.points.back() == problem.goal;
    if (!ends) return broken("the planner's path does not join start and goal");
    if (const auto blocked = blocked_segment(problem, searched.points)) {
      return broken("segment " + std::to_string(*blocked) + " of the planner's path is blocked");
    }
    result.points = without_detours(problem, std::move(searched.points));
    return finish(PathStatus::found, searched.message);
  } catch (const std::exception& error) {
    result.points.clear();
    return finish(PathStatus::failed, error.what());
  }
}

}  // namespace lapwing
