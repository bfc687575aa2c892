// SPDX-License-Identifier: Apache-2.0
// A graph changed for another region, zones or starts, against graphs made from the beginning.
#include "framework/view/changed_graph.h"

#include <gtest/gtest.h>

#include "tests/view/view_world.h"

namespace lapwing {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

// Half of everything that is seen near, a tenth of the rest.
class Near final : public ViewInformation {
 public:
  void contributions(std::span<const VoxelSight> sights, std::span<float> values) const override {
    for (std::size_t k = 0; k < sights.size(); ++k)
      values[k] = sights[k].distance < 9 ? 0.5f : 0.1f;
  }
};

// Closed where y is above a limit.
class Zoned final : public FreeSpace {
 public:
  Zoned(const FreeSpace& open, double most) : open_(open), most_(most) {}
  bool point_free(const Vector3d& p) const override {
    return p.y() <= most_ && open_.point_free(p);
  }
  bool segment_free(const Vector3d& a, const Vector3d& b) const override {
    return std::max(a.y(), b.y()) <= most_ && open_.segment_free(a, b);
  }
  bool swept_box_free(const Vector3d& a, const Vector3d& b, const Vector3d& half) const override {
    return std::max(a.y(), b.y()) + half.y() <= most_ && open_.swept_box_free(a, b, half);
  }
  AlignedBox3d bounds() const override { return open_.bounds(); }

 private:
  const FreeSpace& open_;
  double most_;
};

class ChangedGraphs : public ::testing::Test {
 protected:
  ChangedGraphs() {
    before_ = make_scan_graph(*space_, seeing(was_), Near(), {{{-5, 0, 5}, 0, 0}}, settings_);
  }

  VisibleVoxels seeing(const AlignedBox3d& region) const {
    return {map_, wall_face(), small_sight(region)};
  }
  ScanGraph changed(const AlignedBox3d& region, const FreeSpace& space,
                    const std::vector<Viewpoint>& starts = {},
                    const std::vector<Viewpoint>& pinned = {}) const {
    return changed_graph(before_, was_, pinned_before_, space, &space, seeing(region), Near(),
                         starts, pinned, settings_);
  }
  // What each view tells, as if it were looked from anew.
  void expect_scores(const ScanGraph& graph, const AlignedBox3d& region) const {
    const ScanGraph fresh =
        score_given_views(seeing(region), Near(), graph.candidates.viewpoints, 2);
    ASSERT_EQ(graph.voxels.size(), fresh.voxels.size());
    EXPECT_NEAR(graph.score->total(), fresh.score->total(), 1e-3);
    for (int k = 0; k < graph.score->views(); ++k)
      EXPECT_NEAR(graph.score->alone(k), fresh.score->alone(k), 1e-3) << k;
  }

