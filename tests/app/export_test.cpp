// SPDX-License-Identifier: Apache-2.0
// lapwing export of files that need a place on the earth, and of files that vehicles fly.
#include <gmock/gmock.h>

#include "framework/core/json.h"
#include "tests/app/program_fixture.h"

namespace lapwing {
namespace {

using testing::HasSubstr;

constexpr const char* kHop = R"(local film = require "mission.film"
return film.shot {
  name = "hop", passages = 0, %s
  keyframes = { { time = 0, position = {0, 0, 2} }, { time = %s, position = {30, 0, 4} } },
})";

class Exporting : public CommandLine {
 protected:
  void plan(const std::string& more, const std::string& seconds) {
    std::string text = kHop;
    text.replace(text.find("%s"), 2, more);
    text.replace(text.find("%s"), 2, seconds);
    write("hop.lua", text);
    const Finished finished = run({"run", "hop.lua", "-o", "hop", "--quiet"});
    ASSERT_LE(finished.status, 1) << finished.err;
  }
  Finished exported(std::vector<std::string> more, const std::string& file) {
    std::vector<std::string> words{"export", "hop/plan.json", "-o", file};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  }
};

TEST_F(Exporting, TakesAnOriginForAPlanWithoutOne) {
  plan("", "12");
  const Finished without = exported({"--format", "kml"}, "hop.kml");
  EXPECT_EQ(without.status, 2);
  EXPECT_THAT(without.err, HasSubstr("kml: 'hop' has no origin on the earth"));
  EXPECT_THAT(without.err, HasSubstr("`--origin LAT,LON,HEIGHT,OF`"));
  for (const char* origin :
       {"46.5", "46.5,6.6,0", "46.5,6.6,0,roof", "46.5,6.6,x,ground", "46.5,6.6,0,",
        "nan,6.6,0,ground", "96.5,6.6,0,ground", "0,0,0,ground"}) {
    const Finished refused = exported({"--format", "kml", "--origin", origin}, "hop.kml");
    EXPECT_EQ(refused.status, 2) << origin;
    EXPECT_THAT(refused.err, HasSubstr("--origin")) << origin;
  }
  EXPECT_FALSE(fs::exists(folder_ / "hop.kml"));
  const Finished good = exported({"--format", "kml", "--origin", "46.5,6.6,0,ground"}, "hop.kml");
  EXPECT_EQ(good.status, 0) << good.err;
  EXPECT_THAT(good.out, HasSubstr("WGS 84, origin 46.5, 6.6 at 0 m above the ground there"));
  EXPECT_TRUE(fs::exists(folder_ / "hop.kml"));
}

TEST_F(Exporting, AnOriginOfThePlanStands) {
  plan("origin = { latitude_deg = 46.5, longitude_deg = 6.6, height = 1, height_of = 'ground' },",
       "12");
  EXPECT_EQ(exported({"--format", "kml"}, "hop.kml").status, 0);
  const Finished twice = exported({"--format", "kml", "--origin", "1,2,3,ground"}, "other.kml");
  EXPECT_EQ(twice.status, 2);
  EXPECT_THAT(twice.err, HasSubstr("the plan states an origin of its own"));
}

TEST_F(Exporting, SaysHowAMissionWouldBeFlown) {
  plan("", "12");
  const Finished good =
      exported({"--format", "qgc_plan", "--origin", "46.5,6.6,0,ground"}, "hop.plan");
  EXPECT_EQ(good.status, 0) << good.err;
  EXPECT_THAT(good.out, HasSubstr("m across the path of the plan"));
  EXPECT_THAT(good.out, HasSubstr("than the plan, without take-off and landing"));
}

TEST_F(Exporting, RefusesAMissionThatBreaksWhatThePlanKeeps) {
  // 3.5 s for 30 m, on a battery for 5 s: an autopilot is not so quick.
  plan(
      "vehicle = { mass = 1, inertia = {0.01, 0.01, 0.02}, yaw_share = 0.01, flight_time = 5,\n"
      "  rotors = { thrust = {0, 8.62312}, torque_coefficient = 0.02, arm_length = 0.2 },\n"
      "  limits = { speed_across = 60, climb_speed = 60, descent_speed = 60,\n"
      "             acceleration_across = 60, yaw_rate_deg = 180 },\n"
      "  camera = 'cameras/racing' },",
      "3.5");
  const Finished refused = exported(
      {"--format", "qgc_plan", "--origin", "46.5,6.6,0,ground", "--uncertified"}, "hop.plan");
  EXPECT_EQ(refused.status, 2) << refused.out;
  EXPECT_THAT(refused.err, HasSubstr("the file would break what the plan keeps"));
  EXPECT_THAT(refused.err, HasSubstr("flight_time"));
  EXPECT_FALSE(fs::exists(folder_ / "hop.plan"));
}

}  // namespace
}  // namespace lapwing
