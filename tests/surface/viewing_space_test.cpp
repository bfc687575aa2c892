// SPDX-License-Identifier: Apache-2.0
#include "framework/surface/viewing_space.h"

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/surface/reconstruction.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

void add_quad(TriangleMesh& mesh, const Vector3d& a, const Vector3d& u, const Vector3d& v) {
  const auto first = static_cast<std::int32_t>(mesh.vertices.size());
  for (const Vector3d& p : {a, Vector3d(a + u), Vector3d(a + u + v), Vector3d(a + v)})
    mesh.vertices.push_back(p);
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

// Five faces of a box without the front (-y) and without a floor.
void add_open_box(TriangleMesh& mesh, const Vector3d& low, const Vector3d& high) {
  const Vector3d size = high - low, x(size.x(), 0, 0), y(0, size.y(), 0), z(0, 0, size.z());
  add_quad(mesh, low + z, x, y);
  add_quad(mesh, low, y, z);
  add_quad(mesh, low + x, y, z);
  add_quad(mesh, low + y, x, z);
}

// A hall, 10 m x 8 m x 5 m within, its walls 0.4 m thick, with an opening of `wide` x `high` metres
// in the middle of its front; 0: closed.
std::shared_ptr<const MeshScene> hall(double wide, double high) {
  TriangleMesh mesh;
  add_quad(mesh, {-40, -40, 0}, {80, 0, 0}, {0, 80, 0});
  add_open_box(mesh, {-5, -4, 0}, {5, 4, 5});
  add_open_box(mesh, {-5.4, -4.4, 0}, {5.4, 4.4, 5.4});
  for (const double at : {0.0, 0.4}) {
    const double half = 5 + at, y = -4 - at, top = 5 + at;
    add_quad(mesh, {-half, y, 0}, {half - wide / 2, 0, 0}, {0, 0, top});
    add_quad(mesh, {wide / 2, y, 0}, {half - wide / 2, 0, 0}, {0, 0, top});
    if (wide > 0) add_quad(mesh, {-wide / 2, y, high}, {wide, 0, 0}, {0, 0, top - high});
  }
  return std::make_shared<const MeshScene>(mesh);
}

ViewingSettings around_hall() {
  ViewingSettings settings;
  settings.room = {Vector3d(-15, -15, 1), Vector3d(15, 15, 14)};
  return settings;
}

const std::vector<Vector3d> kAbove{{0, 0, 12}};

const Vector3d kOuterWall(3, -4.4, 2), kInnerFront(3, -4, 2), kBackWall(0.1, 4, 2), kUp(0, 0, 1),
    kAcross(0, 1, 0);

TEST(ViewingSpace, InnerFacesOfAClosedHallCannotBeSeen) {
  const ViewingSpace space(hall(0, 0), around_hall(), kAbove, 2);
  EXPECT_TRUE(space.sees(kOuterWall, kAcross));
  EXPECT_TRUE(space.sees(kOuterWall, -kAcross)) << "either side of a face is tried";
  EXPECT_TRUE(space.sees({1, 1, 5.4}, kUp));
  EXPECT_FALSE(space.sees(kInnerFront, kAcross));
  EXPECT_FALSE(space.sees(kBackWall, kAcross)) << "of a hall that nobody comes into";
  EXPECT_FALSE(space.sees({1, 1, 5}, kUp));
  EXPECT_FALSE(space.sees({1, 1, 0}, kUp)) << "the floor within";
  EXPECT_TRUE(space.sees({9, 1, 0}, kUp)) << "the ground outside";
}

TEST(ViewingSpace, ThroughAnOpeningThatNobodyFitsThroughWhatLiesBehindItIsSeen) {
  const ViewingSpace space(hall(1, 2.5), around_hall(), kAbove, 1);
  EXPECT_TRUE(space.sees(kBackWall, kAcross)) << "from before the opening";
  EXPECT_FALSE(space.sees(kInnerFront, kAcross)) << "only from within";
}

TEST(ViewingSpace, ThroughAnOpeningThatTheVehicleFitsThroughItSeesFromWithin) {
  const ViewingSpace narrow(hall(1, 2.5), around_hall(), kAbove, 1);
  const ViewingSpace wide(hall(4, 4.5), around_hall(), kAbove, 1);
  EXPECT_TRUE(wide.sees(kInnerFront, kAcross));
  EXPECT_GT(wide.free_volume(), narrow.free_volume() + 50);
}

TEST(ViewingSpace, RangeAndAngleLimitWhatIsSeen) {
  ViewingSettings settings = around_hall();
  settings.room = {Vector3d(-15, -15, 11), Vector3d(15, 15, 14)};  // high above the roof
  settings.range = 4;
  const ViewingSpace near(hall(0, 0), settings, kAbove, 1);
  EXPECT_FALSE(near.sees({0, 0, 5.4}, kUp)) << "6 m below the lowest place";
  settings.range = 30;
  const ViewingSpace far(hall(0, 0), settings, kAbove, 1);
  EXPECT_TRUE(far.sees({0, 0, 5.4}, kUp));
  EXPECT_TRUE(far.sees(kOuterWall, kAcross)) << "9 m below, 11 m away: 51 degrees";
  settings.incidence = 0.5;
  const ViewingSpace steep(hall(0, 0), settings, kAbove, 1);
  EXPECT_TRUE(steep.sees({0, 0, 5.4}, kUp));
  EXPECT_FALSE(steep.sees(kOuterWall, kAcross));
}

TEST(ViewingSpace, RefusesWhatMakesNoSense) {
  ViewingSettings settings = around_hall();
  EXPECT_THROW(ViewingSpace(hall(0, 0), settings, std::vector<Vector3d>{{5, 0, 2}, {90, 0, 2}}, 1),
               InputError)
      << "the body does not fit at the first, the second lies outside";
  settings.room = {};
  EXPECT_THROW(ViewingSpace(hall(0, 0), settings, kAbove, 1), InputError);
  settings = around_hall();
  settings.room.max().x() = 1e7;
  EXPECT_THROW(ViewingSpace(hall(0, 0), settings, kAbove, 1), InputError);
  settings = around_hall();
  settings.step = 0;
  EXPECT_THROW(ViewingSpace(hall(0, 0), settings, kAbove, 1), InputError);
}

TEST(CountedSurface, RecallIsOfWhatCounts) {
  const auto scene = hall(0, 0);
  ReconstructionSettings settings;
  settings.region = {Vector3d(-6, -5, 0.5), Vector3d(-3, 5, 6)};  // one end of it
  SurfaceSample sample(scene->mesh(), settings, 2);
  const GridPoints all = sample.points();
  EXPECT_EQ(sample.counted_share(), 1);
  EXPECT_EQ(sample.score(all, 1).recall, 1);
  // Counting all of it changes nothing.
  const auto whole = sample.counted(
      scene->mesh(), [](const Vector3d&, const Vector3d&) { return true; }, 2);
  EXPECT_EQ(std::count(whole.begin(), whole.end(), true), static_cast<long>(all.size()));
  const ViewingSpace space(scene, around_hall(), kAbove, 2);
  const auto sees = [&](const Vector3d& p, const Vector3d& n) { return space.sees(p, n); };
  const std::vector<bool> counted = sample.counted(scene->mesh(), sees, 2);
  EXPECT_EQ(counted, sample.counted(scene->mesh(), sees, 1)) << "for any number of threads";
  sample.count_only(counted);
  // Outer faces: two of 2.4 m, one of 8.8 m, 4.9 m high within the region, and the roof; inner ones
  // are 2 m and 8 m, 4.5 m high, and a ceiling.
  const double outer = (2 * 2.4 + 8.8) * 4.9 + 2.4 * 8.8, inner = (2 * 2 + 8) * 4.5 + 2 * 8.0;
  EXPECT_NEAR(sample.counted_share(), outer / (outer + inner), 0.02);
  GridPoints outside;
  for (std::size_t k = 0; k < all.size(); ++k)
    if (counted[k]) outside.push_back(all[k]);
  const ReconstructionScore score = sample.score(outside, 1);
  EXPECT_EQ(score.recall, 1);
  EXPECT_EQ(score.surface_points, static_cast<std::int64_t>(outside.size()));
  EXPECT_EQ(sample.score(all, 1).precision, 1) << "of all of the surface";
  EXPECT_THROW(sample.count_only(std::vector<bool>(3, true)), InputError);
  EXPECT_THROW(sample.count_only(std::vector<bool>(all.size(), false)), InputError);
}

}  // namespace
}  // namespace lapwing
