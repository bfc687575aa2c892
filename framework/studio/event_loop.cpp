// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/event_loop.h"

#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>

namespace lapwing {

namespace asio = boost::asio;

struct EventLoop::Impl {
  asio::io_context io{1};
  asio::executor_work_guard<asio::io_context::executor_type> guard{io.get_executor()};
};

EventLoop::EventLoop() : impl_(std::make_unique<Impl>()) {}
EventLoop::~EventLoop() = default;

void EventLoop::post(std::function<void()> work) {
  asio::post(impl_->io, std::move(work));
}

void EventLoop::after(std::chrono::milliseconds pause, std::function<void()> work) {
  const auto timer = std::make_shared<asio::steady_timer>(impl_->io, pause);
  timer->async_wait([timer, work = std::move(work)](const boost::system::error_code& error) {
    if (!error) work();
  });
}

void EventLoop::run() {
  impl_->io.run();
  impl_->io.restart();  // so that it may run again
}

void EventLoop::stop() {
  impl_->io.stop();
}

void* EventLoop::io() {
  return &impl_->io;
}

}  // namespace lapwing
