// SPDX-License-Identifier: Apache-2.0
// The graph that tours are planned on, against what its parts say one by one.
#include "framework/view/scan_graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "framework/core/error.h"
#include "tests/view/view_world.h"

namespace lapwing {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

// Half of everything that is seen squarely, a tenth of the rest.
class Halves final : public ViewInformation {
 public:
  void contributions(std::span<const VoxelSight> sights, std::span<float> values) const override {
    for (std::size_t k = 0; k < sights.size(); ++k)
      values[k] = sights[k].incidence && *sights[k].incidence < 0.7f ? 0.5f : 0.1f;
  }
};

struct World {
  std::shared_ptr<Map> map = walled_room();
  std::unique_ptr<FreeSpace> space =
      free_in_both(free_space_of(std::shared_ptr<const Map>(map)),
                   with_room(free_space_of(std::shared_ptr<const MeshScene>(wall_face())), 0.5));
  VisibleVoxels visible;
  ScanGraphSettings settings;

  explicit World(const AlignedBox3d& region = {Vector3d(4, -4, 0), Vector3d(6, 4, 9)})
      : visible(map, wall_face(), small_sight(region)), settings(small_graph(region)) {}
  ScanGraph graph(int threads = 2, const CancellationToken* cancellation = nullptr) {
    settings.threads = threads;
    return make_scan_graph(*space, visible, Halves(), {{{-5, 0, 5}, 0, 0}}, settings, cancellation);
  }
};

TEST(ScanGraph, VoxelsCountWhatTheirRegionWeighs) {
  World world;
  SightSettings sight = small_sight({Vector3d(4, -4, 0), Vector3d(6, 4, 9)});
  sight.region =
      InterestRegion(std::vector{RegionPrism{.name = "left",
                                             .outline = {{4, -4}, {6, -4}, {6, -1}, {4, -1}},
                                             .holes = {},
                                             .low = 0,
                                             .high = 9,
                                             .weight = 4},
                                 RegionPrism{.name = "right",
                                             .outline = {{4, 1}, {6, 1}, {6, 4}, {4, 4}},
                                             .holes = {},
                                             .low = 0,
                                             .high = 9,
                                             .weight = 0.5}});
  const VisibleVoxels weighted(world.map, wall_face(), sight);
  const ScanGraph graph =
      make_scan_graph(*world.space, weighted, Halves(), {{{-5, 0, 5}, 0, 0}}, world.settings);
  ASSERT_EQ(graph.score->views(), 40);
  std::map<double, int> voxels;
  for (std::size_t v = 0; v < graph.voxels.size(); ++v) {
    const double y = world.map->grid().center(graph.voxels[v]).y();
    EXPECT_GT(std::abs(y), 1) << "what lies between the regions counts nothing";
    const double weight = y < 0 ? 4 : 0.5;
    EXPECT_NEAR(graph.score->capacities()[v] * graph.score->unit(), weight, 1e-5);
    ++voxels[weight];
  }
  EXPECT_GT(voxels[4], 20);
  EXPECT_GT(voxels[0.5], 20);
  for (int view = 0; view < graph.score->views(); ++view) {
    const std::vector<SeenVoxel> seen =
        weighted.seen_from(graph.candidates.viewpoints[static_cast<std::size_t>(view)]);
    const std::vector<float> told = contributions_of(seen, Halves());
    double sum = 0;
    for (std::size_t i = 0; i < seen.size(); ++i) sum += told[i] * weighted.weight(seen[i].voxel);
    EXPECT_NEAR(graph.score->alone(view), sum, 1e-4 * (1 + sum));
  }
}

TEST(ScanGraph, ScoresWhatEveryViewSees) {
  World world;
  const ScanGraph graph = world.graph();
  ASSERT_EQ(graph.score->views(), 40);
  ASSERT_EQ(graph.voxels.size(), graph.score->voxels());
  for (int view = 0; view < graph.score->views(); ++view) {
    const Viewpoint& at = graph.candidates.viewpoints[static_cast<std::size_t>(view)];
    const std::vector<SeenVoxel> seen = world.visible.seen_from(at);
    const std::vector<float> told = contributions_of(seen, Halves());
    std::map<VoxelKey, double> expected, found;
    for (std::size_t i = 0; i < seen.size(); ++i) expected[seen[i].voxel] = told[i];
    const auto voxels = graph.score->voxels_of(view);
    const auto amounts = graph.score->amounts_of(view);
    for (std::size_t i = 0; i < voxels.size(); ++i)
      found[graph.voxels[voxels[i]]] = amounts[i] * graph.score->unit();
    ASSERT_EQ(found.size(), expected.size());
    for (const auto& [voxel, amount] : expected) EXPECT_NEAR(found.at(voxel), amount, 1e-5);
  }
  std::set<VoxelKey> all(graph.voxels.begin(), graph.voxels.end());
  EXPECT_EQ(all.size(), graph.voxels.size()) << "a voxel has two numbers";
}

TEST(ScanGraph, DoesNotDependOnThreads) {
  World world;
  const ScanGraph one = world.graph(1), three = world.graph(3);
  EXPECT_EQ(one.voxels, three.voxels);
  ASSERT_EQ(one.motions.motions.size(), three.motions.motions.size());
  for (int view = 0; view < one.score->views(); ++view) {
    const auto a = one.score->amounts_of(view), b = three.score->amounts_of(view);
    EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end()));
  }
}

TEST(ScanGraph, KeepsARoomFromTheMeshAndJoinsViews) {
  World world;
  const ScanGraph graph = world.graph();
  for (const Viewpoint& v : graph.candidates.viewpoints)
    if (std::abs(v.position.y()) < 4 && v.position.x() < 5) {
      EXPECT_LE(v.position.x(), 5 - 0.5 - 0.5 + 1e-9) << "half a body and half a metre";
    }
  EXPECT_GT(graph.motions.motions.size(), 20u);
  EXPECT_GT(graph.motions.unmatched, 0);
}

TEST(ScanGraph, ARegionThatNobodySeesIsSaid) {
  World world(AlignedBox3d(Vector3d(30, 30, 0), Vector3d(33, 33, 3)));
  try {
    world.graph();
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("sees the region of interest"));
  }
}

TEST(ScanGraph, EndsWhenToldTo) {
  World world;
  CancellationToken token;
  token.cancel();
  EXPECT_THROW(world.graph(2, &token), Cancelled);
}

TEST(RoomySpace, IsSmallerOnEverySide) {
  const auto wide = free_space_of(std::shared_ptr<const MeshScene>(wall_face()));
  const auto narrow = with_room(free_space_of(std::shared_ptr<const MeshScene>(wall_face())), 1);
  const Vector3d half(0.5, 0.5, 0.5);
  for (double x = 2; x < 8; x += 0.1) {
    const Vector3d p(x, 0, 5);
    EXPECT_EQ(wide->swept_box_free(p, p, half), std::abs(x - 5) >= 0.5 - 1e-9) << x;
    EXPECT_EQ(narrow->swept_box_free(p, p, half), std::abs(x - 5) >= 1.5 - 1e-9) << x;
    EXPECT_EQ(narrow->point_free(p), std::abs(x - 5) >= 1 - 1e-9) << x;
    EXPECT_EQ(narrow->segment_free(p, p), std::abs(x - 5) >= 1 - 1e-9) << x;
  }
}

}  // namespace
}  // namespace lapwing
