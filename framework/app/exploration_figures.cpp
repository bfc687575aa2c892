#include "framework/app/exploration_figures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "framework/app/exploration_worlds.h"
#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/number_text.h"
#include "framework/export/report.h"

namespace lapwing {

namespace fs = std::filesystem;

std::string Trial::name() const {
  return file_text(world + "_" + utility + "_" + std::to_string(episode));
}

namespace {

// Student's t of 97.5 %: of 1 degree of freedom, of 2, ...
constexpr double kStudent[] = {12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306,
                               2.262,  2.228, 2.201, 2.179, 2.160, 2.145, 2.131, 2.120,
                               2.110,  2.101, 2.093, 2.086, 2.080, 2.074, 2.069, 2.064,
                               2.060,  2.056, 2.052, 2.048, 2.045, 2.042};

// Mean and sample standard deviation; not a number where there are too few values.
struct Mean {
  explicit Mean(const std::vector<double>& values) : count(values.size()) {
    if (values.empty()) return;
    mean = 0;
    for (const double v : values) mean += v / static_cast<double>(count);
    double squares = 0;
    for (const double v : values) squares += (v - mean) * (v - mean);
    deviation = count > 1 ? std::sqrt(squares / static_cast<double>(count - 1)) : 0;
  }
  // Half the width of the 95 % interval of the mean; beyond 31 values by the normal distribution.
  double interval() const {
    if (count < 2) return std::nan("");
    const double t = count - 2 < std::size(kStudent) ? kStudent[count - 2] : 1.96;
    return t * deviation / std::sqrt(static_cast<double>(count));
  }
  std::size_t count = 0;
  double mean = std::nan(""), deviation = std::nan("");
};

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
  std::string world;
  try {
    const Value object = from_json(read_file(path), path.string());
    for (const Value& value : object.at("observed").as_list())
      result.curve.push_back(value.as_number());
    result.length = object.at("length").as_number();
    result.end = object.at("end").as_text();
    world = object.at("world").as_text();
  } catch (const InputError& error) {
    throw InputError("'" + path.string() + "' is no whole episode: delete it, and --resume flies " +
                     "it again (" + error.what() + ")");
  }
  // "a b.obj" and "a_b.obj" have the same files.
  if (world != trial.world)
    throw InputError("'" + path.string() + "' is of the world '" + world + "', not '" +
                     trial.world + "': choose another folder with -o");
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
  std::vector<double> efficiency, relative, below, against, length, seconds;  // by episode
  std::map<std::string, int> ends;  // before all images, by kind

  void add(const Row& other) {
    const auto join = [](std::vector<double>& all, const std::vector<double>& more) {
      all.insert(all.end(), more.begin(), more.end());
    };
    join(efficiency, other.efficiency);
    join(relative, other.relative);
    join(below, other.below);
    join(against, other.against);
    join(length, other.length);
    join(seconds, other.seconds);
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
    if (oracle && relative.size() < efficiency.size())
      text += "; relative: " + std::to_string(relative.size()) + " episodes";
    if (other && against.size() < efficiency.size())
      text += "; against: " + std::to_string(against.size()) + " episodes";
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
    Series series{utility, {0}, {0}};
    for (int t = 0; t < asked.steps; ++t) {
      std::vector<double> at;
      for (const Flown& episode : all) at.push_back(episode.curve[static_cast<std::size_t>(t)]);
      const Mean mean(at);
      curves += world + "," + utility + "," + std::to_string(t + 1) + "," +
                plain_number(mean.mean) + "," + plain_number(mean.deviation) + "\n";
      series.x.push_back(t + 1);
      series.y.push_back(mean.mean);
    }
    return series;
  }

