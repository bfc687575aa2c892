// SPDX-License-Identifier: Apache-2.0
#include "framework/symbolic/trial_point.h"

#include <cmath>

#include "framework/core/number_text.h"

namespace lapwing {

namespace {

constexpr int kWholePoints = 8;      // of the seeded ones, with whole numbers
constexpr double kAgreement = 1e-9;  // relative

}  // namespace

void TrialPoint::begin(int point) {
  constexpr std::uint64_t kSeed = 32;
  point_ = point;
  random_ = Random(kSeed).split(point);
  literal_.reset();
  guess_stage_ = -1;
  numbers_.clear();
  point_parameters_ = *formula_.parameters().values;
  if (point < kSeeded && point % 2 == 1)
    for (double& value : point_parameters_) value += random_.uniform(-0.5, 0.5) * (1 + value);
}

void TrialPoint::begin(int point, double literal) {
  begin(point);
  literal_ = literal;
}

void TrialPoint::begin(int point, const Eigen::MatrixXd& guess, int stage) {
  begin(point);
  guess_ = &guess;
  guess_stage_ = stage;
}

const std::vector<double>& TrialPoint::numbers(int stage, int block) {
  const auto [place, fresh] = numbers_.try_emplace({stage, block});
  std::vector<double>& values = place->second;
  if (!fresh) return values;
  constexpr double kScales[] = {1, 10, 100};
  const StageLayout& layout = formula_.layout();
  const BlockSpec& spec = layout.block(block);
  const Horizon& horizon = formula_.problem().horizon();
  values.resize(spec.size);
  if (guess_stage_ >= 0) {
    const int column = std::min<int>(guess_stage_ + stage, static_cast<int>(guess_->cols()) - 1);
    for (int i = 0; i < spec.size; ++i) values[i] = (*guess_)(layout.offset(block) + i, column);
    return values;
  }
  for (double& value : values)
    value = literal_                ? *literal_
            : point_ == 0           ? 0.0
            : point_ < kWholePoints ? static_cast<double>(random_.integer(-5, 5))
                                    : random_.uniform(-1, 1) * kScales[point_ % 3];
  if (spec.name == "time" && !literal_)
    values[0] = horizon.begin + horizon.duration() * point_ / kSeeded + stage * horizon.step;
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

std::string TrialPoint::text() const {
  std::string text;
  for (const auto& [key, values] : numbers_) {
    text += (text.empty() ? "" : ", ") + formula_.layout().block(key.second).name +
            (key.first ? "[" + std::to_string(key.first) + "]" : "") + " = ";
    for (std::size_t i = 0; i < values.size(); ++i)
      text += (i ? " " : values.size() > 1 ? "{" : "") + plain_number(values[i]);
    if (values.size() > 1) text += "}";
  }
  return text;
}

std::string difference_at(TrialPoint& point, const TermFormula& formula, const TapeFunction& term,
                          const SymbolicEntries& rows, std::vector<bool>& finite) {
  const Tape& tape = *term.tape;
  if (static_cast<int>(rows.size()) != tape.rows())
    return "on plain numbers it returns " + std::to_string(rows.size()) + " numbers, on a stage " +
           std::to_string(tape.rows());
  std::vector<double> inputs, values(tape.rows());
  for (int stage = 0; stage < term.window; ++stage)
    for (const std::string& name : term.blocks) {
      const std::vector<double>& block = point.numbers(stage, formula.layout().index(name));
      inputs.insert(inputs.end(), block.begin(), block.end());
    }
  Workspace workspace;
  tape.evaluate(1, inputs.data(), point.parameters().data(), values.data(), nullptr, workspace);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (!rows[r].known()) return "on plain numbers it returns a formula";
    const double plain = rows[r].value;
    // (-1) ^ 2 is a number, as a formula with a varying exponent it is none.
    if (!std::isfinite(plain) || !std::isfinite(values[r])) continue;
    finite[r] = true;
    if (!(std::abs(plain - values[r]) <= kAgreement * (1 + std::abs(plain))))
      return "on plain numbers result " + std::to_string(r + 1) + " is " + plain_number(plain) +
             ", as recorded " + plain_number(values[r]);
  }
  return "";
}

}  // namespace lapwing
