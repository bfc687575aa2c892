// SPDX-License-Identifier: Apache-2.0
// The quadratic core against Ipopt, on the identical program.
#include <benchmark/benchmark.h>

#include "framework/solve/interior_point.h"
#include "framework/solve/trajectory_solver.h"
#include "tests/bench/bench_problems.h"
#include "tests/bench/bench_registry.h"
#include "tests/bench/ipopt_program.h"

namespace lapwing {
namespace {

constexpr double kTolerance = 1e-8;
constexpr std::uint64_t kSeed = 36;

const QuadraticProgram& flight(double seconds) {
  static std::map<double, QuadraticProgram> programs;
  if (!programs.contains(seconds))
    programs[seconds] = program_of(quadratic_flight(bench_registry(), seconds, kSeed));
  return programs[seconds];
}

void report(benchmark::State& state, const QuadraticProgram& program,
            const QuadraticResult& result) {
  state.counters["cost"] = program.objective(result.x);
  state.counters["iterations"] = result.iterations;
  state.counters["residual"] = std::max({result.primal_residual, result.dual_residual, result.gap});
  if (result.status != QuadraticStatus::optimal) state.SkipWithError("not optimal");
}

void interior_point(benchmark::State& state, double seconds) {
  const QuadraticProgram& program = flight(seconds);
  QuadraticResult result;
  InteriorPointOptions options;
  options.tolerance = kTolerance;
  for (auto _ : state) result = InteriorPoint().solve(program, options);
  report(state, program, result);
}

void ipopt(benchmark::State& state, double seconds, bool mehrotra) {
  const QuadraticProgram& program = flight(seconds);
  QuadraticResult result;
  for (auto _ : state) result = solve_with_ipopt(program, kTolerance, mehrotra);
  report(state, program, result);
}

// The whole solver, from the problem to its report.
void iqp(benchmark::State& state, double seconds) {
  const TrajectoryProblem problem = quadratic_flight(bench_registry(), seconds, kSeed);
  const auto solver = bench_registry().create<TrajectorySolver>("iqp");
  SolveResult result;
  for (auto _ : state) result = solver->solve(problem, {});
  state.counters["cost"] = result.report.cost;
  if (result.report.status != SolveStatus::optimal) state.SkipWithError("not optimal");
}

BENCHMARK_CAPTURE(interior_point, flight_30s, 30.0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ipopt, flight_30s, 30.0, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(ipopt, flight_30s_mehrotra, 30.0, true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(interior_point, flight_300s, 300.0)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(iqp, flight_30s, 30.0)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lapwing
