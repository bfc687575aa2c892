// SPDX-License-Identifier: Apache-2.0
// Films past meshes and through maps, and passage after passage.
#include "framework/geometry/mesh_builder.h"
#include "framework/geometry/mesh_file.h"
#include "framework/map/map_file.h"
#include "framework/plugin/registry.h"
#include "tests/missions/flown_film.h"

namespace lapwing {
namespace {

class PassageFilms : public Filming {
 protected:
  Flown film(const std::string& text, const std::string& more = "") {
    write_file_atomically(folder_ / "film.lua", text);
    return fly((folder_ / "film.lua").string(), more);
  }

  // A wall across the way with two windows. Behind the nearer one stands a screen, closed above and
  // below, so that the way through it turns twice within two metres.
  void write_wall() {
    MeshBuilder builder;
    const auto part = [&](double y0, double y1, double z0, double z1) {
      builder.box({-0.15, y0, z0}, {0.15, y1, z1});
    };
    part(-16, -1.2, 0, 14);
    part(-1.2, 1.2, 0, 1.8), part(-1.2, 1.2, 4.2, 14);
    part(1.2, 9, 0, 14);
    part(9, 13, 0, 1), part(9, 13, 6, 14);
    part(13, 20, 0, 14);
    builder.box({2.2, -4, 0.5}, {2.4, 4, 5.5});
    builder.box({0, -4, 0.5}, {2.4, 4, 0.7});
    builder.box({0, -4, 5.3}, {2.4, 4, 5.5});
    write_ply(builder.mesh(), folder_ / "wall.ply");
  }
};

constexpr const char* kWallFilm = R"(return require "mission.film".shot {
  name = "two windows", duration = 7.5, vehicle = "vehicles/solo",
  keyframes = { { time = 0, position = {-10, 0, 3} }, { time = 7.5, position = {10, 0, 3} } },
  obstacles = { { type = "mesh", file = "wall.ply" } },
  planner = { type = "bit_star", iterations = 20000 },
})";

TEST_F(PassageFilms, TheNearerWindowIsTooNarrowAtSpeed) {
  write_wall();
  const Flown flown = film(kWallFilm);
  EXPECT_EQ(flown.status, 0) << to_json(flown.result);
  const Plan plan = read_plan(flown.folder / "plan.json");
  ASSERT_EQ(plan.environment.obstacles.size(), 1u);
  EXPECT_EQ(plan.environment.obstacles[0].parameters.at("file").as_text(), "obstacle_1.ply");
  for (const Check& check : verify(plan, flown.folder).failures()) ADD_FAILURE() << to_line(check);
  // Through the other one.
  double north = 0;
  for (const Sample& s : plan.trajectory.samples)
    if (std::abs(s.position.x()) < 0.5) north = std::max(north, s.position.y());
  EXPECT_GT(north, 9);
  // What was tried, and why it failed, is in the answer, the log and the report.
  const auto& passages = flown.result.at("film").at("passages").as_list();
  ASSERT_GE(passages.size(), 2u);
  EXPECT_FALSE(passages.front().at("certified").as_boolean());
  EXPECT_FALSE(passages.front().at("why").as_text().empty());
  EXPECT_TRUE(passages.back().at("certified").as_boolean());
  EXPECT_EQ(passages.back().at("number").as_number(), 2);
  for (const char* file : {"run.log", "report.html"})
    EXPECT_NE(read_file(flown.folder / file).find("passage 1 of leg 1"), std::string::npos) << file;
}

TEST_F(PassageFilms, WithTimeTheNearerWindowWillDo) {
  write_wall();
  const Flown flown = film(kWallFilm, "--set duration=30 --set 'keyframes[2].time=30'");
  EXPECT_EQ(flown.status, 0) << to_json(flown.result);
  for (const Sample& s : read_plan(flown.folder / "plan.json").trajectory.samples)
    EXPECT_LT(std::abs(s.position.y()), 8);
}

TEST_F(PassageFilms, WherePassagesRunOutTheReasonsAreGiven) {
  write_wall();
  const Flown flown = film(kWallFilm,
                           "--set duration=5 --set 'keyframes[2].time=5' --set passages=1 "
                           "--set planner.iterations=3000");
  EXPECT_EQ(flown.status, 1);
  const auto& passages = flown.result.at("film").at("passages").as_list();
  ASSERT_GE(passages.size(), 2u) << to_json(flown.result);
  for (const Value& passage : passages) EXPECT_FALSE(passage.at("certified").as_boolean());
  EXPECT_GE(flown.result.at("notes").as_list().size(), passages.size());
}

