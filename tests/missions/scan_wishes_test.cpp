// SPDX-License-Identifier: Apache-2.0
// Views that the user pins, and places without views.
#include "tests/missions/scan_hut.h"

namespace lapwing {
namespace {

class Wishing : public Scanning {
 protected:
  // Positions of the planned views; of all tours.
  std::vector<Eigen::Vector3d> planned(const std::string& more) {
    fs::remove_all(folder_ / "out");
    EXPECT_EQ(run(more), 0) << error();
    std::vector<Eigen::Vector3d> places;
    for (const char* name : {"plan.json", "plan_1.json", "plan_2.json"}) {
      if (!fs::exists(folder_ / "out" / name)) continue;
      const Plan made = read_plan(folder_ / "out" / name);
      for (const PlannedView& view : made.task.scan->views) places.push_back(view.position);
    }
    return places;
  }
  static int near(const std::vector<Eigen::Vector3d>& places, const Eigen::Vector3d& p, double m) {
    return static_cast<int>(std::count_if(
        places.begin(), places.end(), [&](const auto& place) { return (place - p).norm() <= m; }));
  }
};

const std::string kPin = "--set 'pinned=[{position: [7, 3.3, 9], yaw_deg: 205, pitch_deg: -40}]' ";
const Eigen::Vector3d kPinned(7, 3.3, 9);

TEST_F(Wishing, EverySolverTakesAPinnedViewAndSaysItsOwnScore) {
  EXPECT_EQ(near(planned(""), kPinned, 1e-6), 0);
  double best = 0, bound = 1e300;
  for (const char* solver : {"local_search", "recursive_greedy", "milp"}) {
    const std::string by =
        "--set tour.solver=" + std::string(solver) + " --set tour.guard=5 " +
        (std::string(solver) == "local_search" ? "--set tour.iterations=60 " : "");
    // Their own options do not fit the others.
    write_file_atomically(folder_ / "hut.lua", [&] {
      std::string text = read_file(folder_ / "hut.lua");
      const std::size_t at = text.find(", iterations = 60");
      if (at != std::string::npos) text.erase(at, 17);
      return text;
    }());
    EXPECT_EQ(near(planned(by + kPin), kPinned, 1e-6), 1) << solver;
    const Value tour = answer().at("tour");
    EXPECT_GT(tour.at("score").as_number(), 0) << solver;
    EXPECT_LT(tour.at("score").as_number(), 1e5) << solver;  // what is seen, no bonus
    best = std::max(best, tour.at("score").as_number());
    bound = std::min(bound, tour.at("upper_bound").as_number());
  }
  EXPECT_LE(best, bound);  // no solver's bound lies below another one's tour
}

TEST_F(Wishing, OneOfTheToursOfAFleetTakesIt) {
  EXPECT_EQ(near(planned("--set batteries=2 " + kPin), kPinned, 1e-6), 1);
}

TEST_F(Wishing, NoViewIsTakenWhereTheyAreForbidden) {
  std::vector<Eigen::Vector3d> before = planned("");
  ASSERT_GT(before.size(), 2u);
  const Eigen::Vector3d middle = before[before.size() / 2];
  char ball[160];
  std::snprintf(ball, sizeof ball,
                "--set 'forbidden=[{position: [%.17g, %.17g, %.17g], within: 3}]'", middle.x(),
                middle.y(), middle.z());
  const std::vector<Eigen::Vector3d> after = planned(ball);
  // The start may lie there.
  EXPECT_LE(near({after.begin() + 1, after.end()}, middle, 3), near({after[0]}, middle, 3));
}

TEST_F(Wishing, WhatCannotBeIsSaid) {
  const auto pin = [&](const std::string& place) {
    return refused("--set 'pinned=[{position: [" + place + "], yaw_deg: 0, pitch_deg: -40}]'");
  };
  EXPECT_THAT(pin("0, 0, 2"), HasSubstr("pinned view 1 at (0, 0, 2): map and mesh leave"));
  EXPECT_THAT(pin("90, 0, 9"), HasSubstr("outside the space of the tour"));
  EXPECT_THAT(pin("7, 3.3, 9"), HasSubstr("view 1 at (7, 3.3, 9) is on no tour"));  // looks away
  EXPECT_THAT(refused(kPin + "--set 'forbidden=[{position: [7, 3, 9]}]'"),
              HasSubstr("it lies where views are forbidden"));
  EXPECT_THAT(refused("--set 'forbidden=[{position: [0, 0, 10], within: 500}]'"),
              HasSubstr("outside of the balls where views are forbidden"));
  EXPECT_THAT(refused(kPin + "--set 'views=[{position: [7, 3, 9], yaw_deg: 0, pitch_deg: 0}]'"),
              HasSubstr("views are given"));
  EXPECT_THAT(refused("--set 'pinned=[{position: [7, 3.3, 9], yaw_deg: 205}]'"),
              HasSubstr("pitch_deg: missing"));
  EXPECT_THAT(refused("--set 'forbidden=[{position: [7, 3, 9], within: 0}]'"), HasSubstr("within"));
}

}  // namespace
}  // namespace lapwing
