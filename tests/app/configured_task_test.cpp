// SPDX-License-Identifier: Apache-2.0
// Plans whose task was edited against their own configuration, with a digest made anew.
#include <gmock/gmock.h>

#include "framework/app/configured_task.h"
#include "framework/core/json.h"
#include "framework/trajectory/plan_digest.h"
#include "tests/app/program_fixture.h"

namespace lapwing {
namespace {

using ::testing::HasSubstr;

struct EditedTask {
  const char* said;  // by the check
  std::function<void(Value&)> change;
};

class ConfiguredTask : public CommandLine {
 protected:
  void make(const std::string& script) {
    write("shot.lua", script);
    const Finished made = run({"run", "shot.lua", "-o", "run"});
    ASSERT_TRUE(fs::exists(folder_ / "run" / "plan.json")) << made.err << made.out;
    whole_ = from_json(read_file(folder_ / "run" / "plan.json"), "plan.json");
  }

  Value answer() { return from_json(run({"verify", "run/plan.json", "--json"}).out, "answer"); }
  Value judged(Value document) {
    document.set("digest", digest_of(document));
    write_file_atomically(folder_ / "run" / "plan.json", to_json(document) + "\n");
    return answer();
  }
  static const Value& provenance_of(const Value& answer) {
    for (const Value& check : answer.at("certificate").at("checks").as_list())
      if (check.at("name").as_text() == "provenance") return check;
    throw std::runtime_error("no provenance");
  }

  // The whole plan passes; each edit fails, and the reason is said.
  void expect_told(const std::vector<EditedTask>& edits) {
    Value now = answer();
    EXPECT_TRUE(provenance_of(now).at("pass").as_boolean()) << to_json(now.at("provenance"));
    for (const EditedTask& edit : edits) {
      Value document = whole_;
      edit.change(document);
      now = judged(document);
      EXPECT_FALSE(provenance_of(now).at("pass").as_boolean()) << edit.said;
      EXPECT_THAT(to_json(now.at("provenance").at("faults")), HasSubstr(edit.said));
      EXPECT_FALSE(now.at("certificate").at("feasible").as_boolean()) << edit.said;
    }
  }

  static Value& in(Value& document, const std::string& section, const std::string& key) {
    return *document.find(section)->find(key);
  }
  static Value& entry(Value& document, const std::string& section, const std::string& key,
                      std::size_t index = 0) {
    return in(document, section, key).as_list()[index];
  }

