// SPDX-License-Identifier: Apache-2.0
// The seven gates: Ipopt with exact second derivatives against Ipopt that estimates them from
// gradients, on the very problems that the script states: a point mass from straight lines, and the
// whole quadrotor from there.
#include <benchmark/benchmark.h>

#include "framework/config/shipped.h"
#include "framework/mission/mission.h"
#include "tests/bench/bench_registry.h"

namespace lapwing {
namespace {

std::vector<std::shared_ptr<const TrajectoryProblem>> problems() {
  std::vector<std::shared_ptr<const TrajectoryProblem>> seen;
  MissionSettings settings;
  settings.scripts = shipped_folder("scripts");
  settings.configs = shipped_folder("configs");
  settings.registry = &bench_registry();
  settings.observe_problem = [&](std::shared_ptr<const TrajectoryProblem> problem) {
    seen.push_back(std::move(problem));
  };
  Mission mission(shipped_folder("examples") / "racing/seven_gates.lua", settings);
  mission.configure({}, std::vector<std::string>{"refinements=0"});
  mission.plan();
  return seen;
}

void seven_gates(benchmark::State& state, std::size_t which, const char* hessian) {
  static const auto all = problems();
  Value parameters = Value::map();
  parameters.set("hessian", hessian);
  parameters.set("mu_strategy", "monotone");
  const auto solver = bench_registry().create<TrajectorySolver>("ipopt", parameters);
  SolveResult result;
  for (auto _ : state) result = solver->solve(*all.at(which), {});
  state.counters["seconds_of_flight"] =
      all[which]->trajectory(result.point.stages).samples.back().time;
  state.counters["iterations"] = result.report.iterations;
  state.counters["optimal"] = result.report.status == SolveStatus::optimal;
}

BENCHMARK_CAPTURE(seven_gates, point_exact, 0, "exact")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(seven_gates, point_limited_memory, 0, "limited_memory")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(seven_gates, rotors_exact, 1, "exact")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lapwing
