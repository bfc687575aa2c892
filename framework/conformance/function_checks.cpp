// SPDX-License-Identifier: Apache-2.0
#include "framework/conformance/function_checks.h"

#include <cmath>

#include "framework/conformance/function_check.h"
#include "framework/conformance/sample_parameters.h"

namespace lapwing {
namespace {

// What the kernel relies on before the first evaluation.
bool shape_fits(const FunctionShape& shape, const StandardSetting& standard, Findings& findings) {
  const auto need = [&](bool ok, const std::string& message) {
    findings.expect("shape", ok, [&] { return message; });
    return ok;
  };
  bool blocks = !shape.blocks.empty();
  for (const int b : shape.blocks) blocks &= b >= 0 && b < standard.layout.count();
  bool fits = need(blocks, "reads no block, or one that does not exist");
  fits &= need(shape.rows >= 1, "returns no rows");
  fits &= need(shape.window >= 1 && shape.window <= standard.horizon.stages,
               "a window of " + std::to_string(shape.window) + " stages");
  fits &= need(shape.times.empty() || (shape.window == 1 && shape.stages.empty()),
               "given times need a window of one stage and no list of stages");
  fits &= need(shape.row_names.empty() || static_cast<int>(shape.row_names.size()) == shape.rows,
               "names another number of rows than it returns");
  for (const int stage : shape.stages)
    fits &= need(stage >= 0 && stage + shape.window <= standard.horizon.stages,
                 "asks for a stage outside the horizon");
  for (const double time : shape.times)
    fits &= need(std::isfinite(time), "asks for a time that is not a number");
  return fits;
}

struct Trial {
  const StandardSetting& standard;
  std::string description;
  bool strewn = false;  // a few instances of many
};

class EveryBinding {
 public:
  EveryBinding(const FunctionSubject& subject, const CheckOptions& options, Findings& findings,
               const std::function<void(const BoundSubject&)>& also)
      : subject_(subject), options_(options), findings_(findings), also_(also) {}

  void run(const Trial& trial) {
    for (const ParameterCase& given : parameter_cases(subject_.parameters, trial.standard)) {
      if (findings_.settled()) break;
      findings_.set_case(given.description + trial.description);
      try {
        const std::unique_ptr<StageFunction> function = subject_.create(given.parameters);
        const FunctionShape shape = function->bind(trial.standard.setting());
        findings_.expect("creation", function != nullptr, [] { return "creates nothing"; });
        // A case may leave nothing to ask: a cut over all stages.
        if (shape.rows == 0 && !given.must_work) continue;
        if (!shape_fits(shape, trial.standard, findings_)) continue;
        const BoundSubject bound{*function, shape, trial.standard,
                                 instances_of(shape, trial.standard.horizon).times,
                                 subject_.constraint};
        findings_.survives("exceptions", "an evaluation", [&] { check(bound, trial); });
      } catch (const InputError& error) {
        const bool said = std::string(error.what()).size() > 10;
        findings_.expect("creation", !given.must_work && said, [&] {
          return said ? std::string("refused: ") + error.what() : "refused without a reason";
        });
      } catch (const std::exception& error) {
        findings_.fail("creation", std::string("throws: ") + error.what());
      }
    }
    findings_.set_case("");
  }

  // What it reads and never uses is likely a slip, and no mistake.
  void judge_pattern() const {
    if (!options_.wants("pattern") || dependence_.empty()) return;
    std::string idle;
    for (const auto& [name, depends] : dependence_)
      if (!depends) idle += (idle.empty() ? "" : ", ") + name;
    findings_.expect("pattern", true, {});
    if (!idle.empty())
      findings_.warn("pattern",
                     "it reads " + idle + ", and no result depends on it in any case tried");
  }

 private:
  void check(const BoundSubject& bound, const Trial& trial) {
    if (!options_.wants_answers()) return;
    FunctionCheck checked(bound, options_, findings_, dependence_);
    if (trial.strewn) return checked.run_strewn();
    checked.run();
    if (options_.wants("invariance"))
      check_invariance(bound, subject_.declares, options_.seed, findings_);
    also_(bound);
  }

  const FunctionSubject& subject_;
  const CheckOptions& options_;
  Findings& findings_;
  const std::function<void(const BoundSubject&)>& also_;
  Dependence dependence_;
};

}  // namespace

void check_stage_function(const FunctionSubject& subject, const CheckOptions& options,
                          Findings& findings,
                          const std::function<void(const BoundSubject&)>& also) {
  EveryBinding every(subject, options, findings, also);
  for (const bool step_free : {false, true})
    every.run({StandardSetting(step_free), step_free ? ", free step" : ""});
  if (options.wants_any({"creation", "values", "derivatives", "curvature", "ranges"}))
    every.run({StandardSetting::long_flight(), ", a flight of 600 s", true});
  every.judge_pattern();
}

}  // namespace lapwing
