// SPDX-License-Identifier: Apache-2.0
#include "framework/study/exploration_figures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "framework/core/error.h"
#include "framework/core/file_set.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/number_text.h"
#include "framework/export/report.h"
#include "framework/study/csv.h"
#include "framework/study/stratified_sample.h"
#include "framework/study/study_settings.h"

namespace lapwing {

namespace fs = std::filesystem;

std::string Trial::name() const {
  return file_text(world + "_" + utility + "_" + std::to_string(episode));
}

namespace {

// An episode as its files have it.
struct Flown {
  std::vector<double> curve;      // observed after each image; it stays as it is after an early end
  std::string end;                // empty: after all images
  double length = 0;              // m
  double seconds = std::nan("");  // wall clock of a step; there or not

  double efficiency() const {
    double sum = 0;
    for (const double v : curve) sum += v;
    return sum;
  }
};

Flown flown(const Trial& trial, const fs::path& folder, int steps) {
  const fs::path path = folder / "episodes" / (trial.name() + ".json");
  Flown result;
  Trial of;
  try {
    const Value object = from_json(read_file(path), path.string());
    for (const Value& value : object.at("observed").as_list())
      result.curve.push_back(value.as_number());
    result.length = object.at("length").as_number();
    result.end = object.at("end").as_text();
    of = {object.at("world").as_text(), object.at("utility").as_text(),
          object.at("episode").as_integer()};
  } catch (const InputError& error) {
    throw InputError("'" + path.string() +
                     "' is not a complete episode: delete it, and --resume flies " + "it again (" +
                     error.what() + ")");
  }
  // "a b.obj" and "a_b.obj" have the same files.
  if (of.world != trial.world)
    throw InputError("'" + path.string() + "' is of the world '" + of.world + "', not '" +
                     trial.world + "': choose another folder with -o");
  if (of.utility != trial.utility || of.episode != trial.episode)
    throw InputError("'" + path.string() + "' is " + of.utility + "'s episode " +
                     std::to_string(of.episode) + ": delete it, and --resume flies its own");
  if (result.curve.size() >= static_cast<std::size_t>(steps)) result.end.clear();
  if (result.curve.empty()) result.curve.push_back(0);
  result.curve.resize(static_cast<std::size_t>(steps), result.curve.back());
  const fs::path time = folder / "seconds" / (trial.name() + ".json");
  if (fs::exists(time))
    result.seconds = from_json(read_file(time), time.string()).at("seconds_per_step").as_number();
  return result;
}

// What one row is made of: the episodes of a utility in a world, or in all of them.
struct Row {
  std::string world, utility;
  StratifiedSample efficiency, relative, below, against, length, seconds;  // by episode
  std::map<std::string, int> ends;  // before all images, by kind

  void add(const Row& other) {
    efficiency.join(other.efficiency);
    relative.join(other.relative);
    below.join(other.below);
    against.join(other.against);
    length.join(other.length);
    seconds.join(other.seconds);
    for (const auto& [end, times] : other.ends) ends[end] += times;
  }
  int ended_early() const {
    int count = 0;
    for (const auto& [end, times] : ends) count += times;
    return count;
  }
  // "nothing_to_gain 2", "no_way 1", with something between.
  std::string ends_with(const char* between) const {
    std::string text;
    for (const auto& [end, times] : ends)
      text += (text.empty() ? "" : between) + end + " " + std::to_string(times);
    return text;
  }
  // For people: what is unusual of the episodes.
  std::string remarks(bool oracle, bool other) const {
    const int count = ended_early();
    std::string text = std::to_string(count) + (count > 0 ? ": " + ends_with(", ") : "");
    // Where the oracle, or the other flight, saw nothing there is no ratio.
    if (oracle && relative.count() < efficiency.count())
      text += "; relative: " + std::to_string(relative.count()) + " episodes";
    if (other && against.count() < efficiency.count())
      text += "; against: " + std::to_string(against.count()) + " episodes";
    return text;
  }
};

using Episodes = std::vector<Flown>;

struct Figures {
  const ExplorationFigures& asked;
  std::vector<Row> rows;
  std::string curves = "world,utility,images,observed,observed_deviation\n";
  std::vector<Section> charts = {};

