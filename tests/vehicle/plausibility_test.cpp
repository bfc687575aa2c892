// SPDX-License-Identifier: Apache-2.0
// Figures in other units than the file's are found where they are written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "framework/config/yaml.h"
#include "framework/core/units.h"
#include "framework/vehicle/flight_controller.h"
#include "tests/vehicle/vehicle_fixture.h"

namespace lapwing {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// One figure a line, so that messages can be checked for lines.
std::string small_racer(const std::string& key, const std::string& value) {
  std::vector<std::pair<std::string, std::string>> lines = {{"mass", "0.9"},
                                                            {"inertia", "[0.001, 0.001, 0.0017]"},
                                                            {"yaw_share", "0.1"},
                                                            {"flight_time", "240"},
                                                            {"camera", "cameras/action"},
                                                            {"rotors", ""},
                                                            {"  thrust", "[0, 7]"},
                                                            {"  torque_coefficient", "0.05"},
                                                            {"  arm_length", "0.15"},
                                                            {"limits", ""},
                                                            {"  speed_across", "25"},
                                                            {"  climb_speed", "15"},
                                                            {"  descent_speed", "15"},
                                                            {"  acceleration_across", "40"},
                                                            {"  yaw_rate_deg", "170"}};
  std::string text;
  for (auto& [name, standard] : lines)
    text += name + ": " + (name == key ? value : standard) + "\n";
  return text;
}

std::string message_of(const std::string& key, const std::string& value,
                       const Value& camera = camera_file()) {
  try {
    read_vehicle(from_yaml(small_racer(key, value), "racer.yaml"), camera);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Plausibility, ASlipOfUnitsIsNamedWithLineKeyAndUnit) {
  EXPECT_EQ(message_of("mass", "0.9"), "accepted");
  EXPECT_THAT(message_of("inertia", "[6000, 6000, 11000]"),
              AllOf(HasSubstr("racer.yaml:2: inertia: 6000 kg m^2 for a mass of 0.9 kg"),
                    HasSubstr("is it g cm^2? Then write '6000 g cm^2'")));
  EXPECT_THAT(message_of("inertia", "[10, 10, 17]"), HasSubstr("is it kg cm^2?"));
  EXPECT_THAT(message_of("inertia", "[900, 900, 1500]"), HasSubstr("is it g cm^2?"));
  EXPECT_THAT(message_of("inertia", "[1e6, 1e6, 1.7e6]"), HasSubstr("is it g mm^2?"));
  EXPECT_THAT(message_of("inertia", "[1e-12, 1e-12, 1e-12]"), HasSubstr("racer.yaml:2: inertia"));
  EXPECT_THAT(message_of("  arm_length", "1e-12"),
              HasSubstr("racer.yaml:9: rotors.arm_length: 1e-12 m is not what a multirotor has"));
  EXPECT_THAT(message_of("  arm_length", "150"), HasSubstr("is it mm? Then write '150 mm'"));
  EXPECT_THAT(message_of("  arm_length", "15"), HasSubstr("is it cm? Then write '15 cm'"));
  EXPECT_THAT(message_of("  thrust", "[0, 700]"),
              AllOf(HasSubstr("racer.yaml:7: rotors.thrust"), HasSubstr("is it gf?")));
  EXPECT_THAT(message_of("mass", "900"),
              AllOf(HasSubstr("racer.yaml:1: mass"), HasSubstr("Then write '900 g'")));
  EXPECT_THAT(message_of("mass", "9e6"), HasSubstr("racer.yaml:1: mass"));
  EXPECT_THAT(message_of("yaw_share", "1e-300"), HasSubstr("racer.yaml:3: yaw_share: 1e-300 is"));
  EXPECT_THAT(message_of("  torque_coefficient", "1e-300"),
              HasSubstr("racer.yaml:8: rotors.torque_coefficient"));
  EXPECT_THAT(message_of("flight_time", "1e-300"), HasSubstr("racer.yaml:4: flight_time"));
  EXPECT_THAT(message_of("flight_time", "4"), HasSubstr("is it min? Then write '4 min'"));
  EXPECT_THAT(message_of("  speed_across", "1e300"), HasSubstr("racer.yaml:11: limits.speed_"));
  EXPECT_THAT(message_of("  climb_speed", "1500"), HasSubstr("is it cm/s?"));
  EXPECT_THAT(message_of("  yaw_rate_deg", "1e-9"), HasSubstr("racer.yaml:15: limits.yaw_rate"));
  Value camera = camera_file();
  camera.set("focal_length", Value(Value::List{8.8, 8.8}));
  EXPECT_THAT(message_of("mass", "0.9", camera), HasSubstr("for an image 1920 px wide"));
}

TEST(Plausibility, WhatIsSuggestedIsAccepted) {
  EXPECT_EQ(message_of("inertia", "[6000 g cm^2, 6000 g cm^2, 11000 g cm^2]"), "accepted");
  EXPECT_EQ(message_of("  arm_length", "150 mm"), "accepted");
  EXPECT_EQ(message_of("  arm_length", "6 in"), "accepted");
  EXPECT_EQ(message_of("  thrust", "[0 gf, 700 gf]"), "accepted");
  EXPECT_EQ(message_of("mass", "900 g"), "accepted");
  EXPECT_EQ(message_of("flight_time", "4 min"), "accepted");
}

// The number that was written is suggested, not the one that it was converted to.
TEST(Plausibility, ASlipFromAnotherUnitIsNamedAsWritten) {
  EXPECT_THAT(message_of("flight_time", "900 h"), HasSubstr("is it s? Then write '900 s'"));
  EXPECT_THAT(message_of("flight_time", "9e5 min"), HasSubstr("Then write '9e+05 s'"));
  EXPECT_THAT(message_of("  arm_length", "0.15 mm"), HasSubstr("Then write '0.15 m'"));
  EXPECT_THAT(message_of("mass", "0.9 g"), HasSubstr("Then write '0.9 kg'"));
}

std::string gimbal_message(const std::string& gimbal) {
  try {
    read_vehicle(from_yaml(small_racer("", "") + "gimbal: {" + gimbal + "}\n", "racer.yaml"));
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Plausibility, RadiansInDegreesOfAGimbalAreNamed) {
  const std::string still = "yaw_deg: [0, 0], yaw_rate_deg: 0, ";
  const std::string level = "pitch_deg: [0, 0], pitch_rate_deg: 0, ";
  EXPECT_THAT(gimbal_message(still + "pitch_deg: [-1.57, 0], pitch_rate_deg: 1.05"),
              AllOf(HasSubstr("racer.yaml:16: gimbal.pitch_deg: -1.57 to 0 degrees is narrower"),
                    HasSubstr("is it rad? Then write '[-1.57 rad, 0 rad]'"),
                    HasSubstr("gimbal.pitch_rate_deg: 1.05 deg/s"),
                    HasSubstr("is it rad/s? Then write '1.05 rad/s'")));
  EXPECT_EQ(gimbal_message(still + "pitch_deg: [-1.57 rad, 0 rad], pitch_rate_deg: 1.05 rad/s"),
            "accepted");
  EXPECT_THAT(gimbal_message(level + "yaw_deg: [-3.14, 3.14], yaw_rate_deg: 90"),
              HasSubstr("gimbal.yaw_deg"));
  // Real ones: of camera drones, of cinema, one that only levels, a slow one.
  for (const char* real :
       {"pitch_deg: [-90, 30], pitch_rate_deg: 100", "pitch_deg: [-15, 15], pitch_rate_deg: 10",
        "pitch_deg: [-5, 5], pitch_rate_deg: 3", "pitch_deg: [-90, -90], pitch_rate_deg: 0"})
    EXPECT_EQ(gimbal_message(still + real), "accepted") << real;
}

// Figures of multirotors from 20 g to 150 kg, each as its maker or a paper gives it, rounded.
TEST(Plausibility, RealMultirotorsAreAccepted) {
  struct Real {
    const char* name;
    double mass, arm, ixx, izz, thrust, torque;
  };
  const Real reals[] = {{"toy", 0.020, 0.032, 8e-6, 1.3e-5, 0.12, 0.004},
                        {"indoor research", 0.027, 0.046, 1.4e-5, 2.2e-5, 0.15, 0.006},
                        {"five inch racer", 0.60, 0.11, 0.0015, 0.0028, 15, 0.014},
                        {"folding camera drone", 0.25, 0.12, 0.0006, 0.001, 1.2, 0.008},
                        {"survey", 4.7, 0.45, 0.12, 0.2, 25, 0.02},
                        {"cinema", 25, 0.8, 1.6, 2.8, 130, 0.03},
                        {"spraying", 90, 1.4, 18, 32, 500, 0.05},
                        {"cargo", 150, 1.8, 60, 100, 900, 0.06}};
  for (const Real& r : reals) {
    Value file = vehicle_file();
    file.set("mass", r.mass);
    file.set("yaw_share", 0.05);
    file.set("inertia", Value(Value::List{r.ixx, r.ixx, r.izz}));
    file.find("rotors")->set("thrust", Value(Value::List{0.0, r.thrust}));
    file.find("rotors")->set("arm_length", r.arm);
    file.find("rotors")->set("torque_coefficient", r.torque);
    EXPECT_NO_THROW(read_vehicle(file)) << r.name;
  }
}

// Whatever is accepted can be controlled: no figure within the ranges ends in a defect.
TEST(Plausibility, EveryAcceptedVehicleHasGains) {
  std::mt19937 random(7);
  const auto between = [&](double low, double high) {  // evenly over the orders of magnitude
    return low * std::pow(high / low, std::uniform_real_distribution<double>(0, 1)(random));
  };
  int accepted = 0;
  for (int i = 0; i < 4000; ++i) {
    Vehicle v = read_vehicle(vehicle_file());
    v.mass = between(0.005, 1000);
    v.rotors.arm_length = between(0.01, 5);
    const double scale = v.mass * v.rotors.arm_length * v.rotors.arm_length;
    const double flat = scale * between(0.0025, 4);
    v.inertia = {flat, flat, std::min(2 * flat, scale * between(0.0025, 4))};
    v.rotors.thrust_max = v.mass * kGravity / 4 * between(1.001, 30);
    v.rotors.thrust_min = 0;
    v.rotors.torque_coefficient = between(1e-4, 1);
    v.rotors.lag = i % 3 ? between(1e-6, 1) : 0;
    v.yaw_share = between(1e-3, 0.999);
    try {
      v = vehicle_from_value(to_value(v));
    } catch (const InputError&) {
      continue;
    }
    ++accepted;
    ControllerGains gains;
    ASSERT_NO_THROW(gains = gains_of(v)) << to_json(to_value(v));
    EXPECT_GT(gains.position, 0);
    EXPECT_TRUE(gains.attitude.allFinite() && gains.rates.allFinite());
  }
  EXPECT_GT(accepted, 1000);
}

}  // namespace
}  // namespace lapwing
