// SPDX-License-Identifier: Apache-2.0
// Fleets: known distances and times, and one fault at a time.
#include "framework/verify/fleet.h"

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
using testing::HasSubstr;
namespace fs = std::filesystem;

class Fleets : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("lapwing_fleets_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    map_ = walled_room();
    const std::string bytes = map_file_bytes(".ot", *map_);
    write_file_atomically(folder_ / "map.ot", bytes);
    sum_ = sha256(bytes);
    plans_ = {tour(-3, 5), tour(-3, 8)};
    std::set<VoxelKey> all;
    for (Plan& plan : plans_) {
      const std::set<VoxelKey> seen = seen_by(*plan.task.scan);
      plan.task.scan->seen = static_cast<std::int64_t>(seen.size());
      all.insert(seen.begin(), seen.end());
    }
    fleet_.mission = "wall";
    fleet_.kind = "scan";
    fleet_.separation = 2.5;
    fleet_.reserve = 30;
    fleet_.seen = static_cast<std::int64_t>(all.size());
    fleet_.seen_share = 0.95;
    fleet_.tours = {{"1", 1, 0, "plan_1.json", "1"}, {"2", 1, 0, "plan_2.json", "2"}};
  }
  void TearDown() override { fs::remove_all(folder_); }

  // Along y before the wall, there and back in 8 s; two images of it.
  Plan tour(double x, double z) const {
    Plan plan;
    plan.mission = "wall";
    plan.kind = "scan";
    plan.vehicle = to_value(reference_vehicle());
    plan.trajectory.motion = path_motion();
    plan.trajectory.has_gimbal = true;
    ScanTask scan;
    scan.region = Eigen::AlignedBox3d(Vector3d(4, -4, 1), Vector3d(6, 4, 9));
    scan.camera = {32, 24, 40, 40, 15.5, 11.5};
    scan.range = 15;
    scan.map = "known";
    for (int i = 0; i < 5; ++i) {
      Sample s;
      s.time = 2 * i;
      s.position = {x, i == 4 ? -3.0 : i == 2 ? 3.0 : 0.0, z};
      if (i == 0) s.position.y() = -3;
      plan.trajectory.samples.push_back(s);
      if (i == 1 || i == 2) scan.views.push_back({s.time, s.position, 0, 0, {}});
    }
    plan.environment.obstacles = {file_at("known", "map", "map.ot", sum_)};
    plan.environment.margin = 0.5;
    plan.task.scan = scan;
    return plan;
  }

  // Step by step along every ray.
  std::set<VoxelKey> seen_by(const ScanTask& scan) const {
    constexpr double kStep = 0.02;
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

  Certificate judged(const DigestFindings* digest = nullptr) const {
    std::vector<Certificate> own;
    for (const Plan& plan : plans_) own.push_back(verify(plan, folder_));
    std::vector<FleetMember> members;
    for (std::size_t t = 0; t < plans_.size(); ++t)
      members.push_back({&plans_[t], &own[t], std::to_string(t + 1)});
    return verify_fleet(fleet_, members, digest, {.folder = folder_}, faults_);
  }
  Check check(const std::string& name) const {
    const Certificate certificate = judged();
    const Check* found = certificate.find(name);
    if (!found) throw std::runtime_error("no check " + name);
    return *found;
  }
  // The only check that fails.
  std::string failure() const {
    const auto failures = judged().failures();
    return failures.size() == 1 ? failures.front().name
                                : std::to_string(failures.size()) + " failures";
  }

  fs::path folder_;
  std::shared_ptr<Map> map_;
  std::string sum_;
  std::vector<Plan> plans_;
  Fleet fleet_;
  std::vector<std::string> faults_;
};

