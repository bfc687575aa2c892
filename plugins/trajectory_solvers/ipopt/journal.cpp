// SPDX-License-Identifier: Apache-2.0
#include "plugins/trajectory_solvers/ipopt/journal.h"

#include "framework/core/log.h"

namespace lapwing {

void JournalLines::write(const char* text) {
  for (; *text; ++text) {
    if (*text != '\n') {
      pending_ += *text;
      continue;
    }
    line(pending_);
    pending_.clear();
  }
}

void JournalLines::flush() {
  line(pending_);
  pending_.clear();
}

void JournalLines::line(const std::string& text) {
  if (text.empty() || text.find("CPU secs") != text.npos) return;
  out_of_memory_ = out_of_memory_ || text.find("out of memory") != text.npos;
  logging::debug("ipopt: " + text);
}

}  // namespace lapwing
