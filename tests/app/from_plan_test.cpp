// SPDX-License-Identifier: Apache-2.0
// lapwing run --from PLAN.json: the plan of an earlier run as a start.
#include "framework/core/json.h"
#include "framework/trajectory/plan.h"
#include "framework/trajectory/plan_digest.h"
#include "tests/app/program_fixture.h"

namespace lapwing {
namespace {

class FromPlan : public CommandLine {
 protected:
  void write_film() {
    write("shot.lua", R"(
      local film = require "mission.film"
      return film.shot {
        subject = { position = {0, 0, 2}, height = 4, width = 5 },
        keyframes = { { time = 0, position = {-18, -6, 3} }, { time = 10, position = {0, -2, 14} },
                      { time = 20, position = {18, 4, 5} } } })");
  }
  Value plan(const std::string& folder) {
    return from_json(read_file(folder_ / folder / "plan.json"), "plan.json");
  }
};

TEST_F(FromPlan, BeginsThereAndSaysSo) {
  write_film();
  ASSERT_EQ(run({"run", "shot.lua", "-o", "cold", "--quiet"}).status, 0);
  // As it is: nothing is left to do but to prove it.
  ASSERT_EQ(run({"run", "shot.lua", "--from", "cold/plan.json", "-o", "warm", "--quiet"}).status,
            0);
  const Value cold = plan("cold"), warm = plan("warm");
  EXPECT_FALSE(cold.at("solver").find("started_from"));
  const Value& from = warm.at("solver").at("started_from");
  EXPECT_EQ(from.at("sha256").as_text(), cold.at("digest").at("sha256").as_text());
  EXPECT_EQ(from.at("mission").as_text(), "shot");
  const double best = cold.at("solver").at("cost").as_number();
  EXPECT_NEAR(warm.at("solver").at("cost").as_number(), best, 1e-5 * (1 + best));
  EXPECT_LT(warm.at("solver").at("iterations").as_number(),
            cold.at("solver").at("iterations").as_number());
  // The first point of its history is the plan's.
  EXPECT_NEAR(warm.at("solver").at("history").as_list().at(0).at("cost").as_number(), best,
              1e-3 * (1 + best));
  // The same bytes each time.
  ASSERT_EQ(run({"run", "shot.lua", "--from", "cold/plan.json", "-o", "again", "--quiet"}).status,
            0);
  EXPECT_EQ(read_file(folder_ / "warm/plan.json"), read_file(folder_ / "again/plan.json"));
}

TEST_F(FromPlan, ResampledInTime) {
  write_film();
  ASSERT_EQ(run({"run", "shot.lua", "-o", "cold", "--quiet"}).status, 0);
  ASSERT_EQ(run({"run", "shot.lua", "--set", "step=0.07", "--from", "cold/plan.json", "-o", "fine",
                 "--quiet"})
                .status,
            0);
  const double best = plan("cold").at("solver").at("cost").as_number();
  const Value history = plan("fine").at("solver").at("history");
  EXPECT_NEAR(history.as_list().at(0).at("cost").as_number(), best, 0.2 * (1 + best));
}

TEST_F(FromPlan, RefusesWhatIsNoStart) {
  write_film();
  ASSERT_EQ(run({"run", "shot.lua", "-o", "cold", "--quiet"}).status, 0);
  const auto refuse = [&](std::vector<std::string> arguments, const std::string& why) {
    arguments.insert(arguments.begin(), "run");
    arguments.insert(arguments.end(), {"--from", "cold/plan.json", "-o", "none", "--quiet"});
    refused(arguments, {why}, true);
  };
  refuse({"shot.lua", "--set", "model=velocity"},
         "the plan moves by 'force', the problem by 'velocity'");
  write("own.yaml", read_file(LAPWING_SOURCE_DIR "/configs/vehicles/solo.yaml"));
  refuse({"shot.lua", "--set", "vehicle=own.yaml"},
         "a plan of the vehicle 'vehicles/solo', the problem is of 'own.yaml'");
  const auto film = [&](const char* file, const std::string& name, const std::string& more) {
    write(file, R"(
      local film = require "mission.film"
      return film.shot { name = ")" +
                    name + R"(",
                         keyframes = { { time = 0, position = {0, 0, 2} }, )" +
                    more + R"(
                                       { time = 9, position = {9, 0, 2} } } })");
  };
  film("blind.lua", "shot", "{ time = 3, position = {3, 0, 2} },");
  refuse({"blind.lua"}, "the plan has a ");
  film("shorter.lua", "shot", "");
  refuse({"shorter.lua"}, "keyframes: 2; the plan to begin from (--from) has 3");
  film("another.lua", "another", "{ time = 3, position = {3, 0, 2} },");
  refuse({"another.lua"}, "--from: a plan of the mission 'shot'; this one is 'another'");
  write("other.lua", R"(
    return { kind = "race", plan = function(run) error "never called" end })");
  refuse({"other.lua"}, "--from: a mission of kind 'race' does not begin from a plan");
  write("taking.lua", R"(
    return { kind = "race", takes_start = true, plan = function(run) error "never called" end })");
  refuse({"taking.lua"}, "--from: a plan of kind 'film'; this mission is of kind 'race'");
  refused({"run", "shot.lua", "--from", "nowhere.json"}, {"nowhere.json"}, true);
  write("no_plan.json", "{\"kind\": \"film\"}");
  refused({"run", "shot.lua", "--from", "no_plan.json"}, {"no_plan.json"}, true);
  write("garbage.json", "not a plan");
  refused({"run", "shot.lua", "--from", "garbage.json"}, {"garbage.json"}, true);
}

}  // namespace
}  // namespace lapwing