TEST_F(Fleets, AGoodOneIsCertified) {
  const Certificate certificate = judged();
  for (const Check& failed : certificate.failures()) ADD_FAILURE() << to_line(failed);
  EXPECT_TRUE(certificate.feasible());
  // 3 m apart all the time.
  EXPECT_NEAR(check("separation").worst.value(), 3, 1e-3);
  EXPECT_NEAR(check("fleet_coverage").worst.value(), 1, 0.02);
  EXPECT_NEAR(check("reserve").worst.value(), reference_vehicle().flight_time - 8, 1e-9);
  EXPECT_FALSE(check("sequence").skipped.empty()) << "every drone flies once";
  // Neither alone sees what both see.
  EXPECT_GT(fleet_.seen, std::max(plans_[0].task.scan->seen, plans_[1].task.scan->seen));
}

TEST_F(Fleets, DistancesAreThoseAtEqualTimes) {
  fleet_.separation = 3.5;
  EXPECT_EQ(failure(), "separation");
  // One second later on one line: 3 m beside and 3 m above or below each other.
  fleet_.tours[1].start = 2;
  EXPECT_NEAR(check("separation").worst.value(), 3, 1e-3) << "they meet on the way back";
  fleet_.tours[1].start = 100;
  EXPECT_FALSE(check("separation").skipped.empty());
}

// 10 s of swap: until 5 s after it has come home a drone is on the line below its home, and from 5
// s before it begins. The second one's home is 3 m above the first one's.
TEST_F(Fleets, ADroneThatClimbsIsAnywhereBelowItsHome) {
  fleet_.swap = 10;
  fleet_.tours[1].start = 17.5;  // climbs from 12.5 s; the first one lands until 13 s
  EXPECT_NEAR(check("separation").worst.value(), 0, 1e-6);
  fleet_.tours[1].start = 18.5;
  EXPECT_FALSE(check("separation").skipped.empty());
}

TEST_F(Fleets, OneDroneNeedsTheSwapBetweenItsTours) {
  fleet_.swap = 60;
  fleet_.tours[1] = {"1", 2, 68, "plan_2.json", "2"};
  plans_[1] = plans_[0];
  fleet_.seen = plans_[0].task.scan->seen;
  EXPECT_EQ(failure(), "0 failures");
  EXPECT_NEAR(check("sequence").worst.value(), 60, 1e-9);
  fleet_.tours[1].start = 67.9;
  EXPECT_EQ(failure(), "sequence");
  // Battery 2 before battery 1.
  fleet_.tours[1].start = 100;
  std::swap(fleet_.tours[0].battery, fleet_.tours[1].battery);
  EXPECT_EQ(failure(), "sequence");
}

TEST_F(Fleets, ADroneComesHomeWithItsReserve) {
  fleet_.reserve = reference_vehicle().flight_time - 7;
  EXPECT_EQ(failure(), "reserve");
  fleet_.reserve = 30;
  plans_[1].trajectory.samples.back().position.y() += 0.2;
  EXPECT_EQ(failure(), "homes");
  EXPECT_NEAR(check("homes").worst.value(), 0.2, 1e-9);
  fleet_.tours[1] = {"1", 2, 100, "plan_2.json", "2"};
  EXPECT_NEAR(check("homes").worst.value(), 3, 1e-9) << "the next battery begins elsewhere";
}

TEST_F(Fleets, AClaimOfMoreThanTheViewsSeeIsRefused) {
  const std::int64_t seen = fleet_.seen;
  fleet_.seen = seen * 11 / 10;
  EXPECT_EQ(failure(), "fleet_coverage");
  fleet_.seen = plans_[0].task.scan->seen + plans_[1].task.scan->seen + 1;
  EXPECT_THAT(check("fleet_document").detail, HasSubstr("contradicts those of the plans"));
  fleet_.seen = plans_[0].task.scan->seen - 1;
  EXPECT_FALSE(check("fleet_document").pass);
  fleet_.seen = seen;
  // A tour that looks elsewhere.
  for (PlannedView& view : plans_[1].task.scan->views) view.yaw = EIGEN_PI;
  for (Sample& s : plans_[1].trajectory.samples) s.yaw = EIGEN_PI;
  EXPECT_FALSE(check("fleet_coverage").pass);
  EXPECT_THAT(check("tours").detail, HasSubstr("drone 2, battery 1"));
}

