// SPDX-License-Identifier: Apache-2.0
// Meshes whose coordinates are no metres near the origin, and meshes that only look so.
#include "framework/geometry/mesh_doubts.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <fstream>

#include "framework/core/error.h"
#include "framework/geometry/mesh_builder.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;
namespace fs = std::filesystem;

class MeshDoubts : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("mesh_doubts_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  // Every coordinate times `scale`, then moved.
  fs::path write(const TriangleMesh& mesh, double scale = 1,
                 const Vector3d& moved = Vector3d::Zero()) const {
    std::ofstream file(folder_ / "mesh.obj");
    file.precision(12);
    for (const Vector3d& v : mesh.vertices) {
      const Vector3d p = scale * v + moved;
      file << "v " << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
    }
    for (const auto& t : mesh.triangles)
      file << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
    return folder_ / "mesh.obj";
  }
  std::string refusal(const fs::path& file) const {
    try {
      read_mesh(file);
    } catch (const InputError& error) {
      return error.what();
    }
    return "was read";
  }

  fs::path folder_;
};

// 12 m x 10 m x 7 m.
TriangleMesh house() {
  MeshBuilder builder;
  builder.box({-6, -5, 0}, {6, 5, 7});
  return builder.take();
}

// 900 m x 700 m: halls of 30 m and two chimneys of 180 m.
TriangleMesh works() {
  MeshBuilder builder;
  builder.quad({0, 0, 0}, {900, 0, 0}, {900, 700, 0}, {0, 700, 0});
  for (const double x : {50.0, 350.0, 650.0}) builder.box({x, 100, 0}, {x + 200, 600, 30});
  for (const double x : {300.0, 600.0}) builder.box({x, 300, 0}, {x + 12, 312, 180});
  return builder.take();
}

// 2 km x 2 km with a relief of 800 m, and no wall.
TriangleMesh mountains() {
  MeshBuilder builder;
  const auto at = [](int i, int j) {
    return Vector3d(50.0 * i, 50.0 * j, 400 + 400 * std::sin(0.2 * i) * std::cos(0.17 * j));
  };
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j) {
      builder.face(std::array{at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      builder.face(std::array{at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return builder.take();
}

TEST_F(MeshDoubts, ABuildingInCentimetresOrMillimetresIsToldWithItsUnit) {
  EXPECT_EQ(read_mesh(write(house())).doubt, "");
  const MeshFile large = read_mesh(write(house(), 100));
  EXPECT_THAT(large.doubt, HasSubstr("its walls stand 700 m tall on 1200 x 1000 m"));
  EXPECT_THAT(large.doubt, HasSubstr("if it is in centimetres (7 m then)"));
  EXPECT_THAT(large.doubt, HasSubstr("state its unit (unit = 0.01), or convert it to metres"));
  EXPECT_THAT(read_mesh(write(house(), 1000)).doubt,
              HasSubstr("if it is in millimetres (7 m then), state its unit (unit = 0.001)"));
  // Who states the unit is believed.
  EXPECT_EQ(read_mesh(write(house(), 100), {.unit = 0.01}).doubt, "");
  EXPECT_EQ(read_mesh(write(house(), 100), {.unit = 1}).doubt, "");
  EXPECT_THAT(read_mesh(write(house(), 0.01)).doubt, HasSubstr("it is 0.12 m large"));
}

TEST_F(MeshDoubts, ALargeSiteInMetresIsNone) {
  EXPECT_EQ(read_mesh(write(works())).doubt, "");
  EXPECT_EQ(read_mesh(write(mountains())).doubt, "");
  MeshBuilder tower;  // of 240 m, by itself
  tower.box({0, 0, 0}, {30, 30, 240});
  EXPECT_EQ(read_mesh(write(tower.take())).doubt, "");
  // A map's own frame may have its origin a few kilometres away.
  EXPECT_EQ(read_mesh(write(works(), 1, {3000, 2000, 0})).doubt, "");
  if (const char* data = std::getenv("LAPWING_DATA")) {
    for (const auto& entry : fs::directory_iterator(fs::path(data) / "meshes"))
      EXPECT_EQ(read_mesh(entry.path(),
                          {.up = entry.path().stem() == "edgar_mine" ? std::optional(UpAxis::y)
                                                                     : std::nullopt})
                    .doubt,
                "")
          << entry.path();
  }
}

TEST_F(MeshDoubts, CoordinatesOfAGridOfTheLandAreToldOrRefused) {
  // UTM: beyond what single precision keeps.
  const std::string utm = refusal(write(house(), 1, {465000, 5247000, 410}));
  EXPECT_THAT(utm, HasSubstr("mesh.obj': it lies between (464994, 524699"));
  EXPECT_THAT(utm, HasSubstr("a map grid (such as UTM)"));
  EXPECT_THAT(utm, HasSubstr("single precision resolves them to 0.63 m. Subtract a corner"));
  // Nearer, it can be read: 5 mm are lost.
  const MeshFile near = read_mesh(write(house(), 1, {85000, 40000, 0}));
  EXPECT_THAT(near.doubt, HasSubstr("resolves them to 0.01 m. Subtract a corner"));
  // Too large, not too far: another unit.
  const std::string large = refusal(write(house(), 20000));
  EXPECT_THAT(large, HasSubstr("one unit of the file is read as 1 m; if it is in millimetres"));
  EXPECT_EQ(large.find("UTM"), std::string::npos) << large;
}

}  // namespace
}  // namespace lapwing
