// SPDX-License-Identifier: Apache-2.0
#include "framework/study/scan_tables.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/study/csv.h"
#include "framework/study/stratified_sample.h"

namespace lapwing {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

MeanOf mean_of(const std::vector<double>& values) {
  if (values.empty()) return {kNone, kNone};
  StratifiedSample sample;
  for (const double value : values) sample.add(value);
  if (values.size() < 2) return {sample.mean(), 0};
  return {sample.mean(), sample.deviation() / std::sqrt(static_cast<double>(values.size()))};
}

template <class Get>
MeanOf mean_over(const std::vector<const ScanRow*>& rows, const Get& get) {
  std::vector<double> values;
  for (const ScanRow* row : rows) values.push_back(get(*row));
  return mean_of(values);
}

ScanSummary summary_of(const std::vector<const ScanRow*>& all) {
  ScanSummary s;
  s.mission = all.front()->mission;
  s.method = all.front()->method;
  s.budget = all.front()->budget;
  s.rows = static_cast<int>(all.size());
  s.surface_share = all.front()->surface_share;
  std::vector<const ScanRow*> rows;
  for (const ScanRow* row : all) {
    if (!row->reproducible) s.reproducible = false;
    if (row->found && row->counts) rows.push_back(row);
  }
  s.counted = static_cast<int>(rows.size());
  const auto over = [&](auto get) { return mean_over(rows, get); };
  s.precision = over([](const ScanRow& r) { return 100 * r.with_first.precision; });
  s.recall = over([](const ScanRow& r) { return 100 * r.with_first.recall; });
  s.f = over([](const ScanRow& r) { return 100 * r.with_first.f; });
  s.precision_alone = over([](const ScanRow& r) { return 100 * r.alone.precision; });
  s.recall_alone = over([](const ScanRow& r) { return 100 * r.alone.recall; });
  s.f_alone = over([](const ScanRow& r) { return 100 * r.alone.f; });
  s.score = over([](const ScanRow& r) { return r.score; });
  s.score_share = over([](const ScanRow& r) { return 100 * r.score_share; });
  s.seconds = over([](const ScanRow& r) { return r.seconds; });
  s.images = over([](const ScanRow& r) { return r.images; });
  std::vector<double> gaps;
  for (const ScanRow* row : rows) {
    if (row->upper_bound && *row->upper_bound > 0) {
      gaps.push_back(100 * (*row->upper_bound - row->score) / *row->upper_bound);
    }
  }
  s.gap = mean_of(gaps);
  return s;
}

// printf's format for one number.
std::string text_of(const char* format, double number) {
  if (!std::isfinite(number)) return "-";
  char text[48];
  std::snprintf(text, sizeof text, format, number);
  return text;
}

std::string with_error(const MeanOf& mean, int rows) {
  std::string text = text_of("%.2f", mean.mean);
  if (rows > 1 && std::isfinite(mean.mean)) text += " +- " + text_of("%.2f", mean.error);
  return text;
}

std::string padded(const std::string& text, std::size_t width, bool left = false) {
  const std::string space(width - std::min(width, text.size()), ' ');
  return left ? text + space : space + text;
}

bool same_table(const ScanSummary& a, const ScanSummary& b) {
  return a.mission == b.mission && a.budget == b.budget;
}

std::string title_of(const ScanSummary& s) {
  return s.mission + ", a budget of " + text_of("%g", s.budget) + " s";
}

// What recall is measured against.
std::string share_in_words(const ScanSummary& s) {
  if (s.surface_share == 1) return "";
  return "; recall of the " + text_of("%.1f", 100 * s.surface_share) +
         " % of the surface that can be seen from a free place";
}

std::string remark_of(const ScanSummary& s) {
  std::string remark;
  if (s.counted < s.rows) {
    remark = std::to_string(s.counted) + " of " + std::to_string(s.rows) + " count";
  }
  if (!s.reproducible) remark += std::string(remark.empty() ? "" : "; ") + "ended by the clock";
  return remark;
}

// Tables: from one summary to the first of the next table.
template <class Use>
void for_each_table(const std::vector<ScanSummary>& summaries, const Use& use) {
  for (std::size_t first = 0; first < summaries.size();) {
    std::size_t end = first + 1;
    while (end < summaries.size() && same_table(summaries[first], summaries[end])) ++end;
    use(first, end);
    first = end;
  }
}

}  // namespace

