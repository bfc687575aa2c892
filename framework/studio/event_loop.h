// SPDX-License-Identifier: Apache-2.0
// The one thread of a studio's server: sockets, timers, and what other threads hand it.
#pragma once

#include <chrono>
#include <functional>
#include <memory>

namespace lapwing {

class EventLoop {
 public:
  EventLoop();
  ~EventLoop();
  EventLoop(const EventLoop&) = delete;
  EventLoop& operator=(const EventLoop&) = delete;

  // From any thread: `work` runs on the loop's thread, in order.
  void post(std::function<void()> work);
  // On the loop's thread, once, unless the loop ends before.
  void after(std::chrono::milliseconds pause, std::function<void()> work);
  // Runs until `stop`; what work throws comes out.
  void run();
  void stop();

  void* io();  // the loop as Boost.Asio has it, for sockets

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lapwing
