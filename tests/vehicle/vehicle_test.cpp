// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "framework/core/units.h"
#include "tests/vehicle/vehicle_fixture.h"

namespace lapwing {
namespace {

using testing::HasSubstr;

std::string error_of(const Value& vehicle, const Value& camera = camera_file()) {
  try {
    read_vehicle(vehicle, camera);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

Value with(const char* table, const char* key, Value value) {
  Value file = vehicle_file();
  (*table ? *file.find(table) : file).set(key, std::move(value));
  return file;
}

Value pair_of(double a, double b) {
  return Value(Value::List{a, b});
}

TEST(Vehicle, ReadsUnitsAndDegrees) {
  const Vehicle v = read_vehicle(vehicle_file());
  EXPECT_EQ(v.name, "solo");
  EXPECT_DOUBLE_EQ(v.speed_across_max, 10.0);
  EXPECT_DOUBLE_EQ(v.flight_time, 1200.0);
  EXPECT_DOUBLE_EQ(v.yaw_rate_max, std::numbers::pi / 2);
  ASSERT_TRUE(v.gimbal);
  EXPECT_DOUBLE_EQ(v.gimbal->pitch_min, -std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(v.gimbal->pitch_rate_max, std::numbers::pi / 2);
  EXPECT_EQ(v.camera.name, "action");
  EXPECT_EQ(v.camera.width, 1920);
  EXPECT_TRUE(v.rotors.diagonal);
  EXPECT_FALSE(v.acceleration_up_max);
}

TEST(Vehicle, BoundsHaveTheValuesOfSection383) {
  const Vehicle v = read_vehicle(vehicle_file());
  EXPECT_NEAR(v.thrust_max(), 0.9 * 32.0, 1e-12);  // "20 % of the moment leaves 90 % of the thrust"
  EXPECT_NEAR(v.thrust_min(), 0.1 * 32.0 + 0.8, 1e-12);
  EXPECT_NEAR(v.yaw_torque_max(), 0.2 * 2 * 0.016 * 8.0, 1e-15);
}

// Thrusts of the two rotor pairs that give thrust u and yaw moment m without roll or pitch moment:
// the solution of (3.11), written out independently of the bounds.
std::pair<double, double> pairs(const Vehicle& v, double u, double m) {
  const double k = v.rotors.torque_coefficient;
  return {u / 4 + m / (4 * k), u / 4 - m / (4 * k)};
}

void expect_rotors_within(const Vehicle& v, double u, double m) {
  const auto [a, b] = pairs(v, u, m);
  EXPECT_NEAR(2 * (a + b), u, 1e-12);
  EXPECT_NEAR(2 * v.rotors.torque_coefficient * (a - b), m, 1e-12);
  for (const double f : {a, b}) {
    EXPECT_GE(f, v.rotors.thrust_min - 1e-12) << "u " << u << " m " << m;
    EXPECT_LE(f, v.rotors.thrust_max + 1e-12) << "u " << u << " m " << m;
  }
}

TEST(Vehicle, EveryThrustAndYawMomentWithinBoundsKeepsEachRotorWithinItsOwn) {
  for (const double smallest : {0.0, 0.2, 1.0}) {
    for (const double share : {0.01, 0.2, 0.5}) {
      Vehicle v = read_vehicle(vehicle_file());
      v.rotors.thrust_min = smallest;
      v.yaw_share = share;
      for (int i = 0; i <= 50; ++i) {
        for (int j = 0; j <= 50; ++j) {
          const double u = v.thrust_min() + (v.thrust_max() - v.thrust_min()) * i / 50;
          expect_rotors_within(v, u, v.yaw_torque_max() * (2.0 * j / 50 - 1));
        }
      }
    }
  }
}

TEST(Vehicle, BoundsAreTight) {
  const Vehicle v = read_vehicle(vehicle_file());
  EXPECT_NEAR(pairs(v, v.thrust_max(), v.yaw_torque_max()).first, v.rotors.thrust_max, 1e-12);
  EXPECT_NEAR(pairs(v, v.thrust_min(), v.yaw_torque_max()).second, v.rotors.thrust_min, 1e-12);
}

TEST(Vehicle, RefusesLimitsThatContradict) {
  EXPECT_THAT(error_of(with("rotors", "thrust", pair_of(8, 0.2))), HasSubstr("below the largest"));
  EXPECT_THAT(error_of(with("gimbal", "pitch_deg", pair_of(0, -90))),
              HasSubstr("the range 0 to -90 degrees is empty"));
  EXPECT_THAT(error_of(with("gimbal", "pitch_rate_deg", 0)), HasSubstr("but a rate of 0"));
  EXPECT_THAT(error_of(with("", "yaw_share", 1.0)), HasSubstr("yaw_share"));
  EXPECT_THAT(error_of(with("", "inertia", Value(Value::List{0.01, 0.01, 0.03}))),
              HasSubstr("moment of inertia"));
}

TEST(Vehicle, RefusesAVehicleThatCannotHover) {
  EXPECT_THAT(error_of(with("", "mass", 3.0)), HasSubstr("cannot hover: its weight is 29.42 N"));
  EXPECT_THAT(error_of(with("", "mass", 0.3)), HasSubstr("cannot hover"));
  EXPECT_THAT(error_of(with("", "yaw_share", 0.999)), HasSubstr("hover"));
}

TEST(Vehicle, RefusesHalfAGimbalAndNamesWhatIsMissing) {
  Value file = vehicle_file();
  file.set("gimbal", Value::map()).set("pitch_deg", pair_of(-90, 0));
  const std::string message = error_of(file);
  EXPECT_THAT(message, HasSubstr("gimbal.yaw_deg"));
  EXPECT_THAT(message, HasSubstr("gimbal.pitch_rate_deg"));
}

TEST(Vehicle, WithoutAGimbalTheCameraIsFixed) {
  Value file = vehicle_file();
  std::erase_if(file.as_map(), [](const auto& entry) { return entry.first == "gimbal"; });
  EXPECT_FALSE(read_vehicle(file).gimbal);
}

TEST(Vehicle, CollectsErrorsOfTheTable) {
  Value file = vehicle_file();
  file.set("mas", 1.5);
  file.find("limits")->set("climb_speed", "2 kg");
  file.find("limits")->set("yaw_rate_deg", -1);
  const std::string message = error_of(file);
  EXPECT_THAT(message, HasSubstr("mass"));
  EXPECT_THAT(message, HasSubstr("limits.climb_speed"));
  EXPECT_THAT(message, HasSubstr("limits.yaw_rate_deg"));
}

TEST(Vehicle, RefusesCamerasThatCannotBe) {
  Value camera = camera_file();
  camera.set("image_size", pair_of(1920.5, 1080));
  EXPECT_THAT(error_of(vehicle_file(), camera), HasSubstr("whole numbers"));
  camera = camera_file();
  camera.set("principal_point", pair_of(5000, 500));
  EXPECT_THAT(error_of(vehicle_file(), camera), HasSubstr("within the image"));
}

TEST(Vehicle, RoundTripsThroughAPlanExactly) {
  Vehicle v = read_vehicle(vehicle_file());
  v.acceleration_up_max = 0.1 + 0.2;
  const Value value = to_value(v);
  const Value again = to_value(vehicle_from_value(from_json(to_json(value), "plan.json")));
  EXPECT_EQ(value, again);
  EXPECT_EQ(to_json(value), to_json(again));
}

TEST(Vehicle, PlanBlockIsReadStrictly) {
  Value value = to_value(read_vehicle(vehicle_file()));
  value.find("limits")->set("speed_acros", 99.0);
  value.find("camera")->set("width", 1.5);
  value.set("mass", std::nan(""));
  std::erase_if(value.as_map(), [](const auto& entry) { return entry.first == "flight_time"; });
  try {
    vehicle_from_value(value);
    FAIL();
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_THAT(message, HasSubstr("did you mean 'speed_across'"));
    EXPECT_THAT(message, HasSubstr("vehicle.camera.width: expected an integer"));
    EXPECT_THAT(message, HasSubstr("vehicle.mass: expected a finite number"));
    EXPECT_THAT(message, HasSubstr("vehicle.flight_time: missing"));
  }
}

TEST(Vehicle, PlanBlockThatContradictsItselfIsRefused) {
  Value value = to_value(read_vehicle(vehicle_file()));
  value.find("gimbal")->set("pitch_min", 1.0);
  EXPECT_THROW(vehicle_from_value(value), InputError);
}

}  // namespace
}  // namespace lapwing
