// SPDX-License-Identifier: Apache-2.0
// What a scan says of its coverage, held against the true surface and against what was not seen.
#include "tests/missions/scan_house.h"

namespace lapwing {
namespace {

class SlowCovering : public Covering {};

TEST_F(SlowCovering, DefaultsSeeTheOutermostWallsOfAMesh) {
  const Value answer = of_house("");
  const Value& surface = answer.at("tour").at("surface");
  const Value& truth = surface.at("true");
  EXPECT_GT(number(truth, "first_flight_share"), 0.95) << to_json(surface);
  EXPECT_GT(number(truth, "tour_share"), 0.75) << to_json(surface);
  // The region is wider than the bounds: walls, roof and 7 m of ground on every side.
  EXPECT_GT(number(truth, "open"), 12 * 10 + 2 * 7 * (12 + 10) + 5 * (2 * (12 + 10) + 20));
  // No more is claimed than is true.
  EXPECT_LT(number(surface, "seen_share"), number(truth, "tour_share") + 0.03);
  EXPECT_LT(number(surface, "unknown"), 0.05 * number(surface, "known"));
  EXPECT_LE(number(surface, "seen"), number(surface, "visible"));
  EXPECT_LE(number(surface, "visible"), number(surface, "known"));
}

// A hall that is open to the east, seen from straight above: what lies in it is no known surface,
// but unknown.
TEST_F(Covering, WhatTheFirstFlightNeverSawIsUnknownAndSaidInWords) {
  std::string hall = kHouseMesh;
  hall.erase(hall.find("f 2 3 7 6\n"), 10);
  write_file_atomically(folder_ / "house.obj", hall);
  const Value answer = of_house(
      "--set 'flights=[{pattern: meander, views: 16, reach: 0, height: 20, pitch_deg: -85}]' "
      "--set region.lower=[-7,-6,-0.4] --set region.upper=[8,6,7.4]");
  const Value& surface = answer.at("tour").at("surface");
  EXPECT_LT(number(surface.at("true"), "first_flight_share"), 0.8) << to_json(surface);
  EXPECT_GT(number(surface, "unknown"), 25) << to_json(surface);
  const Value& largest = surface.at("largest_opening");
  EXPECT_GT(number(largest, "area"), 20) << to_json(surface);
  EXPECT_TRUE(largest.at("passable").as_boolean());
  // The open side is joined to what was not seen of the walls beside it.
  for (const auto& [axis, most] : {std::pair{0, 8.0}, {1, 6.0}})
    EXPECT_LE(std::abs(largest.at("position").as_list().at(axis).as_number()), most);
  std::string notes;
  for (const Value& note : answer.at("notes").as_list()) notes += note.as_text() + "\n";
  EXPECT_THAT(notes, HasSubstr("unknown and not counted: at least "));
  EXPECT_THAT(notes, HasSubstr("(2 m wide) would pass through the largest opening"));
  EXPECT_THAT(read_file(folder_ / "out/report.html"), HasSubstr("unknown, not counted"));
}

TEST_F(SlowCovering, TheTerminalThePlanAndTheReportSayTheSame) {
  const Value answer = of_house("");
  std::string sentence;
  for (const Value& note : answer.at("notes").as_list())
    if (note.as_text().starts_with("surface: the tour sees")) sentence = note.as_text();
  ASSERT_FALSE(sentence.empty());
  // Only candidates were asked, not every free place.
  const std::string considered =
      std::to_string(answer.at("tour").at("candidates").as_integer()) + " candidate views";
  for (const std::string& said :
       {"visible from any of the " + considered, std::string("unknown and not counted: ")})
    EXPECT_THAT(sentence, HasSubstr(said));
  EXPECT_THAT(plan(), HasSubstr(sentence));
  EXPECT_THAT(read_file(folder_ / "out/report.html"), HasSubstr(sentence));
  // What only a simulator knows stands beside it in the answer and in the report, and is no part of
  // the plan.
  std::string truth;
  for (const Value& note : answer.at("notes").as_list())
    if (note.as_text().starts_with("true surface (simulation)")) truth = note.as_text();
  ASSERT_FALSE(truth.empty());
  EXPECT_THAT(read_file(folder_ / "out/report.html"), HasSubstr(truth));
  EXPECT_EQ(plan().find("true surface"), std::string::npos);
  // 80 x 60 pixels are for planning.
  EXPECT_THAT(plan(), HasSubstr("camera.focal"));
}

// Quick looks change effort, never the task.
TEST_F(Covering, ASmallScanKeepsBudgetRegionCameraAndRange) {
  const auto options = [&](const std::string& more) {
    const std::string line = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing config '" +
                             (folder_ / "house.lua").string() + "' --json --data '" +
                             folder_.string() + "' --set input=house.obj " + more + " > '" +
                             (folder_ / "options.json").string() + "'";
    EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 0);
    return from_json(read_file(folder_ / "options.json"), "options");
  };
  const auto shown = [](const Value& given, const char* key) {
    const Value* found = given.find(key);
    return found ? to_json(*found) : std::string("absent");
  };
  const Value stated = options(""), small = options("--config scan/small");
  for (const char* task : {"tour", "camera", "range", "region", "flights", "vehicle", "reach"})
    EXPECT_EQ(shown(small, task), shown(stated, task)) << task;
  EXPECT_NE(to_json(small.at("effort")), to_json(stated.at("effort")));
}

}  // namespace
}  // namespace lapwing
