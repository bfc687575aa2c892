// SPDX-License-Identifier: Apache-2.0
// A plugin tried with every case of its parameters. Internal to the room.
#pragma once

#include "framework/conformance/findings.h"
#include "framework/conformance/sample_parameters.h"
#include "framework/conformance/standard_setting.h"
#include "framework/core/error.h"

namespace lapwing {

// Creates the subject for every case and calls `check(plugin, parameters, findings, first)`;
// `first`: with its defaults. What it throws in creation or check becomes a finding; `what` names
// the check's call.
template <class Kind, class Check>
std::vector<CheckResult> check_with_every_case(const Specimen<Kind>& subject,
                                               const CheckOptions& options, const std::string& what,
                                               const Check& check) {
  Findings findings(options);
  const StandardSetting standard(false);
  bool first = true;
  for (const ParameterCase& parameter_case : parameter_cases(subject.parameters, standard)) {
    if (findings.settled()) break;
    findings.set_case(parameter_case.description);
    try {
      const std::unique_ptr<Kind> plugin = subject.create(parameter_case.parameters);
      findings.expect("creation", true, {});
      if (options.wants_answers())
        findings.survives("exceptions", what,
                          [&] { check(*plugin, parameter_case.parameters, findings, first); });
    } catch (const InputError& error) {
      findings.expect("creation", !parameter_case.must_work,
                      [&] { return std::string("refused: ") + error.what(); });
    } catch (const std::exception& error) {
      findings.fail("creation", std::string("throws: ") + error.what());
    }
    first = false;
  }
  findings.set_case("");
  return std::move(findings).results();
}

// The same for checks that need the plugin alone: `check(plugin, findings, first)`.
template <class Kind, class Check>
std::vector<CheckResult> check_every_case(const Specimen<Kind>& subject,
                                          const CheckOptions& options, const std::string& what,
                                          const Check& check) {
  return check_with_every_case(subject, options, what,
                               [&](Kind& plugin, const Value&, Findings& findings, bool first) {
                                 check(plugin, findings, first);
                               });
}

}  // namespace lapwing
