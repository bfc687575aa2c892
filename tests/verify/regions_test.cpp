// SPDX-License-Identifier: Apache-2.0
// Maps to keep away from and zones to stay in, and plans that cheat about them.
#include <gtest/gtest.h>
#include <unistd.h>

#include "framework/core/checksum.h"
#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/random.h"
#include "framework/map/map_file.h"
#include "framework/plugin/registry.h"
#include "framework/verify/blocked_voxels.h"
#include "framework/verify/verify.h"
#include "tests/verify/reference_plan.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;
namespace fs = std::filesystem;

std::uint16_t key(int v) {
  return static_cast<std::uint16_t>(kCenterKey + v);
}

class Regions : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("lapwing_regions_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    // Free from -10 to 10 m and 0 to 5 m up in voxels of 0.5 m, but for a post of one voxel across
    // at x = 0, y = 2, and a voxel that is as likely as not at x = 4, y = 2, z = 2.
    Value parameters = Value::map();
    parameters.set("resolution", 0.5);
    const Registry registry({fs::path(LAPWING_BUILD_DIR) / "lib/plugins"});
    map_ = registry.create<Map>("brick", parameters, "map");
    std::vector<VoxelLeaf> leaves;
    for (int x = -20; x < 20; ++x)
      for (int y = -20; y < 20; ++y)
        for (int z = 0; z < 10; ++z) {
          const bool post = x == 0 && y == 4, doubtful = x == 8 && y == 4 && z == 4;
          leaves.push_back({{key(x), key(y), key(z)}, 0, 0, post ? 2.0f : doubtful ? 0.0f : -2.0f});
        }
    map_->import(leaves);
    write_map_file(folder_ / "hall.ot", *map_);
    write_map_file(folder_ / "hall.bt", *map_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  Plan plan(const std::vector<Vector3d>& points) const {
    Plan plan;
    plan.mission = "hall";
    plan.kind = "scan";
    plan.vehicle = to_value(reference_vehicle());
    plan.trajectory.motion = path_motion();
    Sample sample;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (i > 0) sample.time += (points[i] - points[i - 1]).norm();
      sample.position = points[i];
      plan.trajectory.samples.push_back(sample);
    }
    plan.environment.margin = 0.5;
    return plan;
  }
  Plan in_hall(const std::vector<Vector3d>& points) const {
    Plan p = plan(points);
    p.environment.obstacles = {
        file_at("hall", "map", "hall.ot", sha256(read_file(folder_ / "hall.ot")))};
    return p;
  }
  Check check(const Plan& plan, const char* name) const {
    return *verify(plan, folder_).find(name);
  }

  fs::path folder_;
  std::shared_ptr<Map> map_;
};

TEST_F(Regions, DistancesToBlockedVoxelsAreExact) {
  const BlockedVoxels voxels(read_map_file(folder_ / "hall.ot"),
                             {Vector3d(-9, -9, 0.5), Vector3d(9, 9, 4.5)});
  const double known[3][2] = {{-9, 9.5}, {-9, 9.5}, {0.5, 5}};  // whole voxels of the box
  const auto to_box = [](const Vector3d& p, const Vector3d& low, const Vector3d& high) {
    return (low - p).cwiseMax(p - high).cwiseMax(0.0).norm();
  };
  Random random(4);
  for (int k = 0; k < 2000; ++k) {
    const Vector3d p(random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(0.5, 4.5));
    double expected =
        std::min(to_box(p, {0, 2, 0}, {0.5, 2.5, 5}), to_box(p, {4, 2, 2}, {4.5, 2.5, 2.5}));
    for (int i = 0; i < 3; ++i)
      expected = std::min({expected, p(i) - known[i][0], known[i][1] - p(i)});
    EXPECT_NEAR(voxels.distance(p, 2), std::min(expected, 2.0), 1e-9) << p.transpose();
  }
  EXPECT_EQ(voxels.distance({30, 0, 2}, 2), 0) << "unknown";
  EXPECT_THROW(
      BlockedVoxels(read_map_file(folder_ / "hall.bt"), {Vector3d(-1, -1, 1), Vector3d(1, 1, 2)}),
      InputError);
  EXPECT_THROW(BlockedVoxels(read_map_file(folder_ / "hall.ot"),
                             {Vector3d(-1e4, -1e4, -1e4), Vector3d(1e4, 1e4, 1e4)}),
               InputError);
}

