// SPDX-License-Identifier: Apache-2.0
// Races flown by hand: the logs that are shipped, flown round the course that they were made for.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "framework/core/files.h"
#include "framework/trajectory/plan.h"
#include "framework/vehicle/race_score.h"
#include "tests/missions/flown_film.h"
#include "tests/vehicle/scripted_pilots.h"

namespace lapwing {
namespace {

class RaceGame : public Filming {
 protected:
  int command(const std::string& arguments) {
    const std::string line = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing " + arguments +
                             " > /dev/null 2> '" + (folder_ / "stderr.txt").string() + "'";
    return WEXITSTATUS(std::system(line.c_str()));
  }
  std::string error() { return read_file(folder_ / "stderr.txt"); }
};
using testing::HasSubstr;
constexpr double kStrength = 30;  // m/s^2, of a full stick: the bends ask for 20

const std::string kRacing = (kExamples / "../racing").string();

std::string log_of(const RaceFlight& flight) {
  std::string text = "time,forward,left\n";
  char line[80];
  double next = 0;
  for (const RaceSample& sample : flight.samples) {
    if (sample.time < next - 1e-9) continue;
    next = sample.time + 0.1;
    std::snprintf(line, sizeof line, "%.3f,%.3f,%.3f\n", sample.time, sample.stick.x(),
                  sample.stick.y());
    text += line;
  }
  return text;
}

TEST_F(RaceGame, TimidCutterAndLeaverEndAsTheyShould) {
  const Flown flown = fly("../racing/two_players.lua");
  ASSERT_EQ(flown.status, 0);
  const Plan plan = read_plan(flown.folder / "plan.json");
  // LAPWING_WRITE_PILOTS=FOLDER makes the logs anew, for a course that has changed.
  if (const char* folder = std::getenv("LAPWING_WRITE_PILOTS")) {
    const Vehicle vehicle = vehicle_from_value(plan.vehicle);
    const ReferenceMotion course(plan.trajectory, vehicle);
    const StickLog centred({{0, {0, 0}}}, "none");
    const Pilot pilot{.name = "", .log = centred, .strength = kStrength, .reach = 12};
    Pilot wild = pilot, slow = pilot;
    wild.weight = 1;
    slow.speed = 0.9;
    const std::filesystem::path to = folder;
    const auto write = [&](const char* name, const Pilot& who, const StickSource& stick) {
      write_file_atomically(to / name, log_of(fly_race(plan.trajectory, vehicle, who, stick)));
    };
    write("timid.csv", slow, timid_pilot(course, kStrength, slow.speed));
    write("cutter.csv", pilot, corner_cutter(course, kStrength));
    write("leaver.csv", wild, leaver(course, kStrength));
  }
  const Value& pilots = flown.result.at("game").at("pilots");
  ASSERT_EQ(pilots.as_list().size(), 2u);
  const Value &timid = pilots.as_list()[0], &cutter = pilots.as_list()[1];
  EXPECT_EQ(timid.at("end").as_text(), "finished");
  EXPECT_EQ(cutter.at("end").as_text(), "finished");
  EXPECT_GT(timid.at("time").as_number(), 1.05 * plan.trajectory.duration());
  EXPECT_LT(cutter.at("time").as_number(), timid.at("time").as_number());
  EXPECT_GT(cutter.at("deviation_worst").as_number(), timid.at("deviation_worst").as_number());
  for (const Value* pilot : {&timid, &cutter})
    EXPECT_TRUE(pilot->at("missed_gates").as_list().empty()) << to_json(*pilot);
  // The course turns left: who cuts its corners is left of it.
  const Vehicle vehicle = vehicle_from_value(plan.vehicle);
  const ReferenceMotion course(plan.trajectory, vehicle);
  const Pilot cutting{.name = "",
                      .log = read_stick_log(kRacing + "/pilots/cutter.csv"),
                      .strength = kStrength,
                      .reach = 12};
  double left = 0;
  for (const RaceSample& sample : fly_race(plan.trajectory, vehicle, cutting).samples) {
    const Eigen::Vector3d along = course.at(sample.progress).velocity;
    const Eigen::Vector3d off = sample.state.position - sample.course;
    left += off.dot(Eigen::Vector3d(-along.y(), along.x(), 0).normalized()) * 0.02;
  }
  EXPECT_GT(left / cutter.at("time").as_number(), 0.1) << "m on average";
  EXPECT_NE(read_file(flown.folder / "report.html").find("Score over time"), std::string::npos);

  const std::string page = (folder_ / "race.html").string();
  EXPECT_EQ(command("race '" + (flown.folder / "plan.json").string() + "' --pilot '" + kRacing +
                    "/pilots/leaver.csv:weight=1,strength=30,reach=12' --pilot '" + kRacing +
                    "/pilots/timid.csv:name=Ann,strength=30,reach=12' -o '" + page + "'"),
            0);
  for (const char* words : {"left the course", "Ann wins"})
    EXPECT_NE(read_file(page).find(words), std::string::npos) << words;
}

TEST_F(RaceGame, WhatIsNoRaceIsSaid) {
  const Flown flown = fly("../racing/two_players.lua", "--set players=[]");
  ASSERT_EQ(flown.status, 0);
  EXPECT_EQ(flown.result.find("game"), nullptr);
  const std::string plan = "race '" + (flown.folder / "plan.json").string() + "' ";
  const auto refused = [&](const std::string& given, const std::string& why) {
    EXPECT_EQ(command(plan + given), 2) << given;
    EXPECT_THAT(error(), HasSubstr(why));
  };
  refused("", "--pilot");
  refused("--pilot nowhere.csv", "nowhere.csv");
  write_file_atomically(folder_ / "gap.csv", "time,forward,left\n0,0,0\n3,0,0\n");
  refused("--pilot '" + (folder_ / "gap.csv").string() + "'", "a gap from 0 s to 3 s");
  const std::string timid = "--pilot '" + kRacing + "/pilots/timid.csv";
  refused(timid + ":wieght=1'", "unknown 'wieght'");
  refused(timid + ":weight=2'", "weight must lie between 0 and 1");
  refused(timid + ":weight=x'", "must be a number");
}

}  // namespace
}  // namespace lapwing
