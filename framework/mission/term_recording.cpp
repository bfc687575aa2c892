// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/term_recording.h"

#include <algorithm>
#include <cmath>

#include "framework/core/log.h"
#include "framework/core/parameters.h"
#include "framework/mission/guard.h"

namespace lapwing {

namespace {

constexpr const char* kRecordingKey = "lapwing.term_recording";
constexpr std::size_t kManyOperations = 20'000;  // of a tape: a solve takes minutes

int refuse_parameter(lua_State* state) {
  std::vector<std::string> known;
  lua_pushnil(state);
  while (lua_next(state, 1)) {
    known.emplace_back(lua_tostring(state, -2));
    lua_pop(state, 1);
  }
  std::sort(known.begin(), known.end());
  const std::string name = lua_type(state, 2) == LUA_TSTRING ? lua_tostring(state, 2) : "?";
  const std::string nearest = nearest_name(name, known);
  refuse_symbolic(state, "no parameter '" + name + "' in its `parameters`" +
                             (nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
}

std::uint64_t next_serial() {
  static std::uint64_t serial = 0;
  return ++serial;
}

// "sin" of "bad argument #1 to 'sin' (...)": what stands between two texts; empty where they do
// not.
std::string text_between(const std::string& text, std::string_view before, std::string_view after) {
  const std::size_t begin = text.find(before);
  if (begin == text.npos) return "";
  const std::size_t from = begin + before.size(), end = text.find(after, from);
  return end == text.npos ? "" : text.substr(from, end - from);
}

std::vector<std::string> functions_of_lapwing(lua_State* state) {
  std::vector<std::string> names;
  lua_getglobal(state, "lapwing");
  lua_pushnil(state);
  while (lua_next(state, -2)) {
    if (lua_type(state, -2) == LUA_TSTRING && lua_isfunction(state, -1))
      names.emplace_back(lua_tostring(state, -2));
    lua_pop(state, 1);
  }
  lua_pop(state, 1);
  std::sort(names.begin(), names.end());
  return names;
}

// What to write instead of what Lua itself complains of; empty where nothing is known.
std::string remedy_for(lua_State* state, const std::string& complaint) {
  const std::vector<std::string> known = functions_of_lapwing(state);
  const std::string taken = text_between(complaint, "bad argument #", "(number expected, got v");
  const std::string of_math = text_between(taken, "to '", "'");
  if (std::find(known.begin(), known.end(), of_math) != known.end())
    return ": write lapwing." + of_math;
  const std::string missing = text_between(complaint, "call a nil value (field '", "')");
  const std::string nearest = missing.empty() ? "" : nearest_name(missing, known);
  return nearest.empty() ? "" : "; did you mean lapwing." + nearest + "?";
}

}  // namespace

TermRecording::TermRecording(lua_State* state, std::string what, const TrajectoryProblem& problem,
                             const TermParameters& parameters, double width)
    : state_(state), problem_(problem), parameters_(parameters), layout_(problem.layout()) {
  setting_.what = std::move(what);
  setting_.width = width;
  setting_.serial = next_serial();
  for (const char* clock : {"time", "step"})
    if (layout_.find(clock) < 0)
      layout_.add({.name = clock, .unit = "s", .role = BlockRole::clock});
  set_symbolic_setting(state, &setting_);
  lua_pushlightuserdata(state, this);
  lua_setfield(state, LUA_REGISTRYINDEX, kRecordingKey);
}

TermRecording::~TermRecording() {
  set_symbolic_setting(state_, nullptr);
  lua_pushnil(state_);
  lua_setfield(state_, LUA_REGISTRYINDEX, kRecordingKey);
}

TermRecording& TermRecording::current(lua_State* state) {
  lua_getfield(state, LUA_REGISTRYINDEX, kRecordingKey);
  auto* recording = static_cast<TermRecording*>(lua_touserdata(state, -1));
  lua_pop(state, 1);
  if (!recording) refuse_symbolic(state, "a stage was kept from the recording of a term");
  return *recording;
}

// ---- what the function reads --------------------------------------------------------------------

SymbolicEntries TermRecording::read(int stage, int block) {
  const BlockSpec& spec = layout_.block(block);
  const Horizon& horizon = problem_.horizon();
  if (spec.name == "step" && horizon.uniform() && !horizon.step_free)
    return {{.value = horizon.step}};
  SymbolicEntries entries(spec.size);
  if (!symbolic_) {
    const std::vector<double>& values = numbers(stage, block);
    for (int i = 0; i < spec.size; ++i) entries[i].value = values[i];
    return entries;
  }
  for (int i = 0; i < spec.size; ++i) {
    const auto same = std::find_if(inputs_.begin(), inputs_.end(), [&](const Input& input) {
      return input.stage == stage && input.block == block && input.component == i;
    });
    const auto index = static_cast<int>(same - inputs_.begin());
    if (same == inputs_.end()) inputs_.push_back({stage, block, i});
    entries[i].node = setting_.graph.input(index);
  }
  return entries;
}

void TermRecording::push_parameters() {
  lua_newtable(state_);
  for (const TermParameter& parameter : parameters_.list) {
    SymbolicEntries entries(parameter.size);
    for (int i = 0; i < parameter.size; ++i) {
      if (symbolic_)
        entries[i].node = setting_.graph.parameter(parameter.first + i);
      else
        entries[i].value = point_parameters_[parameter.first + i];
    }
    if (parameter.scalar)
      push_symbolic(state_, entries[0]);
    else
      push_symbolic_vector(state_, std::move(entries));
    lua_setfield(state_, -2, parameter.name.c_str());
  }
  lua_newtable(state_);
  lua_pushcfunction(state_, &guarded<refuse_parameter>);
  lua_setfield(state_, -2, "__index");
  lua_setmetatable(state_, -2);
}

// ---- what it returns ----------------------------------------------------------------------------

Origin place_of_function(lua_State* state, int function) {
  lua_Debug record;
  lua_pushvalue(state, function);
  lua_getinfo(state, ">S", &record);
  if (record.source[0] != '@') return {};
  return {record.source + 1, record.linedefined};
}

// What Lua itself raised says neither which term it was nor what to write.
void TermRecording::raise(int message) {
  if (lua_type(state_, message) != LUA_TSTRING) lua_error(state_);
  std::string text = lua_tostring(state_, message);
  if (text.find(setting_.what) == text.npos) {
    const std::size_t place = text.find(".lua:");
    const std::size_t after = place == text.npos ? text.npos : text.find(": ", place);
    const std::string remedy = remedy_for(state_, text);
    text.insert(after == text.npos ? 0 : after + 2, setting_.what + ": ");
    text += remedy;
  }
  push_text(state_, text);
  lua_error(state_);
}

void TermRecording::collect(int index, int depth, SymbolicEntries& rows) {
  constexpr int kMostRows = 256;
  if (is_symbolic_scalar(state_, index)) {
    rows.push_back(symbolic_argument(state_, index, "its result"));
  } else if (lua_istable(state_, index) && depth < 2 && lua_rawlen(state_, index) > 0) {
    const auto count = static_cast<lua_Integer>(lua_rawlen(state_, index));
    for (lua_Integer i = 1; i <= count; ++i) {
      lua_rawgeti(state_, index, i);
      collect(lua_gettop(state_), depth + 1, rows);
      lua_pop(state_, 1);
    }
  } else if (is_symbolic_vector(state_, index)) {
    const SymbolicEntries entries = symbolic_vector_argument(state_, index, "its result");
    rows.insert(rows.end(), entries.begin(), entries.end());
  } else {
    throw InputError("expected the function to return numbers or vectors, got " +
                     describe_symbolic(state_, index));
  }
  if (rows.size() > kMostRows) throw InputError("the function returns more than 256 numbers");
}

SymbolicEntries TermRecording::call(int function) {
  const int top = lua_gettop(state_);
  luaL_checkstack(state_, 16, "recording a term");
  lua_pushvalue(state_, function);
  push_stage(state_, 0, setting_.serial);
  push_parameters();
  if (lua_pcall(state_, 2, LUA_MULTRET, 0) != LUA_OK) raise(lua_gettop(state_));
  SymbolicEntries rows;
  const int results = lua_gettop(state_) - top;
  try {
    if (results == 0) throw InputError("the function returns nothing; expected numbers or vectors");
    for (int i = 1; i <= results; ++i) collect(top + i, 0, rows);
  } catch (const InputError& error) {
    throw InputError(place_of_function(state_, function), setting_.what + ": " + error.what());
  }
  lua_settop(state_, top);
  return rows;
}

// Blocks and window of the result; `places` says where each input stands in an instance.
void TermRecording::list_inputs(TapeFunction& result, std::vector<int>& places, int& width) const {
  std::vector<int> blocks;
  for (const Input& input : inputs_) {
    result.window = std::max(result.window, input.stage + 1);
    if (std::find(blocks.begin(), blocks.end(), input.block) == blocks.end())
      blocks.push_back(input.block);
  }
  if (blocks.empty()) blocks.push_back(layout_.index("step"));  // a constant, once an instance
  std::map<int, int> offsets;
  int stride = 0;
  result.blocks.clear();
  for (const int block : blocks) {
    result.blocks.push_back(layout_.block(block).name);
    offsets[block] = stride;
    stride += layout_.block(block).size;
  }
  for (const Input& input : inputs_)
    places.push_back(input.stage * stride + offsets[input.block] + input.component);
  width = stride * result.window;
}

void TermRecording::record(int function, TapeFunction& result) {
  function = lua_absindex(state_, function);
  symbolic_ = true;
  const SymbolicEntries rows = call(function);
  std::vector<int> outputs, places;
  for (const SymbolicScalar& row : rows) {
    if (row.known() && !std::isfinite(row.value))
      throw InputError(place_of_function(state_, function),
                       setting_.what + ": returns no finite number whatever the stage is");
    outputs.push_back(symbolic_node(setting_, row));
  }
  outputs_ = outputs;
  int width = 0;
  list_inputs(result, places, width);
  const bool free = problem_.horizon().step_free;
  result.affine = setting_.graph.affine(outputs, [&](int input) {
    return layout_.block(inputs_[input].block).role == BlockRole::clock && !free;
  });
  result.tape = std::make_shared<const Tape>(setting_.graph, outputs, places, width);
  const std::string place = place_of_function(state_, function).to_string();
  result.written_at = (place.empty() ? "" : place + ": ") + setting_.what;
  if (inputs_.empty() && parameters_.list.empty())
    logging::warning(result.written_at + ": is the same number whatever the stage is");
  if (setting_.graph.nodes().size() > kManyOperations)
    logging::warning(result.written_at + ": takes " +
                     std::to_string(setting_.graph.nodes().size()) +
                     " operations at every stage; solving will be slow");
}

}  // namespace lapwing
