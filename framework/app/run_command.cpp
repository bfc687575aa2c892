// SPDX-License-Identifier: Apache-2.0
// lapwing run: load, check, plan, certify, write, report.
#include <chrono>
#include <cmath>
#include <iostream>

#include "framework/app/command_line.h"
#include "framework/app/fleet_run.h"
#include "framework/app/interruption.h"
#include "framework/app/mapping_run.h"
#include "framework/app/mission_loading.h"
#include "framework/app/plan_figures.h"
#include "framework/app/progress_line.h"
#include "framework/app/provenance.h"
#include "framework/app/report_viewer.h"
#include "framework/app/run_additions.h"
#include "framework/app/run_outcome.h"
#include "framework/app/run_target.h"
#include "framework/app/terminal.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/log.h"
#include "framework/core/visible_text.h"
#include "framework/export/episode_file.h"
#include "framework/export/exporter.h"
#include "framework/export/flight_report.h"

namespace lapwing {

namespace {

struct RunOutcome {
  MissionResult result = {};
  Certificate certificate = {};
  std::string status = {};  // ok, not_certified, infeasible, failed, cancelled
  RunTarget& target;
  Value provenance = {};  // what the certificate is about
  double seconds = 0;     // wall clock, all of it
  std::vector<RunAddition> additions = {};
};

Value json_of(const RunOutcome& outcome, const Invocation& invocation) {
  const MissionResult& result = outcome.result;
  Value object = Value::map();
  object.set("mission", result.plan.mission);
  object.set("kind", result.plan.kind);
  object.set("status", outcome.status);
  object.set("plan", (outcome.target.folder() / "plan.json").string());
  if (invocation.report_data)
    object.set("report_data", (outcome.target.folder() / "report.json").string());
  outcome.target.add_to(object);
  object.set("seed", static_cast<std::int64_t>(invocation.seed));
  Value& seconds = object.set("seconds", Value::map());
  seconds.set("total", outcome.seconds);
  seconds.set("solve", result.solve_seconds);
  object.set("reproducible",
             outcome.status != "cancelled" && result.report.status != SolveStatus::time_limit);
  object.set("solver", solver_figures(result));
  object.set("provenance", outcome.provenance);
  object.set("certificate", outcome.certificate.to_value());
  if (const auto all = all_notes(result); !all.empty())
    object.set("notes", Value(Value::List(all.begin(), all.end())));
  if (result.block.is_map())
    object.set(result.block_name.empty() ? result.plan.kind : result.block_name, result.block);
  for (const RunAddition& addition : outcome.additions)
    if (!addition.key.empty()) object.set(addition.key, addition.figures);
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
    std::cout << "  the solver reached its iteration limit: every check passes; a slightly better "
                 "flight may exist\n";
  for (const RunAddition& addition : outcome.additions) {
    std::cout << visible_text(addition.summary);
    if (!addition.failure.empty()) std::cout << "  " << visible_text(addition.failure) << "\n";
  }
  std::cout << "  report: " << visible_line((outcome.target.folder() / "report.html").string())
            << "\n";
  if (const std::string old = outcome.target.old_run_in_words(); !old.empty())
    std::cout << "  " << visible_line(old) << "\n";
  std::cout.flush();
}

void write_files(const RunOutcome& outcome, const Invocation& invocation, const Registry& registry,
                 const logging::Capture& capture) {
  const Plan& plan = outcome.result.plan;
  RunFiles files;
  files.plan = plan_text(plan);
  const auto exporter = registry.create<Exporter>("csv");
  files.trajectory = in_plugin(*exporter, "write", [&] { return exporter->write(plan); });
  std::vector<Section> own;
  for (const RunAddition& addition : outcome.additions)
    own.insert(own.end(), addition.sections.begin(), addition.sections.end());
  add_report(report_of(outcome.result, outcome.status, std::move(own),
                       viewer_of(outcome.result, outcome.certificate)),
             invocation, files);
  logging::info("status " + outcome.status);
  for (const std::string& note : all_notes(outcome.result)) logging::info(note);
  for (const RunAddition& addition : outcome.additions) {
    if (!addition.failure.empty()) logging::info(addition.failure);
    if (addition.long_exposure) files.long_exposure = addition.long_exposure;
  }
  for (const Check& check : outcome.certificate.failures())
    logging::info("fails: " + to_line(check));
  files.log = capture.text();
  add_obstacles(outcome.result, files);
  if (outcome.result.exploration)
    for (auto& file : episode_files(*outcome.result.exploration, *files.plan,
                                    std::string("lapwing ") + program_version()))
      files.obstacles.push_back(std::move(file));
  outcome.target.write(files);
}

}  // namespace

ExitStatus run_mission(const std::filesystem::path& script, const Invocation& invocation) {
  const double begin = steady_seconds();
  const logging::Capture capture;
  const Interruption interruption;
  const Registry registry = invocation.registry();
  ProgressLine progress("plan", std::cerr, progress_style_of_stderr(invocation.quiet),
                        columns_of_stderr(), &steady_seconds);
  const auto mission =
      load_mission(script, invocation, registry, &interruption.token(), &progress,
                   [&progress] { progress.clear(); }, {.surface = {}, .tour = {}, .steps = true});
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
  if (outcome.result.fleet)
    return finish_fleet({outcome.result, target, interruption.token(), progress, begin}, invocation,
                        registry, capture);
  progress.begin("certificate");
  // Also the best so far of a run that was told to end is judged.
  JudgedPlan judged = judge(outcome.result.plan, outcome.result.obstacle_folder, nullptr,
                            {.progress = &progress, .controllers = controllers_of(invocation)});
  outcome.certificate = std::move(judged.certificate);
  outcome.provenance = std::move(judged.provenance);
  progress.begin("files");
  progress.report(-1, "");
  outcome.status = status_of(outcome.result, outcome.certificate, interruption.token().cancelled());
  complete_plan(outcome.result, outcome.certificate, outcome.status);
  outcome.additions = run_additions(outcome.result, outcome.certificate, interruption.token());
  write_files(outcome, invocation, registry, capture);
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
  } else {
    for (const RunAddition& addition : outcome.additions)
      if (!addition.failure.empty())
        std::cerr << "lapwing: " << visible_line(outcome.result.plan.mission) << ": "
                  << visible_text(addition.failure) << std::endl;
  }
  return exit_status_of(outcome.status);
}

}  // namespace lapwing
