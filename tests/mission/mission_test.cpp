// SPDX-License-Identifier: Apache-2.0
#include "framework/config/yaml.h"
#include "tests/mission/mission_fixture.h"

namespace lapwing {
namespace {

TEST_F(MissionTest, AShotIsPlanned) {
  const auto mission = load(film(""));
  mission->configure({}, {});
  EXPECT_EQ(mission->name(), "test");
  EXPECT_EQ(mission->kind(), "film");
  const MissionResult result = mission->plan();
  EXPECT_EQ(result.report.status, SolveStatus::optimal) << result.report.message;
  const Certificate certificate = verify(result.plan);
  for (const Check& check : certificate.failures()) ADD_FAILURE() << to_line(check);
  EXPECT_EQ(result.plan.task.keyframes.size(), 2u);
  EXPECT_TRUE(result.notes.empty());
  const Eigen::Vector3d last = result.plan.trajectory.samples.back().position;
  EXPECT_NEAR((last - Eigen::Vector3d(6, 0, 4)).norm(), 0, 0.5);
  EXPECT_NEAR(result.plan.trajectory.samples.back().yaw, M_PI / 2, 0.17);
}

TEST_F(MissionTest, OptionsKnowWhereTheyComeFrom) {
  const auto mission = load(film("step = 0.2,"));
  Value layer = Value::map();
  layer.set("weights", Value::map()).set("keyframe", Value(5.0)).with_origin({"c.yaml", 3});
  mission->configure(
      std::vector<Value>{layer},
      std::vector<std::string>{"weights.effort=0.5", "solver.iterations=7", "stretch=auto",
                               "sandbox.memory=100", "keyframes[2].time=4"});
  const Value& options = mission->configuration();
  EXPECT_EQ(options.at("step").as_number(), 0.2);
  EXPECT_EQ(options.at("step").origin().line, 8);
  EXPECT_EQ(options.at("weights").at("keyframe").origin(), (Origin{"c.yaml", 3}));
  EXPECT_EQ(options.at("weights").at("effort").origin().source, "--set weights.effort=0.5");
  EXPECT_EQ(options.at("weights").at("smoothness").origin().source, "default");
  EXPECT_EQ(options.at("solver").at("type").as_text(), "iqp");
  EXPECT_EQ(options.at("solver").at("iterations").as_integer(), 7);
  EXPECT_EQ(options.at("solver").at("tolerance").origin().source, "default");
  EXPECT_EQ(options.at("stretch").as_text(), "auto");
  EXPECT_EQ(options.at("keyframes").as_list()[1].at("time").as_number(), 4);
  EXPECT_EQ(options.find("sandbox"), nullptr);
}

TEST_F(MissionTest, WrongOptionsAreNamed) {
  expect(film("wieghts = {},"), "shot.lua:8: wieghts: unknown key; did you mean 'weights'?");
  expect(film("weights = { snap = 1 },"), "weights.snap: unknown key");
  expect(film("duration = '20 m',"), "duration: '20 m' is not a quantity in s");
  expect(film("duration = -1,"), "duration: expected above 0 and at most 100000 s, got -1");
  expect(film("duration = 0 / 0,"), "shot.lua:2: duration: expected a finite number, got NaN");
  expect(film("order = 5,"), "order: expected between 1 and 4");
  expect(film("start = 'rset',"), "start: expected one of rest, moving, free, got 'rset'; did you");
  expect(film("stretch = 'atuo',"), "stretch: ");
  expect(film("solver = 'iqpp',"), "did you mean 'iqp'");
  expect(film("solver = { type = 'iqp', iteration = 3 },"),
         "solver.iteration: unknown key; did you mean 'iterations'?");
  expect(film("solver = { type = 3 },"), "solver: expected the name of a plugin");
  expect(film("vehicle = 'vehicles/sool',"), "vehicles/solo");
  expect(film("vehicle = { mass = 1 },"), "missing");
  expect(film("name = 3,"), "mission.name: expected a text");
  expect(film(""), "--set wieghts.snap=2: wieghts: unknown key", {"wieghts.snap=2"});
  expect(film(""), "did you mean 'weights'?", {"wieghts.snap=2"});
  expect(film(""), "--set duration=soon: duration: 'soon' is not a quantity in s",
         {"duration=soon"});
  expect(film(""), "keyframes[9]", {"keyframes[9].time=2"});
}

// A vehicle file's contents in a configuration, on a script that names a file.
TEST_F(MissionTest, ATableOfAVehicleReplacesTheNameOfOne) {
  write_file_atomically(folder_ / "shot.lua", R"(return require("mission.film").shot {
    vehicle = "vehicles/solo",
    keyframes = { { position = {0, 0, 2} }, { position = {3, 4, 4} } } })");
  Mission mission(folder_ / "shot.lua", settings());
  Value layer = Value::map();
  layer.set("vehicle",
            read_yaml(std::string(LAPWING_SOURCE_DIR) + "/configs/vehicles/phantom.yaml"));
  mission.configure(std::vector<Value>{layer}, {});
  const Value& vehicle = mission.configuration().at("vehicle");
  EXPECT_FALSE(vehicle.find("type"));
  EXPECT_GT(vehicle.at("mass").as_number(), 0);
  // Whoever writes a `type` beside the others is told.
  layer.find("vehicle")->set("type", "vehicles/solo");
  layer.find("vehicle")->find("type")->with_origin(layer.at("vehicle").at("mass").origin());
  EXPECT_THROW(mission.configure(std::vector<Value>{layer}, {}), InputError);
}

TEST_F(MissionTest, WrongKeyframesAreNamed) {
  const auto shot = [](const std::string& keyframes, const std::string& more = "") {
    return "local film = require 'mission.film'\n\nreturn film.shot { " + more + "keyframes = {" +
           keyframes + "} }";
  };
  expect(shot("{time=0, position={0,0,1}}, {time=5, position={1,0,1}}, {time=3, position={2,0,1}}"),
         "shot.lua:3: keyframes[3].time: 3 s comes before keyframe 2 at 5 s");
  expect(shot("{time=1, position={0,0,1}}, {time=1, position={1,0,1}}"),
         "shot.lua:3: keyframes[2].time: 1 s is also the time of keyframe 1");
  expect(shot("{time=0, position={0,0,1}}, {time=25, position={1,0,1}}", "duration = 20, "),
         "shot.lua:3: keyframes[2].time: 25 s is outside the duration of 20 s");
  expect(shot("{time=-1, position={0,0,1}}"), "keyframes[1].time: expected at least 0 s");
  expect(shot("{position={0,0}}"),
         "keyframes[1].position: expected a list of 3 numbers in m, got 2");
  expect(shot("{position={0,0,0/0}}"), "keyframes[1].position[3]: expected a finite number");
  expect(shot("{pos={0,0,1}}"), "keyframes[1].pos: unknown key");
  expect(shot("{}"), "keyframes[1].position: missing");
  expect(shot(""), "keyframes: expected at least one");
  expect(shot("1, 2"), "keyframes[1]: expected a table");
  expect("return require('mission.film').shot { name = 'x' }", "keyframes: missing");
  expect("return require('mission.film').shot(3)", "film.shot: expected a table, got number");
  expect("return require('mission.film').from_file { name = 'x' }",
         "shot.lua:1: no shot: --set input=PATH");
  expect("return require('mission.film').from_file { file = 'none.json' }",
         "data file 'none.json' not found in ");
  expect(shot("{time=0, position={0,0,1}}, {time=5, position={1,0,1}}", "start = 'moving', "),
         "needs start_velocity");
}

TEST_F(MissionTest, DegenerateFilmsFly) {
  for (const char* keyframes :
       {"{position={1,2,3}}",                      // hover
        "{time=3, position={1,2,3}, yaw_deg=30}",  // hover, later
        "{position={0,0,2}}, {position={4,0,2}}, {position={4,0,2}}, {position={8,0,2}}",  // a
                                                                                           // pause
        "{position={0,0,2}}, {position={0,0,2}}",
        "{position={0,0,2}}, {position={3,3,2}}, {position={6,6,2}}, {position={9,9,2}}",
        "{position={0,0,2}}, {position={0,0,5}}, {position={0,0,9}}",  // straight up
        "{time=0,position={0,0,2}}, {time=4,position={4,0,2}}, {time=4.05,position={4.1,0,2}},"
        "{time=8,position={8,0,2}}",  // 0.05 s apart
        "{time=0,position={0,0,2}}, {time=0.05,position={0,0,2}}",
        "{position={0,0,2}}, {position={1,0,2}}, {time=6,position={2,0,2}}, {position={4,0,2}}",
        "{position={0,0,2},yaw_deg=170}, {position={4,0,2},yaw_deg=-170}"}) {
    const auto mission = load(std::string("return require('mission.film').shot { keyframes = {") +
                              keyframes + "} }");
    mission->configure({}, {});
    const MissionResult result = mission->plan();
    const Certificate certificate = verify(result.plan);
    for (const Check& check : certificate.failures()) {
      ADD_FAILURE() << keyframes << "\n" << to_line(check);
    }
  }
}

TEST_F(MissionTest, TimesAreFilledIn) {
  const auto times = [this](const std::string& shot) {
    const auto mission = load("return require('mission.film').shot { " + shot + " }");
    mission->configure({}, {});
    std::vector<double> result;
    for (const KeyframeTask& k : mission->plan().plan.task.keyframes) result.push_back(k.time);
    return result;
  };
  const std::string p = "{position={0,0,2}}";
  EXPECT_EQ(times("duration = 12, keyframes = {" + p + "," + p + "," + p + "," + p + "}"),
            (std::vector<double>{0, 4, 8, 12}));
  EXPECT_EQ(times("keyframes = {" + p + "," + p + ",{time=6,position={0,0,2}}," + p + "}"),
            (std::vector<double>{0, 3, 6, 7}));
  EXPECT_EQ(times("keyframes = {{position={0,0,2}}, {position={20,0,2}}, {position={25,0,2}}}"),
            (std::vector<double>{0, std::sqrt(40.0), 2 * std::sqrt(40.0)}));
  EXPECT_EQ(times("stretch = 2, duration = 6, keyframes = {" + p + "," + p + "}"),
            (std::vector<double>{0, 12}));
}

TEST_F(MissionTest, AnImpossibleFilmNamesLimitAndStretch) {
  const std::string script =
      "return require('mission.film').shot { hard = 0.5, keyframes = {"
      "{time=0, position={0,0,2}}, {time=4, position={60,0,2}} } }";
  auto mission = load(script);
  mission->configure({}, {});
  const MissionResult result = mission->plan();
  EXPECT_FALSE(verify(result.plan).feasible());
  ASSERT_EQ(result.notes.size(), 1u);
  EXPECT_NE(
      result.notes[0].find("speed_across of 15 m/s from keyframe 1 to 2 exceeds 10 m/s at 0 s"),
      std::string::npos)
      << result.notes[0];
  EXPECT_NE(result.notes[0].find("certified from a stretch of "), std::string::npos)
      << result.notes[0];
  const double stretch = result.block.at("certified_stretch").as_number();
  EXPECT_EQ(result.block.at("stretch").as_number(), 1);
  EXPECT_EQ(result.plan.trajectory.duration(), 4);

  mission = load(script);
  mission->configure({}, std::vector<std::string>{"stretch=auto"});
  const MissionResult stretched = mission->plan();
  EXPECT_TRUE(verify(stretched.plan).feasible());
  EXPECT_EQ(stretched.block.at("stretch").as_number(), stretch);

  mission = load(script);  // 1 % less is not certified: the stretch is the smallest
  mission->configure({}, std::vector<std::string>{"stretch=" + std::to_string(stretch / 1.011)});
  EXPECT_FALSE(verify(mission->plan().plan).feasible());
}

TEST_F(MissionTest, AFilmThatTurnsTooHardNamesTheLimitItWouldBreak) {
  // Every leg is slow enough, but there and back within two seconds is not for this vehicle.
  auto mission = load(
      "return require('mission.film').shot { hard = 0.2, keyframes = {"
      "{time=0, position={0,0,2}}, {time=1, position={4,0,2}}, {time=2, position={0,0,2}} } }");
  mission->configure({}, {});
  const MissionResult result = mission->plan();
  EXPECT_FALSE(verify(result.plan).feasible());
  ASSERT_EQ(result.notes.size(), 1u);
  EXPECT_NE(result.notes[0].find("N exceeds 28.8 N at "), std::string::npos) << result.notes[0];
  EXPECT_NE(result.notes[0].find("certified from a stretch of "), std::string::npos);
}

TEST_F(MissionTest, ScriptsMustReturnMissions) {
  expect("return 3", "a mission script returns {kind =");
  expect("local x = 1", "this one returns nil");
  expect("return {kind = 'film', name = 'x', options = {}}", "plan is a nil");
  expect("return {kind = 'film', name = 'x', plan = print, option = {}}",
         "mission.option: unknown key");
  expect("return {kind = 'film', name = '', plan = print}", "name: expected");
  expect("return {kind = 'film', name = 'a\\nb', plan = print}", "name: a line break");
  expect("return {kind = 3, name = 'x', plan = print}", "mission.kind: expected a text");
  expect("return {kind = 'film', name = 'x', plan = function() end}",
         "plan: expected the function to return run:plan{...}, a map or a fleet, got nil");
  expect("return {kind = 'film', name = 'x', options = 3, plan = print}", "options: expected");
}

TEST_F(MissionTest, OwnMissionsNeedNoDeclarations) {
  const std::string script = R"(
return {
  kind = "hop", name = "hop", options = { height = 3, solver_name = "iqp" },
  plan = function(run)
    local p = run:problem { vehicle = run:vehicle("vehicles/solo"), duration = 6 }
    p:add_model { type = "quadrotor" }
    p:add_cost { type = "keyframe", weight = 100, keyframes = {
      { time = 0, value = {0, 0, 1} }, { time = 6, value = {0, 0, run.options.height} } } }
    p:add_cost { type = "derivative", weight = 1e-3 }
    p:add_cost { type = "yaw_derivative" }
    p:add_constraint { type = "input_limits" }
    p:add_constraint { type = "boundary_state", start_yaw = 0 }
    p:finish()
    local first = run:solve(p, run.options.solver_name)
    local again = run:solve(p, { type = "iqp" }, { warm_start = first })
    assert(again.status == "optimal" and again.cost <= first.cost * 1.001 + 1e-6, again.message)
    return run:plan { solution = again }
  end,
})";
  auto mission = load(script);
  mission->configure({}, std::vector<std::string>{"height=4"});
  const MissionResult result = mission->plan();
  EXPECT_NEAR(result.plan.trajectory.samples.back().position.z(), 4, 0.1);
  expect(script, "height: expected a number, got 'high'", {"height=high"});
  expect(script, "hieght: unknown key; did you mean 'height'?", {"hieght=4"});
}

