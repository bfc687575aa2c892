// SPDX-License-Identifier: Apache-2.0
// Progress of long work on a terminal: one line, redrawn; elsewhere plain lines, few of them.
#pragma once

#include <functional>
#include <iosfwd>
#include <mutex>
#include <string>

#include "framework/core/phases.h"

namespace lapwing {

// What becomes of progress.
enum class ProgressStyle {
  redrawn,  // one line, at most ten times a second, wiped at the end
  plain,    // a line each time, at most one in two seconds and none before the first two
  silent,
};

// `label` heads the line: "solve". Thread-safe. The line is gone once this object is, also when an
// exception takes it; call `clear` before writing anything else to the same stream.
//
//   solve  iteration 4  37 %  0:12, about 0:20 left
//   plan  3/7 views  view 640 of 2000, 32 %;  all 41 %  2:12, about 3:10 left
//
// Of work with phases, one that took two seconds or more leaves a line behind; shares never fall,
// and where no honest estimate can be made there is none (see PhaseTimes).
class ProgressLine : public PhasedProgress {
 public:
  // Seconds from any fixed moment, never going back.
  using Clock = std::function<double()>;

  // `out` must outlive this object; `columns` is the terminal's width (0: unknown, 80 is assumed).
  ProgressLine(std::string label, std::ostream& out, ProgressStyle style, int columns, Clock clock);
  ~ProgressLine() override;
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void report(double fraction, const std::string& what) override;
  void expect(std::vector<Phase> phases) override;
  void begin(const std::string& phase) override;

  // Wipes the line; the next report draws it again.
  void clear();

 private:
  std::string line(const std::string& what, double elapsed);
  void wipe();

  std::mutex mutex_;
  std::string label_;
  std::ostream& out_;
  ProgressStyle style_;
  int columns_;
  Clock clock_;
  double begin_;
  double last_;
  bool drawn_ = false;
  PhaseTimes times_;
};

// The style that standard error asks for: silent if `quiet`, redrawn on a terminal that can move
// its cursor (TERM neither empty nor "dumb"), else plain.
ProgressStyle progress_style_of_stderr(bool quiet);
// Width of the terminal at standard error, 0 where there is none.
int columns_of_stderr();
// Seconds of the steady clock.
double steady_seconds();

}  // namespace lapwing
