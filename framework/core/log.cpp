// SPDX-License-Identifier: Apache-2.0
#include "framework/core/log.h"

#include <spdlog/logger.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/dist_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>

#include <mutex>

#include "framework/core/visible_text.h"

namespace lapwing::logging {

namespace {

spdlog::level::level_enum to_spdlog(Level level) {
  switch (level) {
    case Level::debug:
      return spdlog::level::debug;
    case Level::info:
      return spdlog::level::info;
    case Level::warning:
      return spdlog::level::warn;
    case Level::error:
      return spdlog::level::err;
    case Level::off:
      return spdlog::level::off;
  }
  return spdlog::level::off;
}

// Keeps every line in memory. The base class holds the lock while sink_it_ runs.
class LineSink final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  std::string text() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return text_;
  }

 private:
  void sink_it_(const spdlog::details::log_msg& message) override {
    const auto level = spdlog::level::to_string_view(message.level);
    text_.append(level.data(), level.size());
    text_ += ": ";
    text_.append(message.payload.data(), message.payload.size());
    text_ += '\n';
  }
  void flush_() override {}
  std::string text_;
};

struct Output {
  std::shared_ptr<spdlog::sinks::stderr_color_sink_mt> console =
      std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
  std::shared_ptr<spdlog::sinks::dist_sink_mt> captures =
      std::make_shared<spdlog::sinks::dist_sink_mt>();
  spdlog::logger logger{"lapwing", {console, captures}};

  Output() {
    console->set_pattern("%^%l:%$ %v");
    console->set_level(spdlog::level::warn);
    logger.set_level(spdlog::level::debug);
  }
};

Output& output() {
  static Output instance;
  return instance;
}

}  // namespace

void set_console_level(Level level) {
  output().console->set_level(to_spdlog(level));
}
void set_console_colour(bool coloured) {
  output().console->set_color_mode(coloured ? spdlog::color_mode::always
                                            : spdlog::color_mode::never);
}
void debug(const std::string& message) {
  output().logger.debug("{}", visible_text(message));
}
void info(const std::string& message) {
  output().logger.info("{}", visible_text(message));
}
void warning(const std::string& message) {
  output().logger.warn("{}", visible_text(message));
}
void error(const std::string& message) {
  output().logger.error("{}", visible_text(message));
}

struct Capture::Impl {
  std::shared_ptr<LineSink> sink = std::make_shared<LineSink>();
};

Capture::Capture() : impl_(new Impl) {
  output().captures->add_sink(impl_->sink);
}

Capture::~Capture() {
  output().captures->remove_sink(impl_->sink);
  delete impl_;
}

std::string Capture::text() const {
  return impl_->sink->text();
}

}  // namespace lapwing::logging
