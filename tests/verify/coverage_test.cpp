// SPDX-License-Identifier: Apache-2.0
// Scans: images taken where the plan says, and what they see, against a walk in small steps.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <set>

#include "framework/core/checksum.h"
#include "framework/core/files.h"
#include "framework/geometry/depth_camera.h"
#include "framework/map/map_file.h"
#include "framework/verify/verify.h"
#include "tests/verify/reference_plan.h"
#include "tests/view/view_world.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;
namespace fs = std::filesystem;

class Coverage : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("lapwing_coverage_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    map_ = walled_room();
    const std::string bytes = map_file_bytes(".ot", *map_);
    write_file_atomically(folder_ / "map.ot", bytes);
    sum_ = sha256(bytes);
  }
  void TearDown() override { fs::remove_all(folder_); }

  // Along y before the wall, three images of it.
  Plan plan() const {
    Plan plan;
    plan.mission = "wall";
    plan.kind = "scan";
    plan.vehicle = to_value(reference_vehicle());
    plan.trajectory.motion = path_motion();
    plan.trajectory.has_gimbal = true;
    ScanTask scan;
    scan.region = Eigen::AlignedBox3d(Vector3d(4, -4, 1), Vector3d(6, 4, 9));
    scan.camera = {32, 24, 18, 18, 15.5, 11.5};
    scan.range = 15;
    scan.map = "known";
    for (int i = 0; i < 3; ++i) {
      Sample s;
      s.time = 2 * i;
      s.position = {-3, -3 + 3.0 * i, 5};
      s.yaw = 0.3 - 0.3 * i;
      s.gimbal_pitch = -0.2 * i;
      plan.trajectory.samples.push_back(s);
      scan.views.push_back({s.time, s.position, s.yaw, s.gimbal_pitch, {}});
    }
    static const auto kSeen = static_cast<std::int64_t>(seen(scan).size());
    scan.seen = kSeen;
    plan.environment.obstacles = {file_at("known", "map", "map.ot", sum_)};
    plan.environment.margin = 0.5;
    plan.task.scan = scan;
    return plan;
  }

  // Step by step along every ray.
  std::set<VoxelKey> seen(const ScanTask& scan) const {
    constexpr double kStep = 0.01;
    std::set<VoxelKey> all;
    for (const PlannedView& view : scan.views) {
      const Pose pose = camera_pose(view.position, view.yaw, view.pitch);
      for (int y = 0; y < scan.camera.height; ++y)
        for (int x = 0; x < scan.camera.width; ++x) {
          const Vector3d way = (pose.orientation * pixel_ray(scan.camera, x, y)).normalized();
          for (double along = 0; along < scan.range; along += kStep) {
            const Vector3d p = view.position + along * way;
            const VoxelKey key = map_->grid().key(p);
            if (map_->read(key).state == VoxelState::free) continue;
            if (scan.region.contains(map_->grid().center(key))) all.insert(key);
            break;
          }
        }
    }
    return all;
  }

  Check check(const Plan& plan, const std::string& name) const {
    const Certificate certificate = verify(plan, folder_);
    for (const Check& c : certificate.checks)
      if (c.name == name) return c;
    throw std::runtime_error("no check " + name);
  }

  fs::path folder_;
  std::shared_ptr<Map> map_;
  std::string sum_;
};

TEST_F(Coverage, RaysOfTheVerifierSeeWhatAWalkInSmallStepsSees) {
  const Plan good = plan();
  ASSERT_GT(good.task.scan->seen, 100);
  const Check coverage = check(good, "coverage");
  EXPECT_TRUE(coverage.pass);
  EXPECT_NEAR(coverage.worst.value(), 1, 0.02) << "rays through edges may fall to either side";
  EXPECT_TRUE(check(good, "view_miss").pass);
  EXPECT_TRUE(check(good, "view_direction").pass);
  EXPECT_TRUE(check(good, "document").pass) << check(good, "document").detail;
  EXPECT_TRUE(verify(good, folder_).feasible());
}

