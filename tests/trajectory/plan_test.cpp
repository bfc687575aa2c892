// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "framework/core/json.h"
#include "framework/trajectory/plan.h"
#include "framework/trajectory/plan_digest.h"
#include "tests/obstacles.h"

namespace lapwing {
namespace {

using testing::HasSubstr;

Plan small_plan(const MotionRecord& motion = force_motion()) {
  Plan plan;
  plan.mission = "castle \"flyover\" \xc3\xa9";
  plan.kind = "film";
  plan.geodetic_origin = GeodeticOrigin{47.1, 8.2, 400};
  plan.vehicle = Value::map();
  plan.vehicle.set("name", "solo");
  plan.trajectory.motion = motion;
  plan.trajectory.has_gimbal = true;
  plan.trajectory.has_target = true;
  for (int i = 0; i < 3; ++i) {
    Sample s;
    s.time = 0.1 * i;
    s.position = {1.0 / 3, double(i), 2};
    s.velocity = {0, 10.0, 1e-17};
    s.acceleration = {1, 2, 3};
    s.yaw = 0.3;
    s.yaw_rate = -0.1;
    s.columns.set("force", Eigen::Vector3d(0, 0, 14.7));
    s.columns.set("yaw_torque", 0.01);
    s.columns.set("orientation", Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5));
    s.columns.set("body_rates", Eigen::Vector3d(0.1, 0.2, 0.3));
    s.columns.set("rotor_thrusts", Eigen::Vector4d(1, 2, 3, 4));
    s.gimbal_pitch = -0.7;
    s.target = {5, 6, 7};
    plan.trajectory.samples.push_back(s);
  }
  plan.environment.margin = 0.4;
  plan.environment.obstacles = {sphere_at("tree", {1, 2, 3}, 4),
                                box_at("house", {1, 2, 3}, {4, 5, 6})};
  plan.budget = 120;
  plan.task.keyframes.push_back({.time = 0.1, .position = {0, 1, 2}, .yaw = 0.5});
  plan.task.keyframes.push_back({.time = 0.2, .position = {0, 2, 2}});
  plan.configuration = Value::map();
  plan.configuration.set("weights", 3);
  return plan;
}

Plan reread(const Plan& plan) {
  return plan_from_value(from_json(plan_text(plan), "plan.json"));
}

std::string error_of(const Value& value) {
  try {
    plan_from_value(value);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

void erase(Value& map, const std::string& key) {
  std::erase_if(map.as_map(), [&](const auto& entry) { return entry.first == key; });
}

TEST(Plan, RoundTripIsByteStableForEveryModel) {
  for (const auto* motion : {&force_motion(), &rotors_motion(), &path_motion()}) {
    const Plan plan = small_plan(*motion);
    const std::string text = plan_text(plan);
    EXPECT_EQ(plan_text(reread(plan)), text);
    EXPECT_EQ(plan_text(reread(reread(plan))), text);
  }
}

// small_plan() as a film: zones, subjects, cuts and framing.
Plan film_plan() {
  Plan plan = small_plan();
  auto& obstacles = plan.environment.obstacles;
  obstacles = {zone_at("square", {{0, 0}, {1.0 / 3, 0}, {0, 2}}),
               flight_zone_at("tower", {{5, 5}, {6, 5}, {6, 6}, {5, 6}}, -1, 40)};
  obstacles[0].opaque = false;
  obstacles[0].times = {0.5, 2};
  obstacles[0].moves = {{0, 0, 0}, {1.0 / 3, 0, 1}};
  plan.environment.subjects = {{"walker", {0, 0.1, 2}, {{0, 0, 1}, {1, 0, 1}, {1, 3, 1}}, 1.8, 0.5},
                               {"castle", {0}, {{9, 9, 2}}}};
  plan.cuts = {{0.05, 0.1}, {0.15, 0.2}};
  plan.task.framing = {{"walker", {0, 0.1}}, {"castle", {0.1, 0.2}}};
  plan.task.framing_share = 0.99;
  return plan;
}

TEST(Plan, FilmsSurvive) {
  const Plan plan = reread(film_plan());
  EXPECT_EQ(plan_text(plan), plan_text(film_plan()));
  const Environment& environment = plan.environment;
  ASSERT_EQ(environment.obstacles.size(), 2u);
  const Obstacle &square = environment.obstacles[0], &tower = environment.obstacles[1];
  EXPECT_EQ(recorded_numbers(square.parameters, "corners")[2], 1.0 / 3);
  EXPECT_FALSE(square.opaque);
  EXPECT_EQ(square.side, Side::keep_out);
  EXPECT_EQ(square.moved(0), Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(square.moved(9), Eigen::Vector3d(1.0 / 3, 0, 1));
  EXPECT_NEAR(square.speed(), std::hypot(1.0 / 3, 1) / 1.5, 1e-12);
  EXPECT_EQ(tower.side, Side::keep_inside);
  EXPECT_EQ(tower.parameters.at("floor").as_number(), -1);
  ASSERT_EQ(environment.subjects.size(), 2u);
  EXPECT_EQ(environment.subjects[0].times[1], 0.1);
  EXPECT_EQ(environment.subjects[0].positions[2], Eigen::Vector3d(1, 3, 1));
  EXPECT_EQ(environment.subjects[0].width, 0.5);
  EXPECT_EQ(environment.subjects[1].name, "castle");
  ASSERT_EQ(plan.cuts.size(), 2u);
  EXPECT_EQ(plan.cuts[1].start, 0.15);
  EXPECT_EQ(plan.task.framing[0].subject, "walker");
  EXPECT_EQ(plan.task.framing[1].span.finish, 0.2);
  EXPECT_EQ(plan.task.framing_share, 0.99);
}

TEST(Plan, WithoutFilmThereAreNoKeysOfIt) {
  const Value value = to_value(small_plan());
  EXPECT_EQ(value.find("cuts"), nullptr);
  EXPECT_EQ(value.at("task").find("framing"), nullptr);
  EXPECT_EQ(value.at("task").find("framing_share"), nullptr);
  EXPECT_EQ(value.at("environment").find("subjects"), nullptr);
  const Value& obstacle = value.at("environment").at("obstacles").as_list()[0];
  for (const char* key : {"side", "opaque", "track", "triangles"})
    EXPECT_EQ(obstacle.find(key), nullptr) << key;
}

TEST(Plan, EveryErrorOfAFilmIsListed) {
  Value value = to_value(film_plan());
  auto& obstacles = value.find("environment")->find("obstacles")->as_list();
  auto& subjects = value.find("environment")->find("subjects")->as_list();
  auto& framing = value.find("task")->find("framing")->as_list();
  obstacles[0].set("roof", 3.0);
  obstacles[0].find("track")->find("moves")->as_list()[1] = Value(3);
  obstacles[1].set("parameters", 3);
  obstacles[1].set("side", "beside");
  subjects[0].find("times")->as_list()[1] = "noon";
  subjects[0].find("positions")->as_list()[1] = Value(3);
  erase(subjects[1], "height");
  subjects[1].set("times", 0);
  subjects[1].set("positions", Value(Value::List{Value(Value::List{0.0, 0.0, std::nan("")})}));
  value.find("cuts")->as_list()[1].set("end", 0.2);
  erase(framing[0], "subject");
  framing[1].set("start", false);
  const std::string message = error_of(value);
  EXPECT_THAT(message, HasSubstr("environment.obstacles[1].roof: unknown"));
  EXPECT_THAT(message,
              HasSubstr("environment.obstacles[1].track.moves: expected a list of lists of 3"));
  EXPECT_THAT(message, HasSubstr("environment.obstacles[2].parameters: expected a map"));
  EXPECT_THAT(message,
              HasSubstr("environment.obstacles[2].side: expected one of: keep_out, keep_inside"));
  EXPECT_THAT(message,
              HasSubstr("environment.subjects[1].times: expected a list of finite numbers"));
  EXPECT_THAT(message,
              HasSubstr("environment.subjects[1].positions: expected a list of lists of 3"));
  EXPECT_THAT(message, HasSubstr("environment.subjects[2].height: missing"));
  EXPECT_THAT(message,
              HasSubstr("environment.subjects[2].times: expected a list of finite numbers"));
  EXPECT_THAT(message, HasSubstr("environment.subjects[2].positions: expected a list of lists"));
  EXPECT_THAT(message, HasSubstr("cuts[2].end: unknown"));
  EXPECT_THAT(message, HasSubstr("task.framing[1].subject: missing"));
  EXPECT_THAT(message, HasSubstr("task.framing[2].start: expected a number"));
}

TEST(Plan, AShareOfNoFramingIsRefused) {
  Value value = to_value(small_plan());
  value.find("task")->set("framing_share", 0.9);
  EXPECT_THAT(error_of(value), HasSubstr("task.framing: missing"));
  value = to_value(film_plan());
  erase(*value.find("task"), "framing_share");
  EXPECT_THAT(error_of(value), HasSubstr("task.framing_share: missing"));
}

TEST(Plan, ValuesSurvive) {
  const Plan plan = reread(small_plan());
  EXPECT_EQ(plan.mission, "castle \"flyover\" \xc3\xa9");
  EXPECT_EQ(plan.geodetic_origin->longitude_deg, 8.2);
  EXPECT_EQ(plan.trajectory.samples[1].position, Eigen::Vector3d(1.0 / 3, 1, 2));
  EXPECT_EQ(plan.trajectory.samples[1].velocity.z(), 1e-17);
  EXPECT_EQ(plan.trajectory.samples[2].gimbal_pitch, -0.7);
  EXPECT_EQ(recorded_numbers(plan.environment.obstacles[1].parameters, "upper")[2], 6);
  EXPECT_EQ(plan.task.keyframes[0].yaw, 0.5);
  EXPECT_FALSE(plan.task.keyframes[1].yaw);
  EXPECT_EQ(plan.configuration.at("weights").as_integer(), 3);
  EXPECT_TRUE(plan.solver.is_null());
}

TEST(Plan, SampleHasTheFieldsOfItsModelAlone) {
  const auto keys = [](const MotionRecord& motion) {
    std::vector<std::string> names;
    const Value plan = to_value(small_plan(motion));
    for (const auto& [key, value] : plan.at("samples").as_list()[0].as_map()) names.push_back(key);
    return names;
  };
  using testing::Contains;
  using testing::Not;
  EXPECT_THAT(keys(force_motion()), Contains("force"));
  EXPECT_THAT(keys(force_motion()), Not(Contains("orientation")));
  EXPECT_THAT(keys(rotors_motion()), Contains("rotor_thrusts"));
  EXPECT_THAT(keys(rotors_motion()), Not(Contains("yaw_torque")));
  EXPECT_THAT(keys(path_motion()), Not(Contains("velocity")));
}

TEST(Plan, OptionalSectionsHaveNoKey) {
  Plan plan = small_plan();
  plan.budget.reset();
  plan.geodetic_origin.reset();
  plan.configuration = {};
  const Value value = to_value(plan);
  EXPECT_EQ(value.find("budget"), nullptr);
  EXPECT_EQ(value.find("configuration"), nullptr);
  EXPECT_EQ(value.at("frame").find("geodetic_origin"), nullptr);
  EXPECT_FALSE(reread(plan).budget);
}

TEST(Plan, OriginKeepsWhatItsHeightIsMeasuredFrom) {
  Plan plan = small_plan();
  EXPECT_EQ(to_value(plan).at("frame").at("geodetic_origin").find("height_of"), nullptr);
  for (const GeodeticOrigin& origin :
       {GeodeticOrigin{47.1, 8.2, 400}, GeodeticOrigin{47.1, 8.2, 352.5, HeightOf::sea, 47.5},
        GeodeticOrigin{47.1, 8.2, 1.5, HeightOf::ground}}) {
    plan.geodetic_origin = origin;
    EXPECT_EQ(reread(plan).geodetic_origin, origin);
  }
  EXPECT_FALSE(plan.geodetic_origin->altitude());
  Value value = to_value(plan);
  Value& ground = *value.find("frame")->find("geodetic_origin");
  EXPECT_EQ(ground.find("altitude"), nullptr) << "of a height above the ground nobody knows it";
  ground.set("height_of", "roof");
  EXPECT_THAT(error_of(value),
              HasSubstr("geodetic_origin.height_of: expected one of: sea, ground"));
  erase(ground, "height_of");
  EXPECT_THAT(error_of(value), HasSubstr("geodetic_origin.height_of: missing"));
}

TEST(Plan, HomeIsKept) {
  Plan plan = small_plan();
  EXPECT_EQ(to_value(plan).find("home"), nullptr);
  for (const Home& home : {Home{{1, 2, 3}, std::nullopt, std::nullopt, {}},
                           Home{{1, 2, -3}, 120, 500.5, {{1, 2, 30}, {4, 5, 60}}}}) {
    plan.home = home;
    EXPECT_EQ(reread(plan).home, home);
  }
  Value value = to_value(plan);
  value.find("home")->set("max_hight", 3.0);
  value.find("home")->set("rally_points", Value(Value::List{1.0}));
  EXPECT_THAT(error_of(value), HasSubstr("home.max_hight: unknown; did you mean 'max_height'?"));
  EXPECT_THAT(error_of(value), HasSubstr("home.rally_points"));
  erase(*value.find("home"), "position");
  EXPECT_THAT(error_of(value), HasSubstr("home.position: missing"));
}

TEST(Plan, EveryErrorIsListed) {
  Value value = to_value(small_plan());
  value.set("misson", "x");
  erase(value, "kind");
  auto& samples = value.find("samples")->as_list();
  samples[0].set("time", "soon");
  samples[1].set("position", Value(Value::List{1.0, std::nan(""), 2.0}));
  samples[2].set("yaw_torq", 0.0);
  value.find("task")->find("keyframes")->as_list()[1].set("tolerance", INFINITY);
  value.find("environment")->find("obstacles")->as_list()[0].set("type", Value::map());
  value.find("motion")->set("inputs", "wobbly");
  value.find("frame")->find("geodetic_origin")->set("latitude_deg", 95.0);
  const std::string message = error_of(value);
  EXPECT_THAT(message, HasSubstr("misson: unknown; did you mean 'mission'?"));
  EXPECT_THAT(message, HasSubstr("kind: missing"));
  EXPECT_THAT(message, HasSubstr("samples[1].time: expected a number, got a text"));
  EXPECT_THAT(message, HasSubstr("samples[2].position: expected a list of 3 finite numbers"));
  EXPECT_THAT(message, HasSubstr("samples[3].yaw_torq: unknown; did you mean 'yaw_torque'?"));
  EXPECT_THAT(message, HasSubstr("task.keyframes[2].tolerance: expected a finite number"));
  EXPECT_THAT(message, HasSubstr("environment.obstacles[1].type: expected a text, got a map"));
  EXPECT_THAT(message, HasSubstr("motion.inputs: expected one of: held, linear"));
  EXPECT_THAT(message, HasSubstr("latitude must lie between"));
}

TEST(Plan, FieldsOfAnotherModelAreUnknown) {
  Value value = to_value(small_plan());
  value.find("samples")->as_list()[0].set("orientation", Value(Value::List{1.0, 0.0, 0.0, 0.0}));
  EXPECT_THAT(error_of(value), HasSubstr("samples[1].orientation: unknown"));
}

TEST(Plan, MissingTablesAreReportedOnce) {
  const std::string message = error_of(Value::map());
  EXPECT_THAT(message, HasSubstr("motion: missing"));
  EXPECT_THAT(message, HasSubstr("vehicle: missing"));
  EXPECT_THAT(message, testing::Not(HasSubstr("motion.model")));
  EXPECT_THAT(error_of(Value(3)), HasSubstr("expected a map"));
}

TEST(Plan, RefusesOtherFormatsAndNoSamples) {
  Value value = to_value(small_plan());
  value.set("format", 3);
  value.set("samples", Value::list());
  EXPECT_THAT(error_of(value), HasSubstr("this version reads formats 1 and 2"));
  EXPECT_THAT(error_of(value), HasSubstr("at least one sample"));
}

// Before shapes were plugins, a plan had a list for each kind, and distances named the kind.
TEST(Plan, ReadsTheFirstFormat) {
  Value value = to_value(small_plan());
  value.set("format", 1);
  const Value environment = from_json(R"({ "margin": 0.4,
    "spheres": [ { "name": "tree", "center": [1, 2, 3], "radius": 4 } ],
    "boxes": [ { "name": "house", "lower": [1, 2, 3], "upper": [4, 5, 6] } ],
    "zones": [ { "name": "yard", "corners": [[0, 0], [1, 0], [0, 2]], "ceiling": 9 } ],
    "flight_zones": [ { "name": "park", "corners": [[0, 0], [9, 0], [0, 9]], "floor": -1 } ],
    "meshes": [ { "name": "wall", "file": "wall.ply", "sha256": "00" } ],
    "maps": [ { "name": "hall", "file": "hall.ot", "sha256": "11" } ] })",
                                      "environment");
  value.set("environment", environment);
  value.find("task")->set("framing", Value::list());
  value.find("task")->set("framing_share", 0.9);
  value.find("configuration")->set("line_of_sight", "reported");
  value.set("constraints", from_json(R"([ { "name": "c", "required": true, "operations": [
      { "op": "constant", "number": 1 },
      { "op": "distance", "of": [0, 0, 0], "reach": 5, "obstacle": "map", "index": 0 },
      { "op": "distance", "of": [0, 0, 0], "reach": 5, "obstacle": "no_fly_zone", "index": 0 } ],
    "results": [ { "of": 1, "lower": 0 }, { "of": 2, "lower": 0 } ] } ])",
                                     "constraints"));
  const Plan plan = plan_from_value(value);
  const auto& obstacles = plan.environment.obstacles;
  ASSERT_EQ(obstacles.size(), 6u);
  const auto expect = [&](std::size_t k, const Obstacle& other) {
    EXPECT_EQ(obstacles[k].name, other.name);
    EXPECT_EQ(obstacles[k].type, other.type);
    EXPECT_EQ(obstacles[k].side, other.side);
    EXPECT_TRUE(obstacles[k].opaque);
    for (const auto& [key, number] : other.parameters.as_map())
      if (number.is_text())
        EXPECT_EQ(obstacles[k].parameters.at(key), number);
      else if (number.is_list())
        EXPECT_EQ(recorded_numbers(obstacles[k].parameters, key),
                  recorded_numbers(other.parameters, key));
      else
        EXPECT_EQ(obstacles[k].parameters.at(key).as_number(), number.as_number());
  };
  expect(0, sphere_at("tree", {1, 2, 3}, 4));
  expect(1, box_at("house", {1, 2, 3}, {4, 5, 6}));
  expect(2, zone_at("yard", {{0, 0}, {1, 0}, {0, 2}}, -INFINITY, 9));
  expect(3, flight_zone_at("park", {{0, 0}, {9, 0}, {0, 9}}, -1));
  expect(4, file_at("wall", "mesh", "wall.ply", "00"));
  expect(5, file_at("hall", "map", "hall.ot", "11"));
  EXPECT_FALSE(plan.task.line_of_sight_required);
  EXPECT_EQ(plan.constraints[0].operations[1].component, 5);
  EXPECT_EQ(plan.constraints[0].operations[2].component, 2);
  value.find("environment")->set("spheres", Value(3));
  EXPECT_THAT(error_of(value), HasSubstr("environment.spheres: expected a list"));
}