TEST_F(MissionTest, BindingsRefuseWhatTheyDoNotKnow) {
  const auto plan = [](const std::string& body) {
    return "return { kind = 'x', name = 'x', options = {}, plan = function(run)\n"
           "local v = run:vehicle('vehicles/solo')\n"
           "local p = run:problem { vehicle = v, duration = 2 }\n"
           "p:add_model { type = 'quadrotor' }\n" +
           body + "\nend }";
  };
  expect(plan("run:solv()"), "shot.lua:5: run has no 'solv'; did you mean 'solve'?");
  expect(plan("p:add_cost { type = 'keyfrme' }"), "did you mean 'keyframe'?");
  expect(plan("p:add_cost { type = 'derivative', ordr = 3 }"), "did you mean 'order'?");
  expect(plan("p:add_cost { type = 'derivative', weight = -1 }"),
         "shot.lua:5: add_cost.weight: expected at least 0, got -1");
  expect(plan("p:add_cost { weight = 1 }"), "add_cost.type: missing");
  expect(plan("p:add_cost(3)"), "add_cost: expected a table, got number");
  expect(plan("p:add_constraint { type = 'input_limits', weight = 2 }"), "unknown key");
  expect(plan("run:solve(p, 'iqp')"), "the problem is not finished");
  expect(plan("p:finish() p:add_cost { type = 'derivative' }"), "the problem is finished");
  expect(plan("run:problem { vehicle = 3, duration = 2 }"), "expected a vehicle, got number");
  expect(plan("run:problem { vehicle = v, duration = 2, stepp = 1 }"), "did you mean 'step'?");
  expect(plan("run:problem { vehicle = v, duration = 1e6 }"), "more than 100000 stages");
  expect(plan("return v.sped_across"), "a vehicle has no field 'sped_across'; did you mean");
  expect(plan("v.__gc()"), "a vehicle has no field '__gc'");
  expect(plan("getmetatable(p).__gc(p)"), "attempt to");
  expect(plan("setmetatable(p, {})"), "table expected");
  expect(plan("run.solve(3, 3, 3)"), "expected a problem, got number");
  expect(plan("run:certify(v)"), "expected a plan, got userdata");
  expect(plan("p:guess_path { times = {0, 1}, positions = {{0, 0, 0}} }"), "as many positions");
  expect(plan("lapwing.local_from_geodetic({lat=95, lon=0, alt=0}, {lat=0, lon=0, alt=0})"),
         "origin.lat: expected between -90 and 90");
  expect(plan("lapwing.read_json('../../etc/passwd')"), "'..' is not allowed");
  expect(plan("run:fail('nothing.here', 'is wrong')"), "nothing.here: is wrong");
}

