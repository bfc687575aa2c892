// SPDX-License-Identifier: Apache-2.0
#include "framework/vehicle/stick_log.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "framework/core/error.h"
#include "framework/core/files.h"

namespace lapwing {
namespace {

constexpr std::string_view kHeading = "time,forward,left";

std::string text_of(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", number);
  return text;
}

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

// The numbers of one line; false when they are not exactly three.
bool three_numbers(std::string_view line, double (&numbers)[3]) {
  for (int k = 0; k < 3; ++k) {
    const std::size_t comma = line.find(',');
    if ((comma == std::string_view::npos) != (k == 2)) return false;
    const std::string_view field = trimmed(line.substr(0, comma));
    const auto [end, error] =
        std::from_chars(field.data(), field.data() + field.size(), numbers[k]);
    if (error != std::errc{} || end != field.data() + field.size()) return false;
    if (k < 2) line.remove_prefix(comma + 1);
  }
  return true;
}

}  // namespace

StickLog::StickLog(std::vector<StickSample> samples, const std::string& name)
    : samples_(std::move(samples)) {
  const auto fail = [&](const std::string& why) { throw InputError("'" + name + "': " + why); };
  if (samples_.empty()) fail("it holds no sample");
  double last = 0;
  for (std::size_t k = 0; k < samples_.size(); ++k) {
    const StickSample& sample = samples_[k];
    const std::string which = "sample " + std::to_string(k + 1);
    if (!std::isfinite(sample.time) || !sample.stick.allFinite())
      fail(which + " is not three finite numbers");
    if (sample.time < 0 || (k > 0 && sample.time <= last))
      fail(which + ": times must rise from 0 s, but " + text_of(sample.time) + " s follows " +
           text_of(last) + " s");
    if (sample.time - last > kLongestGap)
      fail("a gap from " + text_of(last) + " s to " + text_of(sample.time) +
           " s; samples must be " + text_of(kLongestGap) + " s apart at most");
    if (sample.stick.cwiseAbs().maxCoeff() > 1)
      fail(which + ": the stick moves from -1 to 1, got " + text_of(sample.stick.x()) + ", " +
           text_of(sample.stick.y()));
    last = sample.time;
  }
}

Eigen::Vector2d StickLog::at(double time) const {
  if (time >= end()) return time == end() ? samples_.back().stick : Eigen::Vector2d::Zero();
  const auto next =
      std::upper_bound(samples_.begin(), samples_.end(), time,
                       [](double t, const StickSample& sample) { return t < sample.time; });
  if (next == samples_.begin()) return next->stick;
  return between(*(next - 1), *next, time);
}

Eigen::Vector2d StickLog::between(const StickSample& from, const StickSample& to, double time) {
  const double share = (time - from.time) / (to.time - from.time);
  return (1 - share) * from.stick + share * to.stick;
}

StickLog parse_stick_log(std::string_view text, const std::string& name) {
  std::vector<StickSample> samples;
  bool headed = false;
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = text.find('\n');
    const std::string_view line = trimmed(text.substr(0, end));
    text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
    if (line.empty() || line.front() == '#') continue;
    const auto fail = [&](const std::string& why) { throw InputError(Origin{name, number}, why); };
    if (!headed) {
      if (line != kHeading)
        fail("a stick log begins with the line '" + std::string(kHeading) + "'");
      headed = true;
      continue;
    }
    double numbers[3];
    if (!three_numbers(line, numbers))
      fail("expected three numbers apart by commas, got '" + std::string(line.substr(0, 60)) + "'");
    samples.push_back({numbers[0], {numbers[1], numbers[2]}});
  }
  return StickLog(std::move(samples), name);
}

std::string stick_log_text(const StickLog& log) {
  std::string text = std::string(kHeading) + "\n";
  for (const StickSample& sample : log.samples()) {
    char line[96];
    std::snprintf(line, sizeof line, "%.17g,%.17g,%.17g\n", sample.time, sample.stick.x(),
                  sample.stick.y());
    text += line;
  }
  return text;
}

StickLog read_stick_log(const std::filesystem::path& path) {
  return parse_stick_log(read_file(path, 64u << 20), path.string());
}

}  // namespace lapwing
