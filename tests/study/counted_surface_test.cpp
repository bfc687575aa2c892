// SPDX-License-Identifier: Apache-2.0
#include "framework/study/counted_surface.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include "framework/core/error.h"
#include "framework/core/files.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

// A slab on the ground: what lies beneath it cannot be seen.
std::shared_ptr<const MeshScene> slab() {
  TriangleMesh mesh;
  const auto face = [&](const Vector3d& a, const Vector3d& u, const Vector3d& v) {
    const auto first = static_cast<std::int32_t>(mesh.vertices.size());
    for (const Vector3d& p : {a, Vector3d(a + u), Vector3d(a + u + v), Vector3d(a + v)})
      mesh.vertices.push_back(p);
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  };
  const Vector3d x(4, 0, 0), y(0, 4, 0), z(0, 0, 1);
  face({-2, -2, 0}, x, y);
  face({-2, -2, 1}, x, y);
  for (const Vector3d& corner : {Vector3d(-2, -2, 0), Vector3d(-2, 2, 0)}) face(corner, x, z);
  for (const Vector3d& corner : {Vector3d(-2, -2, 0), Vector3d(2, -2, 0)}) face(corner, y, z);
  return std::make_shared<const MeshScene>(mesh);
}

class CountedSurfaceFile : public ::testing::Test {
 protected:
  CountedSurfaceFile() {
    fs::remove_all(folder_);
    judge_.region = {Vector3d(-3, -3, -0.5), Vector3d(3, 3, 2)};
    viewing_.room = {Vector3d(-8, -8, 0.5), Vector3d(8, 8, 8)};
  }
  ~CountedSurfaceFile() override { fs::remove_all(folder_); }

  double counted_share() {
    SurfaceSample sample(surface_->mesh(), judge_, 1);
    said_.clear();
    const std::vector<Vector3d> from{{0, 0, 6}};
    count_visible(sample, surface_, judge_, viewing_, from, folder_, "slab", 1,
                  [&](const std::string& line) { said_.push_back(line); });
    return sample.counted_share();
  }
  std::vector<fs::path> files() const {
    std::vector<fs::path> all;
    for (const auto& item : fs::directory_iterator(folder_)) all.push_back(item.path());
    return all;
  }

  fs::path folder_ =
      fs::temp_directory_path() / ("lapwing_counted_surface_" + std::to_string(::getpid()));
  std::shared_ptr<const MeshScene> surface_ = slab();
  ReconstructionSettings judge_;
  ViewingSettings viewing_;
  std::vector<std::string> said_;
};

TEST_F(CountedSurfaceFile, IsMadeOnceAndReadAgain) {
  const double share = counted_share();
  EXPECT_NEAR(share, 32.0 / 48, 0.02) << "the top and four sides, not the bottom";
  ASSERT_EQ(said_.size(), 2u);
  EXPECT_NE(said_[1].find("within 30 m and 75 degrees"), std::string::npos) << said_[1];
  ASSERT_EQ(files().size(), 1u);
  EXPECT_EQ(counted_share(), share);
  EXPECT_EQ(said_.size(), 1u) << "it was read";
}

TEST_F(CountedSurfaceFile, OfOtherLimitsIsAnotherFile) {
  const double share = counted_share();
  // The vehicle's middle comes to 0.5 m of the top, and to 1 m of the sides: of these, their upper
  // edges are seen.
  judge_.range = 0.8;
  const double near = counted_share();
  EXPECT_GT(near, 16.0 / 48);
  EXPECT_LT(near, 22.0 / 48);
  EXPECT_LT(near, share);
  viewing_.body = {0.5, 0.5, 0.2};
  counted_share();
  EXPECT_EQ(files().size(), 3u);
}

TEST_F(CountedSurfaceFile, DamagedIsRefused) {
  counted_share();
  const fs::path file = files().front();
  const std::string whole = read_file(file);
  std::string changed = whole;
  changed.back() ^= 1;
  for (const std::string& text : {changed, whole.substr(0, whole.size() - 1), std::string(),
                                  std::string("lapwing"), whole + "x"}) {
    write_file_atomically(file, text);
    EXPECT_THROW(counted_share(), InputError);
  }
  fs::remove(file);
  counted_share();
  EXPECT_EQ(read_file(file), whole) << "the same bytes again";
}

}  // namespace
}  // namespace lapwing
