// SPDX-License-Identifier: Apache-2.0
#include "plugins/path_planners/ompl/search.h"

#include <ompl/base/MotionValidator.h>
#include <ompl/base/Planner.h>
#include <ompl/base/PlannerTerminationCondition.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/goals/GoalState.h>
#include <ompl/base/objectives/PathLengthOptimizationObjective.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include <chrono>
#include <mutex>

#include "framework/core/random.h"

namespace lapwing {
namespace {

namespace ob = ompl::base;
using Eigen::Vector3d;
using Space = ob::RealVectorStateSpace;

// Within the bounds: OMPL's own are a little thicker where they are flat.
Vector3d place_of(const ob::State* state, const PathProblem& problem) {
  const auto* values = state->as<Space::StateType>()->values;
  return Vector3d(values[0], values[1], values[2])
      .cwiseMax(problem.bounds.min())
      .cwiseMin(problem.bounds.max());
}

// Segments are checked whole by the space, never by samples along them.
class SweptMotion final : public ob::MotionValidator {
 public:
  SweptMotion(const ob::SpaceInformationPtr& space, const PathProblem& problem)
      : MotionValidator(space), problem_(problem) {}

  bool checkMotion(const ob::State* from, const ob::State* to) const override {
    return problem_.space->swept_box_free(place_of(from, problem_), place_of(to, problem_),
                                          problem_.half);
  }
  bool checkMotion(const ob::State* from, const ob::State* to,
                   std::pair<ob::State*, double>& last_valid) const override {
    if (checkMotion(from, to)) return true;
    last_valid.second = 0;
    if (last_valid.first) si_->copyState(last_valid.first, from);
    return false;
  }

 private:
  const PathProblem& problem_;
};

// Counts how often the planner asks whether to stop, which every planner does once an iteration.
class Limit {
 public:
  Limit(const PathRequest& request, std::int64_t iterations)
      : request_(request), most_(request.iteration_limit.value_or(iterations)), began_(now()) {}

  bool reached() {
    if (count_ >= most_) return true;
    ++count_;
    if (request_.cancellation && request_.cancellation->cancelled()) cancelled_ = true;
    if (request_.wall_clock_guard && now() - began_ > *request_.wall_clock_guard) late_ = true;
    return cancelled_ || late_;
  }
  std::int64_t count() const { return count_; }
  PathStatus status() const {
    return cancelled_ ? PathStatus::cancelled
           : late_    ? PathStatus::time_limit
                      : PathStatus::iteration_limit;
  }

 private:
  static double now() {
    const auto t = std::chrono::steady_clock::now().time_since_epoch();
    return std::chrono::duration<double>(t).count();
  }
  const PathRequest& request_;
  std::int64_t most_, count_ = 0;
  double began_;
  bool cancelled_ = false, late_ = false;
};

ob::SpaceInformationPtr space_of(const PathProblem& problem) {
  ob::RealVectorBounds bounds(3);
  for (int i = 0; i < 3; ++i) {
    // A flat box is allowed; OMPL wants some thickness.
    const auto k = static_cast<unsigned>(i);
    bounds.setLow(k, problem.bounds.min()[i]);
    bounds.setHigh(k, std::max(problem.bounds.max()[i], problem.bounds.min()[i] + 1e-6));
  }
  auto real = std::make_shared<Space>(3);
  real->setBounds(bounds);
  auto space = std::make_shared<ob::SpaceInformation>(real);
  space->setStateValidityChecker([&problem](const ob::State* state) {
    const Vector3d p = place_of(state, problem);
    return problem.space->swept_box_free(p, p, problem.half);
  });
  space->setMotionValidator(std::make_shared<SweptMotion>(space, problem));
  space->setup();
  return space;
}

ob::ProblemDefinitionPtr definition_of(const ob::SpaceInformationPtr& space,
                                       const PathProblem& problem) {
  ob::ScopedState<Space> start(space), goal(space);
  for (unsigned i = 0; i < 3; ++i) {
    start[i] = problem.start[static_cast<int>(i)];
    goal[i] = problem.goal[static_cast<int>(i)];
  }
  auto definition = std::make_shared<ob::ProblemDefinition>(space);
  definition->setStartAndGoalStates(start, goal, 1e-9);
  definition->setOptimizationObjective(
      std::make_shared<ob::PathLengthOptimizationObjective>(space));
  return definition;
}

}  // namespace

OmplOutcome search_with_ompl(const PathProblem& problem, const PathRequest& request,
                             const OmplSettings& settings, MakePlanner make) {
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  ompl::msg::setLogLevel(ompl::msg::LOG_NONE);
  // Any number but 0, which OMPL does not take.
  ompl::RNG::setSeed(static_cast<std::uint_fast32_t>(Random(request.seed).bits() >> 33) | 1u);

  const auto space = space_of(problem);
  const auto definition = definition_of(space, problem);
  const PlannerPointer planner = make(space, settings);
  planner->setProblemDefinition(definition);
  planner->setup();
  Limit limit(request, settings.iterations);
  const ob::PlannerStatus solved =
      planner->solve(ob::PlannerTerminationCondition([&limit] { return limit.reached(); }));

  OmplOutcome outcome;
  outcome.iterations = limit.count();
  if (solved != ob::PlannerStatus::EXACT_SOLUTION) {
    outcome.status = limit.status();
    outcome.message = "no path in " + std::to_string(outcome.iterations) +
                      " iterations; there may be none, or `iterations` is too small";
    return outcome;
  }
  const auto path =
      std::static_pointer_cast<ompl::geometric::PathGeometric>(definition->getSolutionPath());
  for (std::size_t i = 0; i < path->getStateCount(); ++i) {
    outcome.points.push_back(place_of(path->getState(static_cast<unsigned>(i)), problem));
  }
  // The goal was met to 1e-9 m.
  outcome.points.front() = problem.start;
  outcome.points.back() = problem.goal;
  outcome.status = PathStatus::found;
  outcome.message = "found in " + std::to_string(outcome.iterations) + " iterations";
  return outcome;
}

}  // namespace lapwing
