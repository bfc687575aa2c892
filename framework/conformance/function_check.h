// SPDX-License-Identifier: Apache-2.0
// One bound function under all checks of its derivatives and calls. Internal to the room.
#pragma once

#include "framework/conformance/differences.h"
#include "framework/conformance/function_checks.h"

namespace lapwing {

class FunctionCheck {
 public:
  FunctionCheck(const BoundSubject& subject, const CheckOptions& options, Findings& findings,
                Dependence& dependence);

  // On a short horizon, all instances.
  void run();
  // At instances strewn over a long one.
  void run_strewn();

 private:
  // What the function answers for a range of instances.
  struct Answer {
    std::vector<double> values, jacobian, curvature;
    bool operator==(const Answer&) const = default;
  };
  // Buffers start full of a number that no answer holds: what is not written shows.
  static constexpr double kUntouched = 1.2345678901234567e300;

  bool wants(const char* check) const { return options_.wants(check); }
  std::vector<double> inputs(InputKind kind) {
    return make_inputs(subject_.standard, subject_.shape, subject_.times, kind, random_);
  }
  std::vector<double> inputs_of(int instance, InputKind kind) {
    return make_inputs(subject_.standard, subject_.shape, {subject_.times[instance]}, kind,
                       random_);
  }
  std::vector<double> multipliers(int count) const;
  Answer ask(InstanceRange range, const double* x, Workspace& workspace) const;
  Answer ask_all(const std::vector<double>& x) const;
  // Calls that allocate nothing themselves.
  void call(InstanceRange range, const double* x, const double* lambda, Answer& answer,
            Workspace& workspace) const;
  std::string component_text(const InputPlace& place) const;
  std::string input_name(int input) const;
  std::string row_name(int row) const;
  std::string instance_name(int k) const;

  // function_check.cpp: values and derivatives at one instance.
  void values(const std::vector<double>& x);
  void derivatives_at(int k, const std::vector<double>& at);
  void curvature_at(int k, const std::vector<double>& at);
  // Many inputs, each tried along one direction.
  void screen();
  void screen_at(int k, const std::vector<double>& at, bool curvature_too);
  void note_dependence(const Answer& answer);
  bool written(const char* check, const std::vector<double>& numbers, int k);

  // function_calls.cpp: how it may be called.
  void ranges(const std::vector<double>& x, int first, int count);
  void degenerate();
  void repeatable(const std::vector<double>& x);
  void threads();
  void allocations();
  void affine();
  void identity(const std::vector<double>& x);

  // With a fixed step the clock stands still: nothing is differentiated by it.
  bool constant(int block) const;

  const BoundSubject& subject_;
  const CheckOptions& options_;
  Findings& findings_;
  Dependence& dependence_;
  Random random_;
  std::vector<InputPlace> places_;
  int n_, m_;
};

}  // namespace lapwing
