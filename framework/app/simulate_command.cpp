// SPDX-License-Identifier: Apache-2.0
// lapwing simulate.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "framework/app/command_line.h"
#include "framework/app/interruption.h"
#include "framework/app/kept_runs.h"
#include "framework/app/output_target.h"
#include "framework/app/provenance.h"
#include "framework/app/simulation_request.h"
#include "framework/app/terminal.h"
#include "framework/core/checksum.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/number_text.h"
#include "framework/core/parallel.h"
#include "framework/core/units.h"
#include "framework/core/visible_text.h"
#include "framework/export/light_painting.h"
#include "framework/export/simulation_report.h"
#include "framework/items/statement.h"
#include "framework/mission/environment_source.h"
#include "framework/vehicle/closed_loop.h"
#include "framework/vehicle/path_flight.h"
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
  value.set("finished", path.finished);
  value.set("duration", path.duration());
  value.set("late_worst", path.late_worst);
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
bool kept(const FlownPath& path, double tolerance = tolerances::kTracking) {
  return !path.lost && path.finished && path.position_error_worst <= tolerance &&
         path.yaw_error_worst <= tolerances::kTrackingYaw;
}

// Where the camera looks: the gimbal as planned, on the heading that was flown.
void point_camera(const Trajectory& planned, const FlownSample& flown, Sample& kept) {
  const auto& samples = planned.samples;
  auto after = std::upper_bound(samples.begin() + 1, samples.end() - 1, flown.time,
                                [](double t, const Sample& s) { return t < s.time; });
  const Sample &a = *(after - 1), &b = *after;
  const double share = std::clamp((flown.time - a.time) / (b.time - a.time), 0.0, 1.0);
  kept.yaw = a.yaw + share * (b.yaw - a.yaw) + flown.yaw_error;
  if (!planned.has_gimbal) return;
  kept.gimbal_yaw = a.gimbal_yaw + share * (b.gimbal_yaw - a.gimbal_yaw);
  kept.gimbal_pitch = a.gimbal_pitch + share * (b.gimbal_pitch - a.gimbal_pitch);
}

// The flown path against obstacles and subjects, judged as a plan of the model `path` is.
Certificate certificate_of(const Plan& plan, const FlownPath& path,
                           const std::filesystem::path& folder) {
  Plan flown = plan;
  Task asked;
  asked.gates = plan.task.gates;
  asked.framing = plan.task.framing;
  asked.framing_share = plan.task.framing_share;
  asked.line_of_sight_required = false;
  asked.closed_loop_required = false;
  flown.task = asked;
  flown.constraints.clear();
  flown.lights.clear();
  flown.trajectory = {};
  flown.trajectory.motion = path_motion();
  flown.trajectory.has_gimbal = plan.trajectory.has_gimbal;
  for (const FlownSample& sample : path.samples) {
    if (!sample.state.position.allFinite()) break;
    Sample& kept = flown.trajectory.samples.emplace_back();
    kept.time = sample.time;
    kept.position = sample.state.position;
    point_camera(plan.trajectory, sample, kept);
  }
  if (flown.trajectory.samples.empty()) return {};
  // A controller that keeps to the path may be at its end before the plan is.
  const double end = flown.trajectory.samples.back().time;
  for (FramingTask& asked_for : flown.task.framing)
    asked_for.span.finish = std::min(asked_for.span.finish, end);
  std::erase_if(flown.task.framing, [](const FramingTask& asked_for) {
    return asked_for.span.finish <= asked_for.span.start;
  });
  return verify(flown, folder);
}

// Those of the named checks that were made.
std::vector<Check> made_checks(const Certificate& certificate,
                               std::initializer_list<const char*> names) {
  std::vector<Check> found;
  for (const char* name : names) {
    const Check* check = certificate.find(name);
    if (check && check->skipped.empty()) found.push_back(*check);
  }
  return found;
}