  void add_world(const std::string& world) {
    Chart chart;
    chart.title = world;
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
        row.efficiency.push_back(efficiency);
        row.length.push_back(all[e].length);
        if (std::isfinite(all[e].seconds)) row.seconds.push_back(all[e].seconds);
        if (!all[e].end.empty()) ++row.ends[all[e].end];
        if (!other.empty() && other[e].efficiency() > 0)
          row.against.push_back(efficiency / other[e].efficiency());
        if (oracle.empty() || !(oracle[e] > 0)) continue;
        row.relative.push_back(efficiency / oracle[e]);
        if (!learned.empty()) row.below.push_back((learned[e] - efficiency) / oracle[e]);
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

// Empty for what there is not.
std::string number(double value) {
  return std::isfinite(value) ? plain_number(value) : "";
}

std::string table_file(const std::vector<Row>& rows) {
  std::string table =
      "world,utility,episodes,efficiency,efficiency_deviation,relative,relative_deviation,"
      "relative_interval,below_learned,below_learned_interval,length,ended_early,ends,against,"
      "against_deviation,against_interval,compared\n";
  for (const Row& row : rows) {
    const Mean efficiency(row.efficiency), relative(row.relative), below(row.below),
        against(row.against);
    table += row.world + "," + row.utility + "," + std::to_string(row.efficiency.size());
    for (const double value :
         {efficiency.mean, efficiency.deviation, relative.mean, relative.deviation,
          relative.interval(), below.mean, below.interval(), Mean(row.length).mean})
      table += "," + number(value);
    table += "," + std::to_string(row.ended_early()) + "," + row.ends_with("; ");
    for (const double value : {against.mean, against.deviation, against.interval()})
      table += "," + number(value);
    table += "," + std::to_string(row.relative.size()) + "\n";
  }
  return table;
}

std::string seconds_file(const std::vector<Row>& rows) {
  std::string table = "world,utility,episodes,seconds_per_step\n";  // table 5.3
  for (const Row& row : rows)
    table += row.world + "," + row.utility + "," + std::to_string(row.seconds.size()) + "," +
             number(Mean(row.seconds).mean) + "\n";
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
      {"efficiency", "", 0, [](const Row& row) { return Mean(row.efficiency).mean; }},
      {"deviation", "", 0, [](const Row& row) { return Mean(row.efficiency).deviation; }}};
  const auto add = [&](bool there, std::initializer_list<Column> more) {
    if (there) columns.insert(columns.end(), more);
  };
  add(relative, {{"relative", "", 3, [](const Row& row) { return Mean(row.relative).mean; }},
                 {"deviation", "", 3, [](const Row& row) { return Mean(row.relative).deviation; }},
                 {"95 % +-", "", 3, [](const Row& row) { return Mean(row.relative).interval(); }}});
  add(below, {{"below learned", "", 3, [](const Row& row) { return Mean(row.below).mean; }},
              {"95 % +-", "", 3, [](const Row& row) { return Mean(row.below).interval(); }}});
  add(against, {{"against", "", 3, [](const Row& row) { return Mean(row.against).mean; }},
                {"deviation", "", 3, [](const Row& row) { return Mean(row.against).deviation; }},
                {"95 % +-", "", 3, [](const Row& row) { return Mean(row.against).interval(); }}});
  columns.push_back({"flown", "m", 0, [](const Row& row) { return Mean(row.length).mean; }});
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
  columns.push_back({"step", "s", 3, [](const Row& row) { return Mean(row.seconds).mean; }});
  std::string text;
  char part[200];
  const auto add = [&](const char* format, auto... values) {
    std::snprintf(part, sizeof part, format, values...);
    text += part;
  };
  add("%-22s %-18s", "world", "utility");
  for (const Column& column : columns)
    add(" %13s", (std::string(column.name) + (*column.unit ? ", " : "") + column.unit).c_str());
  text += "  ended early\n";
  for (const Row& row : rows) {
    add("%-22s %-18s", row.world.c_str(), row.utility.c_str());
    for (const Column& column : columns) {
      const double value = column.value(row);
      if (std::isfinite(value))
        add(" %13.*f", column.digits, value);
      else
        add(" %13s", "-");
    }
    text += "  " + row.remarks(oracle, !asked.against.empty()) + "\n";
  }
  return text;
}

}  // namespace

std::string write_exploration_figures(const ExplorationFigures& asked) {
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
  report.sections.push_back({"Table", {shown_table(figures.rows, columns, asked, oracle)}});
  for (Section& section : figures.charts) report.sections.push_back(std::move(section));
  write_file_atomically(asked.folder / "table.csv", table_file(figures.rows));
  write_file_atomically(asked.folder / "seconds.csv", seconds_file(figures.rows));
  write_file_atomically(asked.folder / "curves.csv", figures.curves);
  write_file_atomically(asked.folder / "report.html", render_html(report));
  return in_columns(figures.rows, columns, asked, oracle);
}

}  // namespace lapwing
