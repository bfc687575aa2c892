// SPDX-License-Identifier: Apache-2.0
#include "framework/problem/time_spans.h"

#include "framework/core/units.h"
#include "framework/problem/path_clearance.h"
#include "tests/vehicle/vehicle_fixture.h"

namespace lapwing {
namespace {

FunctionShape asked(int window, const std::vector<TimeSpan>& only,
                    const std::vector<TimeSpan>& except) {
  FunctionShape shape{.window = window, .rows = 2, .row_names = {"a", "b"}};
  ask_within(shape, {.stages = 6, .step = 0.1}, only, except);
  return shape;
}

TEST(TimeSpans, ListTheWindowsInsideThem) {
  EXPECT_TRUE(asked(1, {}, {}).stages.empty()) << "all of them";
  EXPECT_EQ(asked(1, {{0.1, 0.3}}, {}).stages, (std::vector{1, 2, 3})) << "ends included";
  EXPECT_EQ(asked(1, {}, {{0.1, 0.3}}).stages, (std::vector{0, 4, 5}));
  EXPECT_EQ(asked(1, {{0, 0.25}, {0.45, 9}}, {{0.1, 0.1}}).stages, (std::vector{0, 2, 5}));
  // Windows of three stages: whole inside, and touching no cut, however short.
  EXPECT_EQ(asked(3, {{0.1, 0.4}}, {}).stages, (std::vector{1, 2}));
  EXPECT_EQ(asked(3, {}, {{0.24, 0.26}}).stages, (std::vector{0, 3}));
  EXPECT_EQ(asked(3, {}, {{0.4, 0.5}}).stages, (std::vector{0, 1}));
}

TEST(TimeSpans, LeaveNoRowsWhereNothingRemains) {
  for (const FunctionShape& shape : {asked(1, {}, {{0, 0.5}}), asked(2, {{0.12, 0.28}}, {})}) {
    EXPECT_EQ(shape.rows, 0);
    EXPECT_TRUE(shape.row_names.empty());
  }
}

TEST(TimeSpans, RefuseWhatLiesBehindTheEnd) {
  EXPECT_THROW(asked(1, {{0.51, 2}}, {}), InputError);
  EXPECT_THROW(asked(1, {}, {{0.51, 2}}), InputError);
  EXPECT_NO_THROW(asked(1, {}, {{0.5, 2}}));
}

TEST(PathClearance, TakesTheLargestAccelerationThatLimitsAllow) {
  Vehicle vehicle = read_vehicle(vehicle_file());
  vehicle.acceleration_across_max = 3;
  vehicle.acceleration_up_max.reset();
  vehicle.acceleration_down_max.reset();
  const double up = vehicle.thrust_max() / vehicle.mass - kGravity;
  EXPECT_DOUBLE_EQ(largest_acceleration(vehicle), std::hypot(3, std::max(up, kGravity)));
  vehicle.acceleration_up_max = 4;
  vehicle.acceleration_down_max = 2;
  EXPECT_DOUBLE_EQ(largest_acceleration(vehicle), 5);
  // Half a second from rest: the path bends by 5/32 m, the chord is up to 0.625 m long.
  const double at_rest =
      PathClearance(vehicle).around<double>(Eigen::Vector3d::Zero(), 0.5).asked(1.0);
  EXPECT_NEAR(at_rest, std::hypot(1.15625, (0.005 + 0.625) / 2), 1e-12);
  const double passed =
      PathClearance(vehicle).around<double>(Eigen::Vector3d(0, 8, 0), 0.5, 2.0).asked(1.0);
  EXPECT_NEAR(passed, std::hypot(1.65625, (4.0 + 1.0 + 0.625) / 2), 1e-5);
}

}  // namespace
}  // namespace lapwing
