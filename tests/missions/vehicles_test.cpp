// SPDX-License-Identifier: Apache-2.0
// Films, light paintings and scans with other vehicle models than the point mass.
#include "framework/core/units.h"
#include "tests/missions/scan_hut.h"

namespace lapwing {
namespace {

class Vehicles : public Scanning {
 protected:
  static Certificate certificate_of(const fs::path& folder) {
    return verify(read_plan(folder / "plan.json"), folder);
  }
  std::string said(const std::string& example, const std::string& more) {
    fly(example, more, "refused", 2);
    return read_file(folder_ / "stderr.txt");
  }
};

TEST_F(Vehicles, AConsumerDroneFilmsWithinWhatItsMakerStates) {
  const Flown flown = fly("consumer_drone.lua");
  expect_certified(flown);
  const Certificate certificate = certificate_of(flown.folder);
  EXPECT_LE(*certificate.find("jerk")->worst, 9);
  EXPECT_LE(*certificate.find("speed_across")->worst, 50 / 3.6);
  EXPECT_TRUE(certificate.find("framing")->pass);
  EXPECT_THAT(certificate.find("closed_loop")->skipped, HasSubstr("states no rotors"));
  EXPECT_THAT(read_file(flown.folder / "trajectory.csv"), HasSubstr("jerk_x [m/s^3]"));
  EXPECT_THAT(read_file(flown.folder / "report.html"), HasSubstr("jerk x"));
}

// With rotors in its file the simulated quadrotor follows what was commanded.
TEST_F(Vehicles, ACommandedFlightIsFollowedByAQuadrotor) {
  const Flown flown = fly("hello.lua", "--set model=velocity");
  expect_certified(flown);
  const Certificate certificate = certificate_of(flown.folder);
  EXPECT_EQ(certificate.find("closed_loop")->skipped, "");
  EXPECT_LE(*certificate.find("closed_loop")->worst, 0.25);
}

TEST_F(Vehicles, AFixedWingFilmsInTurnsThatItCanFly) {
  const Flown flown = fly("fixed_wing.lua");
  expect_certified(flown);
  const Certificate certificate = certificate_of(flown.folder);
  EXPECT_GE(*certificate.find("stall_speed")->worst, 13.3);
  EXPECT_LE(*certificate.find("bank")->worst, radians(35));
  EXPECT_GT(*certificate.find("bank")->worst, radians(5)) << "it turns";
  EXPECT_TRUE(certificate.find("framing")->pass);
  EXPECT_THAT(read_file(flown.folder / "trajectory.csv"),
              HasSubstr("lateral_acceleration [m/s^2]"));
  // The same film from its document alone.
  Plan plan = read_plan(flown.folder / "plan.json");
  EXPECT_EQ(plan.trajectory.motion.name, "coordinated_turn");
  plan.trajectory.motion.name = "submarine";
  EXPECT_THAT(verify(plan).find("document")->detail, HasSubstr("'submarine' has no integrator"));
}

TEST_F(Vehicles, WhatAModelLacksIsNamed) {
  EXPECT_THAT(
      said("fixed_wing.lua", "--set start=rest"),
      HasSubstr("start: the model of this vehicle cannot stand still; give free or moving"));
  EXPECT_THAT(said("fixed_wing.lua", "--set keyframes[2].yaw_deg=20"), HasSubstr("yaw_deg"));
  EXPECT_THAT(said("hello.lua", "--set model=fixed_wing"), HasSubstr("has no wing"));
  EXPECT_THAT(said("hello.lua", "--set model=gimbal"), HasSubstr("has no block 'position'"));
  EXPECT_THAT(said("consumer_drone.lua", "--set model=quadrotor"), HasSubstr("states no rotors"));
  EXPECT_THAT(said("../light_painting/hello.lua",
                   "--set model=fixed_wing --set vehicle=vehicles/crosswind"),
              HasSubstr("begins and ends at rest"));
}

TEST_F(Vehicles, ALightPaintingOfACommandedDrone) {
  const Flown flown = fly("../light_painting/hello.lua", "--set model=velocity");
  expect_certified(flown);
}

TEST_F(Vehicles, AScanOfAConsumerDroneIsCertified) {
  ASSERT_EQ(run("--set vehicle=vehicles/phantom --set model=velocity --set flight.smooth=true"), 0)
      << error();
  const Certificate certificate = certificate_of(folder_ / "out");
  for (const Check& check : certificate.failures()) ADD_FAILURE() << to_line(check);
  EXPECT_EQ(read_plan(folder_ / "out/plan.json").trajectory.motion.name, "velocity");
  EXPECT_LE(*certificate.find("jerk")->worst, 9);
}

TEST_F(Vehicles, ScansThatCannotBeFlownAreRefused) {
  EXPECT_NE(run("--set model=velocity"), 0);
  EXPECT_THAT(error(), HasSubstr("'velocity' needs flight.smooth = true"));
}

}  // namespace
}  // namespace lapwing
