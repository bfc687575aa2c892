// SPDX-License-Identifier: Apache-2.0
// What the simulator adds to a plan: gusts, drag, delays, noise, a battery; and its integrator
// against another's.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <boost/numeric/odeint.hpp>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/units.h"
#include "framework/vehicle/closed_loop.h"
#include "framework/vehicle/dryden.h"
#include "framework/vehicle/monte_carlo.h"
#include "tests/verify/reference_plan.h"

namespace lapwing {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::Vector4d;
using testing::HasSubstr;

Vehicle windy_vehicle() {
  Vehicle vehicle = reference_vehicle();
  vehicle.drag = 0.25;
  vehicle.rotors.lag = 0.03;
  return vehicle;
}

// Position, velocity, quaternion (w first), body rates, rotor thrusts.
using Numbers = std::array<double, 17>;

// The equations of the header, written out a second time, in quaternion rates.
void rates_of(const Vehicle& v, const Vector4d& commanded, const Vector3d& wind, double quadratic,
              const Numbers& x, Numbers& rate) {
  const Vector3d velocity(x[3], x[4], x[5]), w(x[10], x[11], x[12]);
  const Quaterniond q(x[6], x[7], x[8], x[9]);
  const Vector4d thrusts(x[13], x[14], x[15], x[16]);
  const Vector4d u = mixer_of(v.rotors) * thrusts;
  const Vector3d air = velocity - wind;
  const Vector3d a =
      (q.normalized() * Vector3d(0, 0, u(0)) - v.drag * air - quadratic * air.norm() * air) /
          v.mass -
      Vector3d(0, 0, kGravity);
  const Quaterniond turn = q * Quaterniond(0, w.x() / 2, w.y() / 2, w.z() / 2);
  const Vector3d spin =
      (Vector3d(u.tail<3>()) - w.cross(v.inertia.cwiseProduct(w))).cwiseQuotient(v.inertia);
  for (int i = 0; i < 3; ++i) rate[i] = velocity(i), rate[3 + i] = a(i), rate[10 + i] = spin(i);
  rate[6] = turn.w(), rate[7] = turn.x(), rate[8] = turn.y(), rate[9] = turn.z();
  for (int i = 0; i < 4; ++i) rate[13 + i] = (commanded(i) - thrusts(i)) / v.rotors.lag;
}

// Runge-Kutta 4 in steps of 2 ms against an adaptive Dormand-Prince of Boost.Odeint.
TEST(RotorBody, IsWhereAnAdaptiveIntegratorIs) {
  namespace odeint = boost::numeric::odeint;
  const Vehicle vehicle = windy_vehicle();
  const Vector3d wind(3, -1, 0.5);
  const double quadratic = 0.05, hover = vehicle.mass * kGravity / 4;
  const RotorBody body(vehicle, 1, 1, quadratic);
  BodyState state;
  state.velocity = {4, 1, -1};
  state.body_rates = {2, -1, 3};
  state.orientation = Quaterniond(Eigen::AngleAxisd(0.4, Vector3d(1, 2, 3).normalized()));
  state.rotor_thrusts.setConstant(hover);
  Numbers x{0, 0, 0, 4, 1, -1};
  const Quaterniond& q = state.orientation;
  x[6] = q.w(), x[7] = q.x(), x[8] = q.y(), x[9] = q.z();
  for (int i = 0; i < 3; ++i) x[10 + i] = state.body_rates(i);
  for (int i = 0; i < 4; ++i) x[13 + i] = hover;
  const auto stepper = odeint::make_controlled<odeint::runge_kutta_dopri5<Numbers>>(1e-12, 1e-12);
  for (int leg = 0; leg < 10; ++leg) {
    const double roll = leg % 2 ? -1 : 1;
    const Vector4d commanded =
        hover * Vector4d(1.1 + 0.02 * roll, 1.1, 1.1 - 0.02 * roll, 1.1 + 0.01 * leg);
    for (int k = 0; k < 50; ++k) state = body.after(state, commanded, wind, 0.002);
    odeint::integrate_adaptive(
        stepper,
        [&](const Numbers& now, Numbers& rate, double) {
          rates_of(vehicle, commanded, wind, quadratic, now, rate);
        },
        x, 0.0, 0.1, 1e-4);
  }
  EXPECT_LT((state.position - Vector3d(x[0], x[1], x[2])).norm(), 1e-6);
  EXPECT_LT((state.velocity - Vector3d(x[3], x[4], x[5])).norm(), 1e-6);
  EXPECT_LT(state.orientation.angularDistance(Quaterniond(x[6], x[7], x[8], x[9]).normalized()),
            1e-6);
  EXPECT_LT((state.body_rates - Vector3d(x[10], x[11], x[12])).norm(), 1e-6);
  EXPECT_LT((state.rotor_thrusts - Vector4d(x[13], x[14], x[15], x[16])).norm(), 1e-9);
}

// MIL-F-8785C, figures 10 and 11: at 1000 ft all three lengths are 1000 ft and all deviations one.
TEST(Dryden, ScalesAreThoseOfTheStandard) {
  const double foot = 0.3048;
  const DrydenScales high = dryden_scales(1000 * foot);
  EXPECT_NEAR(high.along / foot, 1000, 1);
  EXPECT_NEAR(high.up / foot, 1000, 1e-9);
  EXPECT_NEAR(high.up_share, 1, 1e-3);
  const DrydenScales low = dryden_scales(20 * foot);
  EXPECT_NEAR(low.up / foot, 20, 1e-9);
  EXPECT_NEAR(low.along / foot, 20 / std::pow(0.177 + 0.000823 * 20, 1.2), 1e-9);
  EXPECT_EQ(dryden_scales(-5).up, dryden_scales(10 * foot).up);
}

// Deviations and the correlation over a short time, in steps short and long against the length.
TEST(Dryden, GustsHaveTheirDeviationAndSpectrum) {
  const double height = 10, speed = 8, sigma = 1.7;
  const DrydenScales scales = dryden_scales(height);
  for (const double step : {0.02, 2.0}) {
    DrydenGust gust(sigma, Random(5));
    const int count = 400000;
    Vector3d square = Vector3d::Zero(), lagged = Vector3d::Zero(), before = Vector3d::Zero();
    for (int k = 0; k < count; ++k) {
      const Vector3d now = gust.next(height, speed, step);
      square += now.cwiseAbs2();
      if (k > 0) lagged += now.cwiseProduct(before);
      before = now;
    }
    const double independent = std::max(1.0, scales.along / speed / step);
    const double slack = 8 / std::sqrt(count / independent);
    const Vector3d deviation = (square / count).cwiseSqrt();
    EXPECT_NEAR(deviation.x() / sigma, 1, slack);
    EXPECT_NEAR(deviation.y() / sigma, 1, slack);
    EXPECT_NEAR(deviation.z() / (sigma * scales.up_share), 1, slack);
    // Along: exp(-h). Across and up: (1 - h/2) exp(-h), h the step over the filter's time.
    const double h = step * speed / scales.along, up = step * speed / scales.up;
    EXPECT_NEAR(lagged.x() / square.x(), std::exp(-h), slack);
    EXPECT_NEAR(lagged.y() / square.y(), (1 - h / 2) * std::exp(-h), slack);
    EXPECT_NEAR(lagged.z() / square.z(), (1 - up / 2) * std::exp(-up), slack);
  }
}

double error_with(const Disturbances& disturbances) {
  return fly(reference_plan().trajectory, windy_vehicle(), {.disturbances = disturbances})
      .position_error_worst;
}

TEST(Disturbances, EachOneIsFelt) {
  const double calm = error_with({});
  EXPECT_GT(error_with({.quadratic_drag = 0.2}), 2 * calm);
  EXPECT_NE(error_with({.inertia_error = 0.3}), calm);
  EXPECT_GT(error_with({.battery_loss = 0.3, .battery_used = 0.5}), 2 * calm);
  EXPECT_GT(error_with({.position_noise = 0.05}), 2 * calm);
  EXPECT_GT(error_with({.velocity_noise = 0.2}), 2 * calm);
  EXPECT_GT(error_with({.attitude_noise = radians(3)}), 2 * calm);
  EXPECT_NE(error_with({.rate_noise = 0.2}), calm);
  EXPECT_NE(error_with({.estimator_delay = 0.02}), calm);
  EXPECT_NE(error_with({.command_delay = 0.02}), calm);
}

TEST(Disturbances, TheOnesOfADeadBatteryAreLostFlights) {
  const FlownPath path = fly(reference_plan().trajectory, windy_vehicle(),
                             {.disturbances = {.battery_loss = 0.9, .battery_used = 1}});
  EXPECT_GT(path.position_error_worst, 1);
}

TEST(Disturbances, NonsenseIsRefusedByName) {
  const auto refused = [](const Disturbances& d) -> std::string {
    try {
      error_with(d);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refused({.battery_loss = 1.5}), HasSubstr("battery_loss"));
  EXPECT_THAT(refused({.position_noise = -1}), HasSubstr("position_noise"));
  EXPECT_THAT(refused({.attitude_noise = 2}), HasSubstr("attitude_noise_deg"));
  EXPECT_THAT(refused({.command_delay = std::nan("")}), HasSubstr("command_delay"));
}

TEST(Disturbances, GoThroughAPlanAndBack) {
  Vehicle vehicle = windy_vehicle();
  const Value plain = to_value(vehicle);
  EXPECT_EQ(plain.find("simulation"), nullptr);
  EXPECT_EQ(plain.find("controller"), nullptr);
  vehicle.disturbances = {.battery_loss = 0.2, .command_delay = 0.01};
  vehicle.controller = Value("tvlqr");
  const Vehicle again = vehicle_from_value(to_value(vehicle));
  EXPECT_EQ(again.disturbances, vehicle.disturbances);
  EXPECT_EQ(again.controller, vehicle.controller);
  Value wrong = to_value(vehicle);
  wrong.set("simulation", [] {
    Value table = Value::map();
    table.set("battery_loss", 3.0);
    return table;
  }());
  EXPECT_THROW(vehicle_from_value(wrong), InputError);
}

TEST(MonteCarlo, IsTheSameForAnyNumberOfThreadsAndForEachSeedAlone) {
  const Trajectory trajectory = reference_plan().trajectory;
  const Vehicle vehicle = windy_vehicle();
  const ControlledPlan plan(trajectory, vehicle);
  const FlightConditions spread{.wind_gust = 1,
                                .mass_error = 0.1,
                                .disturbances = {.inertia_error = 0.1, .position_noise = 0.01},
                                .seed = 4};
  const std::vector<SeededRun> one = fly_runs(plan, spread, 4, 1);
  const std::vector<SeededRun> four = fly_runs(plan, spread, 4, 4);
  FlightConditions last = spread;
  last.seed = 7;
  const std::vector<SeededRun> alone = fly_runs(plan, last, 1, 1);
  ASSERT_EQ(one.size(), 4u);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].path.samples.back().state.position,
              four[i].path.samples.back().state.position);
    EXPECT_LE(std::abs(one[i].conditions.mass_error), 0.1);
    EXPECT_EQ(one[i].conditions.seed, 4 + i);
  }
  EXPECT_EQ(alone[0].path.position_error_worst, one[3].path.position_error_worst);
  EXPECT_NE(one[0].conditions.mass_error, one[1].conditions.mass_error);
  EXPECT_NE(one[0].path.position_error_worst, one[1].path.position_error_worst);
}

TEST(MonteCarlo, QuantilesAreLinearBetweenNeighbours) {
  EXPECT_EQ(quantile_of({3, 1, 2}, 0.5), 2);
  EXPECT_EQ(quantile_of({1, 2}, 0.25), 1.25);
  EXPECT_EQ(quantile_of({1, 2}, 1), 2);
  EXPECT_TRUE(std::isnan(quantile_of({}, 0.5)));
}

}  // namespace
}  // namespace lapwing
