// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/term_recording.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <fstream>

#include "framework/core/parameters.h"
#include "framework/mission/guard.h"

namespace lapwing {

namespace {

constexpr const char* kRecordingKey = "lapwing.term_recording";

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

TermRecording::TermRecording(lua_State* state, TermFormula& formula)
    : state_(state), formula_(formula), point_(formula) {
  set_symbolic_setting(state, &formula.setting());
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
  if (symbolic_ || formula_.known_step(block)) return formula_.read(stage, block);
  SymbolicEntries entries;
  for (const double value : point_.numbers(stage, block)) entries.push_back({.value = value});
  return entries;
}

void TermRecording::push_parameters() {
  lua_newtable(state_);
  for (const TermParameter& parameter : formula_.parameters().list) {
    SymbolicEntries entries(parameter.size);
    if (symbolic_)
      entries = formula_.read(parameter);
    else
      for (int i = 0; i < parameter.size; ++i)
        entries[i].value = point_.parameters()[parameter.first + i];
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
  if (text.find(formula_.setting().what) == text.npos) {
    const std::size_t place = text.find(".lua:");
    const std::size_t after = place == text.npos ? text.npos : text.find(": ", place);
    const std::string remedy = remedy_for(state_, text);
    text.insert(after == text.npos ? 0 : after + 2, formula_.setting().what + ": ");
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
  push_stage(state_, 0, formula_.setting().serial);
  push_parameters();
  if (lua_pcall(state_, 2, LUA_MULTRET, 0) != LUA_OK) raise(lua_gettop(state_));
  SymbolicEntries rows;
  const int results = lua_gettop(state_) - top;
  try {
    if (results == 0) throw InputError("the function returns nothing; expected numbers or vectors");
    for (int i = 1; i <= results; ++i) collect(top + i, 0, rows);
  } catch (const InputError& error) {
    throw InputError(place_of_function(state_, function),
                     formula_.setting().what + ": " + error.what());
  }
  lua_settop(state_, top);
  return rows;
}

SymbolicEntries TermRecording::record(int function) {
  symbolic_ = true;
  return call(lua_absindex(state_, function));
}

// ---- whether the tape says the same -------------------------------------------------------------

// Numbers that a function may compare with: whole ones near 0, those in the lines it is written in,
// those that it was made with, and its parameters.
std::vector<double> TermRecording::literals(int function) const {
  constexpr std::size_t kMostLiterals = 64;
  constexpr double kLargest = 1000;  // where rounding is no difference yet
  std::vector<double> found;
  const auto add = [&](double value) {
    if (found.size() < kMostLiterals && std::abs(value) <= kLargest &&
        std::find(found.begin(), found.end(), value) == found.end())
      found.push_back(value);
  };
  for (int whole = -5; whole <= 5; ++whole) add(whole);
  for (const double value : point_.parameters()) add(value);
  for (int i = 1; lua_getupvalue(state_, function, i); ++i) {
    if (lua_type(state_, -1) == LUA_TNUMBER) add(lua_tonumber(state_, -1));
    lua_pop(state_, 1);
  }
  lua_Debug record;
  lua_pushvalue(state_, function);
  lua_getinfo(state_, ">S", &record);
  std::ifstream file(record.source[0] == '@' ? record.source + 1 : "");
  std::string line;
  for (int number = 1; number <= record.lastlinedefined && std::getline(file, line); ++number)
    if (number >= record.linedefined)
      for (const char* at = line.c_str(); *at;) {
        char* end = nullptr;
        const double value =
            std::isdigit(static_cast<unsigned char>(*at)) ? std::strtod(at, &end) : 0.0;
        if (end) add(value), add(-value);
        at = end ? end : at + 1;
      }
  return found;
}

void TermRecording::compare(int function, const TapeFunction& result, std::vector<bool>& finite) {
  symbolic_ = false;
  const SymbolicEntries rows = call(function);
  const std::string difference = difference_at(point_, formula_, result, rows, finite);
  if (difference.empty()) return;
  throw InputError(
      place_of_function(state_, function),
      formula_.setting().what + ": " + difference + ", where " + point_.text() +
          ": the function decides by a value (if, ==, and, or), which is done once, while it is "
          "recorded, or depends on something that changes from call to call; use "
          "lapwing.where(x, a, b), which is a where x > 0 and b elsewhere");
}

void TermRecording::check(int function, const TapeFunction& result, const Eigen::MatrixXd& guess) {
  constexpr int kGuessed = 16;
  function = lua_absindex(state_, function);
  std::vector<bool> finite(result.tape->rows(), false);
  int tried = 0;
  while (tried < TrialPoint::kSeeded) {
    point_.begin(tried++);
    compare(function, result, finite);
  }
  for (const double literal : literals(function)) {
    point_.begin(tried++, literal);
    compare(function, result, finite);
  }
  const int last = std::max(0, static_cast<int>(guess.cols()) - result.window);
  for (int k = 0; k < kGuessed; ++k) {
    point_.begin(tried++, guess, last * k / (kGuessed - 1));
    compare(function, result, finite);
  }
  const auto never = std::find(finite.begin(), finite.end(), false);
  if (never != finite.end())
    throw InputError(place_of_function(state_, function),
                     formula_.setting().what + ": result " +
                         std::to_string(never - finite.begin() + 1) +
                         " is not a finite number at any of " + std::to_string(tried) +
                         " points tried, the first guess among them, such as " + point_.text());
}

}  // namespace lapwing
