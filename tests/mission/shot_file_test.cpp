// SPDX-License-Identifier: Apache-2.0
// Shots of designers: where their keyframes are in the world, and what is said of broken files.
#include "tests/mission/mission_fixture.h"

namespace lapwing {
namespace {

class ShotFiles : public MissionTest {
 protected:
  static std::string script(const std::string& more = "") {
    return "return require('mission.film').from_file { name = 'shot', file = 'shot.json', "
           "vehicle = 'vehicles/solo'" +
           more + " }";
  }
  void shot(const std::string& json) { write_file_atomically(folder_ / "shot.json", json); }

  // What is said of a file.
  std::string said_of(const std::string& json) {
    shot(json);
    return error(script());
  }
};

constexpr const char* kReference = R"("refLLH": {"lat": 47, "lng": 8, "altitude": 400})";

std::string keyframe(const char* from, const char* at) {
  return std::string("{\"lookFromNED\": ") + from + ", \"lookAtNED\": " + at + "}";
}

// North, east, down become east, north, up.
TEST_F(ShotFiles, NorthEastDownBecomesEastNorthUp) {
  shot(std::string("{\n") + kReference + ",\n\"keyframeTimes\": [0, 6],\n\"keyFrameList\": [\n" +
       keyframe(R"({"n": 1, "e": 2, "d": -10})", R"({"n": 30, "e": 2, "d": 0})") + ",\n" +
       keyframe(R"({"n": 4, "e": 7, "d": -12})", R"({"n": 30, "e": 2, "d": 0})") + "]}");
  const auto mission = load(script());
  mission->configure({}, {});
  const Plan plan = mission->plan().plan;
  ASSERT_EQ(plan.task.keyframes.size(), 2u);
  EXPECT_LT((plan.task.keyframes[0].position - Eigen::Vector3d(2, 1, 10)).norm(), 1e-9);
  EXPECT_LT((plan.task.keyframes[1].position - Eigen::Vector3d(7, 4, 12)).norm(), 1e-9);
  EXPECT_EQ(plan.task.keyframes[1].time, 6);
  ASSERT_EQ(plan.environment.subjects.size(), 1u);
  EXPECT_EQ(plan.environment.subjects[0].name, "look-at");
  EXPECT_LT((plan.environment.subjects[0].position(3) - Eigen::Vector3d(2, 30, 0)).norm(), 1e-9);
}

TEST_F(ShotFiles, OptionsStandInPlaceOfTheFile) {
  shot(std::string("{\n") + kReference + ",\n\"keyframeTimes\": [0, 6],\n\"keyFrameList\": [\n" +
       keyframe(R"({"n": 1, "e": 2, "d": -10})", R"({"n": 30, "e": 2, "d": 0})") + ",\n" +
       keyframe(R"({"n": 4, "e": 7, "d": -12})", R"({"n": 30, "e": 2, "d": 0})") + "]}");
  const auto mission = load(script());
  mission->configure(
      {}, std::vector<std::string>{"keyframes=[{time: 0, position: [1, 2, 9]}, {time: 4, position: "
                                   "[3, 2, 9]}, {time: 6, position: [5, 2, 9]}]"});
  Plan plan = mission->plan().plan;
  ASSERT_EQ(plan.task.keyframes.size(), 3u);
  EXPECT_EQ(plan.task.keyframes[2].position, Eigen::Vector3d(5, 2, 9));
  EXPECT_EQ(plan.environment.subjects[0].name, "look-at");  // the file's, where none is given
  EXPECT_TRUE(plan.geodetic_origin);
  mission->configure({}, std::vector<std::string>{"subjects=[{name: tree, position: [0, 9, 1]}]"});
  plan = mission->plan().plan;
  ASSERT_EQ(plan.environment.subjects.size(), 1u);
  EXPECT_EQ(plan.environment.subjects[0].name, "tree");
  EXPECT_EQ(plan.task.keyframes.size(), 2u);
}

TEST_F(ShotFiles, BrokenFilesAreRefusedWithLineAndKey) {
  const std::string good = keyframe(R"({"n": 1, "e": 2, "d": -10})", R"({"n": 9, "e": 2, "d": 0})");
  const auto with = [&](const std::string& frames, const std::string& times) {
    return std::string("{\n") + kReference + ",\n\"keyframeTimes\": " + times +
           ",\n\"keyFrameList\": [\n" + frames + "]}";
  };
  for (const auto& [json, said] : std::initializer_list<std::pair<std::string, const char*>>{
           {"", "shot.json"},
           {"[]", "shot.json"},
           {"{\n\"keyFrameList\": ", "shot.json:2"},
           {with(good, "[0, 1]"), "1 keyframes, but 2 times"},
           {with("", "[]"), "0 keyframes, but 0 times"},
           {with(good, "[\"now\"]"), "keyframeTimes[1]: expected a number"},
           {with("5", "[0]"), "keyframe 1 is missing, or not a table"},
           {with(R"({"lookAtNED": {"n": 1, "e": 2, "d": 3}})", "[0]"),
            "keyFrameList[1].lookFromNED: missing; expected {n, e, d}, or cameraPose"},
           {with(keyframe(R"({"n": 1, "e": 2})", R"({"n": 9, "e": 2, "d": 0})"), "[0]"),
            "keyFrameList[1].lookFromNED.d: expected a number"},
           {with(keyframe(R"({"n": "1", "e": 2, "d": 3})", R"({"n": 9, "e": 2, "d": 0})"), "[0]"),
            "keyFrameList[1].lookFromNED.n: expected a number"},
           {with(keyframe("[1, 2, 3]", R"({"n": 9, "e": 2, "d": 0})"), "[0]"),
            "keyFrameList[1].lookFromNED.e: expected a number"},
           {with(keyframe(R"({"n": 1, "e": 2, "d": 3})", R"({"n": 9, "e": 2, "d": true})"), "[0]"),
            "keyFrameList[1].lookAtNED.d: expected a number"},
           {"{\"keyframeTimes\": [0], \"keyFrameList\": [" + good + "]}", "cameraPose"},
           {"{\"refLLH\": {\"lat\": 47}, \"keyframeTimes\": [0], \"keyFrameList\": [" + good + "]}",
            "refLLH.lng: expected a number"}}) {
    const std::string message = said_of(json);
    EXPECT_NE(message.find(said), std::string::npos) << json << "\ngave: " << message;
    EXPECT_NE(message.find("shot.json"), std::string::npos) << message;
  }
}

TEST_F(ShotFiles, AMissingFileIsNamed) {
  const std::string message = error(script());
  EXPECT_NE(message.find("'shot.json' not found in"), std::string::npos) << message;
}

}  // namespace
}  // namespace lapwing
