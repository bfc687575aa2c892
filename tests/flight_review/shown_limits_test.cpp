// SPDX-License-Identifier: Apache-2.0
// Vehicles with known limits, drag, thrust and lag, read from their logs.
#include "framework/flight_review/shown_limits.h"

#include <map>

#include <gmock/gmock.h>

#include "framework/core/error.h"
#include "framework/flight_log/log_builder.h"
#include "framework/flight_review/shown_fits.h"
#include "tests/flight_review/recorded_flight.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

constexpr double kWeight = 9.80665;  // m/s^2

struct Truth {
  double drag = 0.25;  // 1/s
  Vector3d wind{2, -1, 0};
  double full = 25, exponent = 1.5;  // m/s^2 at full throttle
  double lag = 0.06;                 // s
};

// A flight of two minutes along waves whose thrust, attitude and throttle follow from it.
FlightLog known_flight(const Truth& truth, double noise = 0.05, std::uint64_t seed = 5) {
  LogBuilder builder("test", 0);
  Random random(seed);
  const auto error = [&] { return noise * std::sqrt(3.0) * random.uniform(-1, 1); };
  double followed = NAN, last = 0;
  for (int i = 0; i <= 120 * 200; ++i) {
    const double t = 0.005 * i;
    const Vector3d p(15 * std::sin(0.4 * t), 10 * std::sin(0.31 * t + 1),
                     10 + 4 * std::sin(0.9 * t) + 0.08 * std::sin(7 * t));
    const Vector3d v(6 * std::cos(0.4 * t), 3.1 * std::cos(0.31 * t + 1),
                     3.6 * std::cos(0.9 * t) + 0.56 * std::cos(7 * t));
    const Vector3d a(-2.4 * std::sin(0.4 * t), -0.961 * std::sin(0.31 * t + 1),
                     -3.24 * std::sin(0.9 * t) - 3.92 * std::sin(7 * t));
    // The thrust carries what gravity and drag leave, along the body's z axis.
    const Vector3d force = a + Vector3d(0, 0, kWeight) + truth.drag * (v - truth.wind);
    const Eigen::Quaterniond tilt = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), force);
    const Eigen::Quaterniond q = tilt * Eigen::AngleAxisd(0.5 * t, Vector3d::UnitZ());
    const double thrust = force.norm();
    // The command that gives this thrust through the lag, exactly for held commands.
    if (std::isnan(followed)) followed = thrust;
    const double command = (thrust - followed * std::exp(-(t - last) / truth.lag)) /
                           (i == 0 ? 1 : 1 - std::exp(-(t - last) / truth.lag));
    const double held = i == 0 ? thrust : command;
    EXPECT_GT(held, 0.1);  // else the rotors could not do it
    if (i > 0)
      builder.add("throttle", last,
                  {std::pow(std::max(0.1, held) / truth.full, 1 / truth.exponent)});
    followed = thrust;
    last = t;
    const Vector3d specific =
        q.conjugate() * Vector3d(a + Vector3d(0, 0, kWeight)) + Vector3d(error(), error(), error());
    builder.add("specific_force", t, {specific.x(), specific.y(), specific.z()});
    if (i % 4) continue;
    builder.add("position", t, {p.x(), p.y(), p.z()});
    builder.add("velocity", t, {v.x(), v.y(), v.z()});
    builder.add("orientation", t, {q.w(), q.x(), q.y(), q.z()});
    builder.add("camera", t, {0.5 * t, -0.5 + 0.4 * std::sin(1.2 * t)});
    builder.add("battery", t, {15, 10, 0.9 - 0.4 * t / 120});
  }
  return builder.finish();
}

