// SPDX-License-Identifier: Apache-2.0
#include "framework/flight_review/shown_limits.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "framework/core/number_text.h"
#include "framework/core/units.h"
#include "framework/flight_review/shown_fits.h"
#include "framework/flight_review/shown_motion.h"
#include "framework/vehicle/monte_carlo.h"

namespace lapwing {
namespace {

constexpr double kHeld = 0.5;       // s, that a value must last
constexpr double kExercised = 0.2;  // of the base's limit
constexpr double kFewData = 30;     // s, below which blocks of 5 s tell no interval

using Reading = std::function<std::optional<double>(const ShownState&)>;

// The largest value that lasts, and how long it was near it.
struct Peak {
  double value = 0, time = 0, near = 0;
};

Peak peak_of(const ShownMotion& motion, const Reading& read) {
  Peak peak;
  const auto window = static_cast<std::size_t>(std::max(1.0, std::round(kHeld / motion.step)));
  std::vector<double> values;
  for (const ShownState& s : motion.states) {
    const auto value = s.airborne ? read(s) : std::nullopt;
    values.push_back(value.value_or(NAN));
    if (value) peak.time += motion.step;
  }
  for (std::size_t i = 0; i + window <= values.size(); ++i) {
    double least = INFINITY;
    for (std::size_t k = i; k < i + window; ++k)
      least = std::isnan(values[k]) ? -INFINITY : std::min(least, values[k]);
    peak.value = std::max(peak.value, least);
  }
  for (const double value : values)
    if (value >= 0.9 * peak.value) peak.near += motion.step;
  return peak;
}

// Rates of an angle between neighbouring states.
void fill_rates(const ShownMotion& motion,
                const std::function<std::optional<double>(const ShownState&)>& angle,
                std::vector<double>& rates) {
  rates.assign(motion.states.size(), NAN);
  // Over 0.2 s: angles of logs are coarse.
  const auto reach = static_cast<std::size_t>(std::max(1.0, std::round(0.1 / motion.step)));
  for (std::size_t i = reach; i + reach < motion.states.size(); ++i) {
    const auto a = angle(motion.states[i - reach]), b = angle(motion.states[i + reach]);
    if (a && b)
      rates[i] = std::abs(std::remainder(*b - *a, 2 * M_PI)) /
                 (2 * static_cast<double>(reach) * motion.step);
  }
}

class Collection {
 public:
  Collection(const FlightLog& log, const Vehicle& base)
      : log_(log), base_(base), motion_(shown_motion(log)) {
    limits_.airborne = motion_.airborne_time();
    limits_.source = motion_.source;
  }

  ShownLimits run() {
    add_speeds();
    add_turns();
    add_camera();
    add_fits();
    add_battery();
    return std::move(limits_);
  }

 private:
  void add_peak(const std::string& key, double base, double scale, const char* unit,
                const Reading& read) {
    const Peak peak = peak_of(motion_, read);
    if (peak.time < 2) return;
    const std::string text = plain_number(scale * peak.value, 4) + " " + unit;
    if (peak.value < kExercised * base) {
      limits_.remarks.push_back(key + ": the flight showed " + text +
                                ", less than a fifth of the " + "base: not exercised");
      return;
    }
    limits_.figures.push_back({key, scale * peak.value, std::nullopt, std::nullopt,
                               "held for " + plain_number(kHeld) + " s; above 90 % of it for " +
                                   plain_number(peak.near, 3) + " s of " +
                                   plain_number(peak.time, 4) + " s"});
  }

  void add_speeds() {
    add_peak("limits.speed_across", base_.speed_across_max, 1, "m/s",
             [](const ShownState& s) { return s.velocity.head<2>().norm(); });
    add_peak("limits.climb_speed", base_.climb_speed_max, 1, "m/s",
             [](const ShownState& s) { return s.velocity.z(); });
    add_peak("limits.descent_speed", base_.descent_speed_max, 1, "m/s",
             [](const ShownState& s) { return -s.velocity.z(); });
    add_peak("limits.acceleration_across", base_.acceleration_across_max, 1, "m/s^2",
             [](const ShownState& s) { return s.acceleration.head<2>().norm(); });
    const double vertical = base_.acceleration_across_max / 2;
    add_peak("limits.acceleration_up", base_.acceleration_up_max.value_or(vertical), 1, "m/s^2",
             [](const ShownState& s) { return s.acceleration.z(); });
    add_peak("limits.acceleration_down", base_.acceleration_down_max.value_or(vertical), 1, "m/s^2",
             [](const ShownState& s) { return -s.acceleration.z(); });
  }

  void add_turns() {
    std::vector<double> yaw_rates;
    fill_rates(
        motion_, [](const ShownState& s) { return s.yaw; }, yaw_rates);
    const auto yaw_rate = [&](const ShownState& s) -> std::optional<double> {
      const double rate = yaw_rates[static_cast<std::size_t>(&s - motion_.states.data())];
      return std::isnan(rate) ? std::nullopt : std::optional(rate);
    };
    add_peak("limits.yaw_rate_deg", base_.yaw_rate_max, degrees(1.0), "deg/s", yaw_rate);
    add_peak("limits.tilt_rate_deg", base_.tilt_rate_max.value_or(radians(180)), degrees(1.0),
             "deg/s", [](const ShownState& s) -> std::optional<double> {
               if (!s.body_rates) return std::nullopt;
               return std::max(std::abs(s.body_rates->x()), std::abs(s.body_rates->y()));
             });
    const Peak tilt = peak_of(motion_, [](const ShownState& s) -> std::optional<double> {
      if (!s.orientation) return std::nullopt;
      return std::acos(std::clamp((*s.orientation * Eigen::Vector3d::UnitZ()).z(), -1.0, 1.0));
    });
    if (tilt.time > 0)
      limits_.remarks.push_back("the largest tilt was " + plain_number(degrees(tilt.value), 3) +
                                " degrees");
    else
      limits_.remarks.emplace_back(
          "tilt, tilt rate and drag were not seen: the log holds no "
          "attitude");
  }