TEST_F(MissionTest, DesignersShotsAreRead) {
  write_file_atomically(folder_ / "shot.json", R"({"keyframeTimes": [0, 10],
    "refLLH": {"lat": 47.0, "lng": 8.0, "altitude": 400},
    "keyFrameList": [
      {"lookFromNED": {"n": 0, "e": 0, "d": -5}, "lookAtNED": {"n": 10, "e": 0, "d": 0}},
      {"lookFromNED": {"n": 0, "e": 12, "d": -8}, "lookAtNED": {"n": 0, "e": 0, "d": 0}}]})");
  const std::string script = "return require('mission.film').from_file { file = 'shot.json' }";
  auto mission = load(script);
  mission->configure({}, {});
  const Plan plan = mission->plan().plan;
  ASSERT_EQ(plan.task.keyframes.size(), 2u);
  EXPECT_TRUE(plan.task.keyframes[1].position.isApprox(Eigen::Vector3d(12, 0, 8)));
  ASSERT_EQ(plan.environment.subjects.size(), 1u);
  EXPECT_TRUE(plan.environment.subjects[0].position(0).isApprox(Eigen::Vector3d(0, 10, 0)));
  EXPECT_LT(plan.environment.subjects[0].position(10).norm(), 1e-12);
  ASSERT_TRUE(plan.geodetic_origin);
  EXPECT_EQ(plan.geodetic_origin->altitude(), 400);
  EXPECT_TRUE(verify(plan).feasible());

  mission = load(script);  // without a gimbal the vehicle's yaw turns the camera
  mission->configure({}, std::vector<std::string>{"vehicle=vehicles/racer"});
  const Plan turned = mission->plan().plan;
  EXPECT_TRUE(turned.environment.subjects.empty());
  ASSERT_TRUE(turned.task.keyframes[0].yaw && turned.task.keyframes[1].yaw);
  EXPECT_NEAR(*turned.task.keyframes[0].yaw, M_PI / 2, 1e-12);
  EXPECT_NEAR(*turned.task.keyframes[1].yaw, M_PI, 1e-12);

  write_file_atomically(folder_ / "geodetic.json", R"({"keyframeTimes": [0, 10],
    "keyFrameList": [
      {"cameraPose": {"lat": 47.0, "lng": 8.0, "altitude": 400},
       "lookAt": {"lat": 47.0, "lng": 8.001, "altitude": 400}},
      {"cameraPose": {"lat": 47.0001, "lng": 8.0, "altitude": 405},
       "lookAt": {"lat": 47.0001, "lng": 8.0, "altitude": 300}}]})");
  mission = load("return require('mission.film').from_file { file = 'geodetic.json' }");
  mission->configure({}, std::vector<std::string>{"vehicle=vehicles/racer"});
  const Plan geodetic = mission->plan().plan;
  const Eigen::Vector3d second = geodetic.task.keyframes[1].position;
  EXPECT_NEAR(second.x(), 0, 1e-3);
  EXPECT_NEAR(second.y(), 11.118, 0.01);  // a ten-thousandth of a degree north at 47 degrees
  EXPECT_NEAR(second.z(), 5, 1e-3);
  ASSERT_TRUE(geodetic.task.keyframes[0].yaw);
  EXPECT_NEAR(*geodetic.task.keyframes[0].yaw, 0, 1e-3);
  EXPECT_FALSE(geodetic.task.keyframes[1].yaw);  // straight down has no heading

  for (const auto& [text, fragment] : std::vector<std::pair<std::string, std::string>>{
           {"{}", "keyFrameList is missing"},
           {"{\"keyFrameList\": [], \"keyframeTimes\": []}", "0 keyframes, but 0 times"},
           {"{\"keyFrameList\": [{}], \"keyframeTimes\": [0, 1]}", "1 keyframes, but 2 times"},
           {"{\"keyFrameList\": [{}], \"keyframeTimes\": [0]}",
            "keyframe 1: cameraPose is missing"},
           {"{\"keyFrameList\": [3], \"keyframeTimes\": [0]}", "keyframe 1 is missing"},
           {"[1, 2", "shot.json:1"},
           {"", "shot.json"}}) {
    write_file_atomically(folder_ / "shot.json", text);
    expect(script, fragment);
  }
}

TEST_F(MissionTest, SandboxLimitsAreSettings) {
  EXPECT_EQ(sandbox_limits({}, std::vector<std::string>{"sandbox.memory=64", "duration=3"}).memory,
            64);
  EXPECT_THROW(sandbox_limits({}, std::vector<std::string>{"sandbox.memroy=64"}), InputError);
  EXPECT_THROW(sandbox_limits({}, std::vector<std::string>{"sandbox.seconds=-1"}), InputError);
  Value layer = Value::map();
  layer.set("sandbox", Value::map()).set("seconds", Value(3.0));
  EXPECT_EQ(sandbox_limits(std::vector<Value>{layer}, {}).seconds, 3);
}

}  // namespace
}  // namespace lapwing