TEST(ShownLimits, LimitsAndFitsComeBackWithinTheirIntervals) {
  const Truth truth;
  const ShownLimits shown = shown_limits(known_flight(truth), wave_vehicle());
  const auto value = [&](const char* key) {
    const ShownFigure* figure = shown.find(key);
    EXPECT_NE(figure, nullptr) << key;
    return figure ? figure->value : NAN;
  };
  double fastest = 0;
  for (double t = 0; t < 120; t += 0.01)
    fastest = std::max(fastest, std::hypot(6 * std::cos(0.4 * t), 3.1 * std::cos(0.31 * t + 1)));
  EXPECT_NEAR(value("limits.speed_across"), fastest, 0.1);
  // Held for half a second, so that the quick part of 0.56 m/s does not count.
  EXPECT_NEAR(value("limits.climb_speed"), 3.6, 0.5);
  EXPECT_NEAR(value("limits.descent_speed"), 3.6, 0.5);
  EXPECT_NEAR(value("gimbal.pitch_rate_deg"), 0.48 * 180 / M_PI, 1.5);
  EXPECT_NEAR(value("flight_time"), 0.8 * 120 / 0.4, 2);
  const double mass = wave_vehicle().mass;
  const ShownFigure* drag = shown.find("drag");
  ASSERT_NE(drag, nullptr);
  EXPECT_NEAR(drag->value, truth.drag * mass, 0.03 * mass);
  EXPECT_LT(*drag->low, *drag->high);
  EXPECT_THAT(drag->evidence, HasSubstr("95 % within"));
  EXPECT_NEAR(value("rotors.thrust"), truth.full * mass / 4, 0.005 * truth.full * mass / 4);
  EXPECT_NEAR(value("rotors.lag"), truth.lag, 0.001);
}

TEST(ShownLimits, TheWindIsFound) {
  const Truth truth;
  const auto drag = fit_drag(shown_motion(known_flight(truth)));
  ASSERT_TRUE(drag);
  EXPECT_NEAR(drag->drag.value, truth.drag, 0.02);
  EXPECT_LT((drag->wind - truth.wind.head<2>()).norm(), 0.4);
}

TEST(ShownLimits, IntervalsHoldTheTruthAndGrowWithNoise) {
  Truth truth;
  const auto quiet = fit_drag(shown_motion(known_flight(truth, 0.02)));
  const auto loud = fit_drag(shown_motion(known_flight(truth, 1)));
  ASSERT_TRUE(quiet && loud);
  EXPECT_GT(loud->drag.high - loud->drag.low, quiet->drag.high - quiet->drag.low);
  EXPECT_LT(loud->drag.low, truth.drag);
  EXPECT_GT(loud->drag.high, truth.drag);
}

// What is called an interval of 95 % holds the truth in most flights.
TEST(ShownLimits, IntervalsHoldTheTruthOfManyFlights) {
  const Truth truth;
  std::map<std::string, int> held;
  const auto count = [&](const std::string& name, const FitResult& fit, double value) {
    if (fit.low <= value && value <= fit.high) ++held[name];
  };
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const FlightLog log = known_flight(truth, 0.3, seed);
    const ShownMotion motion = shown_motion(log);
    const auto drag = fit_drag(motion);
    const auto thrust = fit_thrust(log, motion);
    ASSERT_TRUE(drag && thrust);
    const auto lag = fit_lag(log, motion, thrust->exponent.value);
    ASSERT_TRUE(lag);
    count("drag", drag->drag, truth.drag);
    count("thrust", thrust->full, truth.full);
    count("exponent", thrust->exponent, truth.exponent);
    count("lag", *lag, truth.lag);
    if (seed > 2) continue;
    std::printf("drag %.5f..%.5f thrust %.4f..%.4f p %.4f..%.4f lag %.5f..%.5f\n", drag->drag.low,
                drag->drag.high, thrust->full.low, thrust->full.high, thrust->exponent.low,
                thrust->exponent.high, lag->low, lag->high);
  }
  for (const char* name : {"drag", "thrust", "exponent", "lag"}) EXPECT_GE(held[name], 17) << name;
}

