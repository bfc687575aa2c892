// SPDX-License-Identifier: Apache-2.0
// Scans of several batteries and drones, from script to certified plans, and their flights.
#include <iterator>
#include <limits>
#include <set>

#include "framework/core/checksum.h"
#include "framework/trajectory/interpolate.h"
#include "framework/vehicle/closed_loop.h"
#include "tests/missions/scan_fleet.h"
#include "tests/missions/seen_in_flight.h"

namespace lapwing {
namespace {

TEST_F(FleetScans, TwoDronesFlyThreeBatteriesAsOneFleet) {
  ASSERT_EQ(run(kTwoDrones), 0) << error();
  const Value said = answer();
  EXPECT_EQ(said.at("status").as_text(), "ok");
  const Fleet document = fleet();
  ASSERT_EQ(said.at("tours").as_list().size(), document.tours.size());
  ASSERT_GE(document.tours.size(), 2u);
  EXPECT_FALSE(fs::exists(folder_ / "out/plan.json"));
  std::set<std::string> drones;
  std::int64_t most = 0, images = 0;
  for (const FleetTour& tour : document.tours) {
    drones.insert(tour.drone);
    EXPECT_EQ(sha256(read_file(folder_ / "out" / tour.file)), tour.sha256);
    const Plan plan = plan_of(tour);
    EXPECT_LE(plan.trajectory.duration(), 70);
    const double x = tour.drone == "1" ? -8 : 8;
    EXPECT_LT((plan.trajectory.samples.front().position - Eigen::Vector3d(x, x, 13)).norm(), 0.1);
    EXPECT_TRUE(Certificate::from_value(plan.certificate).feasible());
    most = std::max(most, plan.task.scan->seen);
    images += static_cast<std::int64_t>(plan.task.scan->views.size());
  }
  EXPECT_EQ(drones.size(), 2u);
  EXPECT_GT(document.seen, most) << "a second battery shows more";
  EXPECT_GT(images, 4);
  EXPECT_TRUE(Certificate::from_value(document.certificate).feasible());
  for (const char* told : {"plan_1.json", "changes of batteries", "report_1.html", "separation"})
    EXPECT_THAT(read_file(folder_ / "out/report.html"), HasSubstr(told));
  // Judged again, by folder and by document; each plan by itself.
  for (const char* what : {"out", "out/fleet.json", "out/plan_1.json"})
    EXPECT_EQ(verify_again(what), 0) << what << ": " << verified();
  // The same bytes again.
  const std::string bytes = read_file(folder_ / "out/fleet.json");
  ASSERT_EQ(run(kTwoDrones, "hut.lua", "again"), 0) << error();
  EXPECT_EQ(read_file(folder_ / "again/fleet.json"), bytes);
  // A run of one battery into that folder leaves nothing of the fleet.
  ASSERT_EQ(run("", "hut.lua", "again"), 0) << error();
  for (const char* gone : {"fleet.json", "plan_1.json", "report_1.html", "trajectory_1.csv"})
    EXPECT_FALSE(fs::exists(folder_ / "again" / gone)) << gone;
  EXPECT_TRUE(fs::exists(folder_ / "again/plan.json"));

  // What is changed afterwards is found.
  Value edited = from_json(bytes, "fleet.json");
  edited.find("tours")->as_list()[1].set("start", 500);
  write_file_atomically(folder_ / "out/fleet.json", to_json(edited));
  EXPECT_EQ(verify_again("out"), 1);
  EXPECT_THAT(verified(), HasSubstr("changed after writing: tours"));
  write_file_atomically(folder_ / "out/fleet.json", bytes);
  const std::string plan = read_file(folder_ / "out/plan_2.json");
  write_file_atomically(folder_ / "out/plan_2.json", plan + "\n");
  EXPECT_EQ(verify_again("out"), 1);
  EXPECT_THAT(verified(), HasSubstr("is not the file that the fleet names"));
  fs::remove(folder_ / "out/plan_2.json");
  EXPECT_EQ(verify_again("out"), 2);
  EXPECT_THAT(verified(), HasSubstr("plan_2.json"));
}

// Every tour flown by the whole quadrotor under control: images from where it was and how its
// camera looked. All of them together show what the fleet promised.
TEST_F(FleetScans, FlownToursSeeTogetherWhatTheFleetPromised) {
  ASSERT_EQ(run(kTwoDrones), 0) << error();
  const Fleet document = fleet();
  std::set<VoxelKey> planned, flown;
  std::shared_ptr<const Map> map;
  for (const FleetTour& tour : document.tours) {
    const Plan plan = plan_of(tour);
    if (!map) map = map_in(folder_ / "out/map.ot");
    const std::size_t before = flown.size();
    ASSERT_TRUE(see_planned_and_flown(plan, *map, planned, flown));
    EXPECT_GT(flown.size(), before) << "no tour is flown for nothing";
  }
  const double promised = static_cast<double>(document.seen);
  EXPECT_NEAR(static_cast<double>(planned.size()) / promised, 1, 0.03);
  std::set<VoxelKey> both;
  std::set_intersection(planned.begin(), planned.end(), flown.begin(), flown.end(),
                        std::inserter(both, both.end()));
  std::printf("promised %.0f voxels, seen in flight %zu, of them %zu planned\n", promised,
              flown.size(), both.size());
  EXPECT_GE(static_cast<double>(flown.size()) / promised, document.seen_share);
  EXPECT_GE(static_cast<double>(both.size()) / promised, 0.9);
}

// Positions that are less exact keep drones farther apart; the pilot sees all of them.
TEST_F(FleetScans, PilotAndAccuracyHoldForEveryTour) {
  ASSERT_EQ(run(std::string(kTwoDrones) +
                " --set gps_accuracy=0.3 --set fleet.separation=4 --set pilot.position=[0,-14,10] "
                "--set pilot.range=80 " +
                kPond),
            0)
      << error();
  const Fleet document = fleet();
  EXPECT_DOUBLE_EQ(document.separation, 4.6);
  for (const FleetTour& tour : document.tours) {
    const Plan plan = plan_of(tour);
    ASSERT_TRUE(plan.environment.pilot);
    const Certificate certificate = Certificate::from_value(plan.certificate);
    ASSERT_NE(certificate.find("pilot_sight"), nullptr);
    EXPECT_TRUE(certificate.find("pilot_sight")->pass);
  }
  EXPECT_EQ(verify_again("out"), 0) << verified();
}

// Views that are given, each photographed by one of the tours.
TEST_F(FleetScans, GivenViewsAreSharedByTheTours) {
  std::string views;
  for (int k = 0; k < 8; ++k)
    views += std::string(k ? "," : "") + "{position: [" + std::to_string(k < 4 ? -8 : 8) + "," +
             std::to_string(-6 + 4 * (k % 4)) + ",10], yaw_deg: " + (k < 4 ? "0" : "180") +
             ", pitch_deg: -30}";
  const std::string given = "--set 'views=[" + views + "]' --set batteries=2 --set tour.budget=";
  ASSERT_EQ(run(given + "60"), 0) << error();
  const Fleet document = fleet();
  EXPECT_EQ(document.tours.size(), 2u);
  std::set<std::pair<double, double>> places;
  for (const FleetTour& tour : document.tours) {
    const Plan plan = plan_of(tour);
    EXPECT_LE(plan.trajectory.duration(), 60);
    for (const PlannedView& view : plan.task.scan->views)
      places.emplace(view.position.x(), view.position.y());
  }
  EXPECT_EQ(places.size(), 8u);
  EXPECT_NEAR(answer().at("tour").at("score").as_number(), 8, 1e-9) << "each counts 1, once";
}

// A score of batteries that cannot be worse than one of them.
TEST_F(FleetScans, MoreBatteriesShowMore) {
  double before = 0;
  for (const char* batteries : {"1", "2", "3"}) {
    ASSERT_EQ(run(std::string("--set tour.budget=40 --set batteries=") + batteries), 0) << error();
    const double score = answer().at("tour").at("score").as_number();
    EXPECT_GE(score, before) << batteries;
    before = score;
  }
}

TEST_F(FleetScans, PlacesAndBudgetsThatLeaveNoTourAreOneMessage) {
  EXPECT_THAT(refused_fleet("--set batteries=2 --set drones=2 --set "
                            "'fleet.starts=[{position: [8,8,13]},{position: [0,0,2]}]'"),
              HasSubstr("no free start: at (0, 0, 2)"));
  EXPECT_THAT(refused_fleet("--set batteries=2 --set tour.budget=2"),
              HasSubstr("a budget of 2 s is too small"));
}

// As many batteries as it takes, and no fewer: judged by the prediction of the fleet itself.
TEST_F(FleetScans, AnAccuracyTakesTheFewestBatteriesThatReachIt) {
  const std::string asked = "--set tour.budget=40 --set accuracy=0.06 --set accuracy_share=0.9 ";
  ASSERT_EQ(run(asked), 0) << error();
  const Value said = answer();
  const Value& found = said.at("tour").at("accuracy");
  const std::int64_t batteries = found.at("batteries").as_integer();
  EXPECT_GE(batteries, 2);
  EXPECT_EQ(fleet().tours.size(), static_cast<std::size_t>(batteries));
  const double area = found.at("area").as_number(), possible = found.at("possible").as_number();
  EXPECT_GE(area, 0.9 * possible);
  EXPECT_LE(area, possible);
  EXPECT_LE(possible, found.at("known").as_number());
  EXPECT_NEAR(found.at("known").as_number(),
              said.at("tour").at("prediction").at("known").as_number(), 1e-6);
  EXPECT_EQ(verify_again("out"), 0) << verified();
  // One battery fewer: refused with the share that it reaches, which is then enough.
  const std::string fewer = asked + "--set batteries=" + std::to_string(batteries - 1) + " ";
  const std::string refusal = refused_fleet(fewer);
  EXPECT_THAT(refusal, HasSubstr("accuracy: the images of " + std::to_string(batteries - 1)));
  const std::string words = "Expected accuracy_share at most ";
  ASSERT_NE(refusal.find(words), refusal.npos) << refusal;
  const double share = std::stod(refusal.substr(refusal.find(words) + words.size()));
  EXPECT_LT(share, 0.9);
  EXPECT_EQ(run(fewer + "--set accuracy_share=" + std::to_string(share), "hut.lua", "fewer"), 0)
      << error();
  // What no number of batteries reaches is refused, soon.
  EXPECT_THAT(refused_fleet("--set tour.budget=40 --set accuracy=0.0001"),
              HasSubstr("no two views within reach of a tour locate any of the "));
  EXPECT_THAT(refused_fleet(asked + "--set batteries=2"),
              HasSubstr("and at most 2 are allowed. Expected accuracy_share at most"));
}

}  // namespace
}  // namespace lapwing