void print(const Plan& plan, const Simulation& simulation, double tolerance) {
  const FlownPath& path = simulation.path;
  const bool near = simulation.too_near();
  std::printf("%s: %s\n", visible_line(plan.mission).c_str(),
              tinted(kept(path, tolerance) && !near ? Tone::good : Tone::bad,
                     path.lost                ? "lost"
                     : !path.finished         ? "not finished"
                     : !kept(path, tolerance) ? "strays"
                     : near                   ? "too near"
                                              : "flown")
                  .c_str());
  std::printf("  controller              %s\n", visible_line(simulation.controller).c_str());
  std::printf("  conditions              %s\n", simulation.conditions_in_words().c_str());
  for (const Check& check : simulation.distances)
    std::printf("  %-22s  %s\n", check.name.c_str(),
                visible_line(distance_in_words(check)).c_str());
  std::printf("  distance from the plan  worst %.3f m at %.4g s, mean %.3f m\n",
              path.position_error_worst, path.position_error_at, path.position_error_mean);
  std::printf("  yaw against the plan    worst %.2f degrees at %.4g s\n",
              degrees(path.yaw_error_worst), path.yaw_error_at);
  if (path.late_worst > 0)
    std::printf("  flown in                %.4g s, at most %.3g s behind the plan\n",
                path.duration(), path.late_worst);
  std::printf("  rotor speed             up to %.1f %% of the largest\n",
              100 * path.rotor_speed_worst);
  std::printf("  rotors saturated        %.3g %% of the time\n", 100 * path.saturated_share);
  if (!plan.task.strokes.empty()) {
    const DrawingError error = drawing_error(plan, path);
    std::printf("  light from the drawing  worst %.3f m, mean %.4f m\n", error.worst, error.mean);
  }
  if (!path.lost && !kept(path, tolerance))
    std::printf("  more than %s allows: %.3g m and %.3g degrees\n",
                tolerance == tolerances::kTracking ? "a certificate" : "was asked for", tolerance,
                degrees(tolerances::kTrackingYaw));
}

// One run, judged.
RunVerdict verdict_of(const Plan& plan, const FlownPath& path, double tolerance,
                      const std::filesystem::path& folder) {
  RunVerdict verdict;
  verdict.followed = !path.lost && path.finished && path.position_error_worst <= tolerance;
  const Certificate certificate = certificate_of(plan, path, folder);
  const auto passes = [&](std::initializer_list<const char*> names) -> std::optional<bool> {
    const std::vector<Check> made = made_checks(certificate, names);
    if (made.empty()) return std::nullopt;
    return !path.lost && path.finished &&
           std::all_of(made.begin(), made.end(), [](const Check& c) { return c.pass; });
  };
  verdict.gates = passes({"gates"});
  verdict.framed = passes({"framing"});
  verdict.distance = passes({"clearance", "subject_distance"});
  // A flight that ended early, or whose numbers do not hold together, meets nothing.
  if (!plan.task.gates.empty() && !verdict.gates) verdict.gates = false;
  if (!plan.task.framing.empty() && !verdict.framed) verdict.framed = false;
  return verdict;
}

// A plan that is to be flown, and how.
struct PlannedFlight {
  const std::filesystem::path& file;
  const Plan& plan;
  const ControlledPlan& controlled;
  const ControllerChoice& choice;
  const FlightConditions& conditions;
  double tolerance;  // m
};

// Some have obstacles near or subjects in view and others ended before: absent means kept.
void agree_on_distances(SimulatedRuns& runs) {
  const bool any = std::any_of(runs.verdicts.begin(), runs.verdicts.end(),
                               [](const RunVerdict& v) { return v.distance.has_value(); });
  for (RunVerdict& v : runs.verdicts)
    if (any && !v.distance) v.distance = false;
}

SimulatedRuns judged_runs(const PlannedFlight& flight, int count, const Invocation& invocation,
                          const CancellationToken& token) {
  SimulatedRuns runs{flight.choice.name, flight.conditions, flight.tolerance, {}, {}};
  runs.runs = fly_runs(flight.controlled, flight.conditions, count, invocation.threads, &token);
  runs.verdicts.resize(runs.runs.size());
  const std::filesystem::path folder = flight.file.parent_path();
  parallel_for(runs.runs.size(), invocation.threads, [&](std::size_t i) {
    if (token.cancelled()) throw Cancelled();
    runs.verdicts[i] = verdict_of(flight.plan, runs.runs[i].path, runs.tolerance, folder);
  });
  agree_on_distances(runs);
  return runs;
}