  bool evaluated(const std::string& utility) const {
    return std::find(asked.utilities.begin(), asked.utilities.end(), utility) !=
           asked.utilities.end();
  }
  Episodes read(const std::string& world, const std::string& utility, const fs::path& from) const {
    Episodes all;
    for (std::int64_t e = 1; e <= asked.episodes; ++e)
      all.push_back(flown({world, utility, e}, from, asked.steps));
    return all;
  }
  std::vector<double> efficiencies(const std::string& world, const std::string& utility) const {
    std::vector<double> found;
    if (evaluated(utility))
      for (const Flown& episode : read(world, utility, asked.folder))
        found.push_back(episode.efficiency());
    return found;
  }

  Series curve_of(const std::string& world, const std::string& utility, const Episodes& all) {
    Series series{utility, {0}, {0}, false, {0}};
    for (int t = 0; t < asked.steps; ++t) {
      StratifiedSample at;
      for (const Flown& episode : all) at.add(episode.curve[static_cast<std::size_t>(t)]);
      curves += csv_text(world) + "," + csv_text(utility) + "," + std::to_string(t + 1) + "," +
                plain_number(at.mean()) + "," +
                (at.count() > 1 ? plain_number(at.deviation()) : "") + "\n";
      series.x.push_back(t + 1);
      series.y.push_back(at.mean());
      series.spread.push_back(at.deviation());
    }
    return series;
  }

  void add_world(const std::string& world) {
    Chart chart;
    chart.title = world + ": mean and standard deviation";
    chart.x = {"images", "", false, true};
    chart.y = {"observed surface", "voxels"};
    const std::vector<double> oracle = efficiencies(world, "oracle"),
                              learned = efficiencies(world, "learned");
    for (const std::string& utility : asked.utilities) {
      const Episodes all = read(world, utility, asked.folder);
      const Episodes other =
          asked.against.empty() ? Episodes() : read(world, utility, asked.against);
      Row row{world, utility, {}, {}, {}, {}, {}, {}, {}};
      for (std::size_t e = 0; e < all.size(); ++e) {
        const double efficiency = all[e].efficiency();
        row.efficiency.add(efficiency);
        row.length.add(all[e].length);
        if (std::isfinite(all[e].seconds)) row.seconds.add(all[e].seconds);
        if (!all[e].end.empty()) ++row.ends[all[e].end];
        if (!other.empty() && other[e].efficiency() > 0)
          row.against.add(efficiency / other[e].efficiency());
        if (oracle.empty() || !(oracle[e] > 0)) continue;
        row.relative.add(efficiency / oracle[e]);
        if (!learned.empty()) row.below.add((learned[e] - efficiency) / oracle[e]);
      }
      rows.push_back(std::move(row));
      chart.series.push_back(curve_of(world, utility, all));
    }
    charts.push_back({world, {std::move(chart)}});
  }

