// SPDX-License-Identifier: Apache-2.0
#include "tests/mission/scene_fixture.h"

#include "framework/core/files.h"
#include "framework/geometry/mesh_builder.h"
#include "framework/geometry/mesh_file.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;
namespace fs = std::filesystem;

class ShippedScene : public testing::TestWithParam<const char*> {};

TEST_P(ShippedScene, IsSoundAndNoToy) {
  const GeneratedScene scene = shipped_scene(GetParam());
  EXPECT_EQ(scene.name, GetParam());
  EXPECT_GE(scene.mesh.triangles.size(), 20000u);
  EXPECT_LE(scene.mesh.triangles.size(), 1'000'000u);
  EXPECT_TRUE(scene.mesh.bounds().intersects(scene.region));
  EXPECT_GT(scene.region.sizes().minCoeff(), 2.5);
  // No triangle without area, and the most of them in the region.
  std::size_t inside = 0, flat = 0;
  for (std::size_t i = 0; i < scene.mesh.triangles.size(); ++i) {
    if (!(scene.mesh.area(i) > 1e-9)) ++flat;
    const Vector3d middle =
        (scene.mesh.corner(i, 0) + scene.mesh.corner(i, 1) + scene.mesh.corner(i, 2)) / 3;
    if (scene.region.contains(middle)) ++inside;
  }
  EXPECT_EQ(flat, 0u);
  EXPECT_GT(inside, 10000u);
}

TEST_P(ShippedScene, BelongsToItsSeed) {
  const std::string one = ply_bytes(shipped_scene(GetParam(), 7).mesh);
  EXPECT_TRUE(one == ply_bytes(shipped_scene(GetParam(), 7).mesh));
  EXPECT_FALSE(one == ply_bytes(shipped_scene(GetParam(), 8).mesh));
}

INSTANTIATE_TEST_SUITE_P(All, ShippedScene,
                         testing::Values("courtyard", "street", "church", "suburb", "downtown",
                                         "district", "towers", "town", "office", "arcade", "mine",
                                         "depot"),
                         [](const auto& entry) { return std::string(entry.param); });

// The measure itself, on bodies whose answer is known.
TEST(SeenShare, OfABlockNothingIsHidden) {
  MeshBuilder builder;
  builder.quad({-50, -50, 0}, {50, -50, 0}, {50, 50, 0}, {-50, 50, 0});
  builder.box({-10, -10, 0}, {10, 10, 12});
  const MeshScene scene(builder.take());
  const Eigen::AlignedBox3d region(Vector3d(-20, -20, -1), Vector3d(20, 20, 15));
  EXPECT_LT(unseen_share(scene, region, hemisphere(region, 75, 200), 20000), 0.02);
}

TEST(SeenShare, OfATableTheUndersideIsHidden) {
  MeshBuilder builder;
  builder.box({-20, -20, 5}, {20, 20, 5.5});
  const MeshScene scene(builder.take());
  const Eigen::AlignedBox3d region(Vector3d(-21, -21, 0), Vector3d(21, 21, 12));
  // The views' centre lies 6 m up, above the table.
  const double sides = 4 * 40 * 0.5, faces = 2 * 40 * 40;
  EXPECT_NEAR(unseen_share(scene, region, hemisphere(region, 75, 200), 20000),
              faces / 2 / (faces + sides), 0.03);
}

TEST(SeenShare, AFlightAroundMissesAQuarterOfStreetAndCourtyard) {
  for (const char* name : {"street", "courtyard"}) {
    const GeneratedScene made = shipped_scene(name);
    const MeshScene scene(made.mesh);
    const double unseen = unseen_share(scene, made.region, hemisphere(made.region, 75, 200), 60000);
    RecordProperty(name, std::to_string(unseen));
    EXPECT_GE(unseen, 0.25) << name;
    EXPECT_LE(unseen, 0.5) << name;
    std::printf("%s: %.1f %% of the surface is seen by none of 200 views\n", name, 100 * unseen);
  }
}

// The one shipped scene of simple geometry: a flight around sees nearly all of it.
TEST(SeenShare, OfTheTerraceNearlyNothingIsHidden) {
  const GeneratedScene made = shipped_scene("terrace");
  EXPECT_LE(made.mesh.triangles.size(), 2000u);
  EXPECT_FALSE(ply_bytes(made.mesh) == ply_bytes(shipped_scene("terrace", 8).mesh));
  const MeshScene scene(made.mesh);
  EXPECT_LE(unseen_share(scene, made.region, hemisphere(made.region, 75, 200), 60000), 0.02);
}

