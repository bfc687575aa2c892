// SPDX-License-Identifier: Apache-2.0
// Every plugin of the build tree passes what its kind must pass.
#include "framework/app/allocation_counter.h"
#include "framework/conformance/check.h"

namespace lapwing {

void PrintTo(const PluginEntry& entry, std::ostream* out) {
  *out << entry.kind << " " << entry.name;
}

namespace {

const Registry& plugins() {
  static const Registry registry({LAPWING_BUILD_DIR "/lib/plugins"});
  return registry;
}

std::vector<PluginEntry> checked_entries() {
  std::vector<PluginEntry> result;
  for (const PluginEntry& entry : plugins().entries())
    for (const char* kind : {"cost_term", "constraint", "vehicle_model", "trajectory_solver", "map",
                             "path_planner", "tour_solver", "information", "utility", "exporter",
                             "shape", "controller", "flight_log", "executor"})
      if (entry.kind == kind) result.push_back(entry);
  return result;
}

class EveryPlugin : public testing::TestWithParam<PluginEntry> {};

TEST_P(EveryPlugin, Conforms) {
  CheckOptions options;
  options.allocations = allocation_counter();
  const std::vector<CheckResult> results = check_plugin(plugins(), GetParam(), options);
  EXPECT_GE(results.size(), 4u);
  for (const CheckResult& result : results) {
    EXPECT_FALSE(result.outcome == Outcome::failed) << result.name << ": " << result.message;
    if (result.outcome != Outcome::skipped) continue;
    EXPECT_EQ(options.allocations, nullptr) << result.name << ": " << result.message;
  }
}

INSTANTIATE_TEST_SUITE_P(Registered, EveryPlugin, testing::ValuesIn(checked_entries()),
                         [](const auto& entry) {
                           return entry.param.kind + "_" + entry.param.name;
                         });

TEST(EveryPlugin, IsThere) {
  // An empty registry would pass everything above.
  for (const auto& [kind, name] : {std::pair{"cost_term", "derivative"},
                                   {"cost_term", "target_derivative"},
                                   {"cost_term", "keyframe"},
                                   {"cost_term", "input_effort"},
                                   {"constraint", "input_limits"},
                                   {"constraint", "state_limits"},
                                   {"constraint", "boundary_state"},
                                   {"constraint", "hard_keyframe"},
                                   {"cost_term", "target_keyframe"},
                                   {"cost_term", "gimbal_derivative"},
                                   {"cost_term", "camera_angle"},
                                   {"cost_term", "skewness"},
                                   {"cost_term", "framing"},
                                   {"cost_term", "subject_target"},
                                   {"cost_term", "path_distance"},
                                   {"cost_term", "occlusion"},
                                   {"constraint", "obstacle"},
                                   {"shape", "sphere"},
                                   {"shape", "box"},
                                   {"shape", "prism"},
                                   {"shape", "no_fly_zone"},
                                   {"shape", "capsule"},
                                   {"shape", "cone"},
                                   {"shape", "half_space"},
                                   {"shape", "mesh"},
                                   {"shape", "map"},
                                   {"constraint", "corridor"},
                                   {"constraint", "subject_distance"},
                                   {"vehicle_model", "gimbal"},
                                   {"vehicle_model", "quadrotor"},
                                   {"map", "octomap"},
                                   {"map", "brick"},
                                   {"trajectory_solver", "iqp"},
                                   {"trajectory_solver", "ipopt"},
                                   {"trajectory_solver", "nlopt"},
                                   {"path_planner", "rrt"},
                                   {"path_planner", "rrt_star"},
                                   {"path_planner", "rrt_connect"},
                                   {"path_planner", "informed_rrt_star"},
                                   {"path_planner", "bit_star"},
                                   {"information", "uniform"},
                                   {"information", "fronto_parallel"},
                                   {"controller", "thesis"},
                                   {"controller", "geometric"},
                                   {"controller", "tvlqr"},
                                   {"controller", "mpc"},
                                   {"controller", "contouring"},
                                   {"flight_log", "ulog"},
                                   {"flight_log", "csv"},
                                   {"flight_log", "tlog"},
                                   {"executor", "threads"},
                                   {"tour_solver", "greedy"},
                                   {"tour_solver", "cost_benefit"},
                                   {"tour_solver", "recursive_greedy"},
                                   {"tour_solver", "local_search"}})
    EXPECT_NO_THROW(plugins().find(kind, name)) << kind << " " << name;
}

}  // namespace
}  // namespace lapwing