// A shape that the verifier does not know goes with its triangles; a record that was changed is
// told from the others by its own checksum.
TEST(Plan, RecordsOfShapesHaveTrianglesAndChecksums) {
  Plan plan = small_plan();
  Obstacle pole = obstacle_at("pole", "tripod", {{"size", 3.5}});
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1.0 / 3}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  pole.triangles = std::make_shared<TriangleMesh>(mesh);
  pole.tolerance = 0.005;
  plan.environment.obstacles.push_back(pole);
  const Plan back = reread(plan);
  const Obstacle& read = back.environment.obstacles[2];
  ASSERT_NE(read.triangles, nullptr);
  EXPECT_EQ(read.triangles->vertices, mesh.vertices);
  EXPECT_EQ(read.triangles->triangles, mesh.triangles);
  EXPECT_EQ(read.tolerance, 0.005);
  EXPECT_EQ(plan_text(back), plan_text(plan));

  Value document = from_json(plan_text(plan), "plan.json");
  EXPECT_TRUE(check_digest(document).changed.empty());
  Value& second = document.find("environment")->find("obstacles")->as_list()[1];
  second.find("parameters")->set("upper", place_value({4, 5, 7}));
  EXPECT_EQ(check_digest(document).changed,
            (std::vector<std::string>{"environment.obstacles", "environment.obstacles[1]"}));

  Value value = to_value(plan);
  value.find("environment")
      ->find("obstacles")
      ->as_list()[2]
      .find("triangles")
      ->set("triangles", Value(Value::List{numbers_value({0, 1, 2.5})}));
  EXPECT_THAT(error_of(value), HasSubstr("obstacles[3].triangles.triangles: expected places"));
}

