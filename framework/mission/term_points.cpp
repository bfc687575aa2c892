// SPDX-License-Identifier: Apache-2.0
// Whether the tape of a term says what its function says on plain numbers, and where it is tried.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <fstream>

#include "framework/core/number_text.h"
#include "framework/mission/term_recording.h"

namespace lapwing {

namespace {

constexpr int kPoints = 32;          // seeded
constexpr int kWholePoints = 8;      // of these, with whole numbers
constexpr double kAgreement = 1e-9;  // relative

}  // namespace

void TermRecording::begin_point(int point) {
  constexpr std::uint64_t kSeed = 32;
  symbolic_ = false;
  point_ = point;
  random_ = Random(kSeed).split(point);
  literal_.reset();
  guess_stage_ = -1;
  numbers_.clear();
  point_parameters_ = *parameters_.values;
  if (point < kPoints && point % 2 == 1)
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
  if (guess_stage_ >= 0) {
    const int column = std::min<int>(guess_stage_ + stage, static_cast<int>(guess_->cols()) - 1);
    for (int i = 0; i < spec.size; ++i) values[i] = (*guess_)(layout_.offset(block) + i, column);
    return values;
  }
  for (double& value : values)
    value = literal_                ? *literal_
            : point_ == 0           ? 0.0
            : point_ < kWholePoints ? static_cast<double>(random_.integer(-5, 5))
                                    : random_.uniform(-1, 1) * kScales[point_ % 3];
  if (spec.name == "time" && !literal_)
    values[0] = horizon.duration() * point_ / kPoints + stage * horizon.step;
  if (spec.name == "step" && !(literal_ && *literal_ > 0))
    values[0] = horizon.step * (point_ == 0 ? 1 : random_.uniform(0.5, 2));
  if (spec.topology == Topology::quaternion) {
    double squares = 0;
    for (const double value : values) squares += value * value;
    if (squares == 0) values[0] = squares = 1;
    for (double& value : values) value /= std::sqrt(squares);
  }
  return values;
}

std::string TermRecording::values_here() const {
  std::string text;
  for (const auto& [key, values] : numbers_) {
    text += (text.empty() ? "" : ", ") + layout_.block(key.second).name +
            (key.first ? "[" + std::to_string(key.first) + "]" : "") + " = ";
    for (std::size_t i = 0; i < values.size(); ++i)
      text += (i ? " " : values.size() > 1 ? "{" : "") + plain_number(values[i]);
    if (values.size() > 1) text += "}";
  }
  return text;
}

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
  for (const double value : point_parameters_) add(value);
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

void TermRecording::check(int function, const TapeFunction& result, const Eigen::MatrixXd& guess) {
  constexpr int kGuessed = 16;
  function = lua_absindex(state_, function);
  const Origin place = place_of_function(state_, function);
  std::vector<bool> finite(result.tape->rows(), false);
  guess_ = &guess;
  int tried = 0;
  const auto try_it = [&] { check_point(place, result, call(function), finite); };
  while (tried < kPoints) {
    begin_point(tried++);
    try_it();
  }
  for (const double literal : literals(function)) {
    begin_point(tried++);
    literal_ = literal;
    try_it();
  }
  const int last = std::max(0, static_cast<int>(guess.cols()) - result.window);
  for (int k = 0; k < kGuessed; ++k) {
    begin_point(tried++);
    guess_stage_ = last * k / (kGuessed - 1);
    try_it();
  }
  const auto never = std::find(finite.begin(), finite.end(), false);
  if (never != finite.end())
    throw InputError(place,
                     setting_.what + ": result " + std::to_string(never - finite.begin() + 1) +
                         " is not a finite number at any of " + std::to_string(tried) +
                         " points tried, the first guess among them, such as " + values_here());
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
      decides("on plain numbers result " + std::to_string(r + 1) + " is " + plain_number(plain) +
              ", as recorded " + plain_number(values[r]));
  }
}

}  // namespace lapwing
