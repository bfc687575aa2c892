#include "framework/mission/term_recording.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "framework/core/parameters.h"
#include "framework/mission/guard.h"

namespace lapwing {

namespace {

constexpr const char* kRecordingKey = "lapwing.term_recording";
constexpr int kPoints = 32;
constexpr int kWholePoints = 8;      // of these, with whole numbers
constexpr double kAgreement = 1e-9;  // relative

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

std::string short_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
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

void TermRecording::begin_point(int point) {
  constexpr std::uint64_t kSeed = 32;
  symbolic_ = false;
  point_ = point;
  random_ = Random(kSeed).split(point);
  numbers_.clear();
  point_parameters_ = *parameters_.values;
  if (point % 2 == 1)
    for (double& value : point_parameters_) value += random_.uniform(-0.5, 0.5) * (1 + value);
}

const std::vector<double>& TermRecording::numbers(int stage, int block) {
  const auto [place, fresh] = numbers_.try_emplace({stage, block});
  std::vector<double>& values = place->second;
  if (!fresh) return values;
  constexpr double kScales[] = {1, 10, 100};
  const BlockSpec& spec = layout_.block(block);
  const Horizon& horizon = problem_.horizon();
  values.resize(spec.size);
  for (double& value : values)
    value = point_ == 0             ? 0.0
            : point_ < kWholePoints ? static_cast<double>(random_.integer(-5, 5))
                                    : random_.uniform(-1, 1) * kScales[point_ % 3];
  if (spec.name == "time") values[0] = horizon.duration() * point_ / kPoints + stage * horizon.step;
  if (spec.name == "step") values[0] = horizon.step * (point_ == 0 ? 1 : random_.uniform(0.5, 2));
  if (spec.topology == Topology::quaternion) {
    double squares = 0;
    for (const double value : values) squares += value * value;
    if (squares == 0) values[0] = squares = 1;
    for (double& value : values) value /= std::sqrt(squares);
  }
  return values;
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

Origin TermRecording::place_of(int function) const {
  lua_Debug record;
  lua_pushvalue(state_, function);
  lua_getinfo(state_, ">S", &record);
  if (record.source[0] != '@') return {};
  return {record.source + 1, record.linedefined};
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
  lua_call(state_, 2, LUA_MULTRET);
  SymbolicEntries rows;
  const int results = lua_gettop(state_) - top;
  try {
    if (results == 0) throw InputError("the function returns nothing; expected numbers or vectors");
    for (int i = 1; i <= results; ++i) collect(top + i, 0, rows);
  } catch (const InputError& error) {
    throw InputError(place_of(function), setting_.what + ": " + error.what());
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
      throw InputError(place_of(function),
                       setting_.what + ": returns no finite number whatever the stage is");
    outputs.push_back(symbolic_node(setting_, row));
  }
  int width = 0;
  list_inputs(result, places, width);
  const bool free = problem_.horizon().step_free;
  result.affine = setting_.graph.affine(outputs, [&](int input) {
    return layout_.block(inputs_[input].block).role == BlockRole::clock && !free;
  });
  result.tape = std::make_shared<const Tape>(setting_.graph, outputs, places, width);
  compare(function, result);
}

// ---- whether it decides -------------------------------------------------------------------------

std::string TermRecording::values_here() const {
  std::string text;
  for (const auto& [key, values] : numbers_) {
    text += (text.empty() ? "" : ", ") + layout_.block(key.second).name +
            (key.first ? "[" + std::to_string(key.first) + "]" : "") + " = ";
    for (std::size_t i = 0; i < values.size(); ++i)
      text += (i ? " " : values.size() > 1 ? "{" : "") + short_number(values[i]);
    if (values.size() > 1) text += "}";
  }
  return text;
}

void TermRecording::compare(int function, const TapeFunction& result) {
  const Origin place = place_of(function);
  std::vector<bool> finite(result.tape->rows(), false);
  setting_.serial = next_serial();  // what was kept from the recording is not taken
  for (int point = 0; point < kPoints; ++point) {
    begin_point(point);
    check_point(place, result, call(function), finite);
  }
  const auto never = std::find(finite.begin(), finite.end(), false);
  if (never != finite.end())
    throw InputError(place, setting_.what + ": result " +
                                std::to_string(never - finite.begin() + 1) +
                                " is no finite number at any of " + std::to_string(kPoints) +
                                " points tried, such as " + values_here());
}

void TermRecording::check_point(const Origin& place, const TapeFunction& result,
                                const SymbolicEntries& rows, std::vector<bool>& finite) {
  const auto decides = [&](const std::string& difference) {
    throw InputError(
        place, setting_.what + ": " + difference + ", where " + values_here() +
                   ": the function decides by a value (if, ==, and, or), which is done once, while "
                   "it is recorded, or depends on something that changes from call to call; use "
                   "lapwing.where(x, a, b), which is a where x > 0 and b elsewhere");
  };
  const Tape& tape = *result.tape;
  if (static_cast<int>(rows.size()) != tape.rows())
    decides("on plain numbers it returns " + std::to_string(rows.size()) + " numbers, on a stage " +
            std::to_string(tape.rows()));
  std::vector<double> inputs, values(tape.rows());
  for (int stage = 0; stage < result.window; ++stage)
    for (const std::string& name : result.blocks) {
      const std::vector<double>& block = numbers(stage, layout_.index(name));
      inputs.insert(inputs.end(), block.begin(), block.end());
    }
  Workspace workspace;
  tape.evaluate(1, inputs.data(), point_parameters_.data(), values.data(), nullptr, workspace);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (!rows[r].known()) decides("on plain numbers it returns a formula");
    const double plain = rows[r].value;
    // (-1) ^ 2 is a number, as a formula with a varying exponent it is none.
    if (!std::isfinite(plain) || !std::isfinite(values[r])) continue;
    finite[r] = true;
    if (!(std::abs(plain - values[r]) <= kAgreement * (1 + std::abs(plain))))
      decides("on plain numbers result " + std::to_string(r + 1) + " is " + short_number(plain) +
              ", as recorded " + short_number(values[r]));
  }
}

}  // namespace lapwing