TEST(ShownLimits, TimeOnTheGroundIsNoFlightTime) {
  LogBuilder builder("test", 0);
  const auto add = [&](double t, double z, double left) {
    builder.add("position", t, {z > 0 ? 5 * std::sin(0.4 * t) : 0.0, 0, z});
    builder.add("battery", t, {15, 10, left});
  };
  // Ten minutes of idling use a twentieth, two minutes in the air two fifths.
  for (double t = -600; t < 0; t += 0.1) add(t, 0, 0.95 - 0.05 * (t + 600) / 600);
  for (double t = 0; t <= 120; t += 0.1) add(t, std::min(8.0, 2 * t), 0.9 - 0.4 * t / 120);
  for (double t = 120.1; t < 300; t += 0.1) add(t, 0, 0.5);
  const ShownFigure* time = nullptr;
  const ShownLimits shown = shown_limits(builder.finish(), wave_vehicle());
  time = shown.find("flight_time");
  ASSERT_NE(time, nullptr);
  // A third of a percent in a second: four fifths last 240 s.
  EXPECT_NEAR(time->value, 240, 3);
}

TEST(ShownLimits, AWrongTimeTakesNeitherMemoryNorTheLimits) {
  const Truth truth;
  FlightLog sound = known_flight(truth);
  const double thrust = shown_limits(sound, wave_vehicle()).find("rotors.thrust")->value;
  for (const double wrong : {1e7, 1e9}) {
    LogBuilder builder("test", 0);
    for (const auto& [name, series] : sound.series) {
      const auto width = static_cast<std::size_t>(log_quantity(name).width);
      for (std::size_t i = 0; i < series.size(); ++i)
        builder.add(log_quantity(name).name, series.times[i],
                    std::span(&series.values[width * i], width));
      builder.add(log_quantity(name).name, wrong, std::span(series.values.data(), width));
    }
    const FlightLog log = builder.finish();
    EXPECT_LT(log.finish(), 200);
    std::string said;
    for (const std::string& remark : log.remarks) said += remark + "\n";
    EXPECT_THAT(said, HasSubstr("'position': 1 sample far from the time of the recording"));
    EXPECT_NEAR(shown_limits(log, wave_vehicle()).find("rotors.thrust")->value, thrust, 1e-9);
  }
  // A log that was not built so: blocks without data take no memory.
  LogSeries& force = sound.series["specific_force"];
  force.times.push_back(1e12);
  for (const double one : {0.0, 0.0, 9.8}) force.values.push_back(one);
  EXPECT_NE(shown_limits(sound, wave_vehicle()).find("rotors.lag"), nullptr);
}

TEST(ShownLimits, WhatWasNotSeenIsLeftOutAndSaid) {
  LogBuilder builder("test", 0);
  for (int i = 0; i <= 300; ++i)
    builder.add("position", 0.1 * i, {0.5 * std::sin(0.1 * i), 0, i < 20 ? 0.1 * i : 2.0});
  const ShownLimits shown = shown_limits(builder.finish(), wave_vehicle());
  EXPECT_EQ(shown.find("drag"), nullptr);
  EXPECT_EQ(shown.find("rotors.lag"), nullptr);
  EXPECT_EQ(shown.find("limits.speed_across"), nullptr);
  std::string said;
  for (const std::string& remark : shown.remarks) said += remark + "\n";
  EXPECT_THAT(said, HasSubstr("limits.speed_across: the flight showed"));
  EXPECT_THAT(said, HasSubstr("less than a fifth of the base"));
  EXPECT_THAT(said, HasSubstr("the gimbal was not seen"));
  EXPECT_THAT(said, HasSubstr("the flight time was not seen"));
  EXPECT_THAT(said, HasSubstr("mass and inertia cannot be seen in a log"));
}

TEST(ShownLimits, AFlightOfAMomentIsRefused) {
  LogBuilder builder("test", 0);
  for (int i = 0; i <= 30; ++i) builder.add("position", 0.1 * i, {0, 0, 0.1 * i});
  const FlightLog log = builder.finish();
  EXPECT_THROW(shown_limits(log, wave_vehicle()), InputError);
}

}  // namespace
}  // namespace lapwing