// "mpc {...}" with a checksum of the library that has it.
std::string text_of(const ControllerChoice& choice, const Registry& registry) {
  return to_json(to_value(choice), -1) + " " +
         sha256(read_file(registry.find(Controller::kKind, choice.name).library));
}

// The same runs as items; nothing where their results are not for this process.
std::optional<SimulatedRuns> kept_runs(const PlannedFlight& flight, const SimulationRequest& asked,
                                       const Registry& registry, ItemRun& items,
                                       const CancellationToken& token) {
  const std::filesystem::path folder = flight.file.parent_path();
  const Value statement = statement_of(RunInputs{flight.file, text_of(flight.choice, registry),
                                                 to_value(flight.conditions), flight.tolerance});
  const ItemList list = run_items_of(
      asked.kept, flight.conditions.seed, static_cast<std::size_t>(asked.runs),
      made_by(statement.at("program").as_text(), statement), [&](std::uint64_t seed) {
        KeptRun run;
        run.path = flight.controlled.fly(drawn_conditions(flight.conditions, seed), &token);
        run.verdict = verdict_of(flight.plan, run.path, flight.tolerance, folder);
        return run;
      });
  std::optional<FolderClaim> claim;
  const bool whole = items.make(list, statement, [&] {
    claim.emplace(asked.kept, claim_for(asked.items));
    open_statement(asked.kept / "simulation.json", statement, asked.items, "simulation");
  });
  if (!whole) return std::nullopt;
  SimulatedRuns runs{flight.choice.name, flight.conditions, flight.tolerance, {}, {}};
  std::uint64_t seed = flight.conditions.seed;
  for (KeptRun& run : read_runs(list)) {
    runs.runs.push_back({drawn_conditions(flight.conditions, seed++), std::move(run.path)});
    runs.verdicts.push_back(run.verdict);
  }
  agree_on_distances(runs);
  return runs;
}

void print(const Plan& plan, const SimulatedRuns& runs) {
  const double good = runs.good_share();
  std::printf("%s: %s\n", visible_line(plan.mission).c_str(),
              tinted(good == 1 ? Tone::good : Tone::bad,
                     std::to_string(std::lround(good * static_cast<double>(runs.runs.size()))) +
                         " of " + std::to_string(runs.runs.size()) + " runs are good")
                  .c_str());
  std::printf("  controller              %s\n", visible_line(runs.controller).c_str());
  std::printf("  conditions              %s\n", spread_in_words(runs.spread).c_str());
  const auto say = [](const char* label, const std::optional<double>& share) {
    if (share) std::printf("  %-22s  %.4g %% of runs\n", label, 100 * *share);
  };
  say("through all gates", runs.share(&RunVerdict::gates));
  say(("within " + number_text(runs.tolerance, 3) + " m").c_str(), runs.followed_share());
  say("subject in the image", runs.share(&RunVerdict::framed));
  say("clear of obstacles", runs.share(&RunVerdict::distance));
  std::printf("  distance from the plan  median %.3f m, 95 %% within %.3f m, worst %.3f m\n",
              runs.distance_quantile(0.5), runs.distance_quantile(0.95), runs.distance_quantile(1));
  const SeededRun& worst = runs.runs[runs.worst()];
  std::printf("  worst run               seed %llu%s, %.3f m at %.4g s\n",
              static_cast<unsigned long long>(worst.conditions.seed),
              worst.path.lost ? ", lost" : "", worst.path.position_error_worst,
              worst.path.position_error_at);
}

// What the verifier would refuse cannot be flown either.
void require_a_sound_plan(const Plan& plan, const std::filesystem::path& folder) {
  const Certificate certificate = verify(plan, folder);
  const Check* document = certificate.find("document");
  if (!document->pass) throw InputError({}, "the plan is inconsistent: " + document->detail);
}