TEST(Plan, NotANumberCannotBeWritten) {
  Plan plan = small_plan();
  plan.trajectory.samples[1].yaw = std::nan("");
  const auto path = std::filesystem::path(testing::TempDir()) / "lapwing_nan_plan.json";
  std::filesystem::remove(path);
  EXPECT_THROW(write_plan(plan, path), Error);
  EXPECT_FALSE(std::filesystem::exists(path));
  for (const double bad : {std::nan(""), double(INFINITY)}) {
    plan = film_plan();
    plan.environment.obstacles[0].parameters.set("floor", bad);
    EXPECT_THROW(plan_text(plan), Error);
    plan = film_plan();
    plan.cuts[0].finish = bad;
    EXPECT_THROW(plan_text(plan), Error);
  }
}

Plan scan_plan() {
  Plan plan = small_plan();
  ScanTask scan;
  scan.region = Eigen::AlignedBox3d(Eigen::Vector3d(-1, -2, 0), Eigen::Vector3d(1.0 / 3, 2, 9));
  scan.camera = {600, 450, 345, 346, 299.5, 224.5};
  scan.range = 55;
  scan.map = "known";
  scan.seen = 123456789012;
  scan.seen_share = 0.97;
  scan.tolerance = 0.2;
  scan.angle_tolerance = 0.05;
  scan.views = {{0.1, {1, 2, 3}, 0.5, -0.25, ViewKind::planned},
                {0.2, {1.0 / 3, 2, 3}, 7.5, -1.5, ViewKind::matching}};
  plan.task.scan = scan;
  return plan;
}