class SceneScripts : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("lapwing_scenes_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  GeneratedScene make(const std::string& body) const {
    write_file_atomically(folder_ / "own.lua",
                          "return function(options)\nlocal s = lapwing.scene { name = 'own' }\n" +
                              body + "\nreturn s\nend");
    return generate_scene(folder_ / "own.lua", Value(), scene_settings());
  }
  std::string error(const std::string& body) const {
    try {
      make(body);
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  }

  fs::path folder_;
};

TEST_F(SceneScripts, CallsReachTheBuilder) {
  const GeneratedScene scene = make(R"(
    s:color(10, 20, 30)
    s:box({0, 0, 0}, {1, 2, 3})
    s:push({10, 0, 0}, math.pi / 2, 2)
    s:quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0})
    s:pop()
    s:prism({{0, 0}, {1, 0}, {0, 1}}, 5, 6)
    s:tube({0, 0, 7}, {0, 0, 8}, 0.5, 0, 6)
    s:ball({0, 0, 20}, {1, 1, 1}, 1, 0.1)
    s:face {{0, 0, 30}, {1, 0, 30}, {0, 1, 30}}
    s:terrain({0, 0}, 1, 2, {40, 40, 40, 40})
    assert(s:triangles() == 12 + 2 + 8 + 12 + 80 + 1 + 2)
    assert(s:uniform(2, 3) >= 2)
    assert(s:integer(4, 4) == 4)
    s:region({0, 0, 0}, {1, 1, 1}))");
  EXPECT_EQ(scene.name, "own");
  EXPECT_EQ(scene.mesh.triangles.size(), 117u);
  EXPECT_EQ(scene.mesh.colors[0], (Rgb{10, 20, 30}));
  EXPECT_LT((scene.mesh.vertices[9] - Vector3d(10, 2, 0)).norm(), 1e-12);
  EXPECT_NEAR(scene.mesh.bounds().max().z(), 40, 1e-9);
}

TEST_F(SceneScripts, MistakesAreNamedWithTheirLine) {
  const std::pair<const char*, const char*> cases[] = {
      {"s:box({0, 0, 0}, {1, 0, 1})", "own.lua:3: lower must be below upper"},
      {"s:box({0, 0, 0}, {1, 0})", "box: expected a list of 3 numbers"},
      {"s:box({0, 0, 0}, {1, 0, 'x'})", "box: expected a list of 3 numbers"},
      {"s:box({0, 0, 0})", "box: expected a list of 3 numbers"},
      {"s:color(1, 2, 256)", "color: expected numbers from 0 to 255"},
      {"s:color(1, 2)", "color: expected a number, got no value"},
      {"s:pop()", "pop without a push"},
      {"for i = 1, 100 do s:push({0, 0, 0}) end", "deeper than 64"},
      {"s:face {{0, 0, 0}, {1, 0, 0}}", "at least three corners"},
      {"s:face {{0, 0, 0}, {1, 0, 0}, {1, 1, 1}, {0, 1, 0}}", "do not lie in one plane"},
      {"s:prism({{0, 0}, {1, 1}, {0, 1}, {1, 0}}, 0, 1)", "polygon"},
      {"s:tube({0, 0, 0}, {0, 0, 1}, 1, 1, 2.5)", "whole number"},
      {"s:ball({0, 0, 0}, {1, 1, 1}, 9)", "between 0 and 6"},
      {"s:terrain({0, 0}, 1, 3, {1, 2, 3, 4})", "two full rows"},
      {"s:region({0, 0, 0}, {0, 1, 1})", "region: lower must be below upper"},
      {"s:uniform(1, 1)", "uniform: expected"},
      {"s:cube()", "cube"},
      {"lapwing.scene {}", "name"},
      {"lapwing.scene { name = 'x', sede = 2 }", "seed"},
      {"s:region({0, 0, 0}, {1, 1, 1})", "no triangle"},
      {"s:box({0, 0, 0}, {1, 1, 1})", "no region of interest"},
      {"s:box({0, 0, 0}, {1, 1, 1}) s:region({0, 0, 0}, {1, 1, 1}) s:push({0, 0, 0})",
       "a push lacks its pop"},
  };
  for (const auto& [body, said] : cases) {
    EXPECT_NE(error(body).find(said), std::string::npos) << body << "\ngave: " << error(body);
  }
  write_file_atomically(folder_ / "own.lua", "return 3");
  EXPECT_THROW(generate_scene(folder_ / "own.lua", Value(), scene_settings()), InputError);
  write_file_atomically(folder_ / "own.lua", "return function() return 3 end");
  EXPECT_THROW(generate_scene(folder_ / "own.lua", Value(), scene_settings()), InputError);
  EXPECT_THROW(generate_scene(folder_ / "none.lua", Value(), scene_settings()), InputError);
}

}  // namespace
}  // namespace lapwing