std::vector<ScanSummary> summarise(const std::vector<ScanRow>& rows) {
  std::vector<ScanSummary> summaries;
  std::vector<const ScanRow*> together;
  for (const ScanRow& row : rows) {
    const bool same = !together.empty() && together.back()->mission == row.mission &&
                      together.back()->budget == row.budget &&
                      together.back()->method == row.method;
    if (!same && !together.empty()) {
      summaries.push_back(summary_of(together));
      together.clear();
    }
    together.push_back(&row);
  }
  if (!together.empty()) summaries.push_back(summary_of(together));
  return summaries;
}

std::string tables_text(const std::vector<ScanSummary>& summaries) {
  std::string out;
  for_each_table(summaries, [&](std::size_t first, std::size_t end) {
    std::size_t width = 6;
    for (std::size_t i = first; i < end; ++i) width = std::max(width, summaries[i].method.size());
    const int seeds = summaries[first].rows;
    out += (out.empty() ? "" : "\n") + title_of(summaries[first]) + ", " + std::to_string(seeds) +
           (seeds > 1 ? " seeds: means +- standard errors, in percent" : " seed, in percent") +
           share_in_words(summaries[first]) + "\n";
    constexpr std::size_t kWide = 15;
    out += padded("", width) + padded("with the first flight's images", 3 * kWide) +
           padded("without", 3 * kWide) + "\n" + padded("method", width, true);
    for (const char* name : {"precision", "recall", "F", "precision", "recall", "F", "score"}) {
      out += padded(name, kWide);
    }
    out += padded("gap", 8) + padded("images", 8) + padded("flight s", 10) + "\n";
    for (std::size_t i = first; i < end; ++i) {
      const ScanSummary& s = summaries[i];
      out += padded(s.method, width, true);
      for (const MeanOf* mean : {&s.precision, &s.recall, &s.f, &s.precision_alone, &s.recall_alone,
                                 &s.f_alone, &s.score_share}) {
        out += padded(with_error(*mean, s.counted), kWide);
      }
      out += padded(text_of("%.1f", s.gap.mean), 8) + padded(text_of("%.0f", s.images.mean), 8) +
             padded(text_of("%.0f", s.seconds.mean), 10);
      const std::string remark = remark_of(s);
      out += remark.empty() ? "\n" : "  " + remark + "\n";
    }
  });
  return out;
}

std::string tables_csv(const std::vector<ScanSummary>& summaries) {
  std::string out = "mission,budget [s],method,rows,counted,reproducible,surface that counts [%]";
  for (const char* name : {"precision", "recall", "F", "precision alone", "recall alone", "F alone",
                           "score", "score share", "gap", "images", "seconds"}) {
    const std::string column = name;
    const bool percent = column != "score" && column != "images" && column != "seconds";
    out += "," + column + (percent ? " [%]" : "") + "," + column + " error";
  }
  out += "\n";
  for (const ScanSummary& s : summaries) {
    out += csv_text(s.mission) + "," + csv_number(s.budget) + "," + csv_text(s.method) + "," +
           std::to_string(s.rows) + "," + std::to_string(s.counted) + "," +
           (s.reproducible ? "true" : "false") + "," + csv_number(100 * s.surface_share);
    for (const MeanOf* mean :
         {&s.precision, &s.recall, &s.f, &s.precision_alone, &s.recall_alone, &s.f_alone, &s.score,
          &s.score_share, &s.gap, &s.images, &s.seconds}) {
      out += "," + csv_number(mean->mean) + "," + csv_number(mean->error);
    }
    out += "\n";
  }
  return out;
}

