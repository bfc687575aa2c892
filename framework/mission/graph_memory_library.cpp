// SPDX-License-Identifier: Apache-2.0
// Graphs of views that are kept from plan to plan (run.h, ScanMemory).
#include <algorithm>

#include <lua.hpp>

#include "framework/core/json.h"
#include "framework/mission/guard.h"
#include "framework/mission/lua_value.h"
#include "framework/mission/scan_look.h"
#include "framework/mission/scan_objects.h"

namespace lapwing {
namespace {

constexpr BoundField kKeptObjects[] = {{"graph?", "lapwing.scan_graph", "graph to be kept"}};
ParameterTable kept_table() {
  ParameterTable table;
  table.required_text("without", "options that the graph does not depend on, apart by spaces")
      .text("near", "",
            "options in which a graph may differ that an estimate is made from, apart by spaces")
      .boolean("never", false,
               "true: it is not of a kind that is kept; where only an estimate is "
               "asked for, the plan ends");
  return table;
}

// All that a graph depends on.
std::string memory_key(const MissionRun& run, const std::string& left_out) {
  Value options = run.configuration;
  const std::string without = " " + left_out + " ";
  std::erase_if(options.as_map(), [&](const auto& entry) {
    return without.find(" " + entry.first + " ") != std::string::npos;
  });
  return to_json(options, -1) + "\n" + std::to_string(run.settings.seed);
}

// How many graphs like this one are kept.
std::size_t kept_graphs(const ScanWork& work) {
  constexpr std::size_t kSmall = std::size_t{64} << 20;  // bytes
  return bytes_of(work) <= kSmall ? 4 : 1;
}

// run:kept_graph{without =, near =}: graph and prior of the plan before, or nil. With `graph` that
// one is kept from now on.
int kept_graph_of_run(lua_State* state) {
  MissionRun& run = run_of(state);
  const Parameters given = table_argument(state, 2, kept_table(), "kept_graph", kKeptObjects);
  if (!run.settings.scan_memory) return 0;
  const bool estimate = run.settings.observe_estimate != nullptr;
  if (given.boolean("never")) {
    if (estimate) throw Cancelled();
    return 0;
  }
  auto& entries = run.settings.scan_memory->entries;
  std::string key = memory_key(run, given.text("without"));
  std::string near = memory_key(run, given.text("without") + " " + given.text("near"));
  auto found = std::find_if(entries.begin(), entries.end(),
                            [&](const ScanMemory::Entry& entry) { return entry.key == key; });
  lua_getfield(state, 2, "graph");
  if (const auto* graph = test_object<GraphObject>(state, -1, kGraphType)) {
    if (estimate) return 0;  // made in haste
    if (found != entries.end()) entries.erase(found);
    entries.push_front({std::move(key), std::move(near), graph->work});
    if (entries.size() > kept_graphs(*graph->work)) entries.resize(kept_graphs(*graph->work));
    return 0;
  }
  const bool same = found != entries.end();
  if (!same && estimate) {
    found = std::find_if(entries.begin(), entries.end(),
                         [&](const ScanMemory::Entry& entry) { return entry.near == near; });
    if (found == entries.end()) throw Cancelled();
  }
  if (found == entries.end()) {
    // The room of a large one is needed for the next.
    if (!entries.empty() && kept_graphs(*entries.front().work) == 1) entries.clear();
    return 0;
  }
  const std::shared_ptr<const ScanWork> work = found->work;
  if (same) std::rotate(entries.begin(), found, found + 1);
  if (same) begin_planning(run);
  new_object(state, kGraphType, GraphObject{work});
  new_object(state, kPriorType, PriorObject{work->prior});
  lua_pushboolean(state, same);
  return 3;
}

}  // namespace

std::span<const Binding> graph_memory_methods_of_run() {
  static const Binding methods[] = {
      {"kept_graph", &guarded<kept_graph_of_run>,
       "(settings: @): lapwing.scan_graph?, lapwing.prior?, boolean?",
       "graph and prior of the plan before, if it was made from the same options, and true; for an "
       "estimate also of options that are near, and false; nil where plans are made once. With "
       "`graph`, that one is kept",
       &kept_table, kKeptObjects}};
  return methods;
}

}  // namespace lapwing
