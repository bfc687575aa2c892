// SPDX-License-Identifier: Apache-2.0
#include "framework/app/diff_command.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <iostream>
#include <map>

#include "framework/app/output_target.h"
#include "framework/app/plan_comparison.h"
#include "framework/app/text_table.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/number_text.h"
#include "framework/core/units.h"
#include "framework/export/flight_charts.h"

namespace lapwing {

namespace {

constexpr std::size_t kMostDifferences = 40;  // of one kind, where people read them
constexpr std::size_t kLongestValue = 60;     // characters, likewise

std::string figure_text(double value) {
  return std::isfinite(value) ? plain_number(value + 0.0, 5) : "-";  // no "-0"
}

// Whether people would call two results of a check the same: what is left of rounding is no news.
bool as_good_as_equal(const CheckRow& row) {
  constexpr double kNoise = 1e-6;  // of the limit, or of 1
  if (!row.first || !row.second || !row.first->worst || !row.second->worst) return false;
  return row.first->pass == row.second->pass && row.first->limit == row.second->limit &&
         row.first->tolerance == row.second->tolerance &&
         std::abs(*row.first->worst - *row.second->worst) <=
             kNoise * std::max(1.0, std::abs(row.first->limit));
}

std::string value_text(const std::optional<Value>& value) {
  if (!value) return "(none)";
  std::string text = value->is_text() ? value->as_text() : to_json(*value, -1);
  if (text.size() <= kLongestValue) return text;
  while ((static_cast<unsigned char>(text[kLongestValue]) & 0xc0) == 0x80) text.pop_back();
  text.resize(kLongestValue);
  return as_utf8(text) + " ...";
}

// "12.3 m/s of 10, FAIL"; angles in degrees.
std::string check_text(const Check* check) {
  if (!check) return "(none)";
  if (!check->skipped.empty()) return "skipped";
  const bool angle = check->unit.starts_with("rad");
  const auto shown = [&](double value) { return figure_text(angle ? degrees(value) : value); };
  const std::string unit = angle ? "deg" + check->unit.substr(3) : check->unit;
  std::string text = check->worst ? shown(*check->worst) + (unit.empty() ? "" : " " + unit) : "-";
  text += (check->at_least ? ", at least " : ", at most ") + shown(check->limit);
  return text + (check->pass ? "" : ", FAIL") + (check->required ? "" : " (reported only)");
}

using Rows = std::vector<std::vector<std::string>>;

// A section of rows: for the terminal a table, for the page likewise.
struct DifferenceTable {
  std::string title;
  Rows rows;         // the first holds the titles of the columns
  std::string more;  // what was left out
};

// "keyframes" of "keyframes[3].position"; empty for what is in no list.
std::string list_of(const std::string& key) {
  const std::size_t bracket = key.find('[');
  return bracket == key.npos ? "" : key.substr(0, bracket);
}

// Single values before lists; a list in which much differs is one row.
DifferenceTable table_of(const std::string& title, const std::vector<ValueDifference>& found) {
  constexpr std::size_t kFew = 4;  // differences of a list that are worth a row each
  DifferenceTable table{title, {{"key", "first", "second"}}, ""};
  Rows single, few, folded;
  std::map<std::string, std::size_t> in_list;
  for (const ValueDifference& one : found) ++in_list[list_of(one.key)];
  for (const ValueDifference& one : found) {
    const std::string list = list_of(one.key);
    if (list.empty() || in_list[list] <= kFew)
      (list.empty() ? single : few)
          .push_back({one.key, value_text(one.first), value_text(one.second)});
  }
  for (const auto& [list, count] : in_list)
    if (!list.empty() && count > kFew)
      folded.push_back({list, std::to_string(count) + " values differ", "see --json"});
  for (const Rows* rows : {&single, &few, &folded})
    table.rows.insert(table.rows.end(), rows->begin(), rows->end());
  if (table.rows.size() > kMostDifferences + 1) {
    table.more =
        "and " + std::to_string(table.rows.size() - kMostDifferences - 1) + " more: see --json";
    table.rows.resize(kMostDifferences + 1);
  }
  return table;
}

DifferenceTable table_of(const std::string& title, const std::vector<FigureRow>& figures) {
  DifferenceTable table{title, {{"figure", "first", "second", "change"}}, ""};
  for (const FigureRow& row : figures) {
    if (!std::isfinite(row.first) && !std::isfinite(row.second)) continue;
    const std::string first = figure_text(row.first), second = figure_text(row.second);
    const double change = first == second ? 0 : row.second - row.first;
    table.rows.push_back({row.name + (row.unit.empty() ? "" : " [" + row.unit + "]"), first, second,
                          change == 0 ? "same" : (change > 0 ? "+" : "") + figure_text(change)});
  }
  return table;
}

std::string nearest_text(const PlanFigures& figures) {
  return figures.nearest ? figures.nearest->check : "-";
}

std::vector<DifferenceTable> tables_of(const PlanComparison& compared) {
  std::vector<DifferenceTable> tables{table_of("Figures", figure_rows(compared))};
  Rows& figures = tables[0].rows;
  const PlanFigures &a = compared.first.figures, &b = compared.second.figures;
  figures.insert(figures.begin() + 1,
                 {"verdict", a.verdict, b.verdict, a.verdict == b.verdict ? "same" : ""});
  figures.push_back({"limit that is nearest", nearest_text(a), nearest_text(b),
                     nearest_text(a) == nearest_text(b) ? "same" : ""});
  tables.push_back(table_of("Cost of each term", term_rows(compared)));
  tables.push_back(table_of("Options", compared.options));
  tables.push_back(table_of("Task, vehicle and surroundings", compared.task));
  DifferenceTable checks{"Certificate", {{"check", "first", "second"}}, ""};
  for (const CheckRow& row : check_rows(compared)) {
    const std::string first = check_text(row.first), second = check_text(row.second);
    if (first == second || as_good_as_equal(row)) continue;
    checks.rows.push_back({(row.first ? row.first : row.second)->name, first, second});
  }
  tables.push_back(std::move(checks));
  std::erase_if(tables, [](const DifferenceTable& table) { return table.rows.size() < 2; });
  return tables;
}

std::string distance_text(const PlanComparison& compared) {
  return compared.distance > 0
             ? "at most " + figure_text(compared.distance) + " m apart at the same time, at " +
                   figure_text(compared.distance_at) + " s"
             : "both fly the same path at the same times";
}

void print_comparison(const PlanComparison& compared) {
  std::string text = "first:  " + compared.first.file.string() +
                     "\nsecond: " + compared.second.file.string() + "\n";
  if (compared.same) {
    std::cout << text << "the plans are the same" << std::endl;
    return;
  }
  text += distance_text(compared) + "\n";
  for (const DifferenceTable& table : tables_of(compared)) {
    text += "\n" + table.title + "\n" + text_of({table.rows, 1, {}}, columns_of_stdout());
    if (!table.more.empty()) text += table.more + "\n";
  }
  std::cout << text << std::flush;
}

Value json_of(const std::vector<ValueDifference>& found) {
  Value list = Value::list();
  for (const ValueDifference& one : found) {
    Value entry = Value::map();
    entry.set("key", one.key);
    if (one.first) entry.set("first", *one.first);
    if (one.second) entry.set("second", *one.second);
    list.push_back(std::move(entry));
  }
  return list;
}

Value json_of(const Check* check) {
  if (!check) return Value();
  return Certificate{{*check}}.to_value().at("checks").as_list()[0];
}

Value json_of(const PlanComparison& compared) {
  Value object = Value::map();
  object.set("same", compared.same);
  for (const auto& [name, one] :
       {std::pair("first", &compared.first), std::pair("second", &compared.second)}) {
    Value& plan = object.set(name, Value::map());
    plan.set("plan", one->file.string());
    plan.set("mission", one->plan.mission);
    plan.set("kind", one->plan.kind);
    plan.set("figures", to_value(one->figures));
  }
  object.set("options", json_of(compared.options));
  object.set("task", json_of(compared.task));
  Value& checks = object.set("checks", Value::list());
  for (const CheckRow& row : check_rows(compared)) {
    Value entry = Value::map();
    entry.set("name", (row.first ? row.first : row.second)->name);
    entry.set("first", json_of(row.first));
    entry.set("second", json_of(row.second));
    checks.push_back(std::move(entry));
  }
  Value& distance = object.set("distance", Value::map());
  distance.set("worst", compared.distance);
  distance.set("at", compared.distance_at);
  return object;
}

Report page_of(const PlanComparison& compared) {
  Report report;
  report.title = compared.first.plan.mission;
  if (compared.second.plan.mission != report.title)
    report.title += " and " + compared.second.plan.mission;
  report.subtitle = "What differs between " + compared.first.file.string() + " (first) and " +
                    compared.second.file.string() + " (second)";
  report.status = compared.same ? "the same" : "different";
  Section paths =
      paths_section({{"first", &compared.first.plan}, {"second", &compared.second.plan}},
                    compared.first.file.parent_path());
  TextBlock apart;
  apart.text = distance_text(compared);
  paths.blocks.insert(paths.blocks.begin(), apart);
  std::vector<Section> tables;
  for (const DifferenceTable& table : tables_of(compared)) {
    Table shown{"", {}, {}};
    for (const std::string& title : table.rows[0]) shown.columns.push_back({title, ""});
    for (std::size_t i = 1; i < table.rows.size(); ++i)
      shown.rows.push_back({{table.rows[i].begin(), table.rows[i].end()}, Mark::none});
    tables.push_back({table.title, {std::move(shown)}});
    if (table.more.empty()) continue;
    TextBlock more;
    more.text = table.more;
    tables.back().blocks.push_back(more);
  }
  report.sections = {tables.front(), std::move(paths)};
  report.sections.insert(report.sections.end(), tables.begin() + 1, tables.end());
  return report;
}

}  // namespace

ExitStatus diff_plans(const PlanDifference& asked, const Invocation& invocation) {
  if (!asked.page.empty()) require_output(asked.page, {asked.first, asked.second});
  const PlanComparison compared = compare_plans(asked.first, asked.second);
  for (const ComparedPlan* one : {&compared.first, &compared.second})
    if (one->plan.trajectory.samples.empty())
      throw InputError("'" + one->file.string() + "' holds no trajectory");
  if (!asked.page.empty()) write_file_atomically(asked.page, render_html(page_of(compared)));
  if (invocation.json)
    print_json(json_of(compared));
  else
    print_comparison(compared);
  return compared.same ? ExitStatus::done : ExitStatus::not_certified;
}

void add_difference(CLI::App& app, Invocation& invocation, PlanDifference& asked,
                    Command& command) {
  CLI::App* diff = app.add_subcommand("diff", "what differs between two plans");
  const auto add_one = [&](const char* name, const char* shown, std::filesystem::path& target) {
    add_text(*diff, name, shown, "a plan document, a run's folder or its report.html",
             [&](const std::string& path) { target = path; })
        ->required();
  };
  add_one("first", "PLAN.json|DIR", asked.first);
  add_one("second", "PLAN.json|DIR", asked.second);
  add_page(*diff, asked.page);
  add_json(*diff, invocation);
  diff->callback([&] { command = [&] { return diff_plans(asked, invocation); }; });
}

}  // namespace lapwing
