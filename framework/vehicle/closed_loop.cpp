// SPDX-License-Identifier: Apache-2.0
#include "framework/vehicle/closed_loop.h"

#include <cmath>
#include <numbers>

#include "framework/core/error.h"
#include "framework/core/random.h"
#include "framework/vehicle/flight_controller.h"

namespace lapwing {

using Eigen::Vector3d;

namespace {

constexpr double kGustTime = 1.5;  // s, over which a gust forgets itself
constexpr double kLost = 100.0;    // m

// A first-order Gauss-Markov process about a mean.
class Wind {
 public:
  Wind(const FlightConditions& conditions)
      : mean_(conditions.wind_mean *
              Vector3d(std::cos(conditions.wind_yaw), std::sin(conditions.wind_yaw), 0)),
        sigma_(conditions.wind_gust, conditions.wind_gust, conditions.wind_gust / 2),
        keep_(std::exp(-conditions.step / kGustTime)),
        random_(conditions.seed) {
    for (int i = 0; i < 3; ++i) gust_(i) = sigma_(i) * random_.normal();
  }
  Vector3d next() {
    const double fresh = std::sqrt(1 - keep_ * keep_);
    for (int i = 0; i < 3; ++i) gust_(i) = keep_ * gust_(i) + fresh * sigma_(i) * random_.normal();
    return mean_ + gust_;
  }

 private:
  Vector3d mean_, sigma_, gust_ = Vector3d::Zero();
  double keep_;
  Random random_;
};

void check(const FlightConditions& c, const Vehicle& vehicle) {
  const auto refuse = [](const std::string& text) { throw InputError({}, text); };
  constexpr double kFastestWind = 150;  // m/s, beyond what was ever measured near the ground
  if (!(c.wind_mean >= 0 && c.wind_gust >= 0 && c.wind_mean + c.wind_gust <= kFastestWind))
    refuse("wind: mean and gust must be at least 0 m/s, and at most 150 m/s together");
  if (!std::isfinite(c.wind_yaw)) refuse("wind: its direction must be a number");
  if (!(c.mass_error > -0.9 && c.mass_error <= 10))
    refuse("mass error: must lie between -90 and 1000 percent");
  if (!(c.step > 0 && c.step <= 0.02 && c.sample_step >= c.step))
    refuse("the controller's step must lie between 0 and 0.02 s");
  if ((c.wind_mean > 0 || c.wind_gust > 0) && vehicle.drag <= 0)
    refuse("vehicle '" + vehicle.name +
           "' states no drag, so that wind cannot move it: add 'drag' "
           "to its file");
}

// The yaw of an attitude is that of the heading at right angles to its y axis (thesis 3.8.2); where
// the x axis points seen from above differs from it by the product of two tilts.
double yaw_error_of(const BodyState& state, double yaw) {
  const Vector3d y = state.orientation * Vector3d::UnitY();
  return std::remainder(std::atan2(-y.x(), y.y()) - yaw, 2 * std::numbers::pi);
}

// In the state that the reference starts with, rotors at its thrust.
BodyState starting_state(const ReferenceMotion& reference, const FlightController& controller) {
  const ReferencePoint start = reference.at(reference.start());
  const AttitudeReference attitude = controller.attitude(reference.start());
  BodyState state;
  state.position = start.position;
  state.velocity = start.velocity;
  state.orientation = attitude.orientation;
  state.body_rates = attitude.body_rates;
  state.rotor_thrusts.setConstant(reference.force(start).norm() / 4);
  return state;
}

}  // namespace

FlownPath fly(const Trajectory& trajectory, const Vehicle& vehicle,
              const FlightConditions& conditions, const CancellationToken* cancellation,
              const std::function<void(double)>& told) {
  check(conditions, vehicle);
  const ReferenceMotion reference(trajectory, vehicle);
  FlightController controller(vehicle, reference);
  const RotorBody body(vehicle, 1 + conditions.mass_error);
  Wind wind(conditions);
  BodyState state = starting_state(reference, controller);

  FlownPath path;
  const double duration = reference.finish() - reference.start();
  const auto steps = static_cast<std::int64_t>(std::ceil(duration / conditions.step - 1e-9));
  const double step = duration / static_cast<double>(steps);
  const auto every = std::max<std::int64_t>(1, std::llround(conditions.sample_step / step));
  double sum = 0;
  std::int64_t saturated = 0, flown = 0;
  for (std::int64_t k = 0; k <= steps && !path.lost; ++k) {
    if (k % 1024 == 0) {
      if (cancellation && cancellation->cancelled()) throw Cancelled();
      if (told) told(static_cast<double>(k) / static_cast<double>(steps));
    }
    const double time = reference.start() + static_cast<double>(k) * step;
    const ReferencePoint wanted = reference.at(time);
    const double error = (state.position - wanted.position).norm();
    const double yaw_error = yaw_error_of(state, wanted.yaw);
    if (!(error <= kLost)) path.lost = true;
    if ((state.orientation * Vector3d::UnitZ()).z() < 0) path.lost = true;
    if (!(error <= path.position_error_worst))
      path.position_error_worst = error, path.position_error_at = time;
    if (!(std::abs(yaw_error) <= path.yaw_error_worst))
      path.yaw_error_worst = std::abs(yaw_error), path.yaw_error_at = time;
    if (k % every == 0 || k == steps || path.lost)
      path.samples.push_back({time, state, wanted.position, error, yaw_error});
    sum += error;
    ++flown;
    if (k == steps || path.lost) break;
    const RotorCommand command = controller.command(time, state, step);
    saturated += command.saturated;
    state = body.after(state, command.thrusts, wind.next(), step);
    path.rotor_speed_worst =
        std::max(path.rotor_speed_worst,
                 std::sqrt(state.rotor_thrusts.maxCoeff() / vehicle.rotors.thrust_max));
  }
  path.position_error_mean = sum / static_cast<double>(flown);
  path.saturated_share =
      static_cast<double>(saturated) / static_cast<double>(std::max<std::int64_t>(1, flown - 1));
  return path;
}

}  // namespace lapwing
