// SPDX-License-Identifier: Apache-2.0
#include "framework/flight_review/shown_motion.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/flight_review/smooth_path.h"
#include "framework/geometry/geodetic.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr double kAirborne = 0.5;   // m above the ground
constexpr double kLeastFlight = 5;  // s

// The positions, in a local frame.
CurveSamples places_of(const FlightLog& log, std::string& source) {
  CurveSamples samples;
  for (const char* name : {"position", "place", "gps"}) {
    const LogSeries* series = log.find(name);
    if (!series) continue;
    source = std::string(name) + (series->source.empty() ? "" : " (" + series->source + ")");
    samples.times = series->times;
    samples.values.resize(static_cast<Eigen::Index>(series->size()), 3);
    const auto& v = series->values;
    for (std::size_t i = 0; i < series->size(); ++i) {
      Vector3d p(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
      if (std::string_view(name) != "position")
        p = to_local({v[0], v[1], v[2]}, {p.x(), p.y(), p.z()});
      samples.values.row(static_cast<Eigen::Index>(i)) = p.transpose();
    }
    break;
  }
  if (samples.times.empty()) throw InputError("the log holds no position");
  if (const LogSeries* velocity = log.find("velocity")) {
    samples.rate_times = velocity->times;
    samples.rates = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>>(
        velocity->values.data(), static_cast<Eigen::Index>(velocity->size()), 3);
  }
  return samples;
}

double typical_step(const std::vector<double>& times) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < times.size(); ++i) steps.push_back(times[i] - times[i - 1]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

template <class Vector>
std::optional<Vector> as(const std::optional<Eigen::VectorXd>& value) {
  return value ? std::optional<Vector>(Vector(*value)) : std::nullopt;
}

void add_others(const FlightLog& log, ShownState& state) {
  const double t = state.time;
  if (const auto q = value_at(log, "orientation", t))
    state.orientation = Eigen::Quaterniond((*q)[0], (*q)[1], (*q)[2], (*q)[3]);
  state.specific_force = as<Vector3d>(value_at(log, "specific_force", t));
  state.body_rates = as<Vector3d>(value_at(log, "body_rates", t));
  state.camera = as<Eigen::Vector2d>(value_at(log, "camera", t));
  if (const auto yaw = value_at(log, "yaw", t)) state.yaw = (*yaw)[0];
  if (const auto throttle = value_at(log, "throttle", t)) state.throttle = (*throttle)[0];
}

// Height below which the vehicle was for a fiftieth of the time: a smooth curve swings below the
// ground after a hard landing.
double low_height(const std::vector<ShownState>& states) {
  std::vector<double> heights;
  heights.reserve(states.size());
  for (const ShownState& state : states) heights.push_back(state.position.z());
  if (heights.empty()) return 0;
  const auto rank = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 50);
  std::nth_element(heights.begin(), rank, heights.end());
  return *rank;
}

}  // namespace

double ShownMotion::airborne_time() const {
  return step * static_cast<double>(std::count_if(states.begin(), states.end(),
                                                  [](const ShownState& s) { return s.airborne; }));
}

ShownMotion shown_motion(const FlightLog& log) {
  ShownMotion motion;
  const CurveSamples samples = places_of(log, motion.source);
  if (samples.times.size() < 8)
    throw InputError("the log holds " + std::to_string(samples.times.size()) +
                     " positions: too few for limits");
  const double start = samples.times.front(), finish = samples.times.back();
  const double typical = typical_step(samples.times);
  const SmoothCurve curve(samples, start, finish, std::clamp(2 * typical, 0.1, 1.0));
  motion.step = std::max(0.05, (finish - start) / 200000);
  const auto count = static_cast<std::size_t>((finish - start) / motion.step);
  for (std::size_t i = 0; i <= count; ++i) {
    ShownState state;
    state.time = start + motion.step * static_cast<double>(i);
    state.position = curve.at(state.time);
    state.velocity = curve.at(state.time, 1);
    state.acceleration = curve.at(state.time, 2);
    add_others(log, state);
    motion.states.push_back(std::move(state));
  }
  const double ground = low_height(motion.states);
  for (ShownState& state : motion.states) state.airborne = state.position.z() > ground + kAirborne;
  if (motion.airborne_time() < kLeastFlight)
    throw InputError("the log shows " + plain_number(motion.airborne_time(), 3) +
                     " s in the air, 5 s are needed for limits");
  return motion;
}

}  // namespace lapwing
