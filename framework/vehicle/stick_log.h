// SPDX-License-Identifier: Apache-2.0
// What a pilot's stick did, as a CSV file: a line `time,forward,left`, then one line a sample with
// the time in s and two deflections from -1 to 1.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace lapwing {

struct StickSample {
  double time = 0;                                  // s, from the start of the race
  Eigen::Vector2d stick = Eigen::Vector2d::Zero();  // forward, left; -1 to 1
};

class StickLog {
 public:
  static constexpr double kLongestGap = 0.5;  // s, between samples

  // Throws InputError naming `name` and the sample: none at all, a first sample later than the
  // longest gap, times that do not rise, a gap, a deflection beyond 1, a number that is not finite.
  StickLog(std::vector<StickSample> samples, const std::string& name);

  // Linear between samples; before the first as there; centred after the last.
  Eigen::Vector2d at(double time) const;
  // Between two samples of a log, as `at` has it there.
  static Eigen::Vector2d between(const StickSample& from, const StickSample& to, double time);
  double end() const { return samples_.back().time; }  // s
  const std::vector<StickSample>& samples() const { return samples_; }

 private:
  std::vector<StickSample> samples_;
};

// Throws InputError naming the line as well: another heading, a line that is not three numbers.
StickLog parse_stick_log(std::string_view text, const std::string& name);
StickLog read_stick_log(const std::filesystem::path& path);
// The file of a log, from which the same log is read.
std::string stick_log_text(const StickLog& log);

}  // namespace lapwing
