// SPDX-License-Identifier: Apache-2.0
#include "framework/app/progress_line.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <limits>
#include <ostream>
#include <utility>

namespace lapwing {
namespace {

constexpr double kRedrawInterval = 0.1;  // s
constexpr double kPlainInterval = 2.0;   // s
constexpr const char* kWipe = "\r\x1b[K";

// "0:07", "12:40", "1:02:03".
std::string clock_text(double seconds) {
  const auto total = static_cast<long long>(std::min(seconds + 0.5, 1e9));
  const auto two = [](long long v) { return (v < 10 ? "0" : "") + std::to_string(v); };
  const long long hours = total / 3600, minutes = total / 60 % 60;
  return (hours > 0 ? std::to_string(hours) + ":" + two(minutes) : std::to_string(minutes)) + ":" +
         two(total % 60);
}

// No line break or escape sequence from `what` reaches the terminal.
std::string printable(const std::string& text) {
  std::string out = text;
  for (char& c : out) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  }
  return out;
}

// The first `columns` characters of UTF-8 text.
std::string shortened(const std::string& text, int columns) {
  int seen = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool starts = (static_cast<unsigned char>(text[i]) & 0xc0) != 0x80;
    if (starts && seen++ == columns) return text.substr(0, i);
  }
  return text;
}

}  // namespace

ProgressLine::ProgressLine(std::string label, std::ostream& out, ProgressStyle style, int columns,
                           Clock clock)
    : label_(std::move(label)),
      out_(out),
      style_(style),
      columns_(columns > 0 ? columns : 80),
      clock_(std::move(clock)),
      begin_(clock_()),
      last_(style == ProgressStyle::redrawn ? -std::numeric_limits<double>::infinity() : begin_) {}

ProgressLine::~ProgressLine() {
  clear();
}

void ProgressLine::report(double fraction, const std::string& what) {
  if (style_ == ProgressStyle::silent) return;
  const std::lock_guard lock(mutex_);
  const double now = clock_();
  times_.report(fraction, now - begin_);
  const bool redrawn = style_ == ProgressStyle::redrawn;
  if (now - last_ < (redrawn ? kRedrawInterval : kPlainInterval)) return;
  last_ = now;
  const std::string text = line(what, now - begin_);
  if (redrawn) {
    // The last column stays free: writing it makes some terminals begin a new line.
    out_ << kWipe << shortened(text, columns_ - 1);
    drawn_ = true;
  } else {
    out_ << text << '\n';
  }
  out_.flush();
}

void ProgressLine::expect(std::vector<Phase> phases) {
  const std::lock_guard lock(mutex_);
  times_.expect(std::move(phases));
}

void ProgressLine::begin(const std::string& phase) {
  const std::lock_guard lock(mutex_);
  const double now = clock_() - begin_;
  const PhaseTimes::Standing before = times_.standing(now);
  const auto ended = times_.begin(phase, now);
  if (!ended || style_ == ProgressStyle::silent || ended->second < kPlainInterval) return;
  wipe();
  out_ << printable(label_) << "  ";
  if (before.number > 0) out_ << before.number << '/' << before.count << ' ';
  out_ << printable(ended->first) << ": " << clock_text(ended->second) << '\n';
  out_.flush();
}

void ProgressLine::clear() {
  const std::lock_guard lock(mutex_);
  wipe();
}

void ProgressLine::wipe() {
  if (!drawn_) return;
  out_ << kWipe;
  out_.flush();
  drawn_ = false;
}

std::string ProgressLine::line(const std::string& what, double elapsed) {
  const PhaseTimes::Standing standing = times_.standing(elapsed);
  const auto percent = [](double share) {
    return std::to_string(static_cast<int>(share * 100)) + " %";
  };
  std::string text = printable(label_);
  const std::string words = printable(what);
  if (standing.phase.empty()) {
    if (!words.empty()) text += "  " + words;
    if (standing.whole) text += "  " + percent(*standing.whole);
  } else {
    text += "  ";
    if (standing.number > 0)
      text += std::to_string(standing.number) + '/' + std::to_string(standing.count) + ' ';
    text += printable(standing.phase);
    if (!words.empty() && what != standing.phase) text += "  " + words;
    if (standing.fraction) text += ", " + percent(*standing.fraction);
    if (standing.whole) text += ";  all " + percent(*standing.whole);
  }
  text += "  " + clock_text(elapsed);
  if (standing.left) text += ", about " + clock_text(*standing.left) + " left";
  return text;
}

ProgressStyle progress_style_of_stderr(bool quiet) {
  if (quiet) return ProgressStyle::silent;
  const char* terminal = std::getenv("TERM");
  const bool moves = terminal != nullptr && *terminal != '\0' && std::string(terminal) != "dumb";
  return isatty(STDERR_FILENO) && moves ? ProgressStyle::redrawn : ProgressStyle::plain;
}

int columns_of_stderr() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace lapwing
