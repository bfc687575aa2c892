// SPDX-License-Identifier: Apache-2.0
// A hut scanned by an aircraft that cannot stop for its images.
#include "framework/core/units.h"
#include "tests/missions/scan_hut.h"

namespace lapwing {
namespace {

constexpr const char* kWing = "--set vehicle=vehicles/crosswind --set model=fixed_wing ";

class ScanInPassing : public Scanning {
 protected:
  std::string refused_wing(const std::string& more) { return refused(kWing + more); }
};

TEST_F(ScanInPassing, TheFlightIsOneTrajectoryPastItsImages) {
  ASSERT_EQ(run(kWing), 0) << error();
  const Plan made = read_plan(folder_ / "out/plan.json");
  const Certificate certificate = verify(made, folder_ / "out");
  for (const Check& check : certificate.failures()) ADD_FAILURE() << to_line(check);
  EXPECT_EQ(made.trajectory.motion.name, "coordinated_turn");
  EXPECT_LE(*certificate.find("bank")->worst, radians(35));
  EXPECT_GE(*certificate.find("stall_speed")->worst, 13.3);
  EXPECT_THAT(certificate.find("closed_loop")->skipped, HasSubstr("'coordinated_turn'"));
  EXPECT_GE(answer().at("tour").at("images").as_number(), 4);
  double slowest = 100;
  for (const Sample& s : made.trajectory.samples) slowest = std::min(slowest, s.velocity.norm());
  EXPECT_GT(slowest, 13.3) << "it never rests";
  // The inputs do not alternate: over the flight they change sign far less often than it has steps.
  int turns = 0, steps = 0;
  double before = 0;
  for (const Sample& s : made.trajectory.samples) {
    const double climb = s.columns.scalar("climb_acceleration");
    turns += climb * before < 0;
    before = climb;
    ++steps;
  }
  EXPECT_LT(5 * turns, steps);
}

class SlowScanInPassing : public ScanInPassing {};

TEST_F(SlowScanInPassing, TheSameSeedGivesTheSameFlight) {
  ASSERT_EQ(run(kWing, "hut.lua", "a"), 0) << error();
  ASSERT_EQ(run(std::string(kWing) + "--threads 1", "hut.lua", "b"), 0) << error();
  EXPECT_EQ(read_plan(folder_ / "a/plan.json").trajectory.samples.size(),
            read_plan(folder_ / "b/plan.json").trajectory.samples.size());
  EXPECT_EQ(read_file(folder_ / "a/trajectory.csv"), read_file(folder_ / "b/trajectory.csv"));
}

TEST_F(ScanInPassing, WhatMakesNoSenseInPassingIsRefusedByName) {
  EXPECT_THAT(refused_wing("--set flight.smooth=true"), HasSubstr("one trajectory, without legs"));
  EXPECT_THAT(refused_wing("--set passing.speed=5"), HasSubstr("stall"));
  EXPECT_THAT(refused_wing("--set passing.height=3"), HasSubstr("above safe_height"));
  EXPECT_THAT(refused_wing("--set passing.apart=0.5"), HasSubstr("passing.interval"));
  EXPECT_THAT(refused_wing("--set tour.budget=3"), HasSubstr("fits into 3 s"));
  EXPECT_THAT(refused("--set passing.speed=18"), HasSubstr("takes its images at rest"));
  EXPECT_THAT(refused("--set model=fixed_wing"), HasSubstr("has no wing"));
}

}  // namespace
}  // namespace lapwing
