// SPDX-License-Identifier: Apache-2.0
#include "framework/export/flight_report.h"

#include <numbers>

#include "framework/core/json.h"
#include "framework/core/units.h"
#include "framework/export/film_charts.h"
#include "framework/export/flight_charts.h"
#include "framework/trajectory/interpolate.h"
#include "framework/vehicle/vehicle.h"
#include "framework/verify/certificate.h"

namespace lapwing {
namespace {

double number_or_gap(const Value& map, const char* key) {
  const Value* value = map.find(key);
  return value == nullptr || value->is_null() ? std::numeric_limits<double>::quiet_NaN()
                                              : value->as_number();
}

std::string text_or_nothing(const Value& map, const char* key) {
  const Value* value = map.find(key);
  return value == nullptr || value->is_null() ? "" : value->as_text();
}

// What a check says, in the units of the page.
TableRow check_row(const Check& check) {
  if (!check.skipped.empty()) {
    return {{check.name, "", "", "", "", check.skipped}, Mark::skipped};
  }
  const bool angle = check.unit.starts_with("rad");
  const auto shown = [&](double value) { return angle ? degrees(value) : value; };
  std::string unit = angle ? "\u00b0" + check.unit.substr(3) : check.unit;
  if (unit.ends_with("^2")) unit.replace(unit.size() - 2, 2, "\u00b2");
  std::string remark = check.required ? "" : "reported, not required";
  if (!check.detail.empty()) remark += (remark.empty() ? "" : "; ") + check.detail;
  return {{check.name, check.worst ? TableCell(shown(*check.worst)) : TableCell(""),
           (check.at_least ? "\u2265\u00a0" : "\u2264\u00a0") + number_text(shown(check.limit)),
           unit, check.worst ? TableCell(check.at) : TableCell(""), remark},
          check.pass ? Mark::pass : Mark::fail};
}

Table check_table(std::string title, const std::vector<Check>& checks) {
  Table table{std::move(title),
              {{"check", ""}, {"worst", ""}, {"limit", ""}, {"unit", ""}, {"at", "s"}, {"", ""}},
              {}};
  for (const Check& check : checks) table.rows.push_back(check_row(check));
  return table;
}

struct Verdict {
  std::string text = "not judged";
  std::string count;  // empty where there is no certificate
  Mark mark = Mark::none;
  std::vector<Check> failures;
};

Verdict verdict_of(const Plan& plan) {
  if (plan.certificate.is_null()) return {};
  const Certificate certificate = Certificate::from_value(plan.certificate);
  int passed = 0, made = 0;
  for (const Check& check : certificate.checks) {
    if (!check.required || !check.skipped.empty()) continue;
    ++made;
    passed += check.pass ? 1 : 0;
  }
  const bool feasible = certificate.feasible();
  return {feasible ? "certified" : "not certified",
          std::to_string(passed) + " of " + std::to_string(made),
          feasible ? Mark::pass : Mark::fail, certificate.failures()};
}

double length_of(const Trajectory& trajectory) {
  double length = 0;
  for (std::size_t i = 1; i < trajectory.samples.size(); ++i) {
    length += (trajectory.samples[i].position - trajectory.samples[i - 1].position).norm();
  }
  return length;
}

Section summary_section(const Plan& plan, const Vehicle& vehicle) {
  const Verdict verdict = verdict_of(plan);
  double fastest = 0;
  for (const Sample& s : plan.trajectory.samples) fastest = std::max(fastest, s.velocity.norm());
  Facts facts;
  facts.facts = {{"vehicle", vehicle.name, ""},
                 {"duration", number_text(plan.trajectory.duration()), "s"},
                 {"path length", number_text(length_of(plan.trajectory)), "m"}};
  if (plan.trajectory.motion.moves) {
    facts.facts.push_back({"top speed", number_text(fastest, 3), "m/s"});
  }
  if (plan.budget) facts.facts.push_back({"budget", number_text(*plan.budget), "s"});
  facts.facts.push_back({"keyframes", std::to_string(plan.task.keyframes.size()), ""});
  facts.facts.push_back({"samples", std::to_string(plan.trajectory.samples.size()), ""});
  if (!plan.solver.is_null()) {
    facts.facts.push_back(
        {"solver", plan.solver.at("name").as_text() + ", " + plan.solver.at("status").as_text(),
         ""});
  }
  if (!verdict.count.empty()) {
    facts.facts.push_back({"required checks passed", verdict.count, "", verdict.mark});
  }
  Section section{"Summary", {std::move(facts)}};
  if (!verdict.failures.empty()) {
    section.blocks.push_back(check_table("Why the flight is not certified", verdict.failures));
  }
  return section;
}

// Distance to a keyframe at its time, and the smallest within its time tolerance.
struct Miss {
  double at_time = std::numeric_limits<double>::quiet_NaN();
  double closest = std::numeric_limits<double>::quiet_NaN();
  double yaw = std::numeric_limits<double>::quiet_NaN();
};

Miss miss_of(const Trajectory& trajectory, const KeyframeTask& keyframe) {
  const double begin = trajectory.samples.front().time, end = trajectory.samples.back().time;
  const auto distance = [&](double time) {
    return (sample_at(trajectory, time).position - keyframe.position).norm();
  };
  Miss miss;
  if (keyframe.time >= begin && keyframe.time <= end) {
    miss.at_time = distance(keyframe.time);
    if (keyframe.yaw) {
      miss.yaw = std::abs(std::remainder(sample_at(trajectory, keyframe.time).yaw - *keyframe.yaw,
                                         2 * std::numbers::pi));
    }
  }
  constexpr int kSteps = 50;
  const double from = std::max(begin, keyframe.time - keyframe.time_tolerance);
  const double to = std::min(end, keyframe.time + keyframe.time_tolerance);
  for (int i = 0; i <= kSteps && from <= to; ++i) {
    miss.closest = std::fmin(miss.closest, distance(from + (to - from) * i / kSteps));
  }
  miss.closest = std::fmin(miss.closest, miss.at_time);
  return miss;
}

Section keyframe_section(const Plan& plan) {
  Table table{"Distances from the keyframes",
              {{"keyframe", ""},
               {"time", "s"},
               {"miss at its time", "m"},
               {"closest within time tolerance", "m"},
               {"tolerance", "m"},
               {"yaw miss", "\u00b0"},
               {"yaw tolerance", "\u00b0"}},
              {}};
  for (std::size_t i = 0; i < plan.task.keyframes.size(); ++i) {
    const KeyframeTask& k = plan.task.keyframes[i];
    const Miss miss = miss_of(plan.trajectory, k);
    const bool met = miss.closest <= k.tolerance && (!k.yaw || miss.yaw <= k.yaw_tolerance);
    table.rows.push_back({{std::to_string(i + 1), k.time, miss.at_time, miss.closest, k.tolerance,
                           k.yaw ? TableCell(degrees(miss.yaw)) : TableCell(""),
                           k.yaw ? TableCell(degrees(k.yaw_tolerance)) : TableCell("")},
                          met ? Mark::pass : Mark::fail});
  }
  return {"Keyframes", {std::move(table)}};
}

// One series per term over the iterations, in the order in which the terms first occur.
std::vector<Series> cost_series(const Value::List& history) {
  std::vector<Series> series{{"all terms", {}, {}}};
  for (const Value& iteration : history) {
    const double number = iteration.at("iteration").as_number();
    series[0].x.push_back(number);
    series[0].y.push_back(iteration.at("cost").as_number());
    const Value* terms = iteration.find("terms");
    if (terms == nullptr) continue;
    for (const auto& [name, cost] : terms->as_map()) {
      auto found = std::find_if(series.begin() + 1, series.end(),
                                [&name = name](const Series& s) { return s.name == name; });
      if (found == series.end()) found = series.insert(found, Series{name, {}, {}});
      found->x.push_back(number);
      found->y.push_back(cost.as_number());
    }
  }
  return series;
}

// Costs that span more than two decades read better on a logarithmic axis.
bool spans_decades(const std::vector<Series>& series) {
  double low = std::numeric_limits<double>::infinity(), high = 0;
  for (const Series& s : series) {
    for (const double v : s.y) {
      if (v > 0) low = std::min(low, v);
      high = std::max(high, v);
    }
  }
  return high > 100 * low;
}

void add_history(const Value::List& history, Section& section) {
  Chart costs;
  costs.title = "Weighted cost per term";
  costs.x = {"iteration", "", false, true};
  costs.series = cost_series(history);
  costs.y = {"cost", "", spans_decades(costs.series), false};
  section.blocks.push_back(std::move(costs));
  Series violation{"worst violation", {}, {}}, step{"step length", {}, {}};
  for (const Value& iteration : history) {
    const double number = iteration.at("iteration").as_number();
    violation.x.push_back(number);
    violation.y.push_back(number_or_gap(iteration, "violation"));
    step.x.push_back(number);
    step.y.push_back(number_or_gap(iteration, "step"));
  }
  Chart progress;
  progress.title = "Violation and step length";
  progress.x = {"iteration", "", false, true};
  progress.series = {std::move(violation), std::move(step)};
  progress.y = {"value", "", spans_decades(progress.series), false};
  section.blocks.push_back(std::move(progress));
}

Section solver_section(const Value& solver) {
  Section section{"Solver", {}};
  const std::string& status = solver.at("status").as_text();
  const bool solved = status == "optimal" || status == "feasible";
  section.blocks.push_back(
      Facts{{{"solver", solver.at("name").as_text(), ""},
             {"status", status, "", solved ? Mark::pass : Mark::fail},
             {"iterations", number_text(solver.at("iterations").as_number()), ""}}});
  auto& facts = std::get<Facts>(section.blocks.back()).facts;
  for (const char* figure : {"cost", "score", "upper_bound", "images", "evaluations"})
    if (solver.find(figure))
      facts.push_back({figure, number_text(solver.at(figure).as_number()), ""});
  if (const std::string why = text_or_nothing(solver, "message"); !why.empty()) {
    section.blocks.push_back(TextBlock{why, false, ""});
  }
  const Value* history = solver.find("history");
  if (history && !history->as_list().empty()) add_history(history->as_list(), section);
  const Value* terms = solver.find("terms");
  if (terms && !terms->as_map().empty()) {
    Table table{"Cost of the result", {{"term", ""}, {"weighted cost", ""}, {"share", "%"}}, {}};
    double total = 0;
    for (const auto& [name, cost] : terms->as_map()) total += cost.as_number();
    for (const auto& [name, cost] : terms->as_map()) {
      const double share = total > 0 ? std::round(1000 * cost.as_number() / total) / 10 : 0;
      table.rows.push_back({{name, cost.as_number(), share}});
    }
    section.blocks.push_back(std::move(table));
  }
  return section;
}

}  // namespace

Section certificate_section(const Certificate& certificate) {
  Section section{"Certificate", {}};
  for (const CheckGroup group : {CheckGroup::safety, CheckGroup::task}) {
    std::vector<Check> checks;
    for (const Check& check : certificate.checks) {
      if (check.group == group) checks.push_back(check);
    }
    if (checks.empty()) continue;
    section.blocks.push_back(check_table(group == CheckGroup::safety
                                             ? "Safety: the vehicle can fly the plan"
                                             : "Task: the requirements of the mission",
                                         checks));
  }
  return section;
}

std::vector<Section> flight_sections(const Plan& plan, const std::filesystem::path& folder) {
  if (plan.trajectory.samples.empty()) throw Error("a flight without samples has no report");
  const Vehicle vehicle = vehicle_from_value(plan.vehicle);
  std::vector<Section> sections{summary_section(plan, vehicle), path_section(plan, folder)};
  if (plan.trajectory.has_gimbal && !plan.task.scan)
    sections.push_back(camera_section(plan, vehicle));
  sections.push_back(motion_section(plan, vehicle));
  if (Section inputs = input_section(plan, vehicle); !inputs.blocks.empty()) {
    sections.push_back(std::move(inputs));
  }
  sections.push_back(direction_section(plan, vehicle));
  if (!plan.task.keyframes.empty()) sections.push_back(keyframe_section(plan));
  if (!plan.solver.is_null()) sections.push_back(solver_section(plan.solver));
  if (!plan.certificate.is_null()) {
    sections.push_back(certificate_section(Certificate::from_value(plan.certificate)));
  }
  if (!plan.configuration.is_null()) {
    sections.push_back(
        {"Configuration", {TextBlock{to_json(plan.configuration), true, "Effective values"}}});
  }
  return sections;
}

Report flight_report(const Plan& plan, const std::filesystem::path& folder) {
  const Verdict verdict = verdict_of(plan);
  Report report;
  report.title = plan.mission;
  report.sections = flight_sections(plan, folder);
  report.subtitle = plan.kind + ", " + number_text(plan.trajectory.duration()) + " s with " +
                    vehicle_from_value(plan.vehicle).name;
  report.status = verdict.text;
  report.status_mark = verdict.mark;
  return report;
}

}  // namespace lapwing
