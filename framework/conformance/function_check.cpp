// SPDX-License-Identifier: Apache-2.0
#include "framework/conformance/function_check.h"

#include <cmath>

namespace lapwing {
namespace {

constexpr double kFirst = 1e-6, kSecond = 1e-5;  // relative, of derivatives against differences
constexpr double kRounding = 1e-12;
constexpr int kScreens = 48;          // inputs of every instance that are tried along a direction
constexpr int kCurvatureScreens = 8;  // of those, how many for second derivatives too

bool all_finite(const std::vector<double>& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
}

}  // namespace

FunctionCheck::FunctionCheck(const BoundSubject& subject, const CheckOptions& options,
                             Findings& findings, Dependence& dependence)
    : subject_(subject),
      options_(options),
      findings_(findings),
      dependence_(dependence),
      random_(options.seed),
      places_(input_places(subject.shape, subject.standard.layout)),
      n_(static_cast<int>(places_.size())),
      m_(subject.shape.rows) {}

void FunctionCheck::run() {
  const bool derived = wants("derivatives"), curved = wants("curvature") && !subject_.shape.affine;
  for (const InputKind kind :
       {InputKind::random, InputKind::random, InputKind::random, InputKind::far}) {
    const std::vector<double> x = inputs(kind);
    if (wants("values") || wants("pattern")) values(x);
    for (int k = 0; k < subject_.count() && (derived || curved); ++k) {
      const std::vector<double> at(x.begin() + k * n_, x.begin() + (k + 1) * n_);
      if (derived) derivatives_at(k, at);
      if (curved) curvature_at(k, at);
    }
    if (wants("ranges")) ranges(x, 0, subject_.count());
  }
  if (wants("values") || derived || curved) screen();
  if (wants("degenerate input")) degenerate();
  const std::vector<double> x = inputs(InputKind::random);
  if (wants("repeatable")) repeatable(x);
  if (wants("threads")) threads();
  if (wants("allocations")) allocations();
  if (subject_.shape.affine && wants("affine")) affine();
  if (subject_.shape.identity && wants("identity")) identity(x);
}

void FunctionCheck::run_strewn() {
  constexpr int kStrewn = 12;
  const int count = subject_.count();
  for (int i = 0; i < std::min(kStrewn, count); ++i) {
    // The first, the last, and others by chance.
    const int k = i == 0 ? 0 : i == 1 ? count - 1 : static_cast<int>(random_.integer(0, count - 1));
    for (const InputKind kind : {InputKind::random, InputKind::far}) {
      const std::vector<double> at = inputs_of(k, kind);
      if (i < 4) {
        if (wants("derivatives")) derivatives_at(k, at);
        if (wants("curvature") && !subject_.shape.affine) curvature_at(k, at);
      }
      if (wants("values") || wants("derivatives") || wants("curvature")) screen_at(k, at, i < 6);
    }
    if (wants("ranges") && k + 1 < count) {
      std::vector<double> two = inputs_of(k, InputKind::random);
      const std::vector<double> next = inputs_of(k + 1, InputKind::far);
      two.insert(two.end(), next.begin(), next.end());
      ranges(two, k, 2);
    }
  }
}

std::vector<double> FunctionCheck::multipliers(int count) const {
  std::vector<double> result(static_cast<std::size_t>(count) * m_);
  for (std::size_t k = 0; k < result.size(); ++k) result[k] = std::sin(1.0 + 2.0 * k);
  return result;
}

FunctionCheck::Answer FunctionCheck::ask(InstanceRange range, const double* x,
                                         Workspace& workspace) const {
  const std::size_t count = range.count;
  Answer answer{std::vector<double>(count * m_, kUntouched),
                std::vector<double>(count * m_ * n_, kUntouched),
                std::vector<double>(count * n_ * n_, 0.0)};
  call(range, x, multipliers(range.count).data(), answer, workspace);
  return answer;
}

FunctionCheck::Answer FunctionCheck::ask_all(const std::vector<double>& x) const {
  Workspace workspace;
  return ask({0, subject_.count()}, x.data(), workspace);
}

void FunctionCheck::call(InstanceRange range, const double* x, const double* lambda, Answer& answer,
                         Workspace& workspace) const {
  subject_.function.evaluate(range, x, answer.values.data(), answer.jacobian.data(), workspace);
  if (!subject_.shape.affine)
    subject_.function.curvature(range, x, lambda, answer.curvature.data(), workspace);
}

std::string FunctionCheck::component_text(const InputPlace& place) const {
  const BlockSpec& block = subject_.standard.layout.block(place.block);
  return block.size == 1 ? block.name : block.name + "[" + std::to_string(place.component) + "]";
}

std::string FunctionCheck::input_name(int input) const {
  const InputPlace& place = places_[input];
  return component_text(place) + " of stage " + std::to_string(place.stage) + " of the window";
}

std::string FunctionCheck::row_name(int row) const {
  const auto& names = subject_.shape.row_names;
  return names.empty() ? "row " + std::to_string(row) : "row '" + names[row] + "'";
}

std::string FunctionCheck::instance_name(int k) const {
  return "instance " + std::to_string(k) + " at " + text_of(subject_.times[k]) + " s";
}

bool FunctionCheck::constant(int block) const {
  return subject_.standard.layout.block(block).role == BlockRole::clock &&
         !subject_.standard.horizon.step_free;
}

void FunctionCheck::values(const std::vector<double>& x) {
  const Answer answer = ask_all(x);
  note_dependence(answer);
  Workspace workspace;
  std::vector<double> alone(answer.values.size(), kUntouched);
  subject_.function.evaluate({0, subject_.count()}, x.data(), alone.data(), nullptr, workspace);
  for (int k = 0; k < subject_.count(); ++k)
    for (int r = 0; r < m_; ++r) {
      const double value = answer.values[k * m_ + r], without = alone[k * m_ + r];
      const auto at = [&] { return row_name(r) + " of " + instance_name(k); };
      findings_.expect("values", std::isfinite(value) && value != kUntouched,
                       [&] { return at() + " is " + text_of(value); });
      const bool same =
          std::abs(value - without) <= kRounding * std::max(std::abs(value), std::abs(without));
      findings_.expect("values", same || std::isnan(value), [&] {
        return at() + " is " + text_of(without) + ", but " + text_of(value) +
               " when derivatives are asked too";
      });
    }
}

// A clock is exempt: whether it counts depends on the horizon.
void FunctionCheck::note_dependence(const Answer& answer) {
  for (std::size_t e = 0; e < answer.jacobian.size(); ++e) {
    const InputPlace& place = places_[e % n_];
    if (subject_.standard.layout.block(place.block).role == BlockRole::clock) continue;
    dependence_[component_text(place)] |= answer.jacobian[e] != 0;
  }
}

bool FunctionCheck::written(const char* check, const std::vector<double>& numbers, int k) {
  bool fine = all_finite(numbers);
  for (const double x : numbers) fine &= x != kUntouched;
  findings_.expect(check, fine, [&] {
    return "an entry is not finite, or was never written, in " + instance_name(k);
  });
  return fine;
}

void FunctionCheck::derivatives_at(int k, const std::vector<double>& at) {
  Workspace workspace;
  std::vector<double> values(m_), jacobian(m_ * n_, kUntouched);
  subject_.function.evaluate({k, 1}, at.data(), values.data(), jacobian.data(), workspace);
  if (!written("derivatives", jacobian, k)) return;
  const Eigen::Map<const RowMajorMatrix> stated(jacobian.data(), m_, n_);
  const auto function = [&](const double* inputs, double* result) {
    subject_.function.evaluate({k, 1}, inputs, result, nullptr, workspace);
  };
  const WorstEntry worst = compare_derivatives(function, at, stated, kFirst);
  findings_.expect("derivatives", worst.excess <= 1, [&] {
    return "d " + row_name(worst.row) + " / d " + input_name(worst.column) + ", " +
           instance_name(k) + ": says " + text_of(worst.stated) + ", differences give " +
           text_of(worst.expected);
  });
}

void FunctionCheck::curvature_at(int k, const std::vector<double>& at) {
  const std::vector<double> lambda = multipliers(1);
  Workspace workspace;
  // It must be added to, and what was there must not drown what is added.
  RowMajorMatrix zero = RowMajorMatrix::Zero(n_, n_);
  RowMajorMatrix stated = RowMajorMatrix::Constant(n_, n_, 0.5);
  subject_.function.curvature({k, 1}, at.data(), lambda.data(), zero.data(), workspace);
  subject_.function.curvature({k, 1}, at.data(), lambda.data(), stated.data(), workspace);
  if (!stated.allFinite())
    return findings_.fail("curvature", "an entry is not finite in " + instance_name(k));
  const double added = ((stated.array() - 0.5).matrix() - zero).cwiseAbs().maxCoeff();
  findings_.expect("curvature", added <= 1e-9 * (1 + zero.cwiseAbs().maxCoeff()), [&] {
    return "must add to what is there, and does not in " + instance_name(k);
  });
  std::vector<double> values(m_);
  RowMajorMatrix jacobian(m_, n_);
  const auto slope = [&](const double* inputs, double* result) {
    subject_.function.evaluate({k, 1}, inputs, values.data(), jacobian.data(), workspace);
    Eigen::Map<Eigen::VectorXd>(result, n_) =
        jacobian.transpose() * Eigen::Map<const Eigen::VectorXd>(lambda.data(), m_);
  };
  const WorstEntry worst = compare_derivatives(slope, at, zero, kSecond);
  findings_.expect("curvature", worst.excess <= 1, [&] {
    return "d2 / d " + input_name(worst.row) + " d " + input_name(worst.column) + ", " +
           instance_name(k) + ": says " + text_of(worst.stated) + ", differences give " +
           text_of(worst.expected);
  });
}

void FunctionCheck::screen() {
  for (int turn = 0; turn < kScreens; ++turn)
    for (int k = 0; k < subject_.count(); ++k)
      screen_at(k, inputs_of(k, turn % 3 == 2 ? InputKind::far : InputKind::random),
                turn < kCurvatureScreens);
}

void FunctionCheck::screen_at(int k, const std::vector<double>& at, bool curvature_too) {
  Workspace workspace;
  std::vector<double> values(m_, kUntouched), direction(n_);
  RowMajorMatrix jacobian = RowMajorMatrix::Constant(m_, n_, kUntouched);
  const auto function = [&](const double* inputs, double* result) {
    subject_.function.evaluate({k, 1}, inputs, result, nullptr, workspace);
  };
  if (!wants("derivatives") && wants("values")) {
    function(at.data(), values.data());
  } else {
    subject_.function.evaluate({k, 1}, at.data(), values.data(), jacobian.data(), workspace);
  }
  for (int r = 0; r < m_; ++r)
    findings_.expect("values", std::isfinite(values[r]), [&] {
      return row_name(r) + " of " + instance_name(k) + " is " + text_of(values[r]);
    });
  for (double& d : direction) d = random_.uniform(0.5, 1) * (random_.uniform() < 0.5 ? -1 : 1);
  if (wants("derivatives") &&
      (!jacobian.allFinite() || !agrees_along(function, at, direction, jacobian, kFirst)))
    derivatives_at(k, at);
  if (!curvature_too || !wants("curvature") || subject_.shape.affine) return;
  const std::vector<double> lambda = multipliers(1);
  RowMajorMatrix hessian = RowMajorMatrix::Zero(n_, n_);
  subject_.function.curvature({k, 1}, at.data(), lambda.data(), hessian.data(), workspace);
  const auto slope = [&](const double* inputs, double* result) {
    subject_.function.evaluate({k, 1}, inputs, values.data(), jacobian.data(), workspace);
    Eigen::Map<Eigen::VectorXd>(result, n_) =
        jacobian.transpose() * Eigen::Map<const Eigen::VectorXd>(lambda.data(), m_);
  };
  if (!hessian.allFinite() || !agrees_along(slope, at, direction, hessian, kSecond))
    curvature_at(k, at);
}

}  // namespace lapwing
