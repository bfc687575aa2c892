// SPDX-License-Identifier: Apache-2.0
// What a viewer asks about a planned scan is what planning itself has and what the report shows.
#include "framework/mission/scan_look.h"

#include <map>
#include <set>

#include "framework/export/scan_report.h"
#include "tests/mission/hut_scene.h"
#include "tests/mission/mission_fixture.h"

namespace lapwing {
namespace {

class ScanLook : public MissionTest {
 protected:
  void SetUp() override { write_hut_scene(folder_); }
  MissionResult planned(const std::string& more = "") {
    write_file_atomically(folder_ / "hut.lua", R"(
return require("mission.scan").of_scene {
  name = "hut", scene = "hut", resolution = 0.5, range = 30, reach = 8,
  map = { type = "brick", observations = true },
  tour = { budget = 60, iterations = 60 }, usable = { range = 30 },
  camera = { width = 80, height = 60, focal = 46 }, safe_height = 9,
  surface = { spacing = 0.8, cell = 1, trim = 2 },
  candidates = { most = 60, step = 2.5, distance_apart = 2 },
  motions = { alpha = 0.3, coarse = 40 },
)" + more + "}\n");
    MissionSettings own = settings();
    own.keep_tours = true;
    mission_ = std::make_unique<Mission>(folder_ / "hut.lua", own);
    mission_->configure({}, {});
    return mission_->plan();
  }

  std::unique_ptr<Mission> mission_;
};

// What a view tells of is what the score holds of it, and its motions are those of the graph.
void expect_views(const ScanWork& work) {
  std::size_t ways = 0;
  for (int view = 0; view < work.graph.score->views(); view += 3) {
    const ViewLook look = look_from_view(work, view);
    EXPECT_EQ(look.score, work.graph.score->alone(view));
    std::set<VoxelKey> told, scored;
    double sum = 0;
    for (const VoxelShare& voxel : look.told) {
      told.insert(voxel.voxel);
      sum += voxel.share;
    }
    for (const std::uint32_t number : work.graph.score->voxels_of(view))
      scored.insert(work.graph.voxels[number]);
    EXPECT_EQ(told, scored);
    EXPECT_NEAR(sum, look.score, 1e-3);
    for (const WayToView& way : look.ways) {
      EXPECT_EQ(way.points.front(), look.view.position);
      EXPECT_EQ(way.points.back(),
                work.graph.candidates.viewpoints[static_cast<std::size_t>(way.view)].position);
      EXPECT_EQ(way.seconds, work.leg_seconds(view, way.view));
    }
    ways += look.ways.size();
  }
  EXPECT_GT(ways, 20u);
}

// Of every voxel what its images tell is the coverage of the report, to the last bit.
TEST_F(ScanLook, AVoxelIsSeenAsTheReportCountsIt) {
  const MissionResult result = planned();
  ASSERT_TRUE(result.kept && result.scan);
  expect_views(*result.kept->work);
  const KeptTour& tour = *result.kept;
  const auto& views = result.plan.task.scan->views;
  ASSERT_EQ(tour.images.size(), views.size());
  for (std::size_t k = 0; k < views.size(); ++k)
    EXPECT_EQ(
        tour.work->graph.candidates.viewpoints[static_cast<std::size_t>(tour.images[k])].position,
        views[k].position);
  std::size_t seen = 0, counted = 0;
  for (const VoxelShare& voxel : result.scan->coverage) {
    const VoxelLook look = look_at_voxel({&tour, 1}, voxel.voxel, 2);
    ASSERT_EQ(look.share, voxel.share);
    EXPECT_EQ(look.images.empty(), voxel.share == 0);
    EXPECT_EQ(look.weight, 1);
    EXPECT_NE(look.reading.state, VoxelState::free);
    seen += look.images.size();
    counted += look.reading.observations > 0;
    for (const ImageOfVoxel& image : look.images)
      EXPECT_NEAR(
          image.sight.distance,
          (views[image.image].position - result.scan->map->grid().center(voxel.voxel)).norm(),
          1e-4);
  }
  EXPECT_GT(seen, result.scan->coverage.size() / 4);
  EXPECT_GT(counted, 100u);
}

// Zones, the hut, what was not measured, a ball where views are forbidden: each place says its own.
TEST_F(ScanLook, PlacesThatAreLeftOutSayWhy) {
  const MissionResult result = planned(R"(
  no_fly_zones = { { name = "school", corners = {{8, -4}, {14, -4}, {14, 4}, {8, 4}} } },
  flight_zones = { { name = "yard", corners = {{-13, -12}, {16, -12}, {16, 12}, {-13, 12}} } },
  forbidden = { { position = {-8, 0, 8}, within = 3 } },
)");
  const ScanWork& work = *result.kept->work;
  const LeftOut left = left_out_of({result.kept.get(), 1}, 2);
  EXPECT_EQ(left.beyond, 0);
  std::map<LeftOutReason, int> counts;
  std::set<std::vector<double>> candidates;
  for (const Viewpoint& v : work.graph.candidates.viewpoints)
    candidates.insert({v.position.x(), v.position.y(), v.position.z()});
  for (const LeftOutPlace& place : left.places) {
    ++counts[place.why];
    const Eigen::Vector3d& p = place.position;
    const bool is_candidate = candidates.contains({p.x(), p.y(), p.z()});
    EXPECT_EQ(is_candidate, place.why >= LeftOutReason::nothing) << to_string(place.why);
    if (place.why == LeftOutReason::no_fly) {
      EXPECT_GT(p.x() + work.body.x(), 8 - 2);
    }
    if (place.why == LeftOutReason::flight_zone) {
      EXPECT_GT(std::max({p.x() - 16, -13 - p.x(), std::abs(p.y()) - 12}), -3);
    }
    if (place.why == LeftOutReason::forbidden) {
      EXPECT_LE((p - Eigen::Vector3d(-8, 0, 8)).norm(), 3);
    }
    if (place.why == LeftOutReason::outside) {
      EXPECT_FALSE(work.allowed.contains(p));
    }
  }
  for (const LeftOutReason why :
       {LeftOutReason::outside, LeftOutReason::obstacle, LeftOutReason::unknown,
        LeftOutReason::no_fly, LeftOutReason::flight_zone, LeftOutReason::forbidden,
        LeftOutReason::not_chosen})
    EXPECT_GT(counts[why], 0) << to_string(why);
  // Candidates are taken or left out.
  std::size_t not_taken = 0;
  for (const auto& [why, count] : counts)
    if (why >= LeftOutReason::nothing) not_taken += static_cast<std::size_t>(count);
  const std::set<int> taken(result.kept->images.begin(), result.kept->images.end());
  EXPECT_EQ(not_taken + taken.size(), work.graph.candidates.viewpoints.size());
}

}  // namespace
}  // namespace lapwing
