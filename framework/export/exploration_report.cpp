// SPDX-License-Identifier: Apache-2.0
#include "framework/export/exploration_report.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "framework/core/png.h"
#include "framework/core/units.h"

namespace lapwing {
namespace {

constexpr std::size_t kListed = 15;  // candidates in the table
constexpr int kSlicePixels = 128;    // across, of a slice of a grid
constexpr double kTick = 1.2;        // m, of the line that shows where a candidate looks

std::vector<double> from_zero(const std::vector<double>& observed) {
  std::vector<double> curve{0};
  curve.insert(curve.end(), observed.begin(), observed.end());
  return curve;
}

Series series_of(std::string name, const std::vector<double>& observed) {
  Series series;
  series.name = std::move(name);
  series.y = from_zero(observed);
  series.x.resize(series.y.size());
  std::iota(series.x.begin(), series.x.end(), 0.0);
  return series;
}

Facts summary(const ExplorationRecord& record) {
  Facts facts;
  const auto add = [&](std::string label, std::string value, std::string unit = "") {
    facts.facts.push_back({std::move(label), std::move(value), std::move(unit)});
  };
  const double observed = record.observed.empty() ? 0 : record.observed.back();
  add("utility", record.utility);
  add("ended", record.end);
  add("images", std::to_string(record.observed.size()));
  add("way", number_text(record.length), "m");
  add("observed surface", std::to_string(std::lround(observed)),
      "of " + std::to_string(std::lround(record.surface)) + " voxels");
  add("efficiency", std::to_string(std::lround(record.efficiency)),
      record.per_second ? "voxels, mean over the flight" : "voxel images");
  if (record.oracle_efficiency > 0)
    add("relative to the oracle", number_text(record.efficiency / record.oracle_efficiency, 3));
  if (!record.oracle_end.empty())
    add("the oracle ended after", std::to_string(record.oracle.size()),
        "images: " + record.oracle_end);
  return facts;
}

Section growth(const ExplorationRecord& record) {
  FilmStrip strip;
  strip.title = "Seen from above";
  if (record.cut) strip.title += ", all above " + number_text(*record.cut, 3) + " m left out";
  strip.title += ": height from blue (" + number_text(record.moments.back().lowest, 3) +
                 " m) to yellow (" + number_text(record.moments.back().highest, 3) +
                 " m), light is free, dark unknown";
  for (const ExplorationMoment& moment : record.moments) {
    strip.frames.push_back({encode_png(moment.map),
                            moment.map.width,
                            moment.map.height,
                            "after " + std::to_string(moment.images) + " images",
                            {}});
  }
  strip.viewed = true;
  return {"Growth of the map", {strip}};
}

Section path(const ExplorationRecord& record) {
  Drawing drawing;
  drawing.along = {"images", "", false, true};
  drawing.value = {"images", ""};
  drawing.lines.push_back({"path", record.path, record.path_images, record.path_images});
  if (!record.path.empty()) drawing.points.push_back({"start", record.path.front()});
  Scene3D scene{"The path, coloured by the number of images", drawing};
  PathView above{"The same from above", Projection::above, drawing};
  return {"Exploration's path", {scene, above}};
}

Section candidates(const ExplorationRecord& record) {
  std::vector<ExplorationCandidate> sorted = record.candidates;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const auto& a, const auto& b) { return a.value > b.value; });
  Section section{"Candidates at the last step", {}};
  Drawing drawing;
  drawing.value = {"utility", ""};
  Polyline ticks;
  ticks.name = "candidates";
  Series values;
  values.name = record.utility;
  const Eigen::Vector3d gap = Eigen::Vector3d::Constant(std::nan(""));
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    const ExplorationCandidate& c = sorted[k];
    ticks.points.insert(ticks.points.end(), {c.position, c.position + kTick * c.direction, gap});
    ticks.values.insert(ticks.values.end(), {c.value, c.value, c.value});
    values.x.push_back(static_cast<double>(k + 1));
    values.y.push_back(c.value);
  }
  drawing.lines.push_back(std::move(ticks));
  section.blocks.push_back(Scene3D{"Where they stand and look, coloured by utility", drawing});
  Chart chart;
  chart.title = "Utility of each of the " + std::to_string(sorted.size()) + " candidates";
  chart.x = {"candidates, best first", "", false, true};
  chart.y = {"utility", ""};
  chart.series.push_back(std::move(values));
  section.blocks.push_back(std::move(chart));
  Table table;
  table.title = "The best of them";
  table.columns = {{"x", "m"}, {"y", "m"}, {"z", "m"}, {"heading", "deg"}, {"utility", ""}};
  for (std::size_t k = 0; k < std::min(kListed, sorted.size()); ++k) {
    const ExplorationCandidate& c = sorted[k];
    const double heading = degrees(std::atan2(c.direction.y(), c.direction.x()));
    table.rows.push_back({{c.position.x(), c.position.y(), c.position.z(), heading, c.value}});
  }
  section.blocks.push_back(std::move(table));
  return section;
}

// As many pixels for every grid, so that they can be compared.
Picture enlarged(const Picture& small, int width) {
  const int times = std::max(1, width / small.width);
  Picture large{small.width * times, small.height * times, {}};
  large.rgb.reserve(small.rgb.size() * static_cast<std::size_t>(times) * times);
  for (int y = 0; y < large.height; ++y)
    for (int x = 0; x < large.width; ++x) {
      const auto at = 3 * (static_cast<std::size_t>(y / times) * small.width + x / times);
      large.rgb.insert(large.rgb.end(), {small.rgb[at], small.rgb[at + 1], small.rgb[at + 2]});
    }
  return large;
}

Section grids(const ExplorationRecord& record) {
  Section section{"What a learned utility is shown at the last view", {}};
  for (const GridSlices& grid : record.grids) {
    const auto add = [&](const std::vector<Picture>& pictures, const char* what) {
      FilmStrip strip;
      strip.title = std::string(what) + ", " + std::to_string(grid.points) +
                    " points along an edge: a slice at the height of the camera, with the view "
                    "direction up; black is 0, white is 1";
      for (std::size_t level = 0; level < pictures.size(); ++level) {
        const Picture picture = enlarged(pictures[level], kSlicePixels);
        strip.frames.push_back({encode_png(picture),
                                picture.width,
                                picture.height,
                                "scale " + std::to_string(level + 1) + ", " +
                                    number_text(grid.edges[level], 3) + " m across",
                                {}});
      }
      section.blocks.push_back(std::move(strip));
    };
    add(grid.occupancy, "Occupancy");
    add(grid.certainty, "Certainty");
  }
  return section;
}

}  // namespace

std::vector<Section> exploration_sections(const ExplorationRecord& record) {
  std::vector<Section> sections;
  Chart chart;
  chart.title = "Observed surface";
  chart.x = {"images", "", false, true};
  chart.y = {"observed surface", "voxels"};
  chart.series.push_back(series_of(record.utility, record.observed));
  if (!record.oracle.empty()) chart.series.push_back(series_of("oracle", record.oracle));
  sections.push_back({"Exploration", {summary(record), chart}});
  if (!record.moments.empty()) sections.push_back(growth(record));
  if (record.path.size() > 1) sections.push_back(path(record));
  if (!record.candidates.empty()) sections.push_back(candidates(record));
  if (!record.grids.empty()) sections.push_back(grids(record));
  return sections;
}

}  // namespace lapwing
