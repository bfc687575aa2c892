// SPDX-License-Identifier: Apache-2.0
// qgc_plan and waypoints: files that loaders take, and the flight that becomes of them.
#include <gmock/gmock.h>

#include <sstream>

#include "framework/core/json.h"
#include "framework/export/flown_comparison.h"
#include "tests/obstacles.h"
#include "tests/plugins/exporters/mission_checker.h"
#include "tests/plugins/exporters/placed_film.h"

namespace lapwing {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

Value parameters_of(std::initializer_list<std::pair<const char*, Value>> entries) {
  Value given = Value::map();
  for (const auto& [key, value] : entries) given.set(key, value);
  return given;
}

Plan scan_plan() {
  Plan plan = film_plan();
  plan.kind = "scan";
  plan.task.framing.clear();
  plan.environment.subjects.clear();
  plan.task.scan.emplace();
  for (const int i : {20, 100, 390}) {
    const Sample& s = plan.trajectory.samples[static_cast<std::size_t>(i)];
    plan.task.scan->views.push_back({s.time, s.position, s.yaw, s.gimbal_pitch});
  }
  return plan;
}

std::vector<int> commands_in(const std::string& text) {
  std::vector<int> commands;
  const Value document = from_json(text, "test");
  for (const Value& item : document.at("mission").at("items").as_list())
    commands.push_back(static_cast<int>(item.at("command").as_integer()));
  return commands;
}

TEST(Missions, LoadersTakeThem) {
  for (const Plan& plan : {film_plan(), scan_plan()})
    for (const char* autopilot : {"px4", "ardupilot"})
      for (const int gimbal : {1000, 205})
        for (const char* finish : {"land", "return", "hover"}) {
          const Value given =
              parameters_of({{"autopilot", autopilot}, {"gimbal", gimbal}, {"finish", finish}});
          EXPECT_THAT(plan_faults(file_of("qgc_plan", plan, given)), IsEmpty());
          EXPECT_THAT(waypoints_faults(file_of("waypoints", plan, given)), IsEmpty());
        }
}

TEST(Missions, HoldWhatIsFlownAndFilmed) {
  const std::vector<int> film = commands_in(file_of("qgc_plan", film_plan()));
  using testing::Contains;
  for (const int command : {22, 1001, 195, 2500, 178, 16, 197, 1000, 2501, 21})
    EXPECT_THAT(film, Contains(command)) << command;
  EXPECT_EQ(film.front(), 22);
  EXPECT_EQ(film.back(), 21);
  const std::vector<int> scan = commands_in(file_of("qgc_plan", scan_plan()));
  EXPECT_EQ(std::count(scan.begin(), scan.end(), 2000), 3);
  EXPECT_THAT(scan, Not(Contains(2500)));
  const std::vector<int> older = commands_in(file_of("qgc_plan", film_plan(), with("gimbal", 205)));
  EXPECT_THAT(older, Contains(205));
  EXPECT_THAT(older, Not(Contains(1000)));
  EXPECT_THAT(commands_in(file_of("qgc_plan", film_plan(), with("autopilot", "ardupilot"))),
              Contains(115));
}

TEST(Missions, HeightsCountFromTheTakeOffPlace) {
  // z = 0 is 2 m above the ground of the origin.
  const Value document = from_json(file_of("qgc_plan", film_plan()), "test");
  EXPECT_NEAR(document.at("mission").at("items").as_list()[0].at("Altitude").as_number(), 12, 1e-3);
  const Value raised = from_json(file_of("qgc_plan", film_plan(), with("home_z", 4)), "test");
  EXPECT_NEAR(raised.at("mission").at("items").as_list()[0].at("Altitude").as_number(), 6, 1e-3);
  const auto exporter = exporter_named("qgc_plan");
  const auto said = exporter->losses(film_plan(), exporter->write(film_plan()));
  EXPECT_TRUE(says(said, "origin 46.5191, 6.5668 at 2 m above the ground there"));
  EXPECT_TRUE(says(said, "take-off place, which is at z = -2 m of the plan: from 12 m to 12 m"));
  EXPECT_TRUE(says(said, "above the sea is not known"));
  Plan sea = film_plan();
  sea.geodetic_origin = GeodeticOrigin{kLatitude, kLongitude, 400, HeightOf::sea, 48};
  const Value there = from_json(file_of("qgc_plan", sea), "test");
  EXPECT_NEAR(there.at("mission").at("plannedHomePosition").as_list()[2].as_number(), 400, 0.01);
}

TEST(Missions, TheirFlightIsThatOfThePlan) {
  for (const char* format : {"qgc_plan", "waypoints"})
    for (const char* autopilot : {"px4", "ardupilot"})
      for (const int gimbal : {1000, 205}) {
        const Plan plan = film_plan();
        const auto exporter =
            exporter_named(format, parameters_of({{"autopilot", autopilot}, {"gimbal", gimbal}}));
        const auto flown = exporter->flown(plan, exporter->write(plan));
        ASSERT_TRUE(flown);
        const FlownComparison compared = compare_flown(plan, *flown, {});
        EXPECT_LE(compared.across, 0.25);
        EXPECT_LT(std::abs(compared.late), 2);
        EXPECT_LT(compared.camera, 0.35) << autopilot << gimbal;
        EXPECT_THAT(compared.refusals, IsEmpty());
      }
  const Plan scan = scan_plan();
  const auto exporter = exporter_named("qgc_plan");
  const FlownComparison compared =
      compare_flown(scan, *exporter->flown(scan, exporter->write(scan)), {});
  EXPECT_EQ(compared.images_missed, 0u);
  EXPECT_LT(compared.image_distance, 0.3);
}

TEST(Missions, TheFlightIsReadFromTheBytes) {
  const Plan plan = film_plan();
  const auto exporter = exporter_named("waypoints");
  std::string text = exporter->write(plan);
  const std::size_t place = text.find("46.51", text.find("\t16\t", text.find("\t16\t") + 4));
  text.replace(place, 6, "46.511");
  EXPECT_GT(compare_flown(plan, *exporter->flown(plan, text), {}).across, 100);
  std::string unknown = exporter->write(plan);
  unknown.replace(unknown.find("\t178\t"), 5, "\t179\t");
  EXPECT_THROW(exporter->flown(plan, unknown), InputError);
}

TEST(Missions, AToleranceTradesPointsForLoss) {
  const Plan plan = film_plan();
  std::size_t before = 1000;
  for (const double tolerance : {0.05, 0.5, 3.0}) {
    const auto exporter = exporter_named(
        "qgc_plan", parameters_of({{"tolerance", tolerance}, {"angle_tolerance", 30}}));
    const std::string text = exporter->write(plan);
    const auto commands = commands_in(text);
    const auto count = static_cast<std::size_t>(std::count(commands.begin(), commands.end(), 16));
    EXPECT_LT(count, before);
    before = count;
    EXPECT_LE(compare_flown(plan, *exporter->flown(plan, text), {}).across, tolerance);
  }
}

TEST(Missions, ZonesAreFences) {
  Plan plan = film_plan();
  const auto prism = [](const char* name, Side side, Value::List corners) {
    Obstacle zone;
    zone.name = name;
    zone.type = "prism";
    zone.side = side;
    zone.parameters.set("corners", Value(std::move(corners)));
    return zone;
  };
  plan.environment.obstacles = {
      prism("park", Side::keep_inside, {-90.0, -90.0, 90.0, -90.0, 90.0, 90.0, -90.0, 90.0}),
      prism("far", Side::keep_out, {50.0, 0.0, 60.0, 0.0, 60.0, 9.0}),
      prism("below", Side::keep_out, {-30.0, -30.0, 30.0, -30.0, 30.0, 30.0, -30.0, 30.0}),
      sphere_at("tree", {40, 0, 3}, 2)};
  const auto exporter = exporter_named("qgc_plan");
  const std::string text = exporter->write(plan);
  EXPECT_THAT(plan_faults(text), IsEmpty());
  const Value document = from_json(text, "test");
  const Value& fence = document.at("geoFence");
  EXPECT_EQ(fence.at("polygons").as_list().size(), 2u);
  EXPECT_EQ(fence.at("circles").as_list().size(), 1u);
  EXPECT_TRUE(says(exporter->losses(plan, text), "passes above or below: zone 'below'"));
  EXPECT_TRUE(says(exporter_named("waypoints")->losses(plan, ""), "fences are not in this format"));
}

TEST(Missions, TooLongAPlanIsWrittenInParts) {
  Plan plan = film_plan();
  for (Sample& s : plan.trajectory.samples) s.gimbal_pitch = -0.5 + 0.4 * std::sin(4 * s.time);
  plan.task.framing.clear();
  Value given = parameters_of({{"autopilot", "ardupilot"}, {"angle_tolerance", 0.5}});
  EXPECT_THAT(refusal_of(*exporter_named("qgc_plan", given), plan),
              testing::AllOf(HasSubstr("ArduPilot holds 700"),
                             HasSubstr("a larger `tolerance`, or"), HasSubstr("part=1 to part=")));
  given.set("part", 2);
  const auto exporter = exporter_named("qgc_plan", given);
  const std::string text = exporter->write(plan);
  EXPECT_LE(commands_in(text).size(), 700u);
  EXPECT_TRUE(says(exporter->losses(plan, text), "part 2 of "));
  const auto flown = exporter->flown(plan, text);
  EXPECT_GT(flown->start, 0);
  EXPECT_LE(compare_flown(plan, *flown, {}).across, 0.25);
  given.set("part", 99);
  EXPECT_THAT(refusal_of(*exporter_named("qgc_plan", given), plan), HasSubstr("part=99, and the"));
}

TEST(Missions, RefuseWhatTheyCannotHold) {
  for (const char* format : {"qgc_plan", "waypoints"}) {
    const auto exporter = exporter_named(format);
    Plan homeless = film_plan();
    homeless.geodetic_origin.reset();
    EXPECT_THAT(refusal_of(*exporter, homeless), HasSubstr("has no origin on the earth"));
    Plan still = film_plan();
    still.trajectory.samples.resize(1);
    EXPECT_THAT(refusal_of(*exporter, still), HasSubstr("has no length"));
    Plan lost = film_plan();
    lost.trajectory.samples[3].position.x() = std::nan("");
    EXPECT_THAT(refusal_of(*exporter, lost), HasSubstr("not finite"));
    Plan roofed = film_plan();
    roofed.environment.margin = 0.5;
    roofed.environment.obstacles.push_back(sphere_at("roof", {20, 0, 4}, 2));
    roofed.environment = with_shapes(roofed.environment);
    EXPECT_THAT(
        refusal_of(*exporter, roofed),
        testing::AllOf(HasSubstr("take-off"), HasSubstr("'roof'"), HasSubstr("take_off=false")));
    EXPECT_THROW(exporter_named(format, with("gimbal", 300)), InputError);
    EXPECT_THROW(exporter_named(format, with("tolerance", 0)), InputError);
    EXPECT_THROW(exporter_named(format, with("autopilot", "betaflight")), InputError);
  }
  Plan uncertified = film_plan();
  uncertified.certificate.set("feasible", false);
  EXPECT_THAT(file_of("qgc_plan", uncertified), HasSubstr("Lapwing (not certified)"));
  EXPECT_THAT(file_of("qgc_plan", film_plan()), Not(HasSubstr("not certified")));
  EXPECT_THAT(refusal_of(*exporter_named("waypoints"), uncertified),
              HasSubstr("no place to say so"));
}

// The film with a rest of 2.3 s after 10 s.
Plan resting_plan() {
  Plan plan = film_plan();
  auto& samples = plan.trajectory.samples;
  const Sample still = samples[100];
  for (std::size_t i = 101; i < samples.size(); ++i) samples[i].time += 2.3;
  for (int k = 1; k <= 23; ++k) {
    Sample s = still;
    s.velocity.setZero();
    s.time = 10 + 0.1 * k;
    samples.insert(samples.begin() + 100 + k, s);
  }
  plan.task.framing.clear();
  return plan;
}

std::vector<double> holds_in(const std::string& text) {
  std::vector<double> holds;
  const Value document = from_json(text, "test");
  for (const Value& item : document.at("mission").at("items").as_list())
    if (item.at("command").as_integer() == 16 && item.at("params").as_list()[0].as_number() > 0)
      holds.push_back(item.at("params").as_list()[0].as_number());
  return holds;
}

TEST(Missions, ArduPilotHoldsWholeSeconds) {
  const Plan plan = resting_plan();
  EXPECT_THAT(holds_in(file_of("qgc_plan", plan)), ElementsAre(testing::DoubleNear(2.3, 0.21)));
  const Value given = with("autopilot", "ardupilot");
  for (const char* format : {"qgc_plan", "waypoints"}) {
    const auto exporter = exporter_named(format, given);
    std::string text = exporter->write(plan);
    const FlownFile whole = *exporter->flown(plan, text);
    EXPECT_LT(std::abs(compare_flown(plan, whole, {}).longer), 1);
    // A fraction that another program wrote is dropped.
    const std::string hold = std::string(format) == "qgc_plan" ? "3.0" : "\t16\t3.0000\t";
    const std::string longer = std::string(format) == "qgc_plan" ? "3.9" : "\t16\t3.9000\t";
    ASSERT_NE(text.find(hold), std::string::npos) << text;
    text.replace(text.find(hold), hold.size(), longer);
    EXPECT_EQ(exporter->flown(plan, text)->trajectory.samples.back().time,
              whole.trajectory.samples.back().time);
  }
  for (const double hold : holds_in(file_of("qgc_plan", plan, given)))
    EXPECT_EQ(hold, std::round(hold));
  EXPECT_THAT(holds_in(file_of("qgc_plan", plan, given)), testing::Contains(3));
}

TEST(Missions, RefuseHeightsThatNobodyCanFly) {
  using testing::AllOf;
  for (const char* format : {"qgc_plan", "waypoints"}) {
    const auto said = [&](const Plan& plan,
                          std::initializer_list<std::pair<const char*, Value>> g) {
      return refusal_of(*exporter_named(format, parameters_of(g)), plan);
    };
    const Plan plan = film_plan();  // at z = 10 m
    EXPECT_THAT(said(plan, {{"home_z", 50}}),
                AllOf(HasSubstr("take-off: the first waypoint (z = 10 m) is 40 m below"),
                      HasSubstr("z = 50 m"), HasSubstr("`home_z`")));
    EXPECT_THAT(said(plan, {{"home_z", 10}}), HasSubstr("is 0 m below the take-off place"));
    EXPECT_EQ(said(plan, {{"home_z", 9.99}}), "");
    EXPECT_THAT(said(plan, {{"home_z", 50}, {"take_off", false}}),
                AllOf(HasSubstr("landing: the last waypoint"), HasSubstr("`finish=hover`")));
    EXPECT_EQ(said(plan, {{"home_z", 50}, {"take_off", false}, {"finish", "hover"}}), "");
    // The ground is at z = -2 m.
    Plan low = film_plan();
    for (std::size_t i = 100; i <= 200; ++i) low.trajectory.samples[i].position.z() = -2.5;
    EXPECT_THAT(said(low, {}), AllOf(HasSubstr(": waypoint "), HasSubstr("is -0.5 m above the"),
                                     HasSubstr("s of the plan, z = -2.5 m)")));
    // Above the sea, nothing tells where the ground is.
    low.geodetic_origin = GeodeticOrigin{kLatitude, kLongitude, 400, HeightOf::sea, 48};
    EXPECT_EQ(said(low, {{"home_z", -5}}), "");
  }
}

// The film with a home beside its begin and 6 m above the ground of the origin.
Plan film_from_home() {
  Plan plan = film_plan();
  plan.home = Home{{30, -20, 4}, 120, 300, {{10, 40, 25}}};
  return plan;
}

TEST(Missions, TakeOffAndHeightsAreThoseOfThePlansHome) {
  const Plan plan = film_from_home();
  const auto exporter = exporter_named("qgc_plan");
  const std::string text = exporter->write(plan);
  EXPECT_THAT(plan_faults(text), IsEmpty());
  const Value document = from_json(text, "test");
  const Value& mission = document.at("mission");
  const Eigen::Vector3d origin(kLatitude, kLongitude, 2);
  const auto& home = mission.at("plannedHomePosition").as_list();
  const Eigen::Vector3d there = from_origin(origin, {home[0].as_number(), home[1].as_number(), 6});
  EXPECT_NEAR(there.x(), 30, 0.02);
  EXPECT_NEAR(there.y(), -20, 0.02);
  const auto& items = mission.at("items").as_list();
  ASSERT_EQ(items[0].at("command").as_integer(), 22);
  const auto& up = items[0].at("params").as_list();
  const Eigen::Vector3d above = from_origin(origin, {up[4].as_number(), up[5].as_number(), 12});
  EXPECT_NEAR(above.x(), 30, 0.02);
  EXPECT_NEAR(above.y(), -20, 0.02);
  EXPECT_NEAR(up[6].as_number(), 6, 1e-3);  // to the first waypoint at z = 10 m
  // Flown from the file, it is where the plan has it.
  EXPECT_LE(compare_flown(plan, *exporter->flown(plan, text), {}).across, 0.25);
  const Value raised = from_json(file_of("qgc_plan", plan, with("home_z", 1)), "test");
  EXPECT_NEAR(raised.at("mission").at("items").as_list()[0].at("Altitude").as_number(), 9, 1e-3);
}

TEST(Missions, RallyPointsAreInThePlanFile) {
  const Plan plan = film_from_home();
  const auto exporter = exporter_named("qgc_plan");
  const Value document = from_json(exporter->write(plan), "test");
  const auto& points = document.at("rallyPoints").at("points").as_list();
  ASSERT_EQ(points.size(), 1u);
  const auto& point = points[0].as_list();
  const Eigen::Vector3d there =
      from_origin({kLatitude, kLongitude, 2}, {point[0].as_number(), point[1].as_number(), 27});
  EXPECT_NEAR(there.x(), 10, 0.02);
  EXPECT_NEAR(there.y(), 40, 0.02);
  EXPECT_NEAR(point[2].as_number(), 21, 1e-3);
  EXPECT_TRUE(says(exporter_named("waypoints")->losses(plan, ""), "rally points are not in this"));
}

TEST(Missions, TheWayFromHomeToTheFirstWaypointIsChecked) {
  Plan plan = film_from_home();
  plan.environment.margin = 0.5;
  plan.environment.obstacles = {sphere_at("mast", {25, -10, 10}, 2)};
  plan.environment = with_shapes(plan.environment);
  for (const char* format : {"qgc_plan", "waypoints"}) {
    EXPECT_THAT(refusal_of(*exporter_named(format), plan),
                testing::AllOf(HasSubstr("take-off: the level way"), HasSubstr("'mast'"),
                               HasSubstr("take_off=false")));
    EXPECT_EQ(refusal_of(*exporter_named(format, with("take_off", false)), plan), "");
  }
  plan.home.reset();  // from below the first waypoint, nothing is in the way
  EXPECT_EQ(refusal_of(*exporter_named("qgc_plan"), plan), "");
}

TEST(Missions, WaypointsBelowTheTakeOffPlaceAreSaid) {
  Plan plan = film_plan();
  for (std::size_t i = 100; i <= 200; ++i) plan.trajectory.samples[i].position.z() = 2;
  const auto exporter =
      exporter_named("qgc_plan", parameters_of({{"home_z", 5}, {"time_tolerance", 50}}));
  EXPECT_TRUE(says(exporter->losses(plan, ""), "below the take-off place, the lowest by 3 m"));
  EXPECT_FALSE(says(exporter_named("qgc_plan")->losses(plan, ""), "below the take-off place"));
}

}  // namespace
}  // namespace lapwing