// As the points of the way say, which are 2 mm apart.
TEST_F(Regions, WaysComeAsNearToBlockedVoxelsAsTheirPointsDo) {
  const BlockedVoxels voxels(read_map_file(folder_ / "hall.ot"),
                             {Vector3d(-9, -9, 0.5), Vector3d(9, 9, 4.5)});
  Random random(5);
  int near = 0;
  for (int k = 0; k < 300; ++k) {
    const auto place = [&] {
      return Vector3d(random.uniform(-10, 10), random.uniform(-10, 10), random.uniform(0, 5));
    };
    const Vector3d from = place(), to = k % 3 == 0 ? place() : Vector3d(from + 0.05 * place());
    const double farthest = random.uniform(0.1, 3), length = (to - from).norm();
    const int steps = 1 + static_cast<int>(length / 0.002);
    double least = farthest;
    for (int i = 0; i <= steps; ++i)
      least = std::min(least, voxels.distance(from + (to - from) * i / steps, farthest));
    const auto found = voxels.nearest(from, to, farthest);
    EXPECT_LE(found.distance, least + 1e-9) << k;
    EXPECT_GE(found.distance, least - length / steps) << k;
    if (found.distance < farthest) {
      ++near;
      EXPECT_NEAR(voxels.distance(from + found.share * (to - from), farthest), found.distance, 1e-9)
          << k;
    }
  }
  EXPECT_GT(near, 150);
}

// Chords that are left out because others came nearer change nothing.
TEST_F(Regions, TheClearanceOfALongWayIsThatOfItsPoints) {
  Random random(6);
  std::vector<Vector3d> points;
  for (int k = 0; k < 40; ++k)
    points.emplace_back(random.uniform(-9, 9), random.uniform(-9, 0.5), random.uniform(0.6, 4));
  const BlockedVoxels voxels(read_map_file(folder_ / "hall.ot"),
                             {Vector3d(-12, -12, -2), Vector3d(12, 12, 7)});
  double least = 10;
  for (std::size_t k = 1; k < points.size(); ++k)
    for (int i = 0; i <= 10000; ++i)
      least = std::min(
          least, voxels.distance(points[k - 1] + (points[k] - points[k - 1]) * i / 10000, least));
  EXPECT_NEAR(check(in_hall(points), "clearance").worst.value(), least, 2e-3);
}

TEST_F(Regions, MapsAreKeptAwayFrom) {
  const Check clear = check(in_hall({{-8, -5, 2}, {8, -5, 2}}), "clearance");
  EXPECT_TRUE(clear.pass);
  EXPECT_NEAR(clear.worst.value(), 2, 0.02) << "of walls and floor, which are unknown";
  // Past the post: between two samples, 0.3 m from it.
  const Check past = check(in_hall({{-8, 1.7, 3}, {2, 1.7, 3}}), "clearance");
  EXPECT_FALSE(past.pass);
  EXPECT_NEAR(past.worst.value(), 0.3, 0.01);
  EXPECT_NEAR(past.at, 8.25, 0.3);
  EXPECT_NE(past.detail.find("map 'hall'"), std::string::npos);
  // What is as likely as not blocks like what is occupied.
  EXPECT_FALSE(check(in_hall({{2, 1.7, 2.2}, {8, 1.7, 2.2}}), "clearance").pass);
  // And so does what nobody has seen.
  EXPECT_FALSE(check(in_hall({{8, 0, 2}, {12, 0, 2}}), "clearance").pass);
}

TEST_F(Regions, MapsMustBeWhatThePlanSays) {
  const auto said = [&](const Plan& p) {
    const Check document = check(p, "document");
    EXPECT_FALSE(document.pass);
    return document.detail;
  };
  Plan p = in_hall({{-8, -5, 2}, {8, -5, 2}});
  p.environment.obstacles[0].parameters.set("sha256", std::string(64, '0'));
  EXPECT_NE(said(p).find("has changed"), std::string::npos);
  for (const char* file : {"../hall.ot", "/etc/passwd", ""}) {
    p.environment.obstacles[0].parameters.set("file", file);
    EXPECT_NE(said(p).find("below the plan's folder"), std::string::npos) << file;
  }
  p.environment.obstacles[0] = file_at("gone", "map", "gone.ot", std::string(64, '0'));
  EXPECT_NE(said(p).find("gone.ot"), std::string::npos);
  p.environment.obstacles[0] =
      file_at("two", "map", "hall.bt", sha256(read_file(folder_ / "hall.bt")));
  EXPECT_NE(said(p).find("two states"), std::string::npos);
  write_file_atomically(folder_ / "broken.ot", "# Octomap OcTree file\nid OcTree\nsize 7\n");
  p.environment.obstacles[0] =
      file_at("broken", "map", "broken.ot", sha256(read_file(folder_ / "broken.ot")));
  EXPECT_NE(said(p).find("broken.ot"), std::string::npos);
}