TEST_F(PassageFilms, PlanAndFilesBelongTogether) {
  write_wall();
  const Flown flown = film(kWallFilm, "--set duration=30 --set 'keyframes[2].time=30'");
  ASSERT_EQ(flown.status, 0);
  const Plan plan = read_plan(flown.folder / "plan.json");
  // A wall that has moved since is another wall.
  MeshBuilder moved;
  moved.box({5, -40, 0}, {6, 40, 40});
  write_ply(moved.mesh(), flown.folder / "obstacle_1.ply");
  const Certificate changed = verify(plan, flown.folder);
  EXPECT_FALSE(changed.feasible());
  EXPECT_NE(changed.find("document")->detail.find("has changed"), std::string::npos);
  // The next run without it leaves no mesh behind.
  const Flown open = film(R"(return require "mission.film".shot { name = "open",
    keyframes = { { position = {-10, 0, 3} }, { position = {10, 0, 3} } } })");
  EXPECT_FALSE(fs::exists(open.folder / "obstacle_1.ply"));
}

TEST_F(PassageFilms, ThroughAMap) {
  // A hall of 28 x 12 x 7 m, known but for its walls, with a pillar across the straight way.
  const Registry registry({fs::path(LAPWING_BUILD_DIR) / "lib/plugins"});
  Value parameters = Value::map();
  parameters.set("resolution", 0.5);
  const auto map = registry.create<Map>("brick", parameters, "map");
  std::vector<VoxelLeaf> leaves;
  for (int x = -28; x < 28; ++x)
    for (int y = -12; y < 12; ++y)
      for (int z = 0; z < 14; ++z) {
        const bool pillar = x >= -3 && x < 3 && y >= -5 && y < 5;
        const auto key = [](int v) { return static_cast<std::uint16_t>(kCenterKey + v); };
        leaves.push_back({{key(x), key(y), key(z)}, 0, 0, pillar ? 2.0f : -2.0f});
      }
  map->import(leaves);
  write_map_file(folder_ / "hall.ot", *map);
  const Flown flown = film(R"(return require "mission.film".shot {
    name = "hall", duration = 16, vehicle = "vehicles/solo",
    keyframes = { { time = 0, position = {-10, 0, 3} }, { time = 16, position = {10, 0, 3} } },
    obstacles = { { type = "map", file = "hall.ot" } } })");
  EXPECT_EQ(flown.status, 0) << to_json(flown.result);
  const Plan plan = read_plan(flown.folder / "plan.json");
  ASSERT_EQ(plan.environment.obstacles.size(), 1u);
  EXPECT_EQ(plan.environment.obstacles[0].parameters.at("file").as_text(), "obstacle_1.ot");
  const Certificate certificate = verify(plan, flown.folder);
  for (const Check& check : certificate.failures()) ADD_FAILURE() << to_line(check);
  EXPECT_GE(certificate.find("clearance")->worst.value(), 0.499);
}

TEST_F(PassageFilms, FlightZonesAreKept) {
  // A bent zone: the straight way would leave it.
  const Flown flown = film(R"(return require "mission.film".shot {
    name = "bent zone", duration = 20, vehicle = "vehicles/solo",
    keyframes = { { time = 0, position = {-12, 0, 3} }, { time = 20, position = {12, 0, 3} } },
    flight_zones = { { name = "yard", floor = 0, ceiling = 20,
      corners = { {-15, -3}, {-3, -3}, {0, 8}, {3, -3}, {15, -3}, {15, 14}, {-15, 14} } } },
    volume = { lower = {-14, -10, 1}, upper = {14, 13, 9} } })");
  EXPECT_EQ(flown.status, 0) << to_json(flown.result);
  const Plan plan = read_plan(flown.folder / "plan.json");
  EXPECT_EQ(std::count_if(plan.environment.obstacles.begin(), plan.environment.obstacles.end(),
                          [](const Obstacle& o) { return o.side == Side::keep_inside; }),
            2);
  const Certificate certificate = verify(plan, flown.folder);
  EXPECT_GE(certificate.find("flight_zone")->worst.value(), 0.499);
  double north = 0;
  for (const Sample& s : plan.trajectory.samples) north = std::max(north, s.position.y());
  EXPECT_GT(north, 8.5);
}

class SlowPassageFilms : public PassageFilms {};

TEST_F(SlowPassageFilms, TheRealBuildingsMap) {
  const char* data = std::getenv("LAPWING_DATA");
  if (!data || !fs::exists(fs::path(data) / "maps/geb079.bt"))
    GTEST_SKIP() << "LAPWING_DATA names no folder with maps/geb079.bt";
  const Flown flown = film(R"(return require "mission.film".shot {
    name = "building 79", vehicle = "vehicles/solo", margin = 0.15,
    keyframes = { { position = {-5.88, -0.52, 2.12} }, { position = {-1.4, -0.68, 1} } },
    obstacles = { { type = "map", file = "geb079.bt" } } })",
                           "--data '" + std::string(data) + "'");
  EXPECT_EQ(flown.status, 0) << to_json(flown.result);
  const Plan plan = read_plan(flown.folder / "plan.json");
  for (const Check& check : verify(plan, flown.folder).failures()) ADD_FAILURE() << to_line(check);
}

}  // namespace
}  // namespace lapwing