// `items`: of runs that are kept; null for others.
ExitStatus simulate(const std::filesystem::path& file, const SimulationRequest& asked,
                    const std::filesystem::path& target, const Invocation& invocation,
                    const CancellationToken& token, ItemRun* items) {
  if (!target.empty()) require_output(target, {file});
  Plan plan = read_plan_file(file);
  const std::filesystem::path folder = file.parent_path();
  require_a_sound_plan(plan, folder);
  const Vehicle vehicle = vehicle_from_value(plan.vehicle);
  if (!plan.trajectory.motion.moves) {
    plan.trajectory = flight_along(plan.trajectory, vehicle);
    if (!invocation.json && (!items || items->leads()))
      std::printf(
          "the plan is a path without forces: flown with a stop in every place, in %.4g s\n",
          plan.trajectory.duration());
  }
  const FlightConditions conditions = conditions_of(asked, vehicle);
  const ControllerChoice choice =
      asked.controller.empty() ? controller_of(vehicle)
                               : controller_choice_from(Value(asked.controller), "--controller");
  const ControlledPlan controlled(
      plan.trajectory, vehicle, choice.is_default() ? nullptr : controllers_of(invocation)(choice));
  if (!target.empty()) open_recorded_shapes(plan.environment, invocation.registry(), folder);
  Value object = Value::map();
  object.set("plan", file.string());
  object.set("mission", plan.mission);
  if (asked.runs > 0) {
    const PlannedFlight flight{file,   plan,       controlled,
                               choice, conditions, asked.tolerance.value_or(tolerances::kTracking)};
    const std::optional<SimulatedRuns> made =
        items ? kept_runs(flight, asked, invocation.registry(), *items, token)
              : judged_runs(flight, asked.runs, invocation, token);
    if (!made) return print_answer(*items, invocation);
    const SimulatedRuns& runs = *made;
    if (!target.empty())
      write_file_atomically(target, render_html(runs_report(plan, vehicle, runs, folder)));
    object.set("simulations", to_value(runs));
    if (invocation.json)
      print_json(object);
    else
      print(plan, runs);
    return runs.good_share() == 1 ? ExitStatus::done : ExitStatus::not_certified;
  }
  const double tolerance = asked.tolerance.value_or(tolerances::kTracking);
  Simulation flown{choice.name, conditions, controlled.fly(conditions, &token), {}};
  const FlownPath& path = flown.path;
  const Certificate certificate = certificate_of(plan, path, folder);
  flown.distances = made_checks(certificate, {"clearance", "subject_distance"});
  if (!target.empty())
    write_file_atomically(target, render_html(simulation_report(plan, vehicle, flown, folder)));
  if (invocation.json) {
    Value& simulation = object.set("simulation", to_value(path));
    simulation.set("controller", to_value(choice));
    simulation.set("kept", kept(path, tolerance));
    simulation.set("conditions", to_value(conditions));
    simulation.set("too_near", flown.too_near());
    Value& distances = simulation.set("distances", Value::list());
    for (const Check& check : flown.distances) distances.push_back(to_value(check));
    for (const Check& check : made_checks(certificate, {"gates", "framing"}))
      simulation.set(check.name, to_value(check));
    if (!plan.task.strokes.empty()) {
      const DrawingError error = drawing_error(plan, path);
      simulation.set("drawing_error_worst", error.worst);
      simulation.set("drawing_error_mean", error.mean);
    }
    print_json(object);
  } else {
    print(plan, flown, tolerance);
    for (const Check& check : made_checks(certificate, {"gates", "framing"}))
      std::printf("  %-22s  %s\n", check.name.c_str(), visible_line(result_of(check)).c_str());
  }
  return !kept(path, tolerance) ? ExitStatus::not_certified : ExitStatus::done;
}

}  // namespace

ExitStatus simulate_plan(const std::filesystem::path& file, const SimulationRequest& asked,
                         const std::filesystem::path& target, const Invocation& invocation) {
  const ItemOptions& options = asked.items;
  const bool of_items = options.continues() || options.portable || !options.executor.empty() ||
                        launched_processes() > 1 || !asked.kept.empty();
  if (!of_items) {
    const Interruption interruption;
    return simulate(file, asked, target, invocation, interruption.token(), nullptr);
  }
  return run_items(options, invocation, invocation.registry(),
                   [&](ItemRun& items, const CancellationToken& token) {
                     if (asked.runs == 0 || asked.kept.empty())
                       throw InputError(
                           "simulate: several processes, --executor, --portable and what "
                           "continues runs need --runs N and --keep-runs DIR");
                     return simulate(file, asked, target, invocation, token, &items);
                   });
}

}  // namespace lapwing
