// SPDX-License-Identifier: Apache-2.0
// Fleet documents as bytes, and when their tours begin: known answers.
#include "framework/trajectory/fleet.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/core/json.h"
#include "framework/trajectory/fleet_schedule.h"
#include "framework/trajectory/plan_digest.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

Fleet small_fleet() {
  Fleet fleet;
  fleet.mission = "hut";
  fleet.kind = "scan";
  fleet.separation = 5;
  fleet.swap = 60;
  fleet.reserve = 30;
  fleet.seen = 1234;
  fleet.seen_share = 0.95;
  fleet.tours = {{"1", 1, 0, "plan_1.json", "aa"},
                 {"2", 1, 0.5, "plan_2.json", "bb"},
                 {"1", 2, 130, "plan_3.json", "cc"}};
  return fleet;
}

TEST(FleetDocument, ReadsWhatItWrote) {
  const std::string text = fleet_text(small_fleet());
  const Value document = from_json(text, "fleet.json");
  EXPECT_TRUE(is_fleet(document));
  EXPECT_TRUE(check_digest(document).changed.empty());
  const Fleet again = fleet_from_value(document);
  EXPECT_EQ(fleet_text(again), text);
  EXPECT_EQ(swaps_of(again), 1);
  EXPECT_EQ(name_of_tour(again.tours[2]), "drone 1, battery 2");
  EXPECT_EQ(fleet_plan_name(2), "plan_3.json");
  Value later = document;
  later.find("tours")->as_list()[1].set("start", 0.6);
  EXPECT_EQ(check_digest(later).changed.size(), 1u);
}

TEST(FleetDocument, SaysEverythingThatIsWrong) {
  Value bad = to_value(small_fleet());
  bad.set("separaton", 3);
  bad.find("tours")->as_list()[0].set("battery", 0);
  bad.find("tours")->as_list()[1].set("file", "../other/plan.json");
  bad.set("seen", "many");
  try {
    fleet_from_value(bad);
    FAIL();
  } catch (const InputError& error) {
    for (const char* said : {"separaton", "battery", "beside the fleet document", "seen"})
      EXPECT_THAT(error.what(), HasSubstr(said));
  }
  Fleet many = small_fleet();
  many.tours.resize(Fleet::kMostTours + 1, many.tours.front());
  EXPECT_THROW(fleet_from_value(to_value(many)), InputError);
  Value newer = to_value(small_fleet());
  newer.set("fleet_format", 2);
  EXPECT_THROW(fleet_from_value(newer), InputError);
}

// Along x from `from`, out and back, at 1 m/s.
Trajectory out_and_back(const Vector3d& from, double metres) {
  Trajectory flight;
  for (int k = 0; k < 3; ++k) {
    Sample s;
    s.time = k * metres;
    s.position = from + Vector3d(k == 1 ? metres : 0, 0, 0);
    s.velocity = {k == 0 ? 1.0 : -1.0, 0, 0};
    flight.samples.push_back(s);
  }
  flight.motion.moves = false;  // straight between samples
  return flight;
}

TEST(FleetSchedule, ToursOfOneDroneFollowEachOtherAfterTheSwap) {
  const Trajectory flight = out_and_back({0, 0, 10}, 10);  // 20 s
  const std::vector<TourToFly> tours{{"1", &flight}, {"1", &flight}, {"1", &flight}};
  const auto scheduled = fleet_schedule(tours, {.separation = 5, .swap = 60});
  ASSERT_EQ(scheduled.size(), 3u);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(scheduled[static_cast<std::size_t>(k)].battery, k + 1);
    EXPECT_DOUBLE_EQ(scheduled[static_cast<std::size_t>(k)].start, 80 * k);
  }
}

TEST(FleetSchedule, DronesThatAreFarApartFlyAtOnce) {
  const Trajectory here = out_and_back({0, 0, 10}, 10), there = out_and_back({0, 50, 10}, 10);
  const std::vector<TourToFly> tours{{"1", &here}, {"2", &there}};
  for (const ScheduledTour& tour : fleet_schedule(tours, {.separation = 5, .swap = 60}))
    EXPECT_EQ(tour.start, 0);
}

// Two drones on one line at 1 m/s: the second one may begin once the first one is farther away than
// the separation and comes no nearer, which is only after it is home again.
TEST(FleetSchedule, DronesOnOneLineWaitForEachOther) {
  const Trajectory flight = out_and_back({0, 0, 10}, 40);
  const std::vector<TourToFly> tours{{"1", &flight}, {"2", &flight}};
  const auto near = fleet_schedule(tours, {.separation = 5, .swap = 0});
  ASSERT_EQ(near.size(), 2u);
  EXPECT_EQ(near[0].start, 0);
  // Both come home along the line: they meet unless the first has landed. It lands at 80 s.
  EXPECT_NEAR(near[1].start, 80, 0.5);
  // A swap of 20 s: the first one may be anywhere below home until 90 s, the second one from 10 s
  // before its start.
  EXPECT_NEAR(fleet_schedule(tours, {.separation = 5, .swap = 20})[1].start, 100, 0.5);
  EXPECT_EQ(fleet_schedule(tours, {.separation = 0, .swap = 20})[1].start, 0);
}

// The second drone climbs at a home below which the first one passes.
TEST(FleetSchedule, ADroneThatClimbsIsOnTheLineBelowItsHome) {
  const Trajectory low = out_and_back({0, 0, 10}, 40);    // passes x = 20 at 20 s and at 60 s
  const Trajectory high = out_and_back({20, 0, 40}, 10);  // 20 s, 30 m above
  const std::vector<TourToFly> tours{{"1", &low}, {"2", &high}};
  // At once: climbs until 0 s, while the first one is at 0; lands from 20 s to 30 s, right above
  // its way. The first one is farther away than 5 m from the line after 25 s and until 55 s.
  const auto scheduled = fleet_schedule(tours, {.separation = 5, .swap = 20});
  ASSERT_EQ(scheduled.size(), 2u);
  const double start = scheduled[1].start;
  EXPECT_GT(start, 0);
  const auto apart = [](double from, double to, double a, double b) {
    return to <= a || from >= b;
  };
  for (const auto& [a, b] : {std::pair{15.0, 25.0}, {55.0, 65.0}}) {
    EXPECT_TRUE(apart(start - 10, start, a, b)) << start;
    EXPECT_TRUE(apart(start + 20, start + 30, a, b)) << start;
  }
  EXPECT_LE(start, 36) << "it may climb after 25 s";
}

TEST(FleetSchedule, NothingToFlyIsAnError) {
  const Trajectory none;
  const std::vector<TourToFly> tours{{"1", &none}};
  EXPECT_THROW(fleet_schedule(tours, {}), Error);
}

}  // namespace
}  // namespace lapwing
