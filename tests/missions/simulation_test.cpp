// SPDX-License-Identifier: Apache-2.0
// lapwing simulate on shipped films: followed in still air, robust in wind, honest when lost.
#include "framework/core/units.h"
#include "tests/missions/flown_film.h"

namespace lapwing {
namespace {

class Simulation : public Filming {
 protected:
  int simulate(const fs::path& plan, const std::string& more = "") {
    const std::string line = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing simulate '" +
                             plan.string() + "' --json " + more + " > '" +
                             (folder_ / "simulated.json").string() + "' 2> '" +
                             (folder_ / "stderr.txt").string() + "'";
    return WEXITSTATUS(std::system(line.c_str()));
  }
  double figure(const char* name) const {
    return from_json(read_file(folder_ / "simulated.json"), "stdout")
        .at("simulation")
        .at(name)
        .as_number();
  }
  std::string error() const { return read_file(folder_ / "stderr.txt"); }
};

TEST_F(Simulation, EveryShippedFilmIsFollowed) {
  std::vector<std::string> films(std::begin(kCameraFilms), std::end(kCameraFilms));
  films.emplace_back("hello.lua");
  for (const std::string& film : films) {
    const Flown flown = fly(film);
    ASSERT_EQ(simulate(flown.folder / "plan.json"), 0) << film << error();
    EXPECT_LT(figure("position_error_worst"), 0.15) << film;
    EXPECT_LT(figure("yaw_error_worst"), radians(3)) << film;
    EXPECT_LT(figure("saturated_share"), 1e-3) << film;
    EXPECT_GT(figure("rotor_speed_worst"), 0.3) << film;
  }
}

TEST_F(Simulation, WindMassAndSeedCount) {
  const fs::path plan = fly("hello.lua").folder / "plan.json";
  ASSERT_EQ(simulate(plan), 0) << error();
  const double still = figure("position_error_worst");
  ASSERT_EQ(simulate(plan, "--wind 5,1"), 0) << error();
  const double windy = figure("position_error_worst");
  ASSERT_EQ(simulate(plan, "--wind 5,1 --seed 2"), 0) << error();
  EXPECT_NE(figure("position_error_worst"), windy);
  EXPECT_GT(windy, 2 * still);
  EXPECT_LT(windy, 0.3);
  ASSERT_EQ(simulate(plan, "--mass-error 20"), 0) << error();
  EXPECT_GT(figure("position_error_worst"), 2 * still);
  const std::string page = (folder_ / "page.html").string();
  ASSERT_EQ(simulate(plan, "-o '" + page + "'"), 0) << error();
  EXPECT_NE(read_file(page).find("Rotor thrusts"), std::string::npos);
}

class SlowSimulation : public Simulation {};

// A controller that keeps to the path is at its end some milliseconds before the plan. What the
// plan asks of its last moment is asked of the flight's.
TEST_F(SlowSimulation, AFlightThatEndsBeforeItsPlanIsJudged) {
  const fs::path plan = fly("castle_flyover.lua").folder / "plan.json";
  ASSERT_EQ(simulate(plan, "--controller contouring --runs 1"), 0)
      << read_file(folder_ / "simulated.json");
}

TEST_F(Simulation, WhatWasSimulatedIsSaid) {
  const fs::path plan = fly("hello.lua").folder / "plan.json";
  const std::string page = (folder_ / "page.html").string();
  ASSERT_EQ(simulate(plan, "--wind 5,1,90 --mass-error 10 --seed 7 -o '" + page + "'"), 0)
      << error();
  const Value said = from_json(read_file(folder_ / "simulated.json"), "stdout").at("simulation");
  const Value& conditions = said.at("conditions");
  EXPECT_EQ(conditions.at("wind").as_number(), 5);
  EXPECT_EQ(conditions.at("gusts").as_number(), 1);
  EXPECT_NEAR(degrees(conditions.at("wind_yaw").as_number()), 90, 1e-9);
  EXPECT_NEAR(conditions.at("mass_error").as_number(), 0.1, 1e-12);
  EXPECT_EQ(conditions.at("seed").as_number(), 7);
  for (const char* text :
       {"wind blows towards", "gusts", "seed of gusts and noise", "mass above that of the plan"})
    EXPECT_NE(read_file(page).find(text), std::string::npos) << text;
}

TEST_F(Simulation, AFlightNearerThanPlannedIsNoPlainFlown) {
  write_file_atomically(
      folder_ / "near.lua",
      "return require 'mission.film'.shot { name = 'near', keyframes = { { position "
      "= {0, 0, 3}, time = 0 }, { position = {8, 0, 3}, time = 8 } }, keep_away = { { name = "
      "'bob', position = {4, 0, 0.6}, distance = 2.395 } } }");
  const Flown flown = fly((folder_ / "near.lua").string());
  ASSERT_EQ(flown.status, 0) << to_json(flown.result);
  const fs::path plan = flown.folder / "plan.json";
  const std::string page = (folder_ / "page.html").string();
  ASSERT_LE(simulate(plan, "--mass-error 60 -o '" + page + "'"), 1) << error();
  const Value said = from_json(read_file(folder_ / "simulated.json"), "stdout").at("simulation");
  EXPECT_TRUE(said.at("too_near").as_boolean()) << to_json(said);
  const Value& bob = said.at("distances").as_list().at(0);
  EXPECT_LT(bob.at("least").as_number(), 2.394);
  EXPECT_EQ(bob.at("to_keep").as_number(), 2.395);
  EXPECT_NE(read_file(page).find("too near"), std::string::npos);
  EXPECT_NE(read_file(page).find("bob, distance kept"), std::string::npos);
}

TEST_F(Simulation, WhatMakesNoSenseIsRefused) {
  const fs::path plan = fly("hello.lua").folder / "plan.json";
  for (const char* more : {"--wind 5", "--wind a,b", "--wind 1,2,3,4", "--wind 5,-1",
                           "--mass-error x", "--mass-error -95", "--seed -1"}) {
    EXPECT_EQ(simulate(plan, more), 2) << more;
    EXPECT_NE(error(), "") << more;
  }
  Value broken = from_json(read_file(plan), "plan.json");
  broken.find("vehicle")->set("mass", -1.0);
  write_file_atomically(folder_ / "broken.json", to_json(broken));
  EXPECT_EQ(simulate(folder_ / "broken.json"), 2);
  EXPECT_NE(error().find("mass"), std::string::npos) << error();
  // Five times the mass cannot hover: lost, and status 1.
  EXPECT_EQ(simulate(plan, "--mass-error 400"), 1);
}

}  // namespace
}  // namespace lapwing