  AlignedBox3d was_{Vector3d(4, -4, 0), Vector3d(6, 4, 9)};
  std::shared_ptr<Map> map_ = walled_room();
  std::unique_ptr<FreeSpace> space_ =
      free_in_both(free_space_of(std::shared_ptr<const Map>(map_)),
                   with_room(free_space_of(std::shared_ptr<const MeshScene>(wall_face())), 0.5));
  ScanGraphSettings settings_ = small_graph(was_);
  ScanGraph before_;
  std::vector<int> pinned_before_;
};

TEST_F(ChangedGraphs, NothingChangedIsTheGraphBefore) {
  const ScanGraph graph = changed(was_, *space_);
  ASSERT_EQ(graph.candidates.viewpoints.size(), before_.candidates.viewpoints.size());
  EXPECT_EQ(graph.candidates.given, before_.candidates.given);
  EXPECT_EQ(graph.voxels, before_.voxels);
  EXPECT_EQ(graph.score->total(), before_.score->total());
  ASSERT_EQ(graph.motions.motions.size(), before_.motions.motions.size());
  for (std::size_t k = 0; k < graph.motions.motions.size(); ++k)
    EXPECT_EQ(graph.motions.motions[k].points, before_.motions.motions[k].points);
}

TEST_F(ChangedGraphs, ViewsTellOfTheNewRegionWhatALookTells) {
  for (const AlignedBox3d& region :
       {AlignedBox3d(Vector3d(4, -4, 0), Vector3d(6, 0, 9)),     // less
        AlignedBox3d(Vector3d(4, -4, 0), Vector3d(6, 8, 9)),     // more
        AlignedBox3d(Vector3d(4, -1, 0), Vector3d(6, 7, 9))}) {  // moved
    const ScanGraph graph = changed(region, *space_);
    EXPECT_EQ(graph.candidates.viewpoints.size(), before_.candidates.viewpoints.size());
    expect_scores(graph, region);
  }
}

TEST_F(ChangedGraphs, ARegionThatNobodySeesIsSaid) {
  EXPECT_THROW(changed({Vector3d(4, 60, 0), Vector3d(6, 70, 9)}, *space_), NothingSeen);
}

TEST_F(ChangedGraphs, ViewsAndMotionsInAZoneAreLeftOut) {
  const Zoned zoned(*space_, 1);
  const ScanGraph graph = changed(was_, zoned);
  ASSERT_LT(graph.candidates.viewpoints.size(), before_.candidates.viewpoints.size());
  ASSERT_GT(graph.candidates.viewpoints.size(), 1u);
  ASSERT_FALSE(graph.motions.motions.empty());
  for (const Viewpoint& view : graph.candidates.viewpoints) EXPECT_LE(view.position.y(), 0.5);
  for (const ViewMotion& motion : graph.motions.motions) {
    EXPECT_LT(motion.a, motion.b);
    EXPECT_EQ(motion.points.front(),
              graph.candidates.viewpoints[static_cast<std::size_t>(motion.a)].position);
    EXPECT_EQ(motion.points.back(),
              graph.candidates.viewpoints[static_cast<std::size_t>(motion.b)].position);
    for (const Vector3d& p : motion.points) EXPECT_LE(p.y(), 0.5);
  }
  expect_scores(graph, was_);
}

// Behind the starts comes what was given before, then the pinned views.
// A view that was pinned stays once where it is pinned again, and goes where it is not.
TEST_F(ChangedGraphs, PinnedViewsOfBeforeAreNotGivenTwice) {
  before_.candidates.given = 2;
  pinned_before_ = {1};
  const Viewpoint pinned = before_.candidates.viewpoints[1];
  const ScanGraph kept = changed(was_, *space_, {}, {pinned});
  EXPECT_EQ(kept.candidates.given, 2);
  EXPECT_EQ(kept.candidates.viewpoints.size(), before_.candidates.viewpoints.size());
  EXPECT_EQ(kept.candidates.viewpoints[1].position, pinned.position);
  expect_scores(kept, was_);
  const ScanGraph without = changed(was_, *space_, {}, {});
  EXPECT_EQ(without.candidates.given, 1);
  EXPECT_EQ(without.candidates.viewpoints.size(), before_.candidates.viewpoints.size() - 1);
}

TEST_F(ChangedGraphs, AStartAndAPinnedViewAreJoined) {
  const Viewpoint start{{-4, -2, 4}, 0, 0}, pinned{{-3, 2, 4}, 0, 0};
  const ScanGraph graph = changed(was_, *space_, {start}, {pinned});
  EXPECT_EQ(graph.candidates.given, 3);
  EXPECT_EQ(graph.candidates.viewpoints[0].position, start.position);
  EXPECT_EQ(graph.candidates.viewpoints[1].position, before_.candidates.viewpoints[0].position);
  EXPECT_EQ(graph.candidates.viewpoints[2].position, pinned.position);
  for (const int view : {0, 2}) {
    int joined = 0;
    for (const ViewMotion& motion : graph.motions.motions)
      joined += motion.a == view || motion.b == view;
    EXPECT_GT(joined, 0) << view;
  }
  expect_scores(graph, was_);
}

TEST_F(ChangedGraphs, EndsWhenToldTo) {
  CancellationToken token;
  token.cancel();
  EXPECT_THROW(changed_graph(before_, was_, {}, *space_, nullptr, seeing(was_), Near(), {}, {},
                             settings_, &token),
               Cancelled);
}

}  // namespace
}  // namespace lapwing
