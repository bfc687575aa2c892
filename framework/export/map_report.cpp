// SPDX-License-Identifier: Apache-2.0
#include "framework/export/map_report.h"

#include <cstdio>

#include "framework/core/png.h"
#include "framework/export/map_pictures.h"

namespace lapwing {
namespace {

constexpr int kMostPixels = 900;

std::string metres(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.4g m", value);
  return buffer;
}

std::string caption(const std::string& what, const MapPicture& made) {
  return what + "; squares of " + metres(made.metres) + ", north is up";
}

// The height at which a level cut shows most: much that is free and much that is in the way.
double telling_height(const Map& map, const VoxelBox& bounds) {
  const auto levels = static_cast<std::size_t>(bounds.upper.z - bounds.lower.z + 1);
  std::vector<double> free(levels), occupied(levels);
  map.for_each_leaf([&](const VoxelLeaf& leaf) {
    const VoxelState state = map.settings().state(leaf.log_odds);
    if (state == VoxelState::unknown) return;
    std::vector<double>& counts = state == VoxelState::free ? free : occupied;
    const int size = 1 << leaf.level;
    for (int z = leaf.key.z; z < leaf.key.z + size; ++z)
      if (bounds.lower.z <= z && z <= bounds.upper.z)
        counts[static_cast<std::size_t>(z - bounds.lower.z)] += static_cast<double>(size) * size;
  });
  std::size_t most = 0;
  for (std::size_t z = 0; z < levels; ++z)
    if (free[z] * (occupied[z] + 1) > free[most] * (occupied[most] + 1)) most = z;
  return (bounds.lower.z + static_cast<int>(most) - kCenterKey + 0.5) * map.grid().resolution();
}

Facts facts_of(const MapReport& given) {
  const Map& map = *given.map;
  const VoxelCounts counts = map.counts();
  Facts facts;
  const auto add = [&](std::string name, std::string value) {
    facts.facts.push_back({std::move(name), std::move(value), ""});
  };
  add("backend", given.plugin);
  add("made from", given.source.empty() ? "nothing" : given.source);
  add("voxel", metres(map.grid().resolution()));
  add("known voxels", std::to_string(counts.known));
  add("free", std::to_string(counts.free));
  add("occupied", std::to_string(counts.occupied));
  add("memory", number_text(static_cast<double>(map.bytes()) / (1 << 20)) + " MiB");
  if (const auto bounds = map.bounds()) {
    const double r = map.grid().resolution();
    const auto edge = [&](int axis) {
      return metres((bounds->upper[axis] - bounds->lower[axis] + 1) * r);
    };
    add("extent", edge(0) + " by " + edge(1) + " by " + edge(2));
  }
  return facts;
}

}  // namespace

Report map_report(const MapReport& given) {
  const Map& map = *given.map;
  Report report;
  report.title = given.title;
  report.subtitle = "map of " + std::to_string(given.scans) + " depth images";
  if (given.scans == 0) report.subtitle = "map from a file";
  report.status = given.cancelled ? "cancelled" : "complete";
  report.status_mark = given.cancelled ? Mark::fail : Mark::pass;
  report.sections.push_back({"Summary", {facts_of(given)}});
  const auto bounds = map.bounds();
  if (!bounds) return report;

  const MapPicture above = height_picture(map, kMostPixels);
  report.sections.push_back(
      {"By height",
       {Image{encode_png(above.picture),
              caption("The highest occupied voxels, from " + metres(above.lowest) + " (blue) to " +
                          metres(above.highest) + " (yellow); light is free, dark unknown",
                      above)}}});
  const double height = telling_height(map, *bounds);
  const MapPicture level = cut_picture(map, height, kMostPixels);
  Section cuts{
      "Level cut",
      {Image{encode_png(level.picture),
             caption("Voxels " + metres(height) +
                         " up: black is occupied, light free, grey undecided, dark unknown",
                     level)}}};
  if (map.settings().observations) {
    const MapPicture doubt = uncertainty_picture(map, height, kMostPixels);
    cuts.blocks.push_back(
        Image{encode_png(doubt.picture),
              caption("Certainty of the same voxels, from none (blue) to full (yellow)", doubt)});
  }
  report.sections.push_back(std::move(cuts));
  if (!given.images.empty()) {
    Section section{"Depth images", {}};
    FilmStrip strip;
    strip.title = "Some of the images";
    for (const PosedDepthImage& measured : given.images) {
      const Picture picture = depth_picture(measured.image);
      char text[96];
      std::snprintf(text, sizeof text, "from (%.1f, %.1f, %.1f) m", measured.camera.position.x(),
                    measured.camera.position.y(), measured.camera.position.z());
      strip.frames.push_back({encode_png(picture), picture.width, picture.height, text, {}});
    }
    section.blocks.push_back(std::move(strip));
    report.sections.push_back(std::move(section));
  }
  return report;
}

}  // namespace lapwing
