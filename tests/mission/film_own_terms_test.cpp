// SPDX-License-Identifier: Apache-2.0
// What a film's own terms, speeds and bystanders come to: options, plan, certificate and notes.
#include <numbers>

#include "framework/mission/script_interface.h"
#include "framework/verify/verify.h"
#include "tests/mission/mission_fixture.h"

namespace lapwing {
namespace {

class FilmOwnTerms : public MissionTest {
 protected:
  static std::string shot(const std::string& more, const std::string& last = "time = 10") {
    return "return require('mission.film').shot {\n keyframes = { { time = 0, position = {0, 0, 2} "
           "},\n { " +
           last + ", position = {8, 0, 5} } },\n" + more + " }";
  }
  static std::string west(const std::string& more) {
    return shot("constraints = { { name = 'west of the road', " + more +
                ", value = function(s) return s.position.x end } }");
  }
  MissionResult flown(const std::string& text, std::vector<std::string> overrides = {}) {
    const auto mission = load(text);
    mission->configure({}, overrides);
    return mission->plan();
  }
  static const Check* find(const Certificate& certificate, const std::string& name) {
    const Check* check = certificate.find(name);
    EXPECT_NE(check, nullptr) << name;
    return check;
  }
};

constexpr const char* kWest = "constraint \"west of the road\"";

TEST_F(FilmOwnTerms, AConstraintThatHoldsIsInTheCertificate) {
  const MissionResult result = flown(west("upper = 9"));
  ASSERT_EQ(result.plan.constraints.size(), 1u);
  const Certificate certificate = verify(result.plan);
  EXPECT_TRUE(certificate.feasible());
  const Check* check = find(certificate, kWest);
  EXPECT_TRUE(check->pass && check->required);
  EXPECT_NEAR(*check->worst, 8, 0.1);
}

// At its bound for half of the film, also between the stages.
TEST_F(FilmOwnTerms, AnActiveConstraintIsCertifiedByEverySolver) {
  for (const char* solver : {"iqp", "ipopt", "nlopt"}) {
    const MissionResult result = flown(
        "return require('mission.film').shot { keyframes = { { time = 0, position = {0, 0, 2} }, "
        "{ time = 5, position = {5, 4, 2} }, { time = 10, position = {10, 0, 2} } }, "
        "constraints = { { name = 'north', upper = 3.7, value = function(s) return s.position.y "
        "end } } }",
        {std::string("solver=") + solver});
    const Certificate certificate = verify(result.plan);
    for (const Check& check : certificate.failures()) ADD_FAILURE() << solver << to_line(check);
    EXPECT_NEAR(*find(certificate, "constraint \"north\"")->worst, 3.7, 0.02) << solver;
  }
}

TEST_F(FilmOwnTerms, AnImpossibleConstraintIsNamed) {
  const MissionResult soft = flown(west("upper = 4"));
  EXPECT_FALSE(verify(soft.plan).feasible());
  ASSERT_FALSE(soft.notes.empty());
  EXPECT_NE(soft.notes[0].find(std::string(kWest) + " 8 exceeds 4 at"), std::string::npos)
      << soft.notes[0];
  const MissionResult hard = flown(west("upper = 4"), {"hard=0.3"});
  EXPECT_FALSE(find(verify(hard.plan), kWest)->pass);
  ASSERT_FALSE(hard.notes.empty());
  EXPECT_NE(hard.notes[0].find("west of the road"), std::string::npos) << hard.notes[0];
}

TEST_F(FilmOwnTerms, AnImpossibleConstraintIsNamedForEveryWayOfTiming) {
  for (const std::string timing : {"given", "time_first", "path_first", "free"})
    for (const char* last : {"time = 10", "yaw_deg = 0"}) {
      const std::string text =
          shot("timing = '" + timing +
                   "', constraints = { { name = 'west of the road', upper = 4, value = function(s) "
                   "return s.position.x end } }",
               last);
      const MissionResult result = flown(text);
      EXPECT_FALSE(verify(result.plan).feasible()) << timing;
      ASSERT_FALSE(result.notes.empty()) << timing;
      EXPECT_NE(result.notes[0].find(std::string(kWest) + " 8 exceeds 4 at"), std::string::npos)
          << timing << ": " << result.notes[0];
      // A constraint that a wider bound satisfies is no reason for anything.
      const MissionResult held = flown(
          shot("timing = '" + timing +
                   "', constraints = { { name = 'west of the road', upper = 9, value = function(s) "
                   "return s.position.x end } }",
               last));
      EXPECT_TRUE(verify(held.plan).feasible()) << timing;
      for (const std::string& note : held.notes)
        EXPECT_EQ(note.find("west of the road"), std::string::npos) << timing << ": " << note;
    }
}

// What shuts the flight in between the constraint and an obstacle is the constraint.
TEST_F(FilmOwnTerms, AConstraintThatPushesIntoAnObstacleIsNamed) {
  const MissionResult result = flown(
      "return require('mission.film').shot { keyframes = { { time = 0, position = {0, 0, 2} }, "
      "{ time = 10, position = {8, 0, 2} } }, margin = 0.3, obstacles = { { type = 'box', lower = "
      "{3, -1, 0}, upper = {5, 30, 30} } }, constraints = { { name = 'north', lower = -1.1, value "
      "= function(s) return s.position.y end } } }");
  EXPECT_FALSE(verify(result.plan).feasible());
  ASSERT_FALSE(result.notes.empty());
  EXPECT_NE(result.notes[0].find("constraint \"north\""), std::string::npos) << result.notes[0];
}

TEST_F(FilmOwnTerms, OneThatIsReportedOrNotHeldIsJudged) {
  const MissionResult reported = flown(west("upper = 4, held = false, certificate = 'reported'"));
  const Certificate certificate = verify(reported.plan);
  EXPECT_TRUE(certificate.feasible());
  EXPECT_FALSE(find(certificate, kWest)->pass);
  EXPECT_FALSE(verify(flown(west("upper = 4, held = false")).plan).feasible());
  expect(west("upper = 4, certificate = 'never'"), "certificate");
}

TEST_F(FilmOwnTerms, OneOfAPluginIsListed) {
  const MissionResult result = flown(shot(
      "subject = { position = {4, 9, 1} }, constraints = { { type = 'subject_distance', name = "
      "'far', distance = 3 }, { type = 'subject_distance', distance = 2 }, { type = "
      "'subject_distance', distance = 1 } }"));
  const Certificate certificate = verify(result.plan);
  EXPECT_EQ(find(certificate, "constraint \"far\"")->skipped,
            "of the plugin 'subject_distance', not judged independently");
  find(certificate, "constraint \"subject_distance\"");
  find(certificate, "constraint \"subject_distance 2\"");
}

TEST_F(FilmOwnTerms, ParametersOfPluginsAreOptions) {
  const std::string text = shot(
      "subject = { position = {4, 9, 1} }, costs = { { type = 'skewness', height = 6 }, { name = "
      "'low', residual = function(s) return s.position.z end } },\nconstraints = { { type = "
      "'subject_distance', distance = 3 } }");
  const auto mission = load(text);
  mission->configure({}, std::vector<std::string>{"costs[1].height=4 m", "costs[2].weight=3",
                                                  "constraints[1].distance=2"});
  const Value& options = mission->configuration();
  const Value& cost = options.at("costs").as_list()[0];
  EXPECT_EQ(cost.at("height").as_number(), 4);
  EXPECT_EQ(cost.at("height").origin().source, "--set costs[1].height=4 m");
  EXPECT_EQ(cost.at("weight").as_number(), 1);
  EXPECT_EQ(cost.at("weight").origin().source, "default");
  EXPECT_TRUE(cost.find("spans")) << "a default of the plugin's own";
  EXPECT_EQ(options.at("costs").as_list()[1].at("weight").as_number(), 3);
  EXPECT_EQ(options.at("constraints").as_list()[0].at("distance").as_number(), 2);
  mission->plan();
  expect(text, "costs[1].hieght: unknown key; did you mean 'height'?", {"costs[1].hieght=4"});
  expect(text, "costs[1].height", {"costs[1].height=-1"});
  expect(shot("costs = { { type = 'skewnes', height = 6 } }"), "did you mean 'skewness'?");
  expect(shot("costs = { { type = 'skewness', hight = 6 } }"),
         "shot.lua:4: costs[1].hight: unknown key; did you mean 'height'?");
}

TEST_F(FilmOwnTerms, BoundsAndCertificateOfAFunctionAreOptions) {
  const std::string text = west("upper = 4");
  const auto mission = load(text);
  mission->configure({},
                     std::vector<std::string>{"constraints[1].upper=9", "constraints[1].lower=-0.5",
                                              "constraints[1].certificate=reported"});
  const Value& set = mission->configuration().at("constraints").as_list()[0];
  EXPECT_EQ(set.at("upper").as_number(), 9);
  EXPECT_EQ(set.at("upper").origin().source, "--set constraints[1].upper=9");
  const MissionResult result = mission->plan();
  ASSERT_EQ(result.plan.constraints.size(), 1u);
  EXPECT_EQ(result.plan.constraints[0].results[0].upper, 9);
  EXPECT_EQ(result.plan.constraints[0].results[0].lower, -0.5);
  EXPECT_FALSE(result.plan.constraints[0].required);
  const auto plain = load(text);
  plain->configure({}, {});
  const Value& own = plain->configuration().at("constraints").as_list()[0];
  EXPECT_EQ(own.at("upper").as_number(), 4);
  EXPECT_EQ(own.at("certificate").as_text(), "required");
  EXPECT_EQ(own.find("lower"), nullptr);
  // A bound for every result takes the place of a list.
  const std::string list = shot(
      "constraints = { { name = 'place', upper = {9, 9}, value = function(s) return s.position.x, "
      "s.position.z end } }");
  EXPECT_EQ(flown(list).plan.constraints[0].results[1].upper, 9);
  EXPECT_EQ(flown(list, {"constraints[1].upper=20"}).plan.constraints[0].results[1].upper, 20);
  // A bound that the script leaves open can be given.
  EXPECT_EQ(flown(west("parameters = {}"), {"constraints[1].upper=9"})
                .plan.constraints[0]
                .results[0]
                .upper,
            9);
  expect(text, "constraints[1].uper: unknown key; did you mean 'upper'?",
         {"constraints[1].uper=5"});
  expect(text, "constraints[1].upper: expected", {"constraints[1].upper=high"});
  expect(text, "constraints[1].certificate", {"constraints[1].certificate=never"});
  // Those of a plugin are the plugin's own.
  expect(shot("constraints = { { type = 'input_limits', upper = 4 } }"),
         "constraints[1].upper: unknown key");
  expect(shot("constraints = { { type = 'input_limits' } }"), "constraints[1].certificate",
         {"constraints[1].certificate=reported"});
}

TEST_F(FilmOwnTerms, ASpeedTimesTheKeyframes) {
  const MissionResult result = flown(
      "return require('mission.film').shot { speed = 4, speed_limit = 4.5, keyframes = { "
      "{ position = {0, 0, 3} }, { position = {40, 0, 3} }, "
      "{ position = {60, 0, 3}, speed = 2 } } }");
  const auto& samples = result.plan.trajectory.samples;
  int cruising = 0;
  for (const Sample& s : samples)
    if (s.position.x() > 15 && s.position.x() < 25) {
      EXPECT_NEAR(s.velocity.norm(), 4, 0.1) << s.time;
      ++cruising;
    }
  EXPECT_GT(cruising, 10);
  const Certificate certificate = verify(result.plan);
  EXPECT_TRUE(certificate.feasible());
  EXPECT_LE(*find(certificate, "constraint \"speed_limit\"")->worst, 4.501);
  const double to_middle = result.plan.task.keyframes[1].time;
  EXPECT_GT(result.plan.task.keyframes[2].time - to_middle, 10);
  expect(shot("speed = 3"), "speed: every keyframe has a time; give times or a speed");
  expect(shot("speed = 3, duration = 8", "yaw_deg = 0"), "speed: the duration determines");
  expect(shot("speed = 3, speed_limit = 2", "yaw_deg = 0"), "speed: above the speed_limit");
  expect(shot("", "time = 4, speed = 3"), "keyframes[2].speed: give a time or a speed");
  expect(shot("speed = 3, timing = 'free'", "yaw_deg = 0"), "there is speed_limit");
}

TEST_F(FilmOwnTerms, ASpeedLimitThatTheTimesBreakIsNamed) {
  const MissionResult result = flown(shot("speed_limit = 0.5, hard = 0.3"));
  EXPECT_FALSE(verify(result.plan).feasible());
  ASSERT_FALSE(result.notes.empty());
  EXPECT_NE(result.notes[0].find("speed_limit of"), std::string::npos) << result.notes[0];
  EXPECT_NE(result.notes[0].find("certified from a stretch of"), std::string::npos)
      << result.notes[0];
}

TEST_F(FilmOwnTerms, BystandersAreKeptAwayFrom) {
  const MissionResult result = flown(
      shot("keep_away = { { name = 'couple', position = {4, 0.5, 3}, distance = 3 }, { track = "
           "function(t) return {8 - t / 2, 8, 3} end, distance = 2 } }"));
  const Certificate certificate = verify(result.plan);
  EXPECT_TRUE(certificate.feasible());
  const Check* check = find(certificate, "subject_distance");
  EXPECT_GE(*check->worst, 2.999);
  EXPECT_TRUE(check->detail.starts_with("bystander 'couple'; bystander 'bystander"))
      << check->detail;
  EXPECT_TRUE(check->detail.ends_with(" s, requires 2 m")) << check->detail;
  ASSERT_EQ(result.plan.environment.subjects.size(), 2u);
  EXPECT_FALSE(result.plan.environment.subjects[0].filmed);
  EXPECT_TRUE(result.plan.task.framing.empty());
  expect(shot("keep_away = { { position = {8, 0, 4}, distance = 3 } }"),
         "keyframes[2].position: 1 m from bystander 'bystander', and 3 m are required");
  expect(shot("keep_away = { { position = {8, 0, 4} } }"), "keep_away[1].distance: missing");
  expect(shot("keep_away = { { distance = 4 } }"), "keep_away[1]: expected a position");
}

// On the straight way, under a ceiling: no direction is better than the other there, so that the
// solver alone finds none.
TEST_F(FilmOwnTerms, OneWhoStandsInTheWayIsFlownRound) {
  const MissionResult result = flown(
      "return require('mission.film').shot { hard = 0.3, volume = { lower = {-40, -40, 0.5}, upper "
      "= {60, 40, 7} }, keyframes = { { time = 0, position = {-12, 0, 2} }, { time = 40, position "
      "= {12, 0, 2} } }, keep_away = { { position = {0, 0, 1.7}, distance = 10 } } }");
  const Certificate certificate = verify(result.plan);
  for (const Check& check : certificate.failures()) ADD_FAILURE() << to_line(check);
  EXPECT_GE(*find(certificate, "subject_distance")->worst, 9.999);
  EXPECT_TRUE(result.notes.empty()) << result.notes[0];
  EXPECT_EQ(result.plan.task.keyframes.back().time, 40);
}

// A keyframe may lie a little within the distance: the flight misses it by as much.
TEST_F(FilmOwnTerms, OneWhoStandsAtAnEndIsLeftToTheSolver) {
  const MissionResult result =
      flown(shot("keep_away = { { position = {8, 0, 3}, distance = 2.2 } }"));
  const Certificate certificate = verify(result.plan);
  for (const Check& check : certificate.failures()) ADD_FAILURE() << to_line(check);
  EXPECT_EQ(result.plan.task.keyframes.back().time, 10);
}

TEST_F(FilmOwnTerms, AnOrbitIsEven) {
  for (const double ramp : {2.0, 0.0}) {
    const MissionResult result = flown(
        "local film = require('mission.film') return film.shot { start = '" +
        std::string(ramp > 0 ? "rest" : "free") + "', finish = '" + (ramp > 0 ? "rest" : "free") +
        "', subject = { position = {0, 0, 4} }, keyframes = film.shots.orbit { center = {0, 0, 0}, "
        "radius = 14, height = 8, duration = 40, ramp = " +
        std::to_string(ramp) + " } }");
    EXPECT_TRUE(verify(result.plan).feasible());
    const double rate = 2 * std::numbers::pi / (40 - ramp);
    for (const Sample& s : result.plan.trajectory.samples) {
      const Eigen::Vector3d &p = s.position, &v = s.velocity;
      EXPECT_NEAR(p.head<2>().norm(), 14, 0.05) << s.time;
      if (s.time < ramp || s.time > 40 - ramp) continue;
      const double turned = (p.x() * v.y() - p.y() * v.x()) / p.head<2>().squaredNorm();
      EXPECT_NEAR(turned, rate, 0.02 * rate) << s.time;
      if (s.time > 2 * ramp && s.time < 40 - 2 * ramp) {
        EXPECT_NEAR(turned, rate, 0.005 * rate) << s.time;
      }
    }
  }
}

TEST_F(FilmOwnTerms, NamedShotsDescribeTheirArguments) {
  const auto shots = [](const std::string& call) {
    return "return require('mission.film').shots." + call;
  };
  expect(shots("orbit { center = {0, 0, 2}, raduis = 4, height = 3, duration = 9 }"),
         "shots.orbit.raduis: unknown key; did you mean 'radius'?");
  expect(shots("orbit { center = {0, 0}, radius = 4, height = 3, duration = 9 }"),
         "shots.orbit.center");
  expect(shots("orbit { center = {0, 0, 2}, radius = 4, height = 3, duration = 9, ramp = 5 }"),
         "shots.orbit.ramp: two of 5 s are more than the 9 s");
  expect(shots("pan { position = {0, 0, 2}, look_from = 3, look_to = 'anna', duration = 9 }"),
         "shots.pan.look_from");
  MissionSettings settings;
  settings.scripts = fs::path(LAPWING_SOURCE_DIR) / "scripts";
  settings.configs = fs::path(LAPWING_SOURCE_DIR) / "configs";
  const ScriptInterface interface = read_script_interface(settings);
  const std::string text = annotations_of(interface, registry_);
  for (const char* line :
       {"---@field orbit fun(given: lapwing.film.shots.orbit): lapwing.film.shot.keyframes[]",
        "---@class lapwing.film.shots.orbit", "---@field radius number|string radius of the circle",
        "---@field costs? lapwing.cost_term[]|lapwing.own_cost[]"})
    EXPECT_NE(text.find(line), std::string::npos) << line;
  EXPECT_NE(argument_table_of(interface, "film.shots").find("| | `ramp` | 2 s |"),
            std::string::npos)
      << argument_table_of(interface, "film.shots");
}

}  // namespace
}  // namespace lapwing
