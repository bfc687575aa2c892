// SPDX-License-Identifier: Apache-2.0
// Maps broken on purpose, each of which must be caught.
#include <atomic>
#include <chrono>
#include <thread>

#include "framework/conformance/check.h"
#include "framework/map/plain_map.h"
#include "framework/map/swept_box.h"

namespace lapwing {
namespace {

enum class MapMistake {
  none,
  misses_win,
  scans_add_up,
  not_clamped,
  forgets_observations,
  range_ignored,
  hit_too_far,
  ends_as_free,
  unknown_is_free,
  touching_blocks,
  leaf_twice,
  counts_leaves,
  wrong_bounds,
  import_adds,
  mean_of_known,
  knows_at_birth,
  threads_lose_points,
  never_the_same,
  one_reader_at_a_time,
  import_rounds,
  order_wanders,
  refuses
};

class BrokenMap final : public PlainMap {
 public:
  BrokenMap(const MapSettings& settings, MapMistake mistake)
      : PlainMap(settings), mistake_(mistake) {}

  void for_each_leaf(const std::function<void(const VoxelLeaf&)>& visit) const override {
    if (mistake_ == MapMistake::order_wanders && voxels_.size() > 3) {
      std::vector<VoxelLeaf> leaves;
      PlainMap::for_each_leaf([&](const VoxelLeaf& leaf) { leaves.push_back(leaf); });
      std::rotate(leaves.begin(), leaves.begin() + ++visits_ % 3, leaves.end());
      for (const VoxelLeaf& leaf : leaves) visit(leaf);
      return;
    }
    PlainMap::for_each_leaf(visit);
    if (mistake_ == MapMistake::leaf_twice && voxels_.size() > 3)
      visit({voxels_.begin()->first, 0, 0, voxels_.begin()->second.log_odds});
  }
  VoxelCounts counts() const override {
    VoxelCounts counts = PlainMap::counts();
    if (mistake_ == MapMistake::counts_leaves) counts.known /= 2;
    return counts;
  }
  std::optional<VoxelBox> bounds() const override {
    std::optional<VoxelBox> box = PlainMap::bounds();
    if (box && mistake_ == MapMistake::wrong_bounds) ++box->upper.z;
    if (!box && mistake_ == MapMistake::knows_at_birth) return VoxelBox{};
    return box;
  }

 protected:
  void insert(std::span<const Eigen::Vector3f> points, const Eigen::Vector3f& origin) override {
    const auto before = voxels_;
    if (mistake_ == MapMistake::threads_lose_points && threads() > 1) points = points.subspan(1);
    PlainMap::insert(points, origin);
    if (mistake_ == MapMistake::never_the_same) {
      static int maps = 0;
      voxels_[grid().key(points.front().cast<double>())].log_odds = 0.001f * ++maps;
    }
    if (mistake_ == MapMistake::misses_win)  // a voxel with a point is passed as well
      for (const Eigen::Vector3f& p : points)
        voxels_[grid().key(p.cast<double>())].log_odds += settings().miss;
    if (mistake_ == MapMistake::scans_add_up) PlainMap::insert(points.subspan(1, 1), origin);
    for (auto& [key, voxel] : voxels_) {
      const auto found = before.find(key);
      const float old = found == before.end() ? 0 : found->second.log_odds;
      if (mistake_ == MapMistake::not_clamped && voxel.log_odds == settings().clamp_min)
        voxel.log_odds = old + settings().miss;
      if (mistake_ == MapMistake::forgets_observations) voxel.observations = 0;
    }
    if (mistake_ == MapMistake::range_ignored && std::isfinite(settings().maximum_range))
      voxels_[grid().key(points.front().cast<double>())].log_odds = 1;
  }
  void assign(std::span<const VoxelLeaf> leaves) override {
    const auto before = voxels_;
    PlainMap::assign(leaves);
    if (mistake_ == MapMistake::import_rounds)
      for (const VoxelLeaf& leaf : leaves) {
        float& log_odds = voxels_[leaf.key].log_odds;
        log_odds = std::round(log_odds * 4) / 4;
      }
    if (mistake_ != MapMistake::import_adds) return;
    for (const auto& [key, voxel] : before) voxels_[key].log_odds += 0.25f;
  }
  void cast_checked(std::span<const MapRay> rays, std::span<MapRayHit> hits) const override {
    PlainMap::cast_checked(rays, hits);
    if (mistake_ == MapMistake::one_reader_at_a_time) {
      const bool alone = ++readers_ == 1;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));  // so that readers meet
      if (!alone) hits[0].state = VoxelState::free;
      if (!alone) hits[0].distance = 0;
      --readers_;
    }
    for (MapRayHit& hit : hits) {
      if (mistake_ == MapMistake::hit_too_far && hit.distance > 3 * grid().resolution())
        hit.distance += static_cast<float>(0.01 * grid().resolution());
      if (mistake_ == MapMistake::ends_as_free && hit.state == VoxelState::unknown)
        hit.state = VoxelState::free;
    }
  }
  bool sweep_checked(const SweptBox& box) const override {
    for (int z = box.lower[2] - 1; z <= box.upper[2] + 1; ++z)
      for (int y = box.lower[1] - 1; y <= box.upper[1] + 1; ++y)
        for (int x = box.lower[0] - 1; x <= box.upper[0] + 1; ++x) {
          const int cell[3] = {x, y, z};
          const VoxelReading voxel =
              read({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
                    static_cast<std::uint16_t>(z)});
          const bool close = mistake_ == MapMistake::touching_blocks || box.meets(cell, 0);
          const bool blocks = mistake_ == MapMistake::unknown_is_free
                                  ? voxel.state == VoxelState::occupied
                                  : voxel.state != VoxelState::free;
          if (close && blocks) return false;
        }
    return true;
  }
  void means_checked(int level, std::span<const VoxelKey> keys,
                     std::span<MeanReading> means) const override {
    PlainMap::means_checked(level, keys, means);
    if (mistake_ == MapMistake::mean_of_known)
      for (MeanReading& mean : means) mean.occupancy = 2 * mean.occupancy - 0.5f;
  }

