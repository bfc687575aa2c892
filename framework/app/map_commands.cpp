// SPDX-License-Identifier: Apache-2.0
// lapwing map info, convert and view; lapwing scene view.
#include <cstdio>

#include "framework/app/command_line.h"
#include "framework/app/output_target.h"
#include "framework/core/files.h"
#include "framework/core/visible_text.h"
#include "framework/export/map_report.h"
#include "framework/map/map_file.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

// Cubes from this level on, 128 voxels wide, are many bricks but one node of an octree.
constexpr int kWideLevel = 7;

// The file in a map of its own resolution.
std::unique_ptr<Map> loaded(const fs::path& file, const Registry& registry) {
  const MapFile read = read_map_file(file);
  Value parameters = Value::map();
  parameters.set("resolution", read.resolution);
  const bool wide = std::any_of(read.leaves.begin(), read.leaves.end(),
                                [](const VoxelLeaf& leaf) { return leaf.level >= kWideLevel; });
  std::unique_ptr<Map> map = registry.create<Map>(wide ? "octomap" : "brick", parameters);
  try {
    map->import(read.leaves);
  } catch (const InputError& error) {
    throw InputError("'" + file.string() + "': " + error.what());
  }
  return map;
}

Value extent_of(const Map& map) {
  Value value = Value::map();
  const auto bounds = map.bounds();
  if (!bounds) return value;
  const double r = map.grid().resolution();
  Value lower = Value::list(), upper = Value::list();
  for (int axis = 0; axis < 3; ++axis) {
    lower.push_back((bounds->lower[axis] - kCenterKey) * r);
    upper.push_back((bounds->upper[axis] + 1 - kCenterKey) * r);
  }
  value.set("lower", std::move(lower));
  value.set("upper", std::move(upper));
  return value;
}

}  // namespace

ExitStatus show_map(const fs::path& file, const Invocation& invocation) {
  const Registry registry = invocation.registry();
  const MapFile read = read_map_file(file);
  const std::unique_ptr<Map> map = loaded(file, registry);
  const VoxelCounts counts = map->counts();
  if (invocation.json) {
    Value object = Value::map();
    object.set("map", file.string());
    object.set("resolution", read.resolution);
    object.set("two_states", read.two_states);
    object.set("leaves", static_cast<std::int64_t>(read.leaves.size()));
    object.set("known", static_cast<std::int64_t>(counts.known));
    object.set("free", static_cast<std::int64_t>(counts.free));
    object.set("occupied", static_cast<std::int64_t>(counts.occupied));
    object.set("extent", extent_of(*map));
    print_json(object);
    return ExitStatus::done;
  }
  std::printf("%s\n", visible_line(file.string()).c_str());
  std::printf("  holds      %s\n", read.two_states ? "two states" : "log odds");
  std::printf("  voxel      %.6g m\n", read.resolution);
  std::printf("  leaves     %zu\n", read.leaves.size());
  std::printf("  free       %llu voxels\n", static_cast<unsigned long long>(counts.free));
  std::printf("  occupied   %llu voxels\n", static_cast<unsigned long long>(counts.occupied));
  std::printf("  undecided  %llu voxels, known, but neither free nor occupied\n",
              static_cast<unsigned long long>(counts.known - counts.free - counts.occupied));
  if (const auto bounds = map->bounds()) {
    const char* axes = "xyz";
    for (int axis = 0; axis < 3; ++axis)
      std::printf("  %c          %.6g to %.6g m\n", axes[axis],
                  (bounds->lower[axis] - kCenterKey) * read.resolution,
                  (bounds->upper[axis] + 1 - kCenterKey) * read.resolution);
  }
  return ExitStatus::done;
}

ExitStatus convert_map(const fs::path& file, const fs::path& target, const Invocation& invocation) {
  require_output(target, {file});
  const Registry registry = invocation.registry();
  write_map_file(target, *loaded(file, registry));
  if (!invocation.quiet) std::printf("%s\n", target.c_str());
  return ExitStatus::done;
}

ExitStatus view_map(const fs::path& file, const fs::path& target, const Invocation& invocation) {
  require_output(target, {file});
  const Registry registry = invocation.registry();
  const std::unique_ptr<Map> map = loaded(file, registry);
  write_file_atomically(target, render_html(map_report({.title = file.filename().string(),
                                                        .plugin = "brick",
                                                        .source = file.filename().string(),
                                                        .map = map.get()})));
  return ExitStatus::done;
}

}  // namespace lapwing
