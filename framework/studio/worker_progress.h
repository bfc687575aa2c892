// SPDX-License-Identifier: Apache-2.0
// Tells a studio how far planning has come. Internal to this room.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "framework/core/phases.h"
#include "framework/studio/frames.h"

namespace lapwing {

// Sends frames with `said` = "progress", `phase`, `fraction` (of the whole) and `left` (s); what is
// unknown is null. The first one after half a second, and at most four a second: what is quick
// needs none. Called on one thread.
class WorkerProgress final : public PhasedProgress {
 public:
  using Send = std::function<void(Frame)>;
  explicit WorkerProgress(Send send) : send_(std::move(send)) {}

  void expect(std::vector<Phase> phases) override { times_.expect(std::move(phases)); }
  void begin(const std::string& phase) override {
    times_.begin(phase, now());
    tell();
  }
  void report(double fraction, const std::string&) override {
    times_.report(fraction, now());
    tell();
  }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr double kFirst = 0.5, kBetween = 0.25;  // s

  double now() const { return std::chrono::duration<double>(Clock::now() - began_).count(); }

  void tell() {
    const double time = now();
    if (time < kFirst || time - told_ < kBetween) return;
    told_ = time;
    const PhaseTimes::Standing standing = times_.standing(time);
    Frame frame;
    frame.header.set("said", "progress");
    frame.header.set("phase", as_utf8(standing.phase));
    frame.header.set("fraction", standing.whole ? Value(*standing.whole) : Value());
    frame.header.set("left", standing.left ? Value(*standing.left) : Value());
    send_(std::move(frame));
  }

  Send send_;
  PhaseTimes times_;
  Clock::time_point began_ = Clock::now();
  double told_ = 0;
};

}  // namespace lapwing