TEST_F(Fleets, WhatItsConfigurationAsksForIsRequired) {
  EXPECT_TRUE(check("provenance").pass);
  faults_ = {"the separation is 1 m in the plan and 8 m in its configuration"};
  EXPECT_EQ(failure(), "provenance");
  EXPECT_EQ(check("provenance").detail, faults_[0]);
}

TEST_F(Fleets, PlansOfOtherPlacesAndVehiclesAreRefused) {
  const std::vector<Plan> good = plans_;
  const auto refused = [&](const std::string& said) {
    EXPECT_FALSE(check("fleet_document").pass) << said;
    EXPECT_THAT(check("fleet_document").detail, HasSubstr(said));
    plans_ = good;
  };
  plans_[1].geodetic_origin = GeodeticOrigin{47.4, 8.5, 450, HeightOf::ellipsoid};
  refused("drone 2, battery 1 has another origin on the earth than the first tour");
  plans_[1].home = Home{{1, 2, 0}, 120, std::nullopt, {}};
  refused("drone 2, battery 1 has another home than the first tour");
  // Two drones may be two vehicles; one drone is one.
  plans_[1].vehicle.set("flight_time", 900.0);
  EXPECT_TRUE(check("fleet_document").pass);
  fleet_.tours[1].drone = "1";
  fleet_.tours[1].battery = 2;
  refused("drone 1, battery 2 has another vehicle than the other tours of its drone");
}

TEST_F(Fleets, ADocumentThatContradictsItselfOrItsFilesIsRefused) {
  const Fleet good = fleet_;
  const auto refused = [&](const std::string& said) {
    const Certificate certificate = judged();
    EXPECT_FALSE(certificate.checks.front().pass) << said;
    EXPECT_THAT(certificate.checks.front().detail, HasSubstr(said));
    for (std::size_t i = 1; i < certificate.checks.size(); ++i)
      EXPECT_FALSE(certificate.checks[i].skipped.empty());
    EXPECT_FALSE(certificate.feasible());
    fleet_ = good;
  };
  fleet_.tours[1].sha256 = "3";
  refused("is not the file that the fleet names");
  fleet_.tours[1].drone = "1";
  refused("is listed twice");
  fleet_.tours[1].file = "plan_1.json";
  refused("is flown twice");
  fleet_.tours[1].start = -1;
  refused("must start at 0 s or later");
  fleet_.tours[1].start = std::numeric_limits<double>::quiet_NaN();
  refused("must start at 0 s or later");
  fleet_.separation = -1;
  refused("separation");
  fleet_.seen_share = 0;
  refused("seen_share");
  fleet_.tours.clear();
  refused("there is no tour");
  const DigestFindings changed{.stated = true, .sha256 = "", .changed = {"tours[1]"}};
  EXPECT_THAT(judged(&changed).checks.front().detail, HasSubstr("changed after writing: tours[1]"));
  const DigestFindings none;
  EXPECT_FALSE(judged(&none).feasible());
  const std::vector<Plan> plans = plans_;
  Eigen::AlignedBox3d larger = plans_[1].task.scan->region.bounds();
  larger.max().x() += 1;
  plans_[1].task.scan->region = larger;
  refused("another region, camera or map");
  plans_ = plans;
  // Without the zone that the other tour keeps.
  Obstacle zone;
  zone.name = "school";
  zone.type = "box";
  zone.parameters.set("lower", Value(Value::List{-30.0, -30.0, 0.0}));
  zone.parameters.set("upper", Value(Value::List{-29.0, -29.0, 1.0}));
  plans_[0].environment.obstacles.push_back(zone);
  refused("drone 2, battery 1 keeps another margin");
  plans_ = plans;
  plans_[1].trajectory.samples.clear();
  refused("the document of drone 2, battery 1 does not hold");
}

}  // namespace
}  // namespace lapwing