TEST(Plan, ScansSurvive) {
  const Plan plan = reread(scan_plan());
  EXPECT_EQ(plan_text(plan), plan_text(scan_plan()));
  ASSERT_TRUE(plan.task.scan.has_value());
  const ScanTask& scan = *plan.task.scan;
  EXPECT_EQ(scan.region.bounds().min(), Eigen::Vector3d(-1, -2, 0));
  EXPECT_EQ(scan.region.bounds().max(), Eigen::Vector3d(1.0 / 3, 2, 9));
  EXPECT_EQ(scan.camera.width, 600);
  EXPECT_EQ(scan.camera.height, 450);
  EXPECT_EQ(scan.camera.focal_x, 345);
  EXPECT_EQ(scan.camera.focal_y, 346);
  EXPECT_EQ(scan.camera.principal_x, 299.5);
  EXPECT_EQ(scan.camera.principal_y, 224.5);
  EXPECT_EQ(scan.range, 55);
  EXPECT_EQ(scan.map, "known");
  EXPECT_EQ(scan.seen, 123456789012);
  EXPECT_EQ(scan.seen_share, 0.97);
  EXPECT_EQ(scan.tolerance, 0.2);
  EXPECT_EQ(scan.angle_tolerance, 0.05);
  ASSERT_EQ(scan.views.size(), 2u);
  EXPECT_EQ(scan.views[0].time, 0.1);
  EXPECT_EQ(scan.views[0].kind, ViewKind::planned);
  EXPECT_EQ(scan.views[1].kind, ViewKind::matching);
  EXPECT_EQ(scan.views[1].position, Eigen::Vector3d(1.0 / 3, 2, 3));
  EXPECT_EQ(scan.views[1].yaw, 7.5);
  EXPECT_EQ(scan.views[1].pitch, -1.5);
  EXPECT_EQ(to_value(small_plan()).at("task").find("scan"), nullptr);
  EXPECT_FALSE(reread(small_plan()).task.scan.has_value());
}

