// SPDX-License-Identifier: Apache-2.0
// How a function may be called: in ranges, again, from several threads, without allocating.
#include <cmath>
#include <thread>

#include "framework/conformance/function_check.h"

namespace lapwing {
namespace {

constexpr double kSame = 1e-12;  // relative
constexpr int kThreads = 4;
constexpr int kDraws = 5;  // fresh inputs each

bool nearly(double a, double b) {
  return std::abs(a - b) <= kSame * std::max(std::abs(a), std::abs(b)) ||
         (std::isnan(a) && std::isnan(b));
}

bool every_finite(const std::vector<double>& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
}

}  // namespace

// A range answers as its instances do one by one.
void FunctionCheck::ranges(const std::vector<double>& x, int first, int count) {
  Workspace workspace;
  const Answer whole = ask({first, count}, x.data(), workspace);
  for (int k = 0; k < count; ++k) {
    const Answer one = ask({first + k, 1}, x.data() + k * n_, workspace);
    bool same = true;
    for (int r = 0; r < m_; ++r) same &= nearly(one.values[r], whole.values[k * m_ + r]);
    for (int e = 0; e < m_ * n_; ++e)
      same &= nearly(one.jacobian[e], whole.jacobian[k * m_ * n_ + e]);
    findings_.expect("ranges", same, [&] {
      return instance_name(first + k) + " alone differs from the same in a range of " +
             std::to_string(count);
    });
  }
}

void FunctionCheck::degenerate() {
  for (const auto& [kind, text] : {std::pair{InputKind::zero, "all inputs zero"},
                                   {InputKind::coincident, "all stages equal"}}) {
    const Answer answer = ask_all(inputs(kind));
    const bool finite = every_finite(answer.values) && every_finite(answer.jacobian) &&
                        every_finite(answer.curvature);
    findings_.expect("degenerate input", finite, [&, what = text] {
      return std::string("a value or derivative is not finite with ") + what;
    });
  }
}

void FunctionCheck::repeatable(const std::vector<double>& x) {
  const Answer first = ask_all(x);
  findings_.expect("repeatable", first == ask_all(x),
                   [] { return "the same inputs give two answers"; });
}

// Every thread asks about inputs that nobody asked before, so that what a function keeps is written
// while others read it; what is right is asked afterwards, by one thread alone.
void FunctionCheck::threads() {
  struct Asked {
    std::vector<std::vector<double>> inputs;
    std::vector<Answer> answers;
    bool whole = false;
  };
  const std::vector<double> common = inputs(InputKind::random);
  std::vector<Asked> asked(kThreads);
  for (Asked& own : asked) {
    for (int draw = 0; draw < kDraws; ++draw) own.inputs.push_back(inputs(InputKind::random));
    for (int turn = 0; turn < 15; ++turn) own.inputs.push_back(common);
  }
  std::vector<std::thread> running;
  for (Asked& own : asked)
    running.emplace_back([this, &own] {
      try {
        Workspace workspace;
        for (const std::vector<double>& x : own.inputs)
          own.answers.push_back(ask({0, subject_.count()}, x.data(), workspace));
        own.whole = true;
      } catch (...) {  // said below
      }
    });
  for (std::thread& thread : running) thread.join();
  bool same = true;
  for (const Asked& own : asked) {
    same &= own.whole;
    for (std::size_t i = 0; i < own.answers.size(); ++i)
      same &= own.answers[i] == ask_all(own.inputs[i]);
  }
  findings_.expect("threads", same,
                   [] { return "four threads at once get other answers than one alone"; });
}

// The first call may grow the workspace; no call after it may allocate, whatever it asks.
void FunctionCheck::allocations() {
  if (!options_.allocations)
    return findings_.skip("allocations", "this program does not count them");
  Workspace workspace;
  const int count = subject_.count();
  const std::vector<double> x = inputs(InputKind::random);
  Answer answer = ask({0, count}, x.data(), workspace);
  const std::vector<double> lambda = multipliers(count);
  const auto made = [&](InstanceRange range, const double* at) {
    const std::int64_t before = options_.allocations();
    subject_.function.evaluate(range, at, answer.values.data(), nullptr, workspace);
    call(range, at, lambda.data(), answer, workspace);
    return options_.allocations() - before;
  };
  const auto expect_none = [&](std::int64_t number, const char* what) {
    findings_.expect("allocations", number == 0, [&] {
      return std::to_string(number) +
             " heap allocations in calls that come again and again: " + what;
    });
  };
  expect_none(made({0, count}, x.data()), "the same inputs twice");
  std::int64_t fresh = 0, single = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const InputKind kind = draw % 2 == 0 ? InputKind::random : InputKind::far;
    const std::vector<double> other = inputs(kind);
    fresh += made({0, count}, other.data());
    const std::vector<double> alone = inputs(kind);
    for (int k = 0; k < count; ++k) single += made({k, 1}, alone.data() + k * n_);
  }
  expect_none(fresh, "inputs that it was not asked before");
  expect_none(single, "one instance alone");
}

// A Jacobian that is the same wherever it is taken has no curvature.
void FunctionCheck::affine() {
  const Answer first = ask_all(inputs(InputKind::random));
  for (int point = 0; point < kDraws; ++point) {
    const Answer other = ask_all(inputs(point % 2 == 0 ? InputKind::random : InputKind::far));
    for (std::size_t e = 0; e < first.jacobian.size(); ++e) {
      if (constant(places_[e % n_].block)) continue;
      const double a = first.jacobian[e], b = other.jacobian[e];
      findings_.expect("affine", std::abs(a - b) <= 1e-9 * std::max(std::abs(a), std::abs(b)), [&] {
        return "declared affine, but its Jacobian changes by " + text_of(b - a) +
               " from point to point: by " + input_name(static_cast<int>(e) % n_);
      });
    }
  }
}

void FunctionCheck::identity(const std::vector<double>& x) {
  findings_.expect("identity", m_ == n_, [&] {
    return "declared an identity, but reads " + std::to_string(n_) + " numbers and returns " +
           std::to_string(m_);
  });
  if (m_ == n_)
    findings_.expect("identity", ask_all(x).values == x,
                     [] { return "declared an identity, but returns other numbers"; });
}

}  // namespace lapwing
