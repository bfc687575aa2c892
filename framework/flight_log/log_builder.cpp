// SPDX-License-Identifier: Apache-2.0
#include "framework/flight_log/log_builder.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Geometry>

#include "framework/core/error.h"

namespace lapwing {
namespace {

// The order in which samples come to their times; equal times keep the order of the file.
std::vector<std::size_t> order_of(const std::vector<double>& times) {
  std::vector<std::size_t> order(times.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return times[a] < times[b]; });
  return order;
}

LogSeries sorted(const LogSeries& series, std::size_t width, std::size_t& same_time) {
  LogSeries result{series.source, {}, {}};
  for (const std::size_t i : order_of(series.times)) {
    if (!result.times.empty() && series.times[i] == result.times.back()) {
      ++same_time;
      continue;
    }
    result.times.push_back(series.times[i]);
    const auto first = series.values.begin() + static_cast<std::ptrdiff_t>(i * width);
    result.values.insert(result.values.end(), first, first + static_cast<std::ptrdiff_t>(width));
  }
  return result;
}

constexpr double kFarGap = 600;     // s, and ten times the recording,
constexpr double kFewOfAll = 0.1;   // to a part with less than this share of the samples,
constexpr double kAnyGap = 864000;  // or this, s, to any part: no battery lasts ten days

// The part with the most samples, and what lies within reach of it; the rest has wrong times.
// Returns how many samples were left out.
std::size_t cut_far(LogSeries& series, std::size_t width) {
  const auto& times = series.times;
  if (times.size() < 2) return 0;
  std::vector<std::size_t> starts{0};
  for (std::size_t i = 1; i < times.size(); ++i)
    if (times[i] - times[i - 1] > kFarGap) starts.push_back(i);
  if (starts.size() == 1) return 0;
  starts.push_back(times.size());
  std::size_t main = 0;
  for (std::size_t k = 1; k + 1 < starts.size(); ++k)
    if (starts[k + 1] - starts[k] > starts[main + 1] - starts[main]) main = k;
  const auto count = [&](std::size_t k) { return static_cast<double>(starts[k + 1] - starts[k]); };
  const double span = times[starts[main + 1] - 1] - times[starts[main]];
  const auto far = [&](std::size_t k, double gap) {
    const bool few = count(k) < kFewOfAll * count(main);
    return gap > 10 * span && (few || gap > kAnyGap);
  };
  std::size_t first = main, last = main;
  while (first > 0 && !far(first - 1, times[starts[first]] - times[starts[first] - 1])) --first;
  while (last + 2 < starts.size() &&
         !far(last + 1, times[starts[last + 1]] - times[starts[last + 1] - 1]))
    ++last;
  const std::size_t from = starts[first], to = starts[last + 1], all = times.size();
  const auto part = [](std::vector<double>& v, std::size_t a, std::size_t b) {
    v = std::vector<double>(v.begin() + static_cast<std::ptrdiff_t>(a),
                            v.begin() + static_cast<std::ptrdiff_t>(b));
  };
  part(series.values, width * from, width * to);
  part(series.times, from, to);
  return all - (to - from);
}

// Of the body's x axis; upright or not.
LogSeries yaw_of(const LogSeries& orientation) {
  LogSeries yaw{orientation.source, orientation.times, {}};
  for (std::size_t i = 0; i < orientation.size(); ++i) {
    const double* q = &orientation.values[4 * i];
    yaw.values.push_back(
        std::atan2(2 * (q[1] * q[2] + q[0] * q[3]), 1 - 2 * (q[2] * q[2] + q[3] * q[3])));
  }
  return yaw;
}

std::string counted(std::size_t count, const char* what) {
  return std::to_string(count) + (count == 1 ? " sample " : " samples ") + what;
}

}  // namespace

LogBuilder::LogBuilder(std::string format, std::size_t bytes) {
  log.format = std::move(format);
  log.bytes = bytes;
  log.bytes_read = bytes;
}

void LogBuilder::add(const char* quantity, double time, std::span<const double> values) {
  const LogQuantity& known = log_quantity(quantity);
  if (values.size() != static_cast<std::size_t>(known.width))
    throw Error(std::string("'") + quantity + "' takes " + std::to_string(known.width) +
                " numbers, not " + std::to_string(values.size()));
  const bool finite = std::isfinite(time) && std::all_of(values.begin(), values.end(),
                                                         [](double v) { return std::isfinite(v); });
  if (!finite) {
    ++dropped_[quantity].not_finite;
    return;
  }
  LogSeries& series = log.series[quantity];
  if (!series.times.empty() && time < series.times.back()) ++dropped_[quantity].out_of_order;
  series.times.push_back(time);
  series.values.insert(series.values.end(), values.begin(), values.end());
}

void LogBuilder::name_source(const char* quantity, const std::string& source) {
  log.series[log_quantity(quantity).name].source = source;
}

bool LogBuilder::has(const char* quantity) const {
  const LogSeries* series = log.find(quantity);
  return series && !series->times.empty();
}

FlightLog LogBuilder::finish() {
  for (auto& [name, series] : log.series) {
    const auto width = static_cast<std::size_t>(log_quantity(name).width);
    series = sorted(series, width, dropped_[name].same_time);
    dropped_[name].far = cut_far(series, width);
  }
  std::erase_if(log.series, [](const auto& entry) { return entry.second.times.empty(); });
  if (const LogSeries* orientation = log.find("orientation"); orientation && !log.find("yaw"))
    log.series["yaw"] = yaw_of(*orientation);
  for (const auto& [name, dropped] : dropped_) {
    std::string line;
    const auto say = [&](std::size_t count, const char* what) {
      if (count > 0) line += (line.empty() ? "" : ", ") + counted(count, what);
    };
    say(dropped.not_finite, "not finite");
    say(dropped.same_time, "at a time that another has");
    say(dropped.far, "far from the time of the recording, left out");
    say(dropped.out_of_order, "later in the file than in time");
    if (!line.empty()) log.remarks.push_back("'" + name + "': " + line);
  }
  std::stable_sort(log.photographs.begin(), log.photographs.end());
  return std::move(log);
}

Eigen::Vector4d orientation_of_ned(double w, double x, double y, double z) {
  // Both frames are turned half about an axis: the local one about the middle of north and east.
  const double h = std::numbers::sqrt2 / 2;
  const Eigen::Quaterniond from_ned(0, h, h, 0), from_frd(0, 1, 0, 0);
  const Eigen::Quaterniond q = from_ned * Eigen::Quaterniond(w, x, y, z) * from_frd;
  const double sign = q.w() < 0 ? -1 : 1;
  const double norm = q.norm();
  return sign / norm * Eigen::Vector4d(q.w(), q.x(), q.y(), q.z());
}

Eigen::Vector4d orientation_of_euler(double roll, double pitch, double yaw) {
  const Eigen::Quaterniond q = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                               Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
                               Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX());
  return orientation_of_ned(q.w(), q.x(), q.y(), q.z());
}

double yaw_of_heading(double heading) {
  return std::remainder(M_PI / 2 - heading, 2 * M_PI);
}

}  // namespace lapwing