  Value whole_;
};

TEST_F(ConfiguredTask, OfAFilmIsHeldToItsConfiguration) {
  make(
      "local film = require 'mission.film'\n"
      "return film.shot {\n"
      "  subject = { name = 'anna', position = {4, 9, 1}, height = 1.7, distance = 3 },\n"
      "  keep_away = { { name = 'bob', position = {4, -9, 1}, distance = 3 } },\n"
      "  obstacles = { { type = 'sphere', name = 'tree', center = {2, 4, 2}, radius = 1 } },\n"
      "  volume = { lower = {-20, -20, 0}, upper = {20, 20, 20} },\n"
      "  keyframes = { { time = 0, position = {0, 0, 2} },\n"
      "                { time = 6, position = {6, 0, 2} } },\n"
      "  battery = 60, speed_limit = 5,\n"
      "  constraints = { { name = 'west', upper = 40,\n"
      "                    value = function(s) return s.position.x end } } }\n");
  expect_told({
      {"subject 'anna' of its configuration is not in the plan",
       [](Value& d) {
         Value::List& all = in(d, "environment", "subjects").as_list();
         all.erase(all.begin());
         in(d, "task", "framing") = Value::list();
       }},
      {"subject 'anna' need not be in the image",
       [](Value& d) { in(d, "task", "framing") = Value::list(); }},
      {"subject 'anna' need not be in the image",
       [](Value& d) { entry(d, "task", "framing").set("finish", 0.5); }},
      {"the share of framing is 0.1", [](Value& d) { d.find("task")->set("framing_share", 0.1); }},
      {"subject 'anna' has another position",
       [](Value& d) {
         entry(d, "environment", "subjects").find("positions")->as_list()[0].as_list()[1] = 12.0;
       }},
      {"the height of subject 'anna' is 0.1 m",
       [](Value& d) { entry(d, "environment", "subjects").set("height", 0.1); }},
      {"bystander 'bob' of its configuration is not in the plan",
       [](Value& d) { in(d, "environment", "subjects").as_list().pop_back(); }},
      {"the distance from bystander 'bob' is 1 m",
       [](Value& d) { entry(d, "environment", "subjects", 1).set("distance", 1.0); }},
      {"obstacles[1] of its configuration",
       [](Value& d) { in(d, "environment", "obstacles") = Value::list(); }},
      {"the volume of its configuration",
       [](Value& d) {
         for (Value& o : in(d, "environment", "obstacles").as_list())
           if (o.find("side")) o.find("parameters")->set("ceiling", 99.0);
       }},
      {"the line of sight is reported only in the plan",
       [](Value& d) { d.find("task")->set("line_of_sight_required", false); }},
      {"the margin is 0.1 m", [](Value& d) { d.find("environment")->set("margin", 0.1); }},
      {"the tolerance of keyframe 1 is 3 m in the plan and 0.5 m in its configuration",
       [](Value& d) { entry(d, "task", "keyframes").set("tolerance", 3.0); }},
      {"the time tolerance of keyframe 2 is 9 s in the plan and 0.1 s",
       [](Value& d) { entry(d, "task", "keyframes", 1).set("time_tolerance", 9.0); }},
      {"the yaw tolerance of keyframe 1 is 171.887",
       [](Value& d) { entry(d, "task", "keyframes").set("yaw_tolerance", 3.0); }},
      {"the time of keyframe 2 is 5 s in the plan and 6 s",
       [](Value& d) { entry(d, "task", "keyframes", 1).set("time", 5.0); }},
      {"keyframe 2 has another position",
       [](Value& d) { entry(d, "task", "keyframes", 1).find("position")->as_list()[0] = 5.5; }},
      {"the budget is 600 s", [](Value& d) { d.set("budget", 600.0); }},
      {"constraint 'west' is a function in its configuration, and in the plan it is not judged",
       [](Value& d) {
         for (Value& c : d.find("constraints")->as_list()) {
           if (c.at("name").as_text() != "west") continue;
           Value vague = Value::map();
           vague.set("name", "west");
           vague.set("required", true);
           vague.set("unjudged", "of nobody");
           c = vague;
         }
       }},
      {"constraint 'west' of its configuration is not in the plan",
       [](Value& d) {
         for (Value& c : d.find("constraints")->as_list())
           if (c.at("name").as_text() == "west") c.set("name", "east");
       }},
      {"the speed limit is 50 m/s",
       [](Value& d) {
         for (Value& c : d.find("constraints")->as_list())
           if (c.at("name").as_text() == "speed_limit")
             c.find("results")->as_list()[0].set("upper", 50.0);
       }},
      {"the speed limit of its configuration is not in the plan",
       [](Value& d) { d.set("constraints", Value::list()); }},
      {"the kind is 'mine' in the plan", [](Value& d) { d.set("kind", "mine"); }},
  });
  judged(whole_);
  EXPECT_THAT(run({"verify", "run/plan.json"}).out,
              HasSubstr("not compared  formulas, bounds and times of the script's constraints"));
}

TEST_F(ConfiguredTask, MotionGroundTracksAndOpacityAreHeldToItsConfiguration) {
  make(
      "local film = require 'mission.film'\n"
      "return film.shot {\n"
      "  subject = { position = {4, 9, 1}, height = 1.7 }, ground = 0.5,\n"
      "  obstacles = { { type = 'sphere', name = 'kite', center = {2, -6, 4}, radius = 0.5,\n"
      "                  track = { { time = 0, move = {0, 0, 0} },\n"
      "                            { time = 6, move = {3, 0, 0} } } },\n"
      "                { type = 'box', name = 'hedge', lower = {-9, -9, 0}, upper = {-8, 9, 2} },\n"
      "                { type = 'box', name = 'glass', lower = {-12, -9, 0},\n"
      "                  upper = {-11, 9, 2}, opaque = false } },\n"
      "  keyframes = { { time = 0, position = {0, 0, 2} },\n"
      "                { time = 6, position = {6, 0, 2} } } }\n");
  const auto obstacle = [](Value& document, const std::string& name) -> Value& {
    for (Value& one : in(document, "environment", "obstacles").as_list())
      if (one.at("name").as_text() == name) return one;
    throw std::runtime_error("no obstacle " + name);
  };
  expect_told({
      {"obstacles[1] of its configuration (sphere 'kite')",
       [&](Value& d) {
         obstacle(d, "kite").find("track")->find("moves")->as_list()[1].as_list()[0] = -3.0;
       }},
      {"obstacles[1] of its configuration (sphere 'kite')",
       [&](Value& d) { obstacle(d, "kite").find("track")->find("times")->as_list()[1] = 7.0; }},
      {"obstacles[2] of its configuration (box 'hedge')",
       [&](Value& d) { obstacle(d, "hedge").set("opaque", false); }},
      {"the ground of its configuration, at 0.5 m, is not in the plan",
       [&](Value& d) {
         obstacle(d, "ground").find("parameters")->find("point")->as_list()[2] = 0.25;
       }},
      {"the motion is 'force' in the plan, and the model of its configuration, 'velocity', has",
       [](Value& d) { in(d, "configuration", "model").set("type", "velocity"); }},
  });
  // More than is asked for: nothing to be told.
  Value stricter = whole_;
  obstacle(stricter, "glass").set("opaque", true);
  obstacle(stricter, "ground").find("parameters")->find("point")->as_list()[2] = 0.6;
  EXPECT_TRUE(provenance_of(judged(stricter)).at("pass").as_boolean());
}

TEST_F(ConfiguredTask, OfARaceIsHeldToItsConfiguration) {
  make(
      "local race = require 'mission.race'\n"
      "return race.course { start = {0, 0, 1}, finish = {14, 0, 1}, advise = false,\n"
      "  closed_loop = 'reported', refinements = 0, gates = {\n"
      "    { shape = 'ball', position = {5, 1, 1.5}, radius = 0.5 },\n"
      "    { shape = 'rectangle', position = {10, 0, 1.5}, width = 2, height = 1,\n"
      "      normal_yaw_deg = 10, normal_pitch_deg = 5, tunnel_length = 0.4 } } }\n");
  expect_told({
      {"gate 1 ('gates[1]') is of another radius in the plan",
       [](Value& d) { entry(d, "task", "gates").set("radius", 3.0); }},
      {"gate 1 ('gates[1]') is elsewhere in the plan",
       [](Value& d) { entry(d, "task", "gates").find("position")->as_list()[1] = 0.5; }},
      {"gate 2 ('gates[2]') is of another size in the plan",
       [](Value& d) {
         for (Value& corner : entry(d, "task", "gates", 1).find("corners")->as_list())
           for (Value& number : corner.as_list()) number = 2 * number.as_number();
       }},
      {"there are 1 gates in the plan and 2 in its configuration",
       [](Value& d) { in(d, "task", "gates").as_list().pop_back(); }},
  });
}

// Kinds of one's own are not compared, and that is said.
TEST_F(ConfiguredTask, OfAnotherKindIsSaidToBeNotCompared) {
  Plan plan;
  plan.kind = "survey";
  plan.configuration = Value::map();
  const ConfigurationComparison found = compare_with_configuration(plan);
  EXPECT_TRUE(found.faults.empty());
  EXPECT_THAT(found.not_compared,
              testing::ElementsAre(HasSubstr("missions of kind 'survey' are not compared")));
}

TEST_F(ConfiguredTask, OfAScanIsHeldToItsConfiguration) {
  const Value configuration = from_json(
      R"({"candidates": {}, "motions": {}, "closed_loop": "required", "margin": 0.4, "range": 60,
          "region": {"lower": [0, 0, 0], "upper": [9, 9, 5]}, "tour": {"budget": 200},
          "camera": {"width": 600, "height": 450, "focal": 345}})",
      "scan");
  Plan plan;
  plan.kind = "scan";
  plan.configuration = configuration;
  plan.budget = 200;
  plan.environment.margin = 0.4;
  ScanTask& scan = plan.task.scan.emplace();
  scan.region = Eigen::AlignedBox3d(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(9, 9, 5));
  scan.camera = {600, 450, 345, 345, 299.5, 224.5};
  EXPECT_THAT(compare_with_configuration(plan).faults, testing::IsEmpty());
  EXPECT_THAT(compare_with_configuration(plan).not_compared, testing::SizeIs(1));
  const std::pair<const char*, std::function<void(Plan&)>> edits[] = {
      {"the region",
       [](Plan& p) {
         p.task.scan->region =
             Eigen::AlignedBox3d(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(3, 9, 5));
       }},
      {"the budget is 900 s", [](Plan& p) { p.budget = 900; }},
      {"the budget is not stated", [](Plan& p) { p.budget.reset(); }},
      {"the margin is 0.1 m", [](Plan& p) { p.environment.margin = 0.1; }},
      {"the range is 600 m", [](Plan& p) { p.task.scan->range = 600; }},
      {"the camera's width", [](Plan& p) { p.task.scan->camera.width = 6000; }},
      {"must be seen again is 0.1", [](Plan& p) { p.task.scan->seen_share = 0.1; }},
      {"the tolerance of views is 9 m", [](Plan& p) { p.task.scan->tolerance = 9; }},
      {"directions of view is 1 rad", [](Plan& p) { p.task.scan->angle_tolerance = 1; }},
      {"the closed loop", [](Plan& p) { p.task.closed_loop_required = false; }},
      {"no region to scan", [](Plan& p) { p.task.scan.reset(); }}};
  for (const auto& [said, change] : edits) {
    Plan edited = plan;
    change(edited);
    EXPECT_THAT(compare_with_configuration(edited).faults, testing::ElementsAre(HasSubstr(said)));
  }
}

