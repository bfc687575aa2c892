// SPDX-License-Identifier: Apache-2.0
#include "framework/flight_log/flight_log.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "framework/core/error.h"
#include "framework/core/number_text.h"

namespace lapwing {
namespace {

// Whose numbers are angles that wrap.
bool wraps(std::string_view name) {
  return name == "yaw" || name == "camera" || name == "yaw_setpoint";
}

double between(double a, double b, double share, bool angle) {
  return a + share * (angle ? std::remainder(b - a, 2 * M_PI) : b - a);
}

Eigen::VectorXd turned(const double* a, const double* b, double share) {
  const Eigen::Quaterniond from(a[0], a[1], a[2], a[3]), to(b[0], b[1], b[2], b[3]);
  const Eigen::Quaterniond q = from.slerp(share, to);
  return Eigen::Vector4d(q.w(), q.x(), q.y(), q.z());
}

void judge_series(const std::string& name, const LogSeries& series,
                  std::vector<std::string>& faults) {
  const auto& known = log_quantities();
  const auto found = std::find_if(known.begin(), known.end(),
                                  [&](const LogQuantity& q) { return q.name == name; });
  const auto fault = [&](const std::string& what) { faults.push_back("'" + name + "' " + what); };
  if (found == known.end()) return fault("is not a quantity of logs");
  if (series.times.empty()) fault("has no sample");
  if (series.values.size() != series.times.size() * static_cast<std::size_t>(found->width))
    return fault("has " + std::to_string(series.values.size()) + " numbers for " +
                 std::to_string(series.times.size()) + " samples of " +
                 std::to_string(found->width));
  for (std::size_t i = 0; i < series.times.size(); ++i)
    if (!std::isfinite(series.times[i]) || (i > 0 && !(series.times[i] > series.times[i - 1])))
      return fault("has times that do not rise, at sample " + std::to_string(i));
  for (const double value : series.values)
    if (!std::isfinite(value)) return fault("has a number that is not finite");
}

}  // namespace

const std::vector<LogQuantity>& log_quantities() {
  static const std::vector<LogQuantity> all{
      {"position", 3, "m", "position in the log's local frame"},
      {"place", 3, "", "latitude in degrees, longitude in degrees, height in m, as estimated"},
      {"gps", 3, "", "the same, of the receiver alone"},
      {"velocity", 3, "m/s", "velocity over the ground"},
      {"acceleration", 3, "m/s^2", "derivative of the velocity, as estimated"},
      {"specific_force", 3, "m/s^2", "what the accelerometer measures, in the body"},
      {"orientation", 4, "1", "rotation from the body to the local frame, w first"},
      {"yaw", 1, "rad", "heading of the vehicle"},
      {"body_rates", 3, "rad/s", "rotation rates about the axes of the body"},
      {"camera", 2, "rad", "yaw and pitch of the optical axis in the world, pitch positive up"},
      {"throttle", 1, "1", "commanded collective thrust, as a share of the largest"},
      {"actuators", 4, "1", "commands of the first four motors, as shares of the largest"},
      {"battery", 3, "", "voltage in V, current in A, share of the charge that is left"},
      {"position_setpoint", 3, "m", "commanded position in the local frame"},
      {"velocity_setpoint", 3, "m/s", "commanded velocity"},
      {"yaw_setpoint", 1, "rad", "commanded heading"},
      {"rates_setpoint", 3, "rad/s", "commanded rotation rates about the axes of the body"},
  };
  return all;
}

const LogQuantity& log_quantity(std::string_view name) {
  for (const LogQuantity& quantity : log_quantities())
    if (name == quantity.name) return quantity;
  throw Error("'" + std::string(name) + "' is not a quantity of logs");
}

const LogSeries* FlightLog::find(std::string_view name) const {
  const auto found = series.find(std::string(name));
  return found == series.end() ? nullptr : &found->second;
}

double FlightLog::start() const {
  double least = INFINITY;
  for (const auto& [name, one] : series) least = std::min(least, one.times.front());
  return std::isfinite(least) ? least : 0;
}

double FlightLog::finish() const {
  double most = -INFINITY;
  for (const auto& [name, one] : series) most = std::max(most, one.times.back());
  return std::isfinite(most) ? most : 0;
}

std::vector<std::string> faults_of(const FlightLog& log) {
  std::vector<std::string> faults;
  if (log.format.empty()) faults.emplace_back("it names no format");
  for (const auto& [name, series] : log.series) judge_series(name, series, faults);
  if (!std::is_sorted(log.photographs.begin(), log.photographs.end()))
    faults.emplace_back("photographs are not in the order of their times");
  for (const double time : log.photographs)
    if (!std::isfinite(time)) faults.emplace_back("the time of a photograph is not finite");
  for (const LogMessage& message : log.messages)
    if (!std::isfinite(message.time)) faults.emplace_back("the time of a message is not finite");
  if (log.bytes_read > log.bytes) faults.emplace_back("more was read than the file holds");
  if ((log.find("place") || log.find("gps")) && !log.series.empty() && log.reference &&
      !std::isfinite(log.reference->latitude_deg + log.reference->longitude_deg +
                     log.reference->altitude))
    faults.emplace_back("the reference is not finite");
  return faults;
}

std::optional<Eigen::VectorXd> value_at(const FlightLog& log, std::string_view name, double time,
                                        double longest_gap) {
  const LogSeries* series = log.find(name);
  if (!series || series->times.empty()) return std::nullopt;
  const auto& times = series->times;
  if (!(time >= times.front() && time <= times.back())) return std::nullopt;
  const std::size_t after =
      static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), time) - times.begin());
  const std::size_t j = std::min(after, times.size() - 1), i = j == 0 ? 0 : j - 1;
  const int width = log_quantity(name).width;
  const double* a = &series->values[i * static_cast<std::size_t>(width)];
  const double* b = &series->values[j * static_cast<std::size_t>(width)];
  const double step = times[j] - times[i];
  if (step > longest_gap && time != times[i] && time != times[j]) return std::nullopt;
  const double share = step > 0 ? (time - times[i]) / step : 0;
  if (name == "orientation") return turned(a, b, share);
  Eigen::VectorXd value(width);
  for (int k = 0; k < width; ++k) value[k] = between(a[k], b[k], share, wraps(name));
  return value;
}

}  // namespace lapwing