TEST_F(Coverage, AClaimOfMoreIsRefused) {
  Plan claimed = plan();
  claimed.task.scan->seen = claimed.task.scan->seen * 11 / 10;
  EXPECT_FALSE(check(claimed, "coverage").pass);
  claimed.task.scan->seen_share = 0.85;
  EXPECT_TRUE(check(claimed, "coverage").pass);
  // What the wall hides is not seen: a region behind it.
  Plan behind = plan();
  behind.task.scan->region = Eigen::AlignedBox3d(Vector3d(6.5, -2, 3), Vector3d(8, 2, 6));
  behind.task.scan->seen = 1;
  EXPECT_EQ(check(behind, "coverage").worst.value(), 0);
  EXPECT_FALSE(check(behind, "coverage").pass);
  Plan near = plan();
  near.task.scan->range = 5;  // the wall is 8 m away
  EXPECT_FALSE(check(near, "coverage").pass);
}

TEST_F(Coverage, ImagesAreTakenWhereTheFlightIs) {
  Plan moved = plan();
  moved.task.scan->views[1].position.z() += 0.5;
  EXPECT_FALSE(check(moved, "view_miss").pass);
  EXPECT_NEAR(check(moved, "view_miss").worst.value(), 0.5, 1e-9);
  EXPECT_EQ(check(moved, "view_miss").at, 2);
  moved.task.scan->tolerance = 0.6;
  EXPECT_TRUE(check(moved, "view_miss").pass);
  Plan early = plan();
  early.task.scan->views[1].time = 1;
  EXPECT_NEAR(check(early, "view_miss").worst.value(), 1.5, 1e-9);
  Plan turned = plan();
  turned.task.scan->views[2].pitch += 0.1;
  EXPECT_NEAR(check(turned, "view_direction").worst.value(), 0.1, 1e-9);
  EXPECT_FALSE(check(turned, "view_direction").pass);
  turned = plan();
  turned.task.scan->views[0].yaw += 2 * 3.14159265358979;
  EXPECT_TRUE(check(turned, "view_direction").pass) << "a whole turn is none";
}

TEST_F(Coverage, WhatMakesNoSenseIsSaid) {
  const auto said = [&](const std::function<void(Plan&)>& spoil) {
    Plan spoilt = plan();
    spoil(spoilt);
    const Check document = check(spoilt, "document");
    EXPECT_FALSE(document.pass);
    return document.detail;
  };
  using testing::HasSubstr;
  EXPECT_THAT(said([](Plan& p) { p.task.scan->map = "other"; }), HasSubstr("map 'other'"));
  EXPECT_THAT(said([](Plan& p) { p.task.scan->views.clear(); }), HasSubstr("must have a view"));
  EXPECT_THAT(said([](Plan& p) { p.task.scan->views[1].time = 9; }), HasSubstr("view 2 is not"));
  EXPECT_THAT(said([](Plan& p) { p.task.scan->views[2].time = 0; }), HasSubstr("not later"));
  EXPECT_THAT(said([](Plan& p) { p.task.scan->seen = 0; }), HasSubstr("the number of seen voxels"));
  EXPECT_THAT(said([](Plan& p) { p.task.scan->range = 1e6; }), HasSubstr("rays"));
  EXPECT_THAT(said([](Plan& p) { p.task.scan->camera.width = 0; }), HasSubstr("camera"));
  EXPECT_THAT(said([](Plan& p) { p.task.scan->camera.width = 1 << 30; }), HasSubstr("10^9"));
  EXPECT_THAT(said([](Plan& p) { p.task.scan->views[0].yaw = std::nan(""); }),
              HasSubstr("not finite"));
  EXPECT_THAT(said([](Plan& p) {
                p.task.scan->region = Eigen::AlignedBox3d(Vector3d(4, -4, 1), Vector3d(-9, 4, 9));
              }),
              HasSubstr("region"));
}

