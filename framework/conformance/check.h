// SPDX-License-Identifier: Apache-2.0
// What every plugin of a kind must pass.
//
// Each check is a library function that returns its findings, so that tests, `lapwing plugins
// check` and authors outside this repository run the same ones. A subject is anything that can be
// created from parameters: a registered plugin, or a class under test. Checks never throw; what a
// subject throws becomes a finding. They are seeded and repeat.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "framework/explore/view_utility.h"
#include "framework/map/map.h"
#include "framework/path/path_planner.h"
#include "framework/plugin/registry.h"
#include "framework/problem/constraint.h"
#include "framework/problem/cost_term.h"
#include "framework/problem/vehicle_model.h"
#include "framework/solve/trajectory_solver.h"
#include "framework/vehicle/controller.h"
#include "framework/view/tour_solver.h"
#include "framework/view/view_information.h"

namespace lapwing {

class Executor;         // items/executor.h
class Exporter;         // export/exporter.h
class FlightLogReader;  // flight_log/flight_log_reader.h
class Shape;            // shape/shape.h

enum class Outcome { passed, failed, skipped, warned };  // warned: likely a slip, no mistake

struct CheckResult {
  std::string name;  // "derivatives", "threads", ...
  Outcome outcome = Outcome::passed;
  std::string message;  // why it failed, was skipped or warned of: the first case found
};

template <class Kind>
struct Specimen {
  std::string name;
  ParameterTable parameters;
  // From parameters that lack defaults; throws InputError for bad ones.
  std::function<std::unique_ptr<Kind>(const Value&)> create;
  // Extensions of its descriptor: what it says of itself beyond its kind (problem/invariance.h,
  // explore/view_utility.h).
  std::vector<std::string> declares = {};

  bool says(const std::string& id) const {
    return std::find(declares.begin(), declares.end(), id) != declares.end();
  }
};

struct CheckOptions {
  std::uint64_t seed = 1;
  // Number of heap allocations of the whole process so far. A library cannot count them; without
  // this the allocation check is skipped.
  std::function<std::int64_t()> allocations;
  // Makes these checks alone, of those that `check_names` lists; none: all of them.
  std::vector<std::string> only = {};

  bool wants(const std::string& check) const;
  // Whether anything beyond creation is wanted.
  bool wants_answers() const { return only != std::vector<std::string>{"creation"}; }
  // Whether one of several is wanted.
  bool wants_any(std::initializer_list<const char*> checks) const;
};

// The checks of a kind that can be asked for one by one, so that each may have a process of its
// own. Those of one group look at the same answers and cost as much together as each alone.
std::vector<std::vector<std::string>> check_groups(const std::string& kind);
std::vector<std::string> check_names(const std::string& kind);

std::vector<CheckResult> check_cost_term(const Specimen<CostTerm>& subject,
                                         const CheckOptions& options = {});
std::vector<CheckResult> check_constraint(const Specimen<Constraint>& subject,
                                          const CheckOptions& options = {});
std::vector<CheckResult> check_vehicle_model(const Specimen<VehicleModel>& subject,
                                             const CheckOptions& options = {});
std::vector<CheckResult> check_trajectory_solver(const Specimen<TrajectorySolver>& subject,
                                                 const CheckOptions& options = {});
std::vector<CheckResult> check_path_planner(const Specimen<PathPlanner>& subject,
                                            const CheckOptions& options = {});
std::vector<CheckResult> check_tour_solver(const Specimen<TourSolver>& subject,
                                           const CheckOptions& options = {});
std::vector<CheckResult> check_map(const Specimen<Map>& subject, const CheckOptions& options = {});
std::vector<CheckResult> check_information(const Specimen<ViewInformation>& subject,
                                           const CheckOptions& options = {});
std::vector<CheckResult> check_utility(const Specimen<ViewUtility>& subject,
                                       const CheckOptions& options = {});

// `registry`: of the maps that shapes of files are tried with; null: those are skipped.
std::vector<CheckResult> check_shape_plugin(const Specimen<Shape>& subject,
                                            const CheckOptions& options = {},
                                            const Registry* registry = nullptr);
std::vector<CheckResult> check_controller(const Specimen<Controller>& subject,
                                          const CheckOptions& options = {});
std::vector<CheckResult> check_exporter(const Specimen<Exporter>& subject,
                                        const CheckOptions& options = {});
std::vector<CheckResult> check_flight_log(const Specimen<FlightLogReader>& subject,
                                          const CheckOptions& options = {});
std::vector<CheckResult> check_executor(const Specimen<Executor>& subject,
                                        const CheckOptions& options = {});

template <class Kind>
Specimen<Kind> subject_of(const Registry& registry, const PluginEntry& entry) {
  return {entry.name, entry.parameters,
          [&registry, name = entry.name](const Value& given) {
            return registry.create<Kind>(name, given);
          },
          entry.extensions};
}

// What a plugin of any kind says of itself: names, version, and a parameter table that agrees with
// itself. Opens nothing.
std::vector<CheckResult> check_description(const PluginEntry& entry);
// Whether the plugin's library says of it what the sidecar beside it says.
std::vector<CheckResult> check_sidecar(const PluginEntry& entry);
// Whether parameters of the wrong type, out of range or unknown are refused with an InputError.
std::vector<CheckResult> check_rubbish(const Registry& registry, const PluginEntry& entry);

// A plugin of any kind; of a kind without checks of its own, one skipped result that says so.
std::vector<CheckResult> check_plugin(const Registry& registry, const PluginEntry& entry,
                                      const CheckOptions& options = {});

}  // namespace lapwing
