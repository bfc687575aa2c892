// SPDX-License-Identifier: Apache-2.0
// The checks of mission files find what they say.
#include <gmock/gmock.h>

#include "framework/core/json.h"
#include "tests/obstacles.h"
#include "tests/plugins/exporters/mission_checker.h"
#include "tests/plugins/exporters/placed_film.h"

namespace lapwing {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Not;

// Each rule with a file that breaks it: what is replaced by what, and what is found.
TEST(MissionChecker, EveryRuleOfPlansHasAFileThatBreaksIt) {
  Plan plan = film_plan();
  Obstacle zone;
  zone.name = "far";
  zone.type = "prism";
  zone.parameters.set("corners", Value(Value::List{50.0, 0.0, 60.0, 0.0, 60.0, 9.0}));
  plan.environment.obstacles = {zone, sphere_at("tree", {40, 0, 3}, 2)};
  const Value good = from_json(file_of("qgc_plan", plan), "test");
  ASSERT_THAT(plan_faults(to_json(good)), IsEmpty());
  const auto broken = [&](const std::function<void(Value&)>& change) {
    Value document = good;
    change(document);
    return plan_faults(to_json(document));
  };
  const auto without = [](Value& map, const std::string& key) {
    Value kept = Value::map();
    for (const auto& [name, value] : map.as_map())
      if (name != key) kept.set(name, value);
    map = kept;
  };
  EXPECT_THAT(plan_faults("{"), ElementsAre("no JSON"));
  for (const char* key :
       {"fileType", "version", "groundStation", "mission", "geoFence", "rallyPoints"})
    EXPECT_THAT(broken([&](Value& d) { without(d, key); }), Not(IsEmpty())) << key;
  const auto mission = [](Value& d) -> Value& { return *d.find("mission"); };
  for (const char* key : {"version", "firmwareType", "vehicleType", "cruiseSpeed", "hoverSpeed",
                          "globalPlanAltitudeMode", "plannedHomePosition", "items"})
    EXPECT_THAT(broken([&](Value& d) { without(mission(d), key); }), Not(IsEmpty())) << key;
  EXPECT_THAT(broken([&](Value& d) { mission(d).set("items", Value::list()); }),
              ElementsAre("items"));
  const auto item = [&](Value& d) -> Value& { return mission(d).find("items")->as_list()[0]; };
  for (const char* key : {"type", "autoContinue", "command", "frame", "params"})
    EXPECT_THAT(broken([&](Value& d) { without(item(d), key); }), Not(IsEmpty())) << key;
  for (const char* key : {"AltitudeMode", "Altitude", "AMSLAltAboveTerrain"})
    EXPECT_THAT(broken([&](Value& d) { without(item(d), key); }),
                ElementsAre("altitude: all three or none"));
  EXPECT_THAT(broken([&](Value& d) { item(d).set("AltitudeMode", 2); }),
              ElementsAre("AltitudeMode of another frame"));
  EXPECT_THAT(broken([&](Value& d) { item(d).set("Altitude", 99.0); }),
              ElementsAre("Altitude is not that of the params"));
  EXPECT_THAT(broken([&](Value& d) {
                for (const char* key : {"AltitudeMode", "Altitude", "AMSLAltAboveTerrain"})
                  without(item(d), key);
                item(d).set("frame", 10);
              }),
              ElementsAre("altitude above terrain becomes one above the sea"));
  EXPECT_THAT(broken([&](Value& d) { item(d).set("doJumpId", 7); }), ElementsAre("doJumpId"));
  EXPECT_THAT(broken([&](Value& d) { item(d).set("command", 4711); }),
              testing::Contains("command 4711"));
  EXPECT_THAT(broken([&](Value& d) { item(d).find("params")->as_list().pop_back(); }),
              ElementsAre("params must contain 7 values"));
  EXPECT_THAT(broken([&](Value& d) { item(d).find("params")->as_list()[0] = Value("x"); }),
              ElementsAre("param 1"));
  EXPECT_THAT(broken([&](Value& d) { item(d).find("params")->as_list()[3] = Value(); }), IsEmpty());
  EXPECT_THAT(broken([&](Value& d) { item(d).find("params")->as_list()[4] = Value(); }),
              ElementsAre("param 5"));
  EXPECT_THAT(broken([&](Value& d) { item(d).find("params")->as_list()[4] = Value(91.0); }),
              ElementsAre("no place on the earth"));
  const auto fence = [](Value& d) -> Value& { return *d.find("geoFence"); };
  for (const char* key : {"version", "circles", "polygons"})
    EXPECT_THAT(broken([&](Value& d) { without(fence(d), key); }), Not(IsEmpty())) << key;
  const auto polygon = [&](Value& d) -> Value& { return fence(d).find("polygons")->as_list()[0]; };
  for (const char* key : {"polygon", "inclusion", "version"})
    EXPECT_THAT(broken([&](Value& d) { without(polygon(d), key); }), Not(IsEmpty())) << key;
  EXPECT_THAT(broken([&](Value& d) {
                auto& corners = polygon(d).find("polygon")->as_list();
                std::reverse(corners.begin(), corners.end());
              }),
              ElementsAre("polygon is not clockwise"));
  EXPECT_THAT(broken([&](Value& d) {
                fence(d).find("circles")->as_list()[0].find("circle")->set("radius", -1.0);
              }),
              ElementsAre("circle"));
  EXPECT_THAT(broken([&](Value& d) { d.find("rallyPoints")->set("version", 1); }),
              ElementsAre("rallyPoints.version"));
  for (const Value::List& point : {Value::List{46.5, 6.6}, Value::List{146.5, 6.6, 20.0}})
    EXPECT_THAT(broken([&](Value& d) {
                  d.find("rallyPoints")->set("points", Value(Value::List{Value(point)}));
                }),
                ElementsAre("rallyPoints.points is no place"));
}

TEST(MissionChecker, EveryRuleOfWaypointsHasAFileThatBreaksIt) {
  const std::string good = file_of("waypoints", film_plan());
  const auto broken = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return waypoints_faults(text.replace(at, from.size(), to));
  };
  EXPECT_THAT(waypoints_faults(good), IsEmpty());
  EXPECT_THAT(broken("QGC WPL 110", "QGC WPL 120"), ElementsAre("first line"));
  EXPECT_THAT(waypoints_faults("QGC WPL 110\n"), ElementsAre("no items"));
  EXPECT_THAT(broken("\n1\t0", "\n# a comment\n1\t0"), Not(IsEmpty()));
  EXPECT_THAT(broken("\n1\t0\t3\t22\t", "\n1 0 3 22 "),
              ElementsAre("line 3: expected 12 words between tabs"));
  EXPECT_THAT(broken("\n1\t0\t3\t22", "\n2\t0\t3\t22"), ElementsAre("line 3: number"));
  EXPECT_THAT(broken("\n1\t0\t3\t22", "\n1\t1\t3\t22"), ElementsAre("line 3: current"));
  EXPECT_THAT(broken("\n1\t0\t3\t22", "\n1\t0\t10\t22"), ElementsAre("line 3: frame"));
  EXPECT_THAT(broken("\n1\t0\t3\t22", "\n1\t0\t0\t22"),
              ElementsAre("line 3: height above the sea"));
  EXPECT_THAT(broken("\n1\t0\t3\t22", "\n1\t0\t2\t22"),
              ElementsAre("line 3: frame of the command"));
  EXPECT_THAT(broken("\n1\t0\t3\t22", "\n1\t0\t3\t4711"), ElementsAre("line 3: command"));
  EXPECT_THAT(broken("\n0\t1\t0\t16", "\n0\t1\t3\t16"), ElementsAre("line 2: home"));
  EXPECT_THAT(broken("\n1\t0\t3\t22\t0.0000", "\n1\t0\t3\t22\tnan"), ElementsAre("line 3: word 5"));
  EXPECT_THAT(broken("46.519100", "46.5"), Not(IsEmpty()));
  EXPECT_THAT(broken("46.519100", "96.519100"), ElementsAre("line 2: place"));
}

}  // namespace
}  // namespace lapwing