TEST(Plan, EveryErrorOfAScanIsListed) {
  Value value = to_value(scan_plan());
  Value& scan = *value.find("task")->find("scan");
  scan.find("camera")->set("image_size", Value(Value::List{600.5, 450}));
  erase(*scan.find("region"), "upper");
  scan.set("reach", 3);
  scan.set("seen", "all");
  erase(scan, "map");
  auto& views = scan.find("views")->as_list();
  views[0].set("kind", "extra");
  views[0].set("roll", 0.0);
  erase(views[1], "pitch");
  const std::string text = error_of(value);
  for (const char* part :
       {"task.scan.camera.image_size: expected whole numbers of pixels", "task.scan.region.upper",
        "task.scan.reach", "task.scan.seen", "task.scan.map", "task.scan.views[1].kind",
        "task.scan.views[1].roll", "task.scan.views[2].pitch"})
    EXPECT_THAT(text, HasSubstr(part));
}

TEST(Plan, TruncatedFileIsOneClearError) {
  const auto path = std::filesystem::path(testing::TempDir()) / "lapwing_truncated_plan.json";
  const std::string text = plan_text(small_plan());
  std::ofstream(path) << text.substr(0, text.size() / 2);
  try {
    read_plan(path);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("lapwing_truncated_plan.json"));
  }
  EXPECT_THROW(read_plan(path.string() + ".absent"), InputError);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace lapwing