 private:
  MapMistake mistake_;
  mutable int visits_ = 0;
  mutable std::atomic<int> readers_ = 0;
};

// Takes what it should refuse, a bit.
class Greedy final : public Map {
 public:
  explicit Greedy(const MapSettings& settings) : Map(settings), inner_(settings) {}
  VoxelReading read(const VoxelKey& key) const override { return inner_.read(key); }
  void for_each_leaf(const std::function<void(const VoxelLeaf&)>& visit) const override {
    inner_.for_each_leaf(visit);
  }
  std::optional<VoxelBox> bounds() const override { return inner_.bounds(); }
  VoxelCounts counts() const override { return inner_.counts(); }
  std::size_t bytes() const override { return 0; }

 protected:
  void insert(std::span<const Eigen::Vector3f> points, const Eigen::Vector3f& origin) override {
    inner_.integrate(points, origin);
  }
  void assign(std::span<const VoxelLeaf> leaves) override { inner_.import(leaves); }
  void cast_checked(std::span<const MapRay> rays, std::span<MapRayHit> hits) const override {
    inner_.cast(rays, hits);
  }
  void means_checked(int level, std::span<const VoxelKey> keys,
                     std::span<MeanReading> means) const override {
    inner_.read_means(level, keys, means);
  }
  bool sweep_checked(const SweptBox&) const override { return true; }

 private:
  PlainMap inner_;
};

std::vector<std::string> names_of_failures(const std::vector<CheckResult>& results) {
  std::vector<std::string> names;
  for (const CheckResult& result : results)
    if (result.outcome == Outcome::failed) names.push_back(result.name);
  return names;
}

// The parameters that a mistake needs to show, and no others, so that many can be tried.
ParameterTable few_parameters(MapMistake mistake) {
  ParameterTable table;
  const bool sound = mistake == MapMistake::none;
  if (sound || mistake == MapMistake::range_ignored)
    table.optional_number("maximum_range", "m", "", above(0));
  if (sound || mistake == MapMistake::forgets_observations)
    table.boolean("observations", false, "");
  return table;
}

// Of the check `only`; of all where it is empty.
std::vector<std::string> failures_of_map(MapMistake mistake, const std::string& only = "") {
  CheckOptions options;
  if (!only.empty()) options.only = {only};
  return names_of_failures(check_map({"broken", few_parameters(mistake),
                                      [=](const Value& given) {
                                        if (mistake == MapMistake::refuses) throw InputError("no");
                                        return std::make_unique<BrokenMap>(
                                            map_settings(check(map_parameters(), given)), mistake);
                                      }},
                                     options));
}

bool is_among(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

TEST(BrokenMap, TheSoundOnePasses) {
  EXPECT_EQ(failures_of_map(MapMistake::none), std::vector<std::string>{});
}

TEST(BrokenMap, IsCaught) {
  for (const auto& [mistake, check] : {std::pair{MapMistake::misses_win, "integration"},
                                       {MapMistake::scans_add_up, "integration"},
                                       {MapMistake::not_clamped, "integration"},
                                       {MapMistake::forgets_observations, "integration"},
                                       {MapMistake::range_ignored, "integration"},
                                       {MapMistake::hit_too_far, "ray casts"},
                                       {MapMistake::ends_as_free, "ray casts"},
                                       {MapMistake::unknown_is_free, "boxes"},
                                       {MapMistake::touching_blocks, "touching"},
                                       {MapMistake::leaf_twice, "integration"},
                                       {MapMistake::counts_leaves, "integration"},
                                       {MapMistake::wrong_bounds, "integration"},
                                       {MapMistake::import_adds, "import"},
                                       {MapMistake::mean_of_known, "means"},
                                       {MapMistake::knows_at_birth, "empty"},
                                       {MapMistake::threads_lose_points, "threads"},
                                       {MapMistake::one_reader_at_a_time, "threads"},
                                       {MapMistake::never_the_same, "repeatable"},
                                       {MapMistake::import_rounds, "round trip"},
                                       {MapMistake::order_wanders, "refusals"},
                                       {MapMistake::refuses, "creation"}})
    EXPECT_TRUE(is_among(failures_of_map(mistake, check), check))
        << check << " " << static_cast<int>(mistake);
}

TEST(BrokenMap, IsCaughtWithoutObstacles) {
  const auto names = names_of_failures(
      check_map({"greedy", few_parameters(MapMistake::none), [](const Value& given) {
                   return std::make_unique<Greedy>(map_settings(check(map_parameters(), given)));
                 }}));
  EXPECT_TRUE(is_among(names, "boxes"));
  EXPECT_TRUE(is_among(names, "memory"));
}

}  // namespace
}  // namespace lapwing
