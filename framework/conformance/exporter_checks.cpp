// SPDX-License-Identifier: Apache-2.0
// What every exporter must pass.
#include "framework/conformance/every_case.h"
#include "framework/export/exporter.h"

namespace lapwing {
namespace {

// A hop of eleven samples.
Plan small_plan() {
  Plan plan;
  plan.mission = "hop";
  plan.kind = "film";
  for (int i = 0; i <= 10; ++i) {
    Sample sample;
    sample.time = 0.1 * i;
    sample.position = {0.5 * i, -0.1 * i, 2 + 0.01 * i * (10 - i)};
    sample.yaw = 0.05 * i;
    plan.trajectory.samples.push_back(sample);
  }
  return plan;
}

void check_writing(const Exporter& exporter, Findings& findings) {
  const std::string ending = exporter.file_extension();
  findings.expect("extension", ending.empty() || (ending.size() > 1 && ending[0] == '.'),
                  [&] { return "the extension '" + ending + "' does not begin with a dot"; });
  for (const bool empty : {false, true}) {
    Plan plan = small_plan();
    if (empty) plan.trajectory.samples.clear();
    std::string first;
    try {
      first = exporter.write(plan);
      findings.expect("repeatable", exporter.write(plan) == first,
                      [] { return "equal plans give other bytes"; });
      findings.expect("contents", empty || !first.empty(),
                      [] { return "it writes an empty file for a plan that has samples"; });
    } catch (const InputError& error) {  // it may say what it lacks
      findings.expect("contents", std::string(error.what()).size() > 10,
                      [] { return "it refuses a plan without a reason"; });
    }
  }
}

}  // namespace

std::vector<CheckResult> check_exporter(const Specimen<Exporter>& subject,
                                        const CheckOptions& options) {
  return check_every_case(subject, options, "writing a plan",
                          [](const Exporter& exporter, Findings& findings, bool) {
                            check_writing(exporter, findings);
                          });
}

}  // namespace lapwing