TEST_F(Coverage, OfPrismsWithHolesCountsTheirVoxelsAlone) {
  const RegionPrism ring{.name = "ring",
                         .outline = {{4, -4}, {6, -4}, {6, 4}, {4, 4}},
                         .holes = {{{4.6, -1.1}, {5.9, -1.1}, {5.9, 2.1}, {4.6, 2.1}}},
                         .low = 1,
                         .high = 9};
  Plan holed = plan();
  const std::int64_t whole = holed.task.scan->seen;
  holed.task.scan->region = InterestRegion({ring});
  holed.task.scan->seen = static_cast<std::int64_t>(seen(*holed.task.scan).size());
  EXPECT_LT(holed.task.scan->seen, whole * 3 / 4);
  EXPECT_GT(holed.task.scan->seen, whole / 3);
  EXPECT_NEAR(check(holed, "coverage").worst.value(), 1, 0.03);
  holed.task.scan->seen = whole;
  EXPECT_FALSE(check(holed, "coverage").pass) << "the hole is no part of the region";
  // The document keeps it.
  const Plan read = plan_from_value(to_value(holed));
  ASSERT_EQ(read.task.scan->region.prisms().size(), 1u);
  EXPECT_EQ(read.task.scan->region.prisms()[0].holes, ring.holes);
  EXPECT_EQ(to_value(read), to_value(holed));
}

TEST_F(Coverage, APilotSeesTheWholeFlightOrTheCertificateSaysSince) {
  const auto with = [&](const Vector3d& eye, double range) {
    Plan seen = plan();
    seen.environment.pilot = PilotPlace{eye, range, 1};
    return seen;
  };
  const Plan good = with({-8, 0, 2}, 7);
  EXPECT_TRUE(check(good, "pilot_sight").pass);
  EXPECT_TRUE(verify(good, folder_).feasible());
  EXPECT_NEAR(check(good, "pilot_distance").worst.value(), std::sqrt(25 + 9 + 9), 1e-6);
  EXPECT_FALSE(check(with({-8, 0, 2}, 6), "pilot_distance").pass);
  // The wall is between them all the time.
  const Check behind = check(with({8, 0, 5}, 50), "pilot_sight");
  EXPECT_NEAR(behind.worst.value(), 4, 0.1);
  EXPECT_EQ(behind.at, 0);
  // From (8, -6, 5) the wall hides what lies beyond y = 4/3; the flight passes it at 1.5 m/s.
  const Check beside = check(with({8, -6, 5}, 50), "pilot_sight");
  EXPECT_FALSE(beside.pass);
  EXPECT_NEAR(beside.worst.value(), (3 - 4.0 / 3) / 1.5, 0.1);
  EXPECT_NEAR(beside.at, (3 + 4.0 / 3) / 1.5, 0.1);
  // What is unknown hides as well.
  EXPECT_FALSE(check(with({-14, 0, 5}, 50), "pilot_sight").pass);
  EXPECT_EQ(to_value(plan_from_value(to_value(good))), to_value(good));
  for (const Check& listed : verify(plan(), folder_).checks)
    EXPECT_FALSE(listed.name.starts_with("pilot")) << "no pilot is stated";
}

TEST_F(Coverage, OpaqueShapesHideTheFlightFromAPilotAndOthersDoNot) {
  Plan seen = plan();
  seen.environment.pilot = PilotPlace{{-8, 0, 5}, 50, 1};
  ASSERT_TRUE(check(seen, "pilot_sight").pass);
  seen.environment.obstacles.push_back(sphere_at("balloon", {-5.5, 0, 5}, 0.6));
  EXPECT_FALSE(check(seen, "pilot_sight").pass);
  EXPECT_TRUE(check(seen, "clearance").pass) << "it is in nobody's way";
  seen.environment.obstacles.back().opaque = false;
  EXPECT_TRUE(check(seen, "pilot_sight").pass);
}

TEST_F(Coverage, TheAccuracyOfThePositionIsPartOfTheMargin) {
  Plan accurate = plan();
  accurate.environment.accuracy = 0.3;
  EXPECT_THAT(check(accurate, "clearance").detail,
              testing::HasSubstr("the margin includes 0.3 m, the accuracy of the position"));
  accurate.environment.accuracy = 0.6;
  EXPECT_THAT(check(accurate, "document").detail, testing::HasSubstr("part of the margin"));
}

}  // namespace
}  // namespace lapwing