std::string rows_csv(const std::vector<ScanRow>& rows) {
  std::string out =
      "mission,budget [s],method,seed,status,found,counts,reproducible,score,score share,upper "
      "bound,flight [s],images,first images,candidates,evaluations,precision,recall,F,points,"
      "precision alone,recall alone,F alone,points alone,surface points,surface share,message\n";
  const auto flag = [](bool value) { return value ? "true" : "false"; };
  for (const ScanRow& r : rows) {
    out += csv_text(r.mission) + "," + csv_number(r.budget) + "," + csv_text(r.method) + "," +
           std::to_string(r.seed) + "," + r.status + "," + flag(r.found) + "," + flag(r.counts) +
           "," + flag(r.reproducible) + "," + csv_number(r.score) + "," +
           csv_number(r.score_share) + "," + csv_number(r.upper_bound.value_or(kNone)) + "," +
           csv_number(r.seconds) + "," + std::to_string(r.images) + "," +
           std::to_string(r.first_images) + "," + std::to_string(r.candidates) + "," +
           std::to_string(r.evaluations);
    for (const ReconstructionScore* score : {&r.with_first, &r.alone}) {
      out += "," + csv_number(score->precision) + "," + csv_number(score->recall) + "," +
             csv_number(score->f) + "," + std::to_string(score->points);
    }
    out += "," + std::to_string(r.alone.surface_points) + "," + csv_number(r.surface_share) + "," +
           csv_text(r.message) + "\n";
  }
  return out;
}

namespace {

Table table_of(const std::vector<ScanSummary>& summaries, std::size_t first, std::size_t end) {
  Table table;
  table.title = title_of(summaries[first]) + ", " + std::to_string(summaries[first].rows) +
                (summaries[first].rows > 1 ? " seeds: means and standard errors" : " seed") +
                share_in_words(summaries[first]);
  table.columns = {{"method", ""},   {"precision", "%"},       {"recall", "%"},
                   {"F", "%"},       {"precision alone", "%"}, {"recall alone", "%"},
                   {"F alone", "%"}, {"score", "%"},           {"gap", "%"},
                   {"images", ""},   {"flight", "s"},          {"remark", ""}};
  for (std::size_t i = first; i < end; ++i) {
    const ScanSummary& s = summaries[i];
    TableRow row;
    row.cells.push_back(s.method);
    for (const MeanOf* mean : {&s.precision, &s.recall, &s.f, &s.precision_alone, &s.recall_alone,
                               &s.f_alone, &s.score_share}) {
      row.cells.push_back(with_error(*mean, s.counted));
    }
    row.cells.push_back(text_of("%.1f", s.gap.mean));
    row.cells.push_back(text_of("%.0f", s.images.mean));
    row.cells.push_back(text_of("%.0f", s.seconds.mean));
    row.cells.push_back(remark_of(s));
    table.rows.push_back(std::move(row));
  }
  return table;
}

// One curve for each method over the budgets of a mission, where there are several.
template <class Get>
void add_curves(const std::vector<ScanSummary>& summaries, const std::string& mission,
                const std::string& title, const std::string& label, const Get& get,
                Section& section) {
  std::map<std::string, std::map<double, double>> curves;
  std::vector<std::string> order;
  for (const ScanSummary& s : summaries) {
    if (s.mission != mission) continue;
    if (!curves.count(s.method)) order.push_back(s.method);
    curves[s.method][s.budget] = get(s);
  }
  Chart chart;
  chart.title = title;
  chart.x = {"budget", "s"};
  chart.y = {label, "%"};
  for (const std::string& method : order) {
    if (curves[method].size() < 2) return;
    Series series;
    series.name = method;
    for (const auto& [budget, value] : curves[method]) {
      series.x.push_back(budget);
      series.y.push_back(value);
    }
    chart.series.push_back(std::move(series));
  }
  section.blocks.push_back(std::move(chart));
}

}  // namespace

