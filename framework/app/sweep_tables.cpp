// SPDX-License-Identifier: Apache-2.0
#include "framework/app/sweep_tables.h"

#include <algorithm>
#include <cmath>

#include "framework/app/terminal.h"
#include "framework/app/text_table.h"
#include "framework/core/number_text.h"
#include "framework/core/visible_text.h"
#include "framework/export/flight_charts.h"
#include "framework/study/csv.h"

namespace lapwing {

namespace {

constexpr std::size_t kMostPaths = 60;  // in one picture

struct SweepFigure {
  const char* title;  // of a terminal's and a page's column
  const char* name;   // of a CSV column
  double (*value)(const SweepRun&);
};

double solve_seconds(const SweepRun& run) {
  const Value* seconds = run.answer.find("seconds");
  const Value* solve = seconds ? seconds->find("solve") : nullptr;
  return solve && solve->is_number() ? solve->as_number() : PlanFigures::kNone;
}

double if_planned(const SweepRun& run, double figure) {
  return run.plan ? figure : PlanFigures::kNone;
}

const std::vector<SweepFigure>& sweep_figures() {
  static const std::vector<SweepFigure> all{
      {"cost", "cost", [](const SweepRun& r) { return r.figures.cost; }},
      {"flight [s]", "duration_s",
       [](const SweepRun& r) { return if_planned(r, r.figures.duration); }},
      {"path [m]", "path_length_m",
       [](const SweepRun& r) { return if_planned(r, r.figures.path_length); }},
      {"clearance [m]", "clearance_m", [](const SweepRun& r) { return r.figures.clearance; }},
      {"solve [s]", "solve_seconds", &solve_seconds},
  };
  return all;
}

std::string shown_figure(double value) {
  return std::isfinite(value) ? plain_number(value, 4) : "-";
}

std::string nearest_of(const SweepRun& run) {
  if (!run.figures.nearest) return "-";
  return run.figures.nearest->check + " " + plain_number(100 * run.figures.nearest->share, 3) +
         " %";
}

std::string in_words(const std::string& status) {
  return status == "ok" ? "certified" : status == "not_certified" ? "not certified" : status;
}

// Of all runs, in the order in which they come up.
std::vector<std::string> terms_of(const std::vector<SweepRun>& runs) {
  std::vector<std::string> names;
  for (const SweepRun& run : runs)
    for (const auto& [name, cost] : run.figures.terms)
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  return names;
}

double term_cost(const SweepRun& run, const std::string& name) {
  for (const auto& [term, cost] : run.figures.terms)
    if (term == name) return cost;
  return PlanFigures::kNone;
}

using Rows = std::vector<std::vector<std::string>>;

Rows rows_of_runs(const std::vector<VariedKey>& keys, const std::vector<SweepRun>& runs) {
  Rows rows{{"run"}};
  for (const VariedKey& key : keys) rows[0].push_back(key.name);
  rows[0].push_back("status");
  for (const SweepFigure& figure : sweep_figures()) rows[0].push_back(figure.title);
  rows[0].push_back("nearest limit");
  for (const SweepRun& run : runs) {
    std::vector<std::string> row{run.name};
    row.insert(row.end(), run.values.begin(), run.values.end());
    row.push_back(in_words(run.status()));
    for (const SweepFigure& figure : sweep_figures())
      row.push_back(shown_figure(figure.value(run)));
    row.push_back(nearest_of(run));
    rows.push_back(std::move(row));
  }
  return rows;
}

Rows rows_of_terms(const std::vector<SweepRun>& runs) {
  const std::vector<std::string> terms = terms_of(runs);
  Rows rows{{"run"}};
  rows[0].insert(rows[0].end(), terms.begin(), terms.end());
  for (const SweepRun& run : runs) {
    if (run.figures.terms.empty()) continue;
    std::vector<std::string> row{run.name};
    for (const std::string& term : terms) row.push_back(shown_figure(term_cost(run, term)));
    rows.push_back(std::move(row));
  }
  return rows;
}

std::string reasons_as_text(const SweepRun& run) {
  std::string text;
  for (const std::string& reason : run.reasons()) text += "\n  " + visible_text(reason);
  return text;
}

Mark mark_of(const SweepRun& run) {
  if (!run.exit) return Mark::skipped;
  return *run.exit == 0 ? Mark::pass : Mark::fail;
}

Table page_table(const Rows& rows) {
  Table table;
  for (const std::string& title : rows[0]) table.columns.push_back({title, ""});
  for (std::size_t i = 1; i < rows.size(); ++i)
    table.rows.push_back({{rows[i].begin(), rows[i].end()}, Mark::none});
  return table;
}

std::string with_values(const SweepRun& run, const std::vector<VariedKey>& keys) {
  std::string text = run.name + ":";
  for (std::size_t k = 0; k < keys.size(); ++k)
    text += (k > 0 ? ", " : " ") + keys[k].name + "=" + run.values[k];
  return text;
}

Section paths_of_runs(const std::vector<VariedKey>& keys, const std::vector<SweepRun>& runs) {
  std::vector<std::pair<std::string, const Plan*>> plans;
  std::filesystem::path folder;
  std::size_t left_out = 0;
  for (const SweepRun& run : runs) {
    if (!run.plan || run.plan->trajectory.samples.empty()) continue;
    if (plans.empty()) folder = run.folder;
    if (plans.size() < kMostPaths)
      plans.emplace_back(with_values(run, keys), &*run.plan);
    else
      ++left_out;
  }
  Section section = paths_section(plans, folder);
  if (left_out == 0) return section;
  TextBlock note;
  note.text = "The paths of the first " + std::to_string(kMostPaths) + " runs; those of " +
              std::to_string(left_out) + " more are in their folders.";
  section.blocks.insert(section.blocks.begin(), note);
  return section;
}

}  // namespace

std::string sweep_text(const std::vector<VariedKey>& keys, const std::vector<SweepRun>& runs,
                       std::size_t width) {
  TextTable table{rows_of_runs(keys, runs), 1 + keys.size(), {}};
  table.paint = [&](std::size_t row, std::size_t column, const std::string& cell) {
    if (row == 0 || column != 1 + keys.size() || !runs[row - 1].exit) return cell;
    return tinted(*runs[row - 1].exit == 0 ? Tone::good : Tone::bad, cell);
  };
  std::string text = text_of(table, width);
  const Rows terms = rows_of_terms(runs);
  if (terms.size() > 1) text += "\nCost of each term\n" + text_of({terms, 1, {}}, width);
  for (const SweepRun& run : runs)
    if (const std::string reasons = reasons_as_text(run); !reasons.empty())
      text += "\n" + run.name + ": " + tinted(Tone::bad, in_words(run.status())) + reasons + "\n";
  return text;
}

std::string sweep_csv(const std::vector<VariedKey>& keys, const std::vector<SweepRun>& runs) {
  const std::vector<std::string> terms = terms_of(runs);
  std::vector<std::string> titles{"run"};
  for (const VariedKey& key : keys) titles.push_back(key.name);
  titles.insert(titles.end(), {"status", "exit"});
  for (const SweepFigure& figure : sweep_figures()) titles.push_back(figure.name);
  titles.insert(titles.end(), {"nearest_limit", "nearest_limit_share"});
  for (const std::string& term : terms) titles.push_back("cost." + term);
  titles.push_back("reasons");
  std::string text = csv_line(titles);
  for (const SweepRun& run : runs) {
    std::vector<std::string> row{run.name};
    row.insert(row.end(), run.values.begin(), run.values.end());
    row.push_back(run.status());
    row.push_back(run.exit ? std::to_string(*run.exit) : "");
    for (const SweepFigure& figure : sweep_figures()) row.push_back(csv_number(figure.value(run)));
    row.push_back(run.figures.nearest ? run.figures.nearest->check : "");
    row.push_back(run.figures.nearest ? csv_number(run.figures.nearest->share) : "");
    for (const std::string& term : terms) row.push_back(csv_number(term_cost(run, term)));
    std::string reasons;
    for (const std::string& reason : run.reasons())
      reasons += (reasons.empty() ? "" : "; ") + visible_line(reason);
    row.push_back(reasons);
    text += csv_line(row);
  }
  return text;
}

Value sweep_value(const std::vector<VariedKey>& keys, const std::vector<SweepRun>& runs) {
  Value object = Value::map();
  Value& list = object.set("runs", Value::list());
  for (const SweepRun& run : runs) {
    Value entry = Value::map();
    Value& values = entry.set("values", Value::map());
    for (std::size_t k = 0; k < keys.size(); ++k) values.set(keys[k].name, run.values[k]);
    entry.set("folder", run.folder.string());
    entry.set("exit", run.exit ? Value(*run.exit) : Value());
    entry.set("status", run.status());
    entry.set("figures", run.plan ? to_value(run.figures) : Value());
    Value& reasons = entry.set("reasons", Value::list());
    for (const std::string& reason : run.reasons()) reasons.push_back(reason);
    entry.set("answer", run.answer);
    list.push_back(std::move(entry));
  }
  return object;
}

std::string sweep_page(const std::string& script, const std::vector<VariedKey>& keys,
                       const std::vector<SweepRun>& runs) {
  Report report;
  report.title = "Sweep of " + script;
  const auto passed =
      std::count_if(runs.begin(), runs.end(), [](const SweepRun& run) { return run.exit == 0; });
  report.status = std::to_string(passed) + " of " + std::to_string(runs.size()) + " certified";
  report.status_mark = static_cast<std::size_t>(passed) == runs.size() ? Mark::pass : Mark::fail;
  Table table = page_table(rows_of_runs(keys, runs));
  for (std::size_t i = 0; i < runs.size(); ++i) table.rows[i].mark = mark_of(runs[i]);
  report.sections.push_back({"Runs", {std::move(table)}});
  if (Section paths = paths_of_runs(keys, runs); !paths.blocks.empty())
    report.sections.push_back(std::move(paths));
  if (const Rows terms = rows_of_terms(runs); terms.size() > 1)
    report.sections.push_back({"Cost of each term", {page_table(terms)}});
  Rows failures{{"run", "why"}};
  for (const SweepRun& run : runs)
    for (const std::string& reason : run.reasons()) failures.push_back({run.name, reason});
  if (failures.size() > 1)
    report.sections.push_back({"Why runs are not certified", {page_table(failures)}});
  return render_html(report);
}

}  // namespace lapwing