TEST_F(ConfiguredTask, ZonesRegionsAndThePilotOfAScanAreHeldToItsConfiguration) {
  Plan plan;
  plan.kind = "scan";
  plan.configuration = from_json(
      R"({"candidates": {}, "motions": {}, "closed_loop": "required", "margin": 0.4, "tour": {},
          "gps_accuracy": 0.5, "heights": "unstated", "coordinates": "",
          "regions": [{"corners": [0, 0, 9, 0, 0, 9], "from": 0, "to": 5, "weight": 2,
                       "holes": [{"corners": [1, 1, 2, 1, 1, 2]}], "file": ""}],
          "no_fly_zones": [{"corners": [20, 0, 29, 0, 20, 9], "ceiling": 30, "file": ""},
                           {"file": "zones.geojson"}],
          "flight_zones": [{"corners": [-50, -50, 50, -50, 0, 90], "file": ""}],
          "pilot": {"position": [-9, 0, 1.7], "range": 120}})",
      "scan");
  plan.budget = 300;
  Environment& around = plan.environment;
  around.margin = 0.9;
  around.accuracy = 0.5;
  around.pilot = PilotPlace{{-9, 0, 1.7}, 120, 1};
  const auto zone = [](const char* parameters, Side side) {
    Obstacle obstacle;
    obstacle.type = "prism";
    obstacle.parameters = from_json(parameters, "zone");
    obstacle.side = side;
    return obstacle;
  };
  around.obstacles = {zone(R"({"corners": [20, 0, 29, 0, 20, 9], "ceiling": 30})", Side::keep_out),
                      zone(R"({"corners": [40, 0, 49, 0, 40, 9]})", Side::keep_out),
                      zone(R"({"corners": [-50, -50, 50, -50, 0, 90]})", Side::keep_inside)};
  const RegionPrism prism{"", {{0, 0}, {9, 0}, {0, 9}}, {{{1, 1}, {2, 1}, {1, 2}}}, 0, 5, 2};
  plan.task.scan.emplace().region = InterestRegion({prism});
  EXPECT_THAT(compare_with_configuration(plan).faults, testing::IsEmpty());
  EXPECT_THAT(compare_with_configuration(plan).not_compared,
              testing::Contains(HasSubstr("no_fly_zones[2]")));
  const std::pair<const char*, std::function<void(Plan&)>> edits[] = {
      {"regions[1]",
       [&](Plan& p) {
         RegionPrism other = prism;
         other.weight = 1;
         p.task.scan->region = InterestRegion({other});
       }},
      {"regions[1]",
       [&](Plan& p) {
         RegionPrism other = prism;
         other.holes.clear();
         p.task.scan->region = InterestRegion({other});
       }},
      {"no_fly_zones[1]",
       [](Plan& p) { p.environment.obstacles[0].parameters.set("ceiling", 10.0); }},
      {"the number of no_fly_zones is 1",
       [](Plan& p) { p.environment.obstacles.erase(p.environment.obstacles.begin() + 1); }},
      {"flight_zones[1]", [](Plan& p) { p.environment.obstacles[2].parameters.set("floor", 3.0); }},
      {"the plan has no pilot", [](Plan& p) { p.environment.pilot.reset(); }},
      {"pilot.position", [](Plan& p) { p.environment.pilot->eye.x() = 9; }},
      {"pilot.range is 500 m", [](Plan& p) { p.environment.pilot->range = 500; }},
      {"nothing hides the flight", [](Plan& p) { p.environment.pilot->beside = 90; }},
      {"the accuracy of the position is 0 m", [](Plan& p) { p.environment.accuracy = 0; }},
      {"the margin is 0.5 m", [](Plan& p) { p.environment.margin = 0.5; }}};
  for (const auto& [said, change] : edits) {
    Plan edited = plan;
    change(edited);
    EXPECT_THAT(compare_with_configuration(edited).faults, testing::ElementsAre(HasSubstr(said)));
  }
}

