// SPDX-License-Identifier: Apache-2.0
#include "framework/app/fleet_run.h"

#include <iostream>

#include "framework/app/configured_fleet.h"
#include "framework/app/fleet_words.h"
#include "framework/app/plan_figures.h"
#include "framework/app/provenance.h"
#include "framework/app/run_outcome.h"
#include "framework/app/terminal.h"
#include "framework/core/checksum.h"
#include "framework/core/number_text.h"
#include "framework/core/visible_text.h"
#include "framework/export/exporter.h"
#include "framework/export/fleet_report.h"
#include "framework/trajectory/plan.h"
#include "framework/verify/fleet.h"

namespace lapwing {
namespace {

std::vector<const Plan*> plans_of(const FleetResult& fleet) {
  std::vector<const Plan*> plans;
  for (const MissionResult& tour : fleet.tours) plans.push_back(&tour.plan);
  return plans;
}

}  // namespace

JudgedRun judge_run(MissionResult& result, bool cancelled, const Judges& judges) {
  JudgedRun judged;
  FleetResult& fleet = *result.fleet;
  std::vector<FleetMember> members;
  for (std::size_t t = 0; t < fleet.tours.size(); ++t) {
    MissionResult& tour = fleet.tours[t];
    JudgedPlan one = judge(tour.plan, tour.obstacle_folder, nullptr, judges);
    judged.certificates.push_back(std::move(one.certificate));
    judged.statuses.push_back(status_of(tour, judged.certificates.back(), cancelled));
    complete_plan(tour, judged.certificates.back(), judged.statuses.back());
    judged.texts.push_back(plan_text(tour.plan));
    fleet.document.tours[t].sha256 = sha256(judged.texts.back());
  }
  for (std::size_t t = 0; t < fleet.tours.size(); ++t)
    members.push_back(
        {&fleet.tours[t].plan, &judged.certificates[t], fleet.document.tours[t].sha256});
  const ConfigurationComparison compared = compare_fleet(fleet.document, plans_of(fleet));
  judged.certificate = verify_fleet(
      fleet.document, members, nullptr,
      {.folder = result.obstacle_folder, .cancellation = judges.cancellation}, compared.faults);
  fleet.document.certificate = judged.certificate.to_value();
  judged.status = status_of(result, judged.certificate, cancelled);
  if (judged.status == "cancelled") fleet.document.solver.set("cancelled", true);
  return judged;
}

namespace {

Report report_of(const FleetOutcome& outcome, const JudgedRun& judged) {
  const FleetResult& fleet = *outcome.result.fleet;
  Report report = fleet_report(fleet.document, plans_of(fleet), outcome.result.obstacle_folder);
  if (judged.status == "cancelled") {
    report.status = "cancelled";
    report.status_mark = Mark::fail;
  }
  // Before the certificate.
  const std::vector<Section> own = sections_of(outcome.result);
  report.sections.insert(report.sections.end() - 1, own.begin(), own.end());
  TextBlock findings;
  for (const std::string& note : all_notes(outcome.result)) findings.text += note + "\n\n";
  if (!findings.text.empty())
    report.sections.insert(report.sections.begin(), Section{"Findings", {findings}});
  return report;
}

void write_files(const FleetOutcome& outcome, const JudgedRun& judged, const Invocation& invocation,
                 const Registry& registry, const logging::Capture& capture) {
  const FleetResult& fleet = *outcome.result.fleet;
  RunFiles files;
  const auto exporter = registry.create<Exporter>("csv");
  for (std::size_t t = 0; t < fleet.tours.size(); ++t) {
    const MissionResult& tour = fleet.tours[t];
    const std::string number = std::to_string(t + 1);
    files.tours.emplace_back("report_" + number + ".html",
                             render_html(report_of(tour, judged.statuses[t], {})));
    files.tours.emplace_back("trajectory_" + number + ".csv", in_plugin(*exporter, "write", [&] {
                               return exporter->write(tour.plan);
                             }));
    files.tours.emplace_back(fleet.document.tours[t].file, judged.texts[t]);
  }
  files.fleet = fleet_text(fleet.document);
  add_report(report_of(outcome, judged), invocation, files);
  logging::info("status " + judged.status);
  for (const std::string& note : all_notes(outcome.result)) logging::info(note);
  for (const Check& check : judged.certificate.failures())
    logging::info("fails: " + to_line(check));
  files.log = capture.text();
  add_obstacles(outcome.result, files);
  outcome.target.write(files);
}

Value tour_figures(const FleetTour& tour, const MissionResult& result, const std::string& status,
                   const Certificate& certificate, const std::filesystem::path& folder) {
  Value row = Value::map();
  row.set("drone", tour.drone);
  row.set("battery", std::int64_t{tour.battery});
  row.set("start", tour.start);
  row.set("duration", result.plan.trajectory.duration());
  row.set("images", static_cast<std::int64_t>(result.plan.task.scan->views.size()));
  row.set("plan", (folder / tour.file).string());
  row.set("status", status);
  if (result.block.is_map()) row.set("tour", result.block);
  row.set("certificate", certificate.to_value());
  return row;
}

Value json_of(const FleetOutcome& outcome, const JudgedRun& judged, const Invocation& invocation,
              double total) {
  const MissionResult& result = outcome.result;
  const FleetResult& fleet = *result.fleet;
  Value object = Value::map();
  object.set("mission", result.plan.mission);
  object.set("kind", result.plan.kind);
  object.set("status", judged.status);
  object.set("fleet", (outcome.target.folder() / "fleet.json").string());
  outcome.target.add_to(object);
  object.set("seed", static_cast<std::int64_t>(invocation.seed));
  Value& seconds = object.set("seconds", Value::map());
  seconds.set("total", total);
  seconds.set("solve", result.solve_seconds);
  object.set("reproducible",
             judged.status != "cancelled" && result.report.status != SolveStatus::time_limit);
  object.set("solver", solver_figures(result));
  object.set("certificate", judged.certificate.to_value());
  if (const auto all = all_notes(result); !all.empty())
    object.set("notes", Value(Value::List(all.begin(), all.end())));
  if (result.block.is_map()) object.set(result.block_name, result.block);
  Value& tours = object.set("tours", Value::list());
  for (std::size_t t = 0; t < fleet.tours.size(); ++t)
    tours.push_back(tour_figures(fleet.document.tours[t], fleet.tours[t], judged.statuses[t],
                                 judged.certificates[t], outcome.target.folder()));
  return object;
}

void print_summary(const FleetOutcome& outcome, const JudgedRun& judged) {
  const MissionResult& result = outcome.result;
  const FleetResult& fleet = *result.fleet;
  const bool ok = judged.status == "ok";
  const std::string verdict = ok                                 ? "certified"
                              : judged.status == "not_certified" ? "not certified"
                                                                 : judged.status;
  std::cout << visible_line(result.plan.mission) << ": "
            << tinted(ok ? Tone::good : Tone::bad, verdict) << "\n";
  std::cout << "  " << fleet_in_words(fleet.document, end_of_fleet(fleet.document, plans_of(fleet)))
            << ", solved by " << result.solver << " (" << to_string(result.report.status) << ") in "
            << plain_number(result.solve_seconds, 3) << " s\n";
  for (std::size_t t = 0; t < fleet.tours.size(); ++t)
    std::cout << "  "
              << visible_line(tour_in_words(fleet.document.tours[t], fleet.tours[t].plan,
                                            judged.certificates[t].feasible()))
              << "\n";
  if (!ok)
    for (const Check& check : judged.certificate.failures())
      std::cout << "  " << visible_text(to_line(check)) << "\n";
  for (const std::string& note : ok ? told_notes(result) : all_notes(result))
    std::cout << "  " << visible_text(note) << "\n";
  std::cout << "  report: " << visible_line((outcome.target.folder() / "report.html").string())
            << "\n";
  if (const std::string old = outcome.target.old_run_in_words(); !old.empty())
    std::cout << "  " << visible_line(old) << "\n";
  std::cout.flush();
}

}  // namespace

ExitStatus finish_fleet(const FleetOutcome& outcome, const Invocation& invocation,
                        const Registry& registry, const logging::Capture& capture) {
  outcome.progress.begin("certificate");
  const JudgedRun judged =
      judge_run(outcome.result, outcome.cancellation.cancelled(),
                {.progress = &outcome.progress, .controllers = controllers_of(invocation)});
  outcome.progress.begin("files");
  outcome.progress.report(-1, "");
  write_files(outcome, judged, invocation, registry, capture);
  outcome.progress.clear();
  if (invocation.json) {
    print_json(json_of(outcome, judged, invocation, steady_seconds() - outcome.begin));
  } else if (!invocation.quiet) {
    print_summary(outcome, judged);
  } else if (judged.status != "ok") {
    std::cerr << "lapwing: " << visible_line(outcome.result.plan.mission) << ": "
              << tinted_error(Tone::bad, judged.status);
    for (const Check& check : judged.certificate.failures())
      std::cerr << "\n  " << visible_text(to_line(check));
    std::cerr << std::endl;
  }
  return exit_status_of(judged.status);
}

}  // namespace lapwing
