// SPDX-License-Identifier: Apache-2.0
// A working process as the server holds it: started, spoken to, heard, and started again.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "framework/studio/event_loop.h"
#include "framework/studio/frames.h"

namespace lapwing {

// What a session needs of one.
class Worker {
 public:
  virtual ~Worker() = default;
  // Never blocks. What is sent while there is no process is lost: whoever sends hears of crashes.
  virtual void send(Frame frame) = 0;
};

// The program that works and its words.
struct WorkerProgram {
  std::filesystem::path program = "/proc/self/exe";
  std::vector<std::string> words;
};

// Everything that it hears of comes on the loop's thread.
struct WorkerListener {
  std::function<void(Frame)> heard;
  std::function<void()> started;  // also the first time
  // The process ended by itself; why, in words, with what it wrote on standard error. It is started
  // again at once, or after a second if it keeps ending.
  std::function<void(const std::string& why)> crashed;
};

// Reads from standard input and writes on descriptor 3 (kWorkerOutput). It ends with this process.
class WorkerLink final : public Worker {
 public:
  WorkerLink(EventLoop& loop, WorkerProgram program, WorkerListener listener);
  ~WorkerLink() override;  // ends the process
  void send(Frame frame) override;
  pid_t process() const;

 private:
  struct Run;  // one life of the process
  void start();
  void ended(const std::shared_ptr<Run>& run);

  EventLoop& loop_;
  WorkerProgram program_;
  WorkerListener listener_;
  std::shared_ptr<Run> run_;
  std::vector<std::chrono::steady_clock::time_point> crashes_;
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
};

inline constexpr int kWorkerOutput = 3;

}  // namespace lapwing
