// SPDX-License-Identifier: Apache-2.0
#include "framework/app/plan_comparison.h"

#include <algorithm>
#include <set>

#include "framework/app/provenance.h"
#include "framework/trajectory/interpolate.h"

namespace lapwing {

namespace {

using Differences = std::vector<ValueDifference>;

bool holds_parts(const Value& list) {
  return list.is_list() &&
         std::any_of(list.as_list().begin(), list.as_list().end(),
                     [](const Value& entry) { return entry.is_map() || entry.is_list(); });
}

void compare_values(const std::string& key, const Value* first, const Value* second,
                    Differences& found) {
  if (first && second && *first == *second) return;
  if (first && second && first->is_map() && second->is_map()) {
    const std::string before = key.empty() ? "" : key + ".";
    for (const auto& [name, value] : first->as_map())
      compare_values(before + name, &value, second->find(name), found);
    for (const auto& [name, value] : second->as_map())
      if (!first->find(name)) compare_values(before + name, nullptr, &value, found);
    return;
  }
  // A list of numbers is one value; others are compared entry by entry.
  if (first && second && holds_parts(*first) && holds_parts(*second)) {
    const auto& a = first->as_list();
    const auto& b = second->as_list();
    for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i)
      compare_values(key + "[" + std::to_string(i + 1) + "]", i < a.size() ? &a[i] : nullptr,
                     i < b.size() ? &b[i] : nullptr, found);
    return;
  }
  const auto copy = [](const Value* value) {
    return value ? std::optional<Value>(*value) : std::nullopt;
  };
  found.push_back({key, copy(first), copy(second)});
}

ComparedPlan read_compared(const std::filesystem::path& given) {
  ComparedPlan read;
  read.file = plan_file(given);
  read.plan = read_plan_file(read.file);
  read.document = to_value(read.plan);
  read.figures = figures_of(read.plan);
  if (!read.plan.certificate.is_null())
    read.certificate = Certificate::from_value(read.plan.certificate);
  return read;
}

// Of a document: what the planner was told, but for the options.
Value stated_part(const Value& document) {
  static const std::set<std::string> kElsewhere{"format", "configuration", "solver", "certificate",
                                                "samples"};
  Value stated = Value::map();
  for (const auto& [name, value] : document.as_map())
    if (!kElsewhere.count(name)) stated.set(name, value);
  return stated;
}

void measure_distance(PlanComparison& all) {
  const Trajectory& first = all.first.plan.trajectory;
  const Trajectory& second = all.second.plan.trajectory;
  if (first.samples.empty() || second.samples.empty()) return;
  const double end = std::min(first.samples.back().time, second.samples.back().time);
  const double begin = std::max(first.samples.front().time, second.samples.front().time);
  for (const Trajectory* one : {&first, &second})
    for (const Sample& sample : one->samples) {
      if (sample.time < begin || sample.time > end) continue;
      const double distance =
          (sample_at(first, sample.time).position - sample_at(second, sample.time).position).norm();
      if (distance <= all.distance) continue;
      all.distance = distance;
      all.distance_at = sample.time;
    }
}

double share_of_nearest(const PlanFigures& figures) {
  return figures.nearest ? 100 * figures.nearest->share : PlanFigures::kNone;
}

double term_of(const PlanFigures& figures, const std::string& name) {
  for (const auto& [term, cost] : figures.terms)
    if (term == name) return cost;
  return PlanFigures::kNone;
}

bool same_result(const Check& a, const Check& b) {
  return a.required == b.required && a.skipped == b.skipped && a.worst == b.worst &&
         a.limit == b.limit && a.pass == b.pass && a.tolerance == b.tolerance;
}

}  // namespace

PlanComparison compare_plans(const std::filesystem::path& first,
                             const std::filesystem::path& second) {
  PlanComparison all;
  all.first = read_compared(first);
  all.second = read_compared(second);
  all.same = all.first.document == all.second.document;
  compare_values("", &all.first.plan.configuration, &all.second.plan.configuration, all.options);
  const Value a = stated_part(all.first.document), b = stated_part(all.second.document);
  compare_values("", &a, &b, all.task);
  measure_distance(all);
  return all;
}

std::vector<FigureRow> figure_rows(const PlanComparison& compared) {
  const PlanFigures& a = compared.first.figures;
  const PlanFigures& b = compared.second.figures;
  return {{"duration", "s", a.duration, b.duration},
          {"path length", "m", a.path_length, b.path_length},
          {"top speed", "m/s", a.top_speed, b.top_speed},
          {"clearance", "m", a.clearance, b.clearance},
          {"cost", "", a.cost, b.cost},
          {"nearest limit", "%", share_of_nearest(a), share_of_nearest(b)}};
}

std::vector<FigureRow> term_rows(const PlanComparison& compared) {
  const PlanFigures& a = compared.first.figures;
  const PlanFigures& b = compared.second.figures;
  std::vector<FigureRow> rows;
  for (const auto& [name, cost] : a.terms) rows.push_back({name, "", cost, term_of(b, name)});
  for (const auto& [name, cost] : b.terms)
    if (std::none_of(a.terms.begin(), a.terms.end(),
                     [&name = name](const auto& term) { return term.first == name; }))
      rows.push_back({name, "", PlanFigures::kNone, cost});
  return rows;
}

std::vector<CheckRow> check_rows(const PlanComparison& compared) {
  const Certificate& a = compared.first.certificate;
  const Certificate& b = compared.second.certificate;
  std::vector<CheckRow> rows;
  for (const Check& check : a.checks) {
    const Check* other = b.find(check.name);
    if (!other || !same_result(check, *other)) rows.push_back({&check, other});
  }
  for (const Check& check : b.checks)
    if (!a.find(check.name)) rows.push_back({nullptr, &check});
  return rows;
}

}  // namespace lapwing