  void add_camera() {
    if (!log_.find("camera")) {
      limits_.remarks.emplace_back(
          "the gimbal was not seen: the log holds no direction of the "
          "camera");
      return;
    }
    std::vector<double> rates;
    const auto add = [&](const char* key, double base, auto angle) {
      fill_rates(motion_, angle, rates);
      add_peak(key, base, degrees(1.0), "deg/s", [&](const ShownState& s) -> std::optional<double> {
        const double rate = rates[static_cast<std::size_t>(&s - motion_.states.data())];
        return std::isnan(rate) ? std::nullopt : std::optional(rate);
      });
    };
    if (!base_.gimbal) return;
    add("gimbal.pitch_rate_deg", base_.gimbal->pitch_rate_max,
        [](const ShownState& s) -> std::optional<double> {
          return s.camera ? std::optional(s.camera->y()) : std::nullopt;
        });
    if (base_.gimbal->yaw_rate_max > 0)
      add("gimbal.yaw_rate_deg", base_.gimbal->yaw_rate_max,
          [](const ShownState& s) -> std::optional<double> {
            return s.camera && s.yaw ? std::optional(s.camera->x() - *s.yaw) : std::nullopt;
          });
  }

  void add_fit(const std::string& key, const FitResult& fit, double scale,
               const std::string& what) {
    limits_.figures.push_back(
        {key, scale * fit.value, scale * fit.low, scale * fit.high,
         "fit: " + what + (fit.measured ? ", 95 % within " : ", spread over blocks ") +
             plain_number(scale * fit.low, 3) + " to " + plain_number(scale * fit.high, 3) + ", " +
             plain_number(fit.time, 4) + " s of data"});
  }

  void add_fits() {
    if (const auto drag = fit_drag(motion_)) {
      add_fit("drag", drag->drag, base_.mass,
              "linear drag for a mass of " + plain_number(base_.mass, 4) + " kg");
      limits_.remarks.push_back("the wind was " + plain_number(drag->wind.x(), 3) +
                                " m/s east and " + plain_number(drag->wind.y(), 3) +
                                " m/s north, if it was even");
    } else if (log_.find("orientation")) {
      limits_.remarks.emplace_back("drag could not be told from the flight");
    }
    if (const auto hover = fit_hover(motion_))
      limits_.remarks.push_back(
          "it hovers at a throttle of " + plain_number(hover->value, 3) + " (" +
          (hover->time < kFewData ? std::string("too little data for an interval")
                                  : "spread over blocks " + plain_number(hover->low, 3) + " to " +
                                        plain_number(hover->high, 3)) +
          ", " + plain_number(hover->time, 3) + " s of data)");
    else
      limits_.remarks.emplace_back("the throttle of hovering was not seen");
    const auto thrust = fit_thrust(log_, motion_);
    if (thrust && base_.has_rotors)
      add_fit("rotors.thrust", thrust->full, base_.mass / 4,
              "full throttle for a mass of " + plain_number(base_.mass, 4) +
                  " kg, specific force as throttle to the power of " +
                  plain_number(thrust->exponent.value, 3));
    else
      limits_.remarks.emplace_back("the largest thrust could not be told from the flight");
    const auto lag = fit_lag(log_, motion_, thrust ? thrust->exponent.value : 1);
    if (lag && base_.has_rotors)
      add_fit("rotors.lag", *lag, 1, "specific force behind the throttle");
    else
      limits_.remarks.emplace_back("the lag of the rotors could not be told from the flight");
    limits_.remarks.emplace_back("mass and inertia cannot be seen in a log");
  }

  // Flight time until a fifth of the charge is left, at the rate of the part in the air.
  void add_battery() {
    const LogSeries* battery = log_.find("battery");
    if (!battery || battery->size() < 10) {
      limits_.remarks.emplace_back("the flight time was not seen: the log holds no battery");
      return;
    }
    double used = 0, span = 0;
    for (std::size_t i = 1; i < battery->size(); ++i) {
      if (!airborne_at(battery->times[i - 1]) || !airborne_at(battery->times[i])) continue;
      used += battery->values[3 * i - 1] - battery->values[3 * i + 2];
      span += battery->times[i] - battery->times[i - 1];
    }
    if (used < 0.1 || span < 60) {
      limits_.remarks.push_back(
          "the flight time could not be told: " + plain_number(100 * std::max(0.0, used), 2) +
          " % of the battery were used in the air, in " + plain_number(span, 4) + " s");
      return;
    }
    limits_.figures.push_back({"flight_time", 0.8 * span / used, std::nullopt, std::nullopt,
                               "until a fifth is left; " + plain_number(100 * used, 3) +
                                   " % were used in " + plain_number(span, 4) + " s in the air"});
  }

  bool airborne_at(double time) const {
    const double place = std::round((time - motion_.states.front().time) / motion_.step);
    return place >= 0 && place < static_cast<double>(motion_.states.size()) &&
           motion_.states[static_cast<std::size_t>(place)].airborne;
  }

  const FlightLog& log_;
  const Vehicle& base_;
  ShownMotion motion_;
  ShownLimits limits_;
};

}  // namespace

const ShownFigure* ShownLimits::find(std::string_view key) const {
  for (const ShownFigure& figure : figures)
    if (figure.key == key) return &figure;
  return nullptr;
}

ShownLimits shown_limits(const FlightLog& log, const Vehicle& base) {
  return Collection(log, base).run();
}

}  // namespace lapwing
