// SPDX-License-Identifier: Apache-2.0
#include "framework/app/mapping_run.h"

#include <cstdio>

#include "framework/app/run_outcome.h"
#include "framework/app/terminal.h"
#include "framework/core/visible_text.h"
#include "framework/export/map_report.h"
#include "framework/map/map_file.h"

namespace lapwing {
namespace {

Value json_of(const MappingOutcome& outcome, const Invocation& invocation,
              const std::string& status) {
  const Mapping& mapping = *outcome.result.mapping;
  const VoxelCounts counts = mapping.map->counts();
  Value object = Value::map();
  object.set("mission", outcome.result.plan.mission);
  object.set("kind", outcome.result.plan.kind);
  object.set("status", status);
  outcome.target.add_to(object);
  object.set("seed", static_cast<std::int64_t>(invocation.seed));
  Value& seconds = object.set("seconds", Value::map());
  seconds.set("total", outcome.seconds);
  seconds.set("integrate", mapping.seconds);
  object.set("reproducible", !mapping.cancelled);
  Value& map = object.set("map", Value::map());
  map.set("path", (outcome.target.folder() / "map.ot").string());
  map.set("backend", mapping.plugin);
  map.set("scans", static_cast<std::int64_t>(mapping.scans));
  map.set("resolution", mapping.map->grid().resolution());
  map.set("free", static_cast<std::int64_t>(counts.free));
  map.set("occupied", static_cast<std::int64_t>(counts.occupied));
  map.set("known", static_cast<std::int64_t>(counts.known));
  map.set("bytes", static_cast<std::int64_t>(mapping.map->bytes()));
  return object;
}

void print_summary(const MappingOutcome& outcome, const std::string& status) {
  const Mapping& mapping = *outcome.result.mapping;
  const VoxelCounts counts = mapping.map->counts();
  std::printf("%s: %s\n", visible_line(outcome.result.plan.mission).c_str(),
              tinted(status == "ok" ? Tone::good : Tone::bad, status == "ok" ? "complete" : status)
                  .c_str());
  std::printf(
      "  %s, voxels of %.4g m by %s: %llu free, %llu occupied, "
      "%llu known but undecided, %.1f MiB\n",
      visible_line(mapping.source).c_str(), mapping.map->grid().resolution(),
      mapping.plugin.c_str(), static_cast<unsigned long long>(counts.free),
      static_cast<unsigned long long>(counts.occupied),
      static_cast<unsigned long long>(counts.known - counts.free - counts.occupied),
      static_cast<double>(mapping.map->bytes()) / (1 << 20));
  if (mapping.scans > 0)
    std::printf("  integrated in %.3g s, %.3g ms an image\n", mapping.seconds,
                1e3 * mapping.seconds / static_cast<double>(mapping.scans));
  if (counts.free + counts.occupied == 0)
    std::printf("  no voxel was measured often enough to be free or occupied\n");
  std::printf("  report: %s\n",
              visible_line((outcome.target.folder() / "report.html").string()).c_str());
  if (const std::string old = outcome.target.old_run_in_words(); !old.empty())
    std::printf("  %s\n", visible_line(old).c_str());
}

}  // namespace

ExitStatus finish_mapping(const MappingOutcome& outcome, const Invocation& invocation,
                          const logging::Capture& capture) {
  const Mapping& mapping = *outcome.result.mapping;
  const VoxelCounts counts = mapping.map->counts();
  const bool empty = counts.free + counts.occupied == 0;
  const std::string status = mapping.cancelled ? "cancelled" : empty ? "failed" : "ok";
  RunFiles files;
  files.map = map_file_bytes(".ot", *mapping.map);
  add_report(map_report({.title = outcome.result.plan.mission,
                         .plugin = mapping.plugin,
                         .source = mapping.source,
                         .scans = mapping.scans,
                         .map = mapping.map.get(),
                         .images = mapping.images,
                         .cancelled = mapping.cancelled}),
             invocation, files);
  logging::info("status " + status);
  files.log = capture.text();
  outcome.target.write(files);
  if (invocation.json)
    print_json(json_of(outcome, invocation, status));
  else if (!invocation.quiet)
    print_summary(outcome, status);
  if (mapping.cancelled) return ExitStatus::interrupted;
  return empty ? ExitStatus::not_certified : ExitStatus::done;
}

}  // namespace lapwing