TEST_F(Regions, FlightZonesAreStayedIn) {
  Plan p = plan({{-8, 0, 2}, {8, 0, 2}});
  EXPECT_NE(check(p, "flight_zone").skipped, "");
  p.environment.obstacles.push_back(
      flight_zone_at("field", {{-9, -9}, {9, -9}, {9, 9}, {-9, 9}}, 0, 10));
  EXPECT_TRUE(check(p, "flight_zone").pass);
  EXPECT_NEAR(check(p, "flight_zone").worst.value(), 1, 1e-3);
  p.environment.obstacles.back().parameters.set("ceiling", 2.4);
  EXPECT_FALSE(check(p, "flight_zone").pass) << "the margin counts below the ceiling too";
  // A notch between two samples that both lie inside.
  p.environment.obstacles.back() =
      flight_zone_at("notched", {{-9, -9}, {9, -9}, {9, 9}, {1, 9}, {0, -1}, {-1, 9}, {-9, 9}});
  const Check notched = check(p, "flight_zone");
  EXPECT_FALSE(notched.pass);
  EXPECT_LT(notched.worst.value(), 0.0);
  EXPECT_NEAR(notched.at, 8, 0.5);
  EXPECT_NE(notched.detail.find("flight zone 'notched'"), std::string::npos);
  // Every zone counts.
  p.environment.obstacles.back() = flight_zone_at("field", {{-9, -9}, {9, -9}, {9, 9}, {-9, 9}});
  p.environment.obstacles.push_back(flight_zone_at("far", {{90, 90}, {99, 90}, {99, 99}}));
  EXPECT_FALSE(check(p, "flight_zone").pass);
}

TEST_F(Regions, ZonesThatAreNoneAreRefused) {
  Plan p = plan({{-8, 0, 2}, {8, 0, 2}});
  p.environment.obstacles.emplace_back();
  const auto said = [&](Obstacle zone) {
    p.environment.obstacles.back() = std::move(zone);
    const Check document = check(p, "document");
    EXPECT_FALSE(document.pass);
    EXPECT_NE(document.detail.find("flight zone 'z'"), std::string::npos);
    return document.detail;
  };
  EXPECT_NE(said(flight_zone_at("z", {{0, 0}, {1, 0}})).find("three corners"), std::string::npos);
  EXPECT_NE(said(flight_zone_at("z", {{0, 0}, {2, 2}, {2, 0}, {0, 2}})).find("cross"),
            std::string::npos);
  EXPECT_NE(said(flight_zone_at("z", {{0, 0}, {2, 0}, {2, 2}}, 5, 4)).find("floor below"),
            std::string::npos);
  EXPECT_NE(said(flight_zone_at("z", {{0, 0}, {2, 0}, {NAN, 2}})).find("not finite"),
            std::string::npos);
}

TEST_F(Regions, ThePlanCarriesThem) {
  Plan p = in_hall({{-8, -5, 2}, {8, -5, 2}});
  p.environment.obstacles.push_back(
      flight_zone_at("field", {{-9, -9}, {9, -9}, {9, 9}, {-9, 9}}, 0));
  write_plan(p, folder_ / "plan.json");
  const Plan back = read_plan(folder_ / "plan.json");
  ASSERT_EQ(back.environment.obstacles.size(), 2u);
  EXPECT_EQ(back.environment.obstacles[0].parameters.at("file").as_text(), "hall.ot");
  EXPECT_EQ(back.environment.obstacles[1].side, Side::keep_inside);
  EXPECT_EQ(back.environment.obstacles[1].parameters.at("floor").as_number(), 0);
  EXPECT_EQ(back.environment.obstacles[1].parameters.find("ceiling"), nullptr);
  EXPECT_EQ(plan_text(back), plan_text(p));
  EXPECT_TRUE(verify(back, folder_).feasible());
}

}  // namespace
}  // namespace lapwing