Report study_report(const std::vector<ScanSummary>& summaries, const std::vector<ScanRow>& rows) {
  Report report;
  report.title = "Comparison of scan tours";
  report.subtitle = std::to_string(rows.size()) + " tours";
  std::vector<std::string> missions;
  for (const ScanSummary& s : summaries) {
    if (missions.empty() || missions.back() != s.mission) missions.push_back(s.mission);
  }
  for (const std::string& mission : missions) {
    Section section;
    section.title = mission;
    for_each_table(summaries, [&](std::size_t first, std::size_t end) {
      if (summaries[first].mission == mission) {
        section.blocks.push_back(table_of(summaries, first, end));
      }
    });
    add_curves(
        summaries, mission, "What a budget brings: score", "of all that candidates show",
        [](const ScanSummary& s) { return s.score_share.mean; }, section);
    add_curves(
        summaries, mission, "Model by budget", "F", [](const ScanSummary& s) { return s.f.mean; },
        section);
    report.sections.push_back(std::move(section));
  }
  TextBlock words;
  words.text =
      "Every method has the same budget and one thread; all but the patterns at a safe height have "
      "the same candidates and motions. Precision, recall and "
      "F: points that at least three images agree on, within 0.1 m of the true surface, with the "
      "images of the first flight, and without them; patterns at a safe height (circle, ellipse, "
      "meander) "
      "need no first flight: they are flown straight from view to view, and evaluated without it. "
      "Score: of what all candidates together show. "
      "Gap: to the upper bound of any tour. A row of milp counts if its tour is at least as good "
      "as "
      "greedy's for the sum of rewards that it maximises.";
  report.sections.push_back({"Measured quantities", {words}});
  TextBlock all;
  all.text = rows_csv(rows);
  all.preformatted = true;
  all.folded_title = "All rows";
  report.sections.push_back({"Rows", {all}});
  return report;
}

std::string times_text(const std::filesystem::path& folder) {
  struct Times {
    double first = 0, flight = 0, prepare = 0, plan = 0;
    int rows = 0;
  };
  std::map<std::pair<std::string, std::string>, Times> all;
  std::vector<std::filesystem::path> files;
  for (const auto& item : std::filesystem::directory_iterator(folder)) {
    if (item.path().extension() == ".json") files.push_back(item.path());
  }
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    const Value value = from_json(read_file(file), file.string());
    Times& times = all[{value.at("mission").as_text(), value.at("method").as_text()}];
    times.first += value.at("first_flight").as_number();
    times.flight += value.at("flight").as_number();
    times.prepare += value.at("prepare").as_number();
    times.plan += value.at("plan").as_number();
    ++times.rows;
  }
  std::string out =
      "seconds: flights of the first scan and of the tour; computing candidates and motions, and "
      "the tour; all of it\n";
  std::size_t width = 8;
  for (const auto& [key, times] : all) {
    width = std::max(width, key.first.size() + key.second.size() + 2);
  }
  out += padded("", width);
  for (const char* name : {"first", "flight", "prepare", "plan", "total"}) out += padded(name, 10);
  out += "\n";
  for (const auto& [key, times] : all) {
    // A pattern at a safe height is flown at once.
    const std::string kind = key.second.substr(0, key.second.find('_'));
    const bool one_shot = kind == "circle" || kind == "ellipse" || kind == "meander";
    const double first = one_shot ? 0 : times.first, prepare = one_shot ? 0 : times.prepare;
    out += padded(key.first + ", " + key.second, width, true);
    for (const double sum :
         {first, times.flight, prepare, times.plan, first + times.flight + prepare + times.plan}) {
      out += padded(text_of("%.1f", sum / times.rows), 10);
    }
    out += "\n";
  }
  return out;
}

std::string photos_text(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& item : std::filesystem::directory_iterator(folder)) {
    if (std::filesystem::exists(item.path() / "registered.json")) {
      files.push_back(item.path() / "registered.json");
    }
  }
  std::sort(files.begin(), files.end());
  std::string out = "photographs that COLMAP registers into its largest model, and its models\n";
  for (const auto& file : files) {
    const Value value = from_json(read_file(file), file.string());
    out += value.at("mission").as_text() + ", seed " +
           std::to_string(value.at("seed").as_integer()) + ", " +
           text_of("%g", value.at("budget").as_number()) + " s, " + value.at("method").as_text() +
           ": " + std::to_string(value.at("largest").as_integer()) + " of " +
           std::to_string(value.at("images").as_integer()) + ", " +
           std::to_string(value.at("models").as_integer()) + " models\n";
  }
  return out;
}

}  // namespace lapwing
