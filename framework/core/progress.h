// SPDX-License-Identifier: Apache-2.0
// Progress and cancellation of long work.
#pragma once

#include <atomic>
#include <string>

#include "framework/core/active_call.h"

namespace lapwing {

// Set from a signal handler or another thread; read between units of work. Lock-free.
class CancellationToken {
 public:
  void cancel() { cancelled_.store(true, std::memory_order_relaxed); }
  // Whoever asks is at work: a plugin's long call that neither asks nor evaluates seems to hang.
  bool cancelled() const {
    show_activity();
    return cancelled_.load(std::memory_order_relaxed);
  }

 private:
  std::atomic<bool> cancelled_{false};
};

// Told how far long work has come. Called from the working thread, as often as the worker likes; an
// implementation limits its own output.
class Progress {
 public:
  virtual ~Progress() = default;
  // `fraction` in [0, 1], or negative when unknown; `what` is a few words: "iteration 4".
  virtual void report(double fraction, const std::string& what) = 0;
};

}  // namespace lapwing
