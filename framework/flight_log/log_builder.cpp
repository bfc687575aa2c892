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
  for (auto& [name, series] : log.series)
    series = sorted(series, static_cast<std::size_t>(log_quantity(name).width),
                    dropped_[name].same_time);
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
