// SPDX-License-Identifier: Apache-2.0
// lapwing simulate.
#include <cstdio>

#include "framework/app/command_line.h"
#include "framework/app/output_target.h"
#include "framework/app/provenance.h"
#include "framework/app/terminal.h"
#include "framework/core/files.h"
#include "framework/core/units.h"
#include "framework/core/visible_text.h"
#include "framework/export/light_painting.h"
#include "framework/export/simulation_report.h"
#include "framework/mission/environment_source.h"
#include "framework/vehicle/closed_loop.h"
#include "framework/verify/tolerances.h"
#include "framework/verify/verify.h"

namespace lapwing {
namespace {

Value to_value(const FlownPath& path) {
  Value value = Value::map();
  value.set("lost", path.lost);
  value.set("position_error_worst", path.position_error_worst);
  value.set("position_error_at", path.position_error_at);
  value.set("position_error_mean", path.position_error_mean);
  value.set("yaw_error_worst", path.yaw_error_worst);
  value.set("yaw_error_at", path.yaw_error_at);
  value.set("rotor_speed_worst", path.rotor_speed_worst);
  value.set("saturated_share", path.saturated_share);
  return value;
}

Value to_value(const FlightConditions& conditions) {
  Value value = Value::map();
  value.set("wind", conditions.wind_mean);
  value.set("gusts", conditions.wind_gust);
  value.set("wind_yaw", conditions.wind_yaw);
  value.set("mass_error", conditions.mass_error);
  value.set("seed", static_cast<std::int64_t>(conditions.seed));
  return value;
}

Value to_value(const Check& check) {
  Value value = Value::map();
  value.set("check", check.name);
  if (check.worst) value.set("least", *check.worst);
  value.set("to_keep", check.limit);
  value.set("at", check.at);
  value.set("kept", check.pass);
  value.set("detail", check.detail);
  return value;
}

// Within what the certificate asks of a flight in still air.
bool kept(const FlownPath& path) {
  return !path.lost && path.position_error_worst <= tolerances::kTracking &&
         path.yaw_error_worst <= tolerances::kTrackingYaw;
}

// The flown path against obstacles and subjects, judged as a plan of the model `path` is.
std::vector<Check> distances_of(const Plan& plan, const FlownPath& path,
                                const std::filesystem::path& folder) {
  Plan flown = plan;
  flown.task = {};
  flown.constraints.clear();
  flown.cuts.clear();
  flown.lights.clear();
  flown.trajectory = {};
  flown.trajectory.motion = path_motion();
  for (const FlownSample& sample : path.samples) {
    if (!sample.state.position.allFinite()) break;
    Sample& kept = flown.trajectory.samples.emplace_back();
    kept.time = sample.time;
    kept.position = sample.state.position;
  }
  std::vector<Check> found;
  if (flown.trajectory.samples.empty()) return found;
  const Certificate certificate = verify(flown, folder);
  for (const char* name : {"clearance", "subject_distance"}) {
    const Check* check = certificate.find(name);
    if (check->skipped.empty()) found.push_back(*check);
  }
  return found;
}

void print(const Plan& plan, const Simulation& simulation) {
  const FlownPath& path = simulation.path;
  const bool near = simulation.too_near();
  std::printf("%s: %s\n", visible_line(plan.mission).c_str(),
              tinted(kept(path) && !near ? Tone::good : Tone::bad, path.lost     ? "lost"
                                                                   : !kept(path) ? "strays"
                                                                   : near        ? "too near"
                                                                                 : "flown")
                  .c_str());
  std::printf("  conditions              %s\n", simulation.conditions_in_words().c_str());
  for (const Check& check : simulation.distances)
    std::printf("  %-22s  %s\n", check.name.c_str(),
                visible_line(distance_in_words(check)).c_str());
  std::printf("  distance from the plan  worst %.3f m at %.4g s, mean %.3f m\n",
              path.position_error_worst, path.position_error_at, path.position_error_mean);
  std::printf("  yaw against the plan    worst %.2f degrees at %.4g s\n",
              degrees(path.yaw_error_worst), path.yaw_error_at);
  std::printf("  rotor speed             up to %.1f %% of the largest\n",
              100 * path.rotor_speed_worst);
  std::printf("  rotors saturated        %.3g %% of the time\n", 100 * path.saturated_share);
  if (!plan.task.strokes.empty()) {
    const DrawingError error = drawing_error(plan, path);
    std::printf("  light from the drawing  worst %.3f m, mean %.4f m\n", error.worst, error.mean);
  }
  if (!path.lost && !kept(path))
    std::printf("  more than a certificate allows: %.3g m and %.3g degrees\n",
                tolerances::kTracking, degrees(tolerances::kTrackingYaw));
}

// What the verifier would refuse cannot be flown either.
void require_a_sound_plan(const Plan& plan, const std::filesystem::path& folder) {
  const Certificate certificate = verify(plan, folder);
  const Check* document = certificate.find("document");
  if (!document->pass) throw InputError({}, "the plan is inconsistent: " + document->detail);
}

}  // namespace

ExitStatus simulate_plan(const std::filesystem::path& file, const FlightConditions& conditions,
                         const std::filesystem::path& target, const Invocation& invocation) {
  if (!target.empty()) require_output(target, {file});
  Plan plan = read_plan_file(file);
  require_a_sound_plan(plan, file.parent_path());
  const Vehicle vehicle = vehicle_from_value(plan.vehicle);
  const std::filesystem::path folder = file.parent_path();
  Simulation flown{conditions, fly(plan.trajectory, vehicle, conditions), {}};
  const FlownPath& path = flown.path;
  flown.distances = distances_of(plan, path, folder);
  if (!target.empty()) {
    open_recorded_shapes(plan.environment, invocation.registry(), folder);
    write_file_atomically(target, render_html(simulation_report(plan, vehicle, flown, folder)));
  }
  if (invocation.json) {
    Value object = Value::map();
    object.set("plan", file.string());
    object.set("mission", plan.mission);
    Value& simulation = object.set("simulation", to_value(path));
    simulation.set("kept", kept(path));
    simulation.set("conditions", to_value(conditions));
    simulation.set("too_near", flown.too_near());
    Value& distances = simulation.set("distances", Value::list());
    for (const Check& check : flown.distances) distances.push_back(to_value(check));
    if (!plan.task.strokes.empty()) {
      const DrawingError error = drawing_error(plan, path);
      simulation.set("drawing_error_worst", error.worst);
      simulation.set("drawing_error_mean", error.mean);
    }
    print_json(object);
  } else {
    print(plan, flown);
  }
  return !kept(path) ? ExitStatus::not_certified : ExitStatus::done;
}

}  // namespace lapwing
