// SPDX-License-Identifier: Apache-2.0
// The stage that the function of a term is given: blocks, neighbours, subjects, distances.
#include <algorithm>

#include "framework/mission/guard.h"
#include "framework/mission/term_recording.h"
#include "framework/problem/filmed_point.h"

namespace lapwing {

namespace {

constexpr const char* kStageType = "stage";
constexpr int kLargestWindow = 64;  // stages

struct StageObject {
  int stage = 0;  // places after the window's first
  std::uint64_t serial = 0;
};

TermRecording& recording_of(lua_State* state, const StageObject& stage) {
  TermRecording& recording = TermRecording::current(state);
  if (recording.formula().setting().serial != stage.serial)
    refuse_symbolic(state, "a stage was kept from another term or another call");
  return recording;
}

void push_block(lua_State* state, const SymbolicEntries& entries) {
  if (entries.size() == 1)
    push_symbolic(state, entries[0]);
  else
    push_symbolic_vector(state, entries);
}

// stage:subject(name): where a subject of the environment is at the stage's time.
int subject_of_stage(lua_State* state) {
  const StageObject& stage = object_argument<StageObject>(state, 1, kStageType);
  TermRecording& recording = recording_of(state, stage);
  const std::string name = at_this_line(
      state, [&] { return text_argument(state, 2, "s:subject: the name of a subject"); });
  const Subject& subject = at_this_line(state, [&]() -> const Subject& {
    return subject_named(recording.formula().problem().environment(), name);
  });
  TermFormula& formula = recording.formula();
  const SymbolicScalar time = recording.read(stage.stage, formula.layout().index("time"))[0];
  push_symbolic_vector(state, formula.subject(subject, time));
  return 1;
}

// stage:distance(point [, name]): from a point to the nearest obstacle, or to the one of that name.
int distance_of_stage(lua_State* state) {
  const StageObject& stage = object_argument<StageObject>(state, 1, kStageType);
  TermRecording& recording = recording_of(state, stage);
  const SymbolicEntries point = symbolic_vector_argument(state, 2, "s:distance", 3);
  const std::string name = lua_isnoneornil(state, 3) ? "" : at_this_line(state, [&] {
    return text_argument(state, 3, "s:distance: the name of an obstacle");
  });
  push_symbolic(state,
                at_this_line(state, [&] { return recording.formula().distance(point, name); }));
  return 1;
}

// stage.position, stage[1], stage.subject
int stage_index(lua_State* state) {
  const StageObject& stage = object_argument<StageObject>(state, 1, kStageType);
  TermRecording& recording = recording_of(state, stage);
  if (lua_type(state, 2) == LUA_TNUMBER) {
    const lua_Integer later = lua_isinteger(state, 2) ? lua_tointeger(state, 2) : -1;
    if (later < 0)
      refuse_symbolic(state,
                      "a neighbouring stage is s[1], s[2], ...: expected a whole number, at "
                      "least 0");
    const lua_Integer most =
        std::min(kLargestWindow, recording.formula().problem().horizon().stages) - 1 - stage.stage;
    if (later > most)
      refuse_symbolic(state, "s[" + std::to_string(later) +
                                 "]: the last neighbour that there can "
                                 "be here is s[" +
                                 std::to_string(most) + "]");
    new_object(state, kStageType, StageObject{stage.stage + static_cast<int>(later), stage.serial});
    return 1;
  }
  const std::string name = at_this_line(
      state, [&] { return text_argument(state, 2, "a stage's field: the name of a block"); });
  const int block = at_this_line(state, [&] { return recording.formula().layout().index(name); });
  push_block(state, recording.read(stage.stage, block));
  return 1;
}

int refuse_stage_change(lua_State* state) {
  refuse_symbolic(state, "a stage cannot be changed");
}

}  // namespace

void push_stage(lua_State* state, int stage, std::uint64_t serial) {
  new_object(state, kStageType, StageObject{stage, serial});
}

void open_stage_values(lua_State* state) {
  static const Binding methods[] = {
      {"subject", &guarded<subject_of_stage>, "(name: string): lapwing.vector",
       "position of a subject of the environment at the time of the stage, m"},
      {"distance", &guarded<distance_of_stage>,
       "(point: lapwing.vector, name?: string): lapwing.value",
       "distance in m to the nearest obstacle, or to the named obstacle; negative inside"}};
  static constexpr BoundField kFields[] = {
      {"time", "lapwing.value", "s"},
      {"step", "lapwing.value", "time to the next stage, s"},
      {"[integer]", "lapwing.stage", "the stages after it: s[1], s[2], ..."},
      {"[string]", "lapwing.vector", "every block of the problem: position, yaw, target, ..."}};
  define_type<StageObject>(state, kStageType, {methods}, &guarded<stage_index>);
  note_fields(state, kStageType, kFields);
  luaL_getmetatable(state, kStageType);
  lua_pushcfunction(state, &guarded<refuse_stage_change>);
  lua_setfield(state, -2, "__newindex");
  lua_pop(state, 1);
}

}  // namespace lapwing
