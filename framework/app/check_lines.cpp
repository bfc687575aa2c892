// SPDX-License-Identifier: Apache-2.0
#include "framework/app/check_lines.h"

#include <cstdio>

#include "framework/app/terminal.h"
#include "framework/core/visible_text.h"

namespace lapwing {

void print_check(const Check& check) {
  const bool made = check.skipped.empty();
  std::string verdict = !made ? "skipped" : check.pass ? "pass   " : "FAIL   ";
  verdict = tinted(!made ? Tone::faint : check.pass ? Tone::good : Tone::bad, verdict);
  const bool above = check.name == "provenance" && check.pass;  // in the lines before the checks
  const std::string result = above ? "as its sources say, see above" : result_of(check);
  std::printf("  %s  %-22s %s%s\n", verdict.c_str(), visible_line(check.name).c_str(),
              visible_line(result).c_str(),
              check.required || !check.skipped.empty() ? "" : " (reported only)");
}

void print_failures(const Certificate& certificate) {
  for (const Check& check : certificate.failures()) print_check(check);
}

}  // namespace lapwing