  void add_all_worlds() {
    for (const std::string& utility : asked.utilities) {
      Row all{"all", utility, {}, {}, {}, {}, {}, {}, {}};
      for (const Row& row : rows)
        if (row.utility == utility) all.add(row);
      rows.push_back(std::move(all));
    }
  }
};

// A number that is not finite is absent: an empty cell, a null.
struct Figure {
  const char* name;
  double (*value)(const Row&);
};

constexpr Figure kFigures[] = {
    {"efficiency", [](const Row& row) { return row.efficiency.mean(); }},
    {"efficiency_deviation", [](const Row& row) { return row.efficiency.deviation(); }},
    {"relative", [](const Row& row) { return row.relative.mean(); }},
    {"relative_deviation", [](const Row& row) { return row.relative.deviation(); }},
    {"relative_interval", [](const Row& row) { return row.relative.interval(); }},
    {"below_learned", [](const Row& row) { return row.below.mean(); }},
    {"below_learned_interval", [](const Row& row) { return row.below.interval(); }},
    {"against", [](const Row& row) { return row.against.mean(); }},
    {"against_deviation", [](const Row& row) { return row.against.deviation(); }},
    {"against_interval", [](const Row& row) { return row.against.interval(); }},
    {"length", [](const Row& row) { return row.length.mean(); }}};

Value rows_value(const std::vector<Row>& rows) {
  Value list = Value::list();
  for (const Row& row : rows) {
    Value entry = Value::map();
    entry.set("world", row.world);
    entry.set("utility", row.utility);
    entry.set("episodes", static_cast<std::int64_t>(row.efficiency.count()));
    entry.set("compared", static_cast<std::int64_t>(row.relative.count()));
    entry.set("ended_early", row.ended_early());
    entry.set("ends", row.ends_with("; "));
    for (const Figure& figure : kFigures) {
      const double value = figure.value(row);
      entry.set(figure.name, std::isfinite(value) ? Value(value) : Value());
    }
    list.push_back(std::move(entry));
  }
  return list;
}

// The same as a file of cells, with the same names.
std::string table_file(const Value& rows) {
  const auto text_of = [](const Value& value) -> std::string {
    if (value.is_null()) return "";
    if (value.is_text()) return csv_text(value.as_text());
    return plain_number(value.as_number());
  };
  std::string table;
  for (const Value& row : rows.as_list()) {
    std::string names, cells;
    for (const auto& [name, value] : row.as_map()) {
      names += (names.empty() ? "" : ",") + name;
      cells += (cells.empty() ? "" : ",") + text_of(value);
    }
    if (table.empty()) table = names + "\n";
    table += cells + "\n";
  }
  return table;
}

std::string seconds_file(const std::vector<Row>& rows) {
  std::string table = "world,utility,episodes,seconds_per_step\n";  // table 5.3
  for (const Row& row : rows)
    table += csv_text(row.world) + "," + csv_text(row.utility) + "," +
             std::to_string(row.seconds.count()) + "," +
             (row.seconds.count() > 0 ? plain_number(row.seconds.mean()) : "") + "\n";
  return table;
}

// A column of the tables for people; those of the file have names of their own.
struct Column {
  const char* name;
  const char* unit;
  int digits;  // behind the point, on the shell
  double (*value)(const Row&);
};

// What the evaluated utilities allow: no ratio to an oracle that did not fly.
std::vector<Column> columns_for(bool relative, bool below, bool against) {
  std::vector<Column> columns = {
      {"efficiency", "", 0, [](const Row& row) { return row.efficiency.mean(); }},
      {"deviation", "", 0, [](const Row& row) { return row.efficiency.deviation(); }}};
  const auto add = [&](bool there, std::initializer_list<Column> more) {
    if (there) columns.insert(columns.end(), more);
  };
  add(relative, {{"relative", "", 3, [](const Row& row) { return row.relative.mean(); }},
                 {"deviation", "", 3, [](const Row& row) { return row.relative.deviation(); }},
                 {"95 % +-", "", 3, [](const Row& row) { return row.relative.interval(); }}});
  add(below, {{"below learned", "", 3, [](const Row& row) { return row.below.mean(); }},
              {"95 % +-", "", 3, [](const Row& row) { return row.below.interval(); }}});
  add(against, {{"against", "", 3, [](const Row& row) { return row.against.mean(); }},
                {"deviation", "", 3, [](const Row& row) { return row.against.deviation(); }},
                {"95 % +-", "", 3, [](const Row& row) { return row.against.interval(); }}});
  columns.push_back({"flown", "m", 0, [](const Row& row) { return row.length.mean(); }});
  return columns;
}

Table shown_table(const std::vector<Row>& rows, const std::vector<Column>& columns,
                  const ExplorationFigures& asked, bool oracle) {
  Table table;
  const bool other = !asked.against.empty();
  table.title = "Efficiency (5.6)";
  if (oracle) table.title += ", and relative to the oracle's from the same start";
  if (other) table.title += "; against: of that in '" + asked.against.string() + "'";
  table.columns = {{"world", ""}, {"utility", ""}};
  for (const Column& column : columns) table.columns.push_back({column.name, column.unit});
  table.columns.push_back({"ended early", ""});
  for (const Row& row : rows) {
    std::vector<TableCell> cells = {row.world, row.utility};
    for (const Column& column : columns) cells.emplace_back(column.value(row));
    cells.emplace_back(row.remarks(oracle, other));
    table.rows.push_back({std::move(cells)});
  }
  return table;
}

std::string in_columns(const std::vector<Row>& rows, std::vector<Column> columns,
                       const ExplorationFigures& asked, bool oracle) {
  // Wall-clock figures stand on the shell alone: no two runs agree on them.
  columns.push_back({"step", "s", 3, [](const Row& row) { return row.seconds.mean(); }});
  std::size_t world = 5, utility = 7;  // the names of these columns
  for (const Row& row : rows) {
    world = std::max(world, row.world.size());
    utility = std::max(utility, row.utility.size());
  }
  const auto fixed = [](double value, int digits) {
    char shown[400];  // of any double
    std::snprintf(shown, sizeof shown, "%.*f", digits, value);
    return std::string(shown);
  };
  const auto left = [](const std::string& text, std::size_t width) {
    return text + std::string(width - std::min(width, text.size()), ' ');
  };
  const auto right = [](const std::string& text) {
    constexpr std::size_t kWidth = 14;
    return std::string(kWidth - std::min(kWidth, text.size()), ' ') + text;
  };
  std::string text = left("world", world) + " " + left("utility", utility);
  for (const Column& column : columns)
    text += right(std::string(column.name) + (*column.unit ? ", " : "") + column.unit);
  text += "  ended early\n";
  for (const Row& row : rows) {
    text += left(row.world, world) + " " + left(row.utility, utility);
    for (const Column& column : columns) {
      const double value = column.value(row);
      text += right(std::isfinite(value) ? fixed(value, column.digits) : "-");
    }
    text += "  " + row.remarks(oracle, !asked.against.empty()) + "\n";
  }
  return text;
}

// What was asked, and what follows from it alone: no time of day, no wall clock.
Facts settings_facts(const ExplorationFigures& asked) {
  Facts facts;
  const auto add = [&](const char* label, std::string value, const char* unit = "") {
    facts.facts.push_back({label, std::move(value), unit});
  };
  const Value& settings = asked.settings;
  const auto number_of = [&](const char* key) { return settings.at(key).as_number(); };
  add("starts by seed", std::to_string(settings.at("seed").as_integer()));
  if (number_of("sigma") > 0 || number_of("dropped") > 0) {
    add("noise of the depth", plain_number(number_of("sigma")), "m");
    if (number_of("smooth_to") > 0)
      add("smoothed towards", plain_number(number_of("smooth_to")), "m");
    add("pixels dropped", plain_number(100 * number_of("dropped")), "%");
  }
  if (number_of("stereo") > 0) add("stereo, apart", plain_number(number_of("stereo")), "m");
  if (settings.at("lookahead").as_integer() > 1)
    add("looking ahead", std::to_string(settings.at("lookahead").as_integer()), "views");
  for (const char* key : {"moves", "mapping", "parameters"}) {
    const std::string text = settings_text(settings.at(key));
    if (!text.empty()) add(key, text);
  }
  if (const Value* own = settings.find("world_moves"))
    for (const auto& [world, moves] : own->as_map())
      add(("moves in " + world).c_str(), settings_text(moves));
  return facts;
}

}  // namespace

ExplorationTables write_exploration_figures(const ExplorationFigures& asked) {
  Figures figures{asked, {}};
  for (const std::string& world : asked.worlds) figures.add_world(world);
  if (asked.worlds.size() > 1) figures.add_all_worlds();
  const bool oracle = figures.evaluated("oracle");
  const std::vector<Column> columns =
      columns_for(oracle, oracle && figures.evaluated("learned"), !asked.against.empty());
  Report report;
  report.title = "Exploration";
  report.subtitle = std::to_string(asked.episodes) + " episodes of " + std::to_string(asked.steps) +
                    " images in each world";
  report.sections.push_back(
      {"Table", {shown_table(figures.rows, columns, asked, oracle), settings_facts(asked)}});
  for (Section& section : figures.charts) report.sections.push_back(std::move(section));
  Value rows = rows_value(figures.rows);
  write_files_together(asked.folder, {{{"table.csv", table_file(rows)},
                                       {"seconds.csv", seconds_file(figures.rows)},
                                       {"curves.csv", figures.curves},
                                       {"report.html", render_html(report)}}});
  return {in_columns(figures.rows, columns, asked, oracle), std::move(rows)};
}

}  // namespace lapwing
