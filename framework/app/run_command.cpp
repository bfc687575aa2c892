// lapwing run: load, check, plan, certify, write, report.
#include <chrono>
#include <cmath>
#include <iostream>

#include "framework/app/command_line.h"
#include "framework/app/interruption.h"
#include "framework/app/mapping_run.h"
#include "framework/app/mission_loading.h"
#include "framework/app/plan_figures.h"
#include "framework/app/progress_line.h"
#include "framework/app/provenance.h"
#include "framework/app/run_target.h"
#include "framework/app/terminal.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/log.h"
#include "framework/core/visible_text.h"
#include "framework/export/exporter.h"
#include "framework/export/flight_report.h"
#include "framework/export/light_painting.h"
#include "framework/export/race_report.h"
#include "framework/export/scan_report.h"
#include "framework/geometry/png.h"

namespace lapwing {

namespace {

constexpr std::size_t kLargestObstacle = std::size_t{1} << 30;  // bytes, as the verifier reads

struct RunOutcome {
  MissionResult result = {};
  Certificate certificate = {};
  std::string status = {};  // ok, not_certified, infeasible, failed, cancelled
  RunTarget& target;
  Value provenance = {};                          // what the certificate is about
  double seconds = 0;                             // wall clock, all of it
  std::optional<std::string> long_exposure = {};  // PNG
  std::vector<RacedPilot> raced = {};
  std::string not_raced = {};  // why players did not fly; empty: they did, or there are none
};

// With what only the simulator of a scan knows, which is told and no part of the plan.
std::vector<std::string> told_notes(const MissionResult& result) {
  std::vector<std::string> all = result.notes;
  if (result.scan && result.scan->truth) all.push_back(truth_in_words(*result.scan));
  return all;
}

// With what was tried on the way: for the report, the log and --json.
std::vector<std::string> all_notes(const MissionResult& result) {
  std::vector<std::string> all = told_notes(result);
  all.insert(all.end(), result.details.begin(), result.details.end());
  return all;
}

std::string status_of(const MissionResult& result, const Certificate& certificate, bool cancelled) {
  if (cancelled || result.report.status == SolveStatus::cancelled) return "cancelled";
  // Who stays where it is breaks no rule, but has done nothing of what was asked.
  const bool idle =
      result.report.status == SolveStatus::infeasible && !(result.plan.trajectory.duration() > 0);
  if (certificate.feasible() && !idle) return "ok";
  switch (result.report.status) {
    case SolveStatus::infeasible:
      return "infeasible";
    case SolveStatus::unsupported:
    case SolveStatus::numerical_error:
      return "failed";
    default:
      return "not_certified";
  }
}

ExitStatus exit_status_of(const std::string& status) {
  if (status == "ok") return ExitStatus::done;
  return status == "cancelled" ? ExitStatus::interrupted : ExitStatus::not_certified;
}

Value finite(double number) {
  return std::isfinite(number) ? Value(number) : Value();
}

Value json_of(const RunOutcome& outcome, const Invocation& invocation) {
  const MissionResult& result = outcome.result;
  Value object = Value::map();
  object.set("mission", result.plan.mission);
  object.set("kind", result.plan.kind);
  object.set("status", outcome.status);
  object.set("plan", (outcome.target.folder() / "plan.json").string());
  outcome.target.add_to(object);
  object.set("seed", static_cast<std::int64_t>(invocation.seed));
  Value& seconds = object.set("seconds", Value::map());
  seconds.set("total", outcome.seconds);
  seconds.set("solve", result.solve_seconds);
  object.set("reproducible",
             outcome.status != "cancelled" && result.report.status != SolveStatus::time_limit);
  Value& solver = object.set("solver", Value::map());
  solver.set("name", result.solver);
  solver.set("status", to_string(result.report.status));
  solver.set("iterations", result.report.iterations);
  solver.set("cost", finite(result.report.cost));
  Value& terms = solver.set("terms", Value::map());
  for (const TermCost& term : result.report.terms) terms.set(term.name, finite(term.cost));
  object.set("provenance", outcome.provenance);
  object.set("certificate", outcome.certificate.to_value());
  if (const auto all = all_notes(result); !all.empty())
    object.set("notes", Value(Value::List(all.begin(), all.end())));
  if (result.block.is_map())
    object.set(result.block_name.empty() ? result.plan.kind : result.block_name, result.block);
  if (!outcome.raced.empty()) object.set("game", to_value(outcome.raced));
  if (!outcome.not_raced.empty())
    object.set("game", Value::map()).set("not_flown", outcome.not_raced);
  return object;
}

// What the certificate does not require, and what a user would still want to know.
std::string reported_misses(const Certificate& certificate) {
  std::string lines;
  for (const Check& check : certificate.checks)
    if (!check.required && check.skipped.empty() && !check.pass)
      lines += "\n  reported: " + to_line(check);
  return lines;
}

std::string verdict_in_words(const RunOutcome& outcome) {
  const std::string& status = outcome.status;
  if (status == "ok") return "certified";
  if (status != "cancelled") return status == "not_certified" ? "not certified" : status;
  return status + "; the best so far is " +
         (outcome.certificate.failures().empty() ? "certified" : "not certified");
}

// Why the flight is not certified, each reason once: checks, the solver's message, and `notes` of
// the mission.
std::vector<std::string> findings(const RunOutcome& outcome,
                                  const std::vector<std::string>& notes) {
  std::vector<std::string> lines;
  const bool failed = outcome.status != "ok" && outcome.status != "cancelled";
  if (failed)
    for (const Check& check : outcome.certificate.failures()) lines.push_back(to_line(check));
  if (failed) lines.push_back(outcome.result.report.message);
  lines.insert(lines.end(), notes.begin(), notes.end());
  return said_once(lines);
}

std::string not_raced_words(const RunOutcome& outcome) {
  return "the players did not fly: " + outcome.not_raced;
}

void print_summary(const RunOutcome& outcome, bool verbose) {
  const MissionResult& result = outcome.result;
  char line[160];
  std::snprintf(line, sizeof line, "  %.4g s of flight, solved by %s (%s) in %.3g s",
                result.plan.trajectory.duration(), result.solver.c_str(),
                to_string(result.report.status), result.solve_seconds);
  const bool ok = outcome.status == "ok";
  std::cout << visible_line(result.plan.mission) << ": "
            << tinted(ok ? Tone::good : Tone::bad, verdict_in_words(outcome))
            << (ok ? visible_text(reported_misses(outcome.certificate)) : "") << "\n"
            << line << "\n";
  const bool details = verbose || !ok;
  for (const std::string& finding :
       findings(outcome, details ? all_notes(result) : told_notes(result)))
    std::cout << "  " << visible_text(finding) << "\n";
  if (outcome.status == "ok" && result.report.status == SolveStatus::iteration_limit)
    std::cout << "  the solver came to its iteration limit: every check holds, a slightly better "
                 "flight may exist\n";
  std::cout << visible_text(race_result(outcome.raced));
  if (!outcome.not_raced.empty())
    std::cout << "  " << visible_text(not_raced_words(outcome)) << "\n";
  std::cout << "  report: " << visible_line((outcome.target.folder() / "report.html").string())
            << "\n";
  if (const std::string old = outcome.target.old_run_in_words(); !old.empty())
    std::cout << "  " << visible_line(old) << "\n";
  std::cout.flush();
}

std::string report_page(const RunOutcome& outcome) {
  Report report = flight_report(outcome.result.plan, outcome.result.obstacle_folder);
  if (outcome.status == "cancelled") {
    report.status = "cancelled";
    report.status_mark = Mark::fail;
  }
  if (const auto all = all_notes(outcome.result); !all.empty()) {
    std::string text;
    for (const std::string& note : all) text += note + "\n\n";
    TextBlock findings;
    findings.text = text;
    report.sections.insert(report.sections.begin(), Section{"Findings", {findings}});
  }
  if (outcome.long_exposure) {
    Image image{*outcome.long_exposure, "What a camera with an open shutter sees of the flight"};
    report.sections.insert(report.sections.begin() + 1, Section{"Long exposure", {image}});
  }
  if (outcome.result.scan) {
    const std::vector<Section> scan = scan_sections(outcome.result.plan, *outcome.result.scan);
    report.sections.insert(report.sections.begin() + 1, scan.begin(), scan.end());
  }
  report.sections.insert(report.sections.begin() + 1, outcome.result.sections.begin(),
                         outcome.result.sections.end());
  if (!outcome.not_raced.empty())
    report.sections.insert(report.sections.begin() + 1,
                           Section{"Game", {TextBlock{not_raced_words(outcome)}}});
  if (!outcome.raced.empty()) {
    std::vector<Section> race = race_sections(outcome.result.plan, outcome.raced, {});
    report.sections.insert(report.sections.begin() + 1, race.begin(), race.end());
  }
  return render_html(report);
}

void write_files(const RunOutcome& outcome, const Registry& registry,
                 const logging::Capture& capture) {
  const Plan& plan = outcome.result.plan;
  RunFiles files;
  files.plan = plan_text(plan);
  const auto exporter = registry.create<Exporter>("csv");
  files.trajectory = in_plugin(*exporter, "write", [&] { return exporter->write(plan); });
  files.report = report_page(outcome);
  logging::info("status " + outcome.status);
  for (const std::string& note : all_notes(outcome.result)) logging::info(note);
  if (!outcome.not_raced.empty()) logging::info(not_raced_words(outcome));
  for (const Check& check : outcome.certificate.failures())
    logging::info("fails: " + to_line(check));
  files.log = capture.text();
  files.long_exposure = outcome.long_exposure;
  for (const std::string& name : outcome.result.obstacle_files) {
    std::string bytes = read_file(outcome.result.obstacle_folder / name, kLargestObstacle);
    if (name == "map.ot")
      files.map = std::move(bytes);
    else
      files.obstacles.emplace_back(name, std::move(bytes));
  }
  outcome.target.write(files);
}

// Of the flight under control.
std::string photograph(const Plan& plan) {
  constexpr int kWidth = 1000;  // pixels
  const FlownPath flown = fly(plan.trajectory, vehicle_from_value(plan.vehicle));
  return encode_png(long_exposure(plan, flown, kWidth));
}

std::vector<RacedPilot> flown_by_pilots(const RunOutcome& outcome, const CancellationToken& token) {
  const Plan& plan = outcome.result.plan;
  const Vehicle vehicle = vehicle_from_value(plan.vehicle);
  std::vector<RacedPilot> raced;
  const RaceFlightLimits limits = race_limits(plan.trajectory, plan.task.gates);
  for (const Pilot& pilot : outcome.result.pilots) {
    RaceFlight flight = fly_race(plan.trajectory, vehicle, pilot, limits, &token);
    RaceScore score = score_of(flight, plan.trajectory, plan.task.gates, pilot.handicap);
    raced.push_back({pilot, std::move(flight), std::move(score)});
  }
  return raced;
}

// Whatever comes of the game, the plan was computed and is kept.
void fly_pilots(RunOutcome& outcome, const CancellationToken& token) {
  if (outcome.result.pilots.empty()) return;
  const Check* document = outcome.certificate.find("document");
  try {
    if (token.cancelled()) throw Cancelled();
    if (document && !document->pass)
      outcome.not_raced = "the plan does not hold together: " + document->detail;
    else
      outcome.raced = flown_by_pilots(outcome, token);
  } catch (const Cancelled&) {
    outcome.not_raced = "interrupted; fly them with lapwing race PLAN --pilot LOG";
  } catch (const Error& error) {
    outcome.not_raced = error.what();
  }
}

void complete_plan(RunOutcome& outcome) {
  Plan& plan = outcome.result.plan;
  plan.certificate = outcome.certificate.to_value();
  std::vector<std::string> all = outcome.result.notes;
  all.insert(all.end(), outcome.result.details.begin(), outcome.result.details.end());
  if (!all.empty()) plan.solver.set("notes", Value(Value::List(all.begin(), all.end())));
  if (outcome.status == "cancelled") plan.solver.set("cancelled", true);
}

}  // namespace

ExitStatus run_mission(const std::filesystem::path& script, const Invocation& invocation) {
  const double begin = steady_seconds();
  const logging::Capture capture;
  const Interruption interruption;
  const Registry registry = invocation.registry();
  ProgressLine progress("plan", std::cerr, progress_style_of_stderr(invocation.quiet),
                        columns_of_stderr(), &steady_seconds);
  const auto mission = load_mission(script, invocation, registry, &interruption.token(), &progress,
                                    [&progress] { progress.clear(); });
  registry.find("exporter", "csv");
  RunTarget target(mission->name(), invocation);
  RunOutcome outcome{.target = target};
  logging::info("mission " + mission->name() + ", seed " + std::to_string(invocation.seed));
  outcome.result = mission->plan();
  if (outcome.result.mapping) {
    progress.clear();
    outcome.seconds = steady_seconds() - begin;
    return finish_mapping({outcome.result, target, outcome.seconds}, invocation, capture);
  }
  progress.begin("certificate");
  progress.report(-1, "");
  JudgedPlan judged = judge(outcome.result.plan, outcome.result.obstacle_folder, nullptr);
  outcome.certificate = std::move(judged.certificate);
  outcome.provenance = std::move(judged.provenance);
  progress.begin("files");
  progress.report(-1, "");
  outcome.status = status_of(outcome.result, outcome.certificate, interruption.token().cancelled());
  complete_plan(outcome);
  if (!outcome.result.plan.lights.empty()) outcome.long_exposure = photograph(outcome.result.plan);
  fly_pilots(outcome, interruption.token());
  write_files(outcome, registry, capture);
  progress.clear();
  outcome.seconds = steady_seconds() - begin;
  if (invocation.json) {
    print_json(json_of(outcome, invocation));
  } else if (!invocation.quiet) {
    print_summary(outcome, invocation.verbose);
  } else if (outcome.status != "ok") {
    std::cerr << "lapwing: " << visible_line(outcome.result.plan.mission) << ": "
              << tinted_error(Tone::bad, verdict_in_words(outcome));
    for (const std::string& finding : findings(outcome, {}))
      std::cerr << "\n  " << visible_text(finding);
    std::cerr << std::endl;
  } else if (!outcome.not_raced.empty()) {
    std::cerr << "lapwing: " << visible_line(outcome.result.plan.mission) << ": "
              << visible_text(not_raced_words(outcome)) << std::endl;
  }
  return exit_status_of(outcome.status);
}

}  // namespace lapwing