TEST_F(ConfiguredTask, OfALightPaintingIsHeldToItsConfiguration) {
  Plan plan;
  plan.kind = "light_painting";
  plan.configuration = from_json(
      R"({"reorder": true, "rounding": 0.015, "slowest": 0.1, "origin": [0, 0, 2], "height": 2,
          "view_yaw_deg": 90})",
      "painting");
  plan.task.strokes = {{Eigen::Vector3d(0, 0, 2), Eigen::Vector3d(1, 0, 2)}};
  plan.task.drawing_tolerance = 0.02;
  EXPECT_THAT(compare_with_configuration(plan).faults, testing::IsEmpty());
  plan.task.drawing_tolerance = 0.5;
  EXPECT_THAT(compare_with_configuration(plan).faults,
              testing::ElementsAre(HasSubstr("the tolerance of the drawing is 0.5 m in the plan "
                                             "and 0.02 m")));
  plan.configuration.set("tolerance", 0.5);
  EXPECT_THAT(compare_with_configuration(plan).faults, testing::IsEmpty());
  plan.task.drawing_view = Eigen::Vector3d::UnitX();
  EXPECT_THAT(compare_with_configuration(plan).faults,
              testing::ElementsAre(HasSubstr("spectators look another way")));
}

}  // namespace
}  // namespace lapwing
