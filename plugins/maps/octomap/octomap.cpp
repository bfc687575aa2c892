// SPDX-License-Identifier: Apache-2.0
// The reference: OctoMap's own tree, updated by its own code.
#include <octomap/OcTree.h>

#include "framework/core/error.h"
#include "framework/map/map.h"
#include "framework/map/ray_walk.h"
#include "framework/map/swept_box.h"
#include "framework/plugin/plugin.h"

namespace lapwing {
namespace {

octomap::OcTreeKey key_of(const VoxelKey& key) {
  return {key.x, key.y, key.z};
}

// A tree whose "log odds" are numbers of observations.
class CountTree final : public octomap::OcTree {
 public:
  explicit CountTree(double edge) : OcTree(edge) {
    clamping_thres_min = 0;
    clamping_thres_max = 65535;
  }
};

void make_leaf(octomap::OcTree& tree, octomap::OcTreeNode* node, float value) {
  if (tree.nodeHasChildren(node)) {
    for (unsigned child = 0; child < 8; ++child) {
      if (!tree.nodeChildExists(node, child)) tree.createNodeChild(node, child);
      make_leaf(tree, tree.getNodeChild(node, child), value);
    }
    tree.pruneNode(node);
  }
  node->setLogOdds(value);
}

// `made`: the node is new, so that it stands for nothing yet.
void set_below(octomap::OcTree& tree, octomap::OcTreeNode* node, bool made, int level,
               const VoxelLeaf& leaf, float value) {
  if (level == leaf.level) return make_leaf(tree, node, value);
  const unsigned child = octomap::computeChildIdx(key_of(leaf.key), level - 1);
  const bool missing = !tree.nodeChildExists(node, child);
  const bool pruned = missing && !made && !tree.nodeHasChildren(node);
  if (pruned)
    tree.expandNode(node);
  else if (missing)
    tree.createNodeChild(node, child);
  set_below(tree, tree.getNodeChild(node, child), missing && !pruned, level - 1, leaf, value);
  if (!tree.pruneNode(node)) node->updateOccupancyChildren();
}

// OctoMap itself sets single voxels only; a large cube of them would take for ever.
void set_cube(octomap::OcTree& tree, const VoxelLeaf& leaf, float value) {
  // Any voxel of the cube makes the root; what it says is overwritten.
  if (!tree.getRoot()) tree.updateNode(key_of(leaf.key), 1.0f);
  set_below(tree, tree.getRoot(), false, kTreeDepth, leaf, value);
}

class Octomap final : public Map {
 public:
  static constexpr PluginText kText{"octomap", "1.0.0",
                                    "OctoMap's octree: the reference implementation",
                                    "Hornung et al., Autonomous Robots 34, 2013; thesis 2.2"};
  static ParameterTable parameters() { return map_parameters(); }

  explicit Octomap(const Parameters& parameters)
      : Map(map_settings(parameters)),
        tree_(settings().resolution),
        counts_(tree_.getResolution()) {
    tree_.setProbHit(parameters.number("hit"));
    tree_.setProbMiss(parameters.number("miss"));
    tree_.setClampingThresMin(parameters.number("clamp_min"));
    tree_.setClampingThresMax(parameters.number("clamp_max"));
  }

  VoxelReading read(const VoxelKey& key) const override {
    VoxelReading reading;
    const octomap::OcTreeNode* node = tree_.search(key_of(key));
    if (!node) return reading;
    reading.known = true;
    reading.log_odds = node->getLogOdds();
    reading.state = settings().state(reading.log_odds);
    if (const octomap::OcTreeNode* count = counts_.search(key_of(key)))
      reading.observations = static_cast<std::uint16_t>(count->getLogOdds());
    return reading;
  }

  void for_each_leaf(const std::function<void(const VoxelLeaf&)>& visit) const override {
    for (auto leaf = tree_.begin_leafs(), end = tree_.end_leafs(); leaf != end; ++leaf) {
      const octomap::OcTreeKey low = leaf.getIndexKey();
      VoxelLeaf found{{low[0], low[1], low[2]},
                      static_cast<std::uint8_t>(kTreeDepth - leaf.getDepth()),
                      0,
                      leaf->getLogOdds()};
      if (settings().observations)
        visit_counted(found, visit);
      else
        visit(found);
    }
  }

  std::optional<VoxelBox> bounds() const override {
    std::optional<VoxelBox> box;
    for_each_leaf([&](const VoxelLeaf& leaf) {
      const auto last = static_cast<std::uint16_t>((1 << leaf.level) - 1);
      const VoxelKey& low = leaf.key;
      const VoxelKey high{static_cast<std::uint16_t>(low.x + last),
                          static_cast<std::uint16_t>(low.y + last),
                          static_cast<std::uint16_t>(low.z + last)};
      if (!box) box = VoxelBox{low, high};
      box->lower = {std::min(box->lower.x, low.x), std::min(box->lower.y, low.y),
                    std::min(box->lower.z, low.z)};
      box->upper = {std::max(box->upper.x, high.x), std::max(box->upper.y, high.y),
                    std::max(box->upper.z, high.z)};
    });
    return box;
  }

  VoxelCounts counts() const override {
    VoxelCounts result;
    for (auto leaf = tree_.begin_leafs(), end = tree_.end_leafs(); leaf != end; ++leaf) {
      const std::uint64_t voxels = std::uint64_t{1} << 3 * (kTreeDepth - leaf.getDepth());
      const VoxelState state = settings().state(leaf->getLogOdds());
      result.known += voxels;
      if (state == VoxelState::free) result.free += voxels;
      if (state == VoxelState::occupied) result.occupied += voxels;
    }
    return result;
  }

  // OctoMap's own count, without what the allocator adds to each of its small pieces.
  std::size_t bytes() const override { return bytes_of(tree_, counts_); }

 protected:
  void insert(std::span<const Eigen::Vector3f> points_W, const Eigen::Vector3f& origin_W) override {
    octomap::Pointcloud cloud;
    cloud.reserve(points_W.size());
    for (const Eigen::Vector3f& p : points_W) cloud.push_back(p.x(), p.y(), p.z());
    const octomap::point3d origin(origin_W.x(), origin_W.y(), origin_W.z());
    const double range = std::isfinite(settings().maximum_range) ? settings().maximum_range : -1;
    octomap::KeySet free, occupied;  // as insertPointCloud does
    if (settings().mode == IntegrationMode::discretised)
      tree_.computeDiscreteUpdate(cloud, origin, free, occupied, range);
    else
      tree_.computeUpdate(cloud, origin, free, occupied, range);
    change(free.size() + occupied.size(), [&](octomap::OcTree& tree, CountTree& counts) {
      for (const octomap::OcTreeKey& key : free) tree.updateNode(key, false);
      for (const octomap::OcTreeKey& key : occupied) tree.updateNode(key, true);
      if (!settings().observations) return;
      for (const octomap::KeySet* keys : {&free, &occupied})
        for (const octomap::OcTreeKey& key : *keys) counts.updateNode(key, 1.0f);
    });
  }

  void assign(std::span<const VoxelLeaf> leaves) override {
    change(leaves.size(), [&](octomap::OcTree& tree, CountTree& counts) {
      for (const VoxelLeaf& leaf : leaves) {
        set_cube(tree, leaf, leaf.log_odds);
        if (settings().observations) set_cube(counts, leaf, leaf.observations);
      }
    });
  }

  void cast_checked(std::span<const MapRay> rays, std::span<MapRayHit> hits) const override {
    for (std::size_t k = 0; k < rays.size(); ++k) hits[k] = first_hit(rays[k]);
  }

  void means_checked(int level, std::span<const VoxelKey> keys,
                     std::span<MeanReading> means) const override {
    for (std::size_t k = 0; k < keys.size(); ++k) means[k] = mean(level, keys[k]);
  }

  bool sweep_checked(const SweptBox& box) const override {
    for (int z = box.lower[2]; z <= box.upper[2]; ++z)
      for (int y = box.lower[1]; y <= box.upper[1]; ++y)
        for (int x = box.lower[0]; x <= box.upper[0]; ++x) {
          const int voxel[3] = {x, y, z};
          if (box.meets(voxel, 0) && state(x, y, z) != VoxelState::free) return false;
        }
    return true;
  }

 private:
  // Bytes that one more leaf takes at most: a branch of its own, down from the root.
  static constexpr std::size_t kBranch = kTreeDepth * 8 * (sizeof(octomap::OcTreeNode) + 8);

  std::size_t bytes_of(const octomap::OcTree& tree, const CountTree& counts) const {
    return tree.memoryUsage() + (settings().observations ? counts.memoryUsage() : 0);
  }

  // Nothing is changed where the result would not fit: what comes near the limit is tried on a
  // copy.
  template <class Change>
  void change(std::size_t leaves, const Change& apply) {
    if (bytes() + 2 * leaves * kBranch <= settings().memory_limit) return apply(tree_, counts_);
    octomap::OcTree tree(tree_);
    CountTree counts(counts_);
    apply(tree, counts);
    require_memory(bytes_of(tree, counts));
    tree_.swapContent(tree);
    counts_.swapContent(counts);
  }

  VoxelState state(int x, int y, int z) const {
    const octomap::OcTreeNode* node = tree_.search(
        octomap::OcTreeKey(static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
                           static_cast<std::uint16_t>(z)));
    return node ? settings().state(node->getLogOdds()) : VoxelState::unknown;
  }

  MapRayHit first_hit(const MapRay& ray) const {
    MapRayHit hit;
    RayWalk walk(grid(), ray.origin, ray.direction);
    while (true) {
      hit.voxel = walk.key();
      hit.state = state(walk.cell[0], walk.cell[1], walk.cell[2]);
      hit.distance = static_cast<float>(std::max(walk.entered, 0.0));
      if (hit.state != VoxelState::free) return hit;
      walk.advance();
      if (walk.entered >= ray.range) return nothing_within(ray);
      if (!walk.inside()) return end_of_map(walk);
    }
  }

  MeanReading mean(int level, const VoxelKey& key) const {
    const int edge = 1 << level, low[3] = {key.x & -edge, key.y & -edge, key.z & -edge};
    double occupancy = 0, uncertain = 0;
    for (int z = low[2]; z < low[2] + edge; ++z)
      for (int y = low[1]; y < low[1] + edge; ++y)
        for (int x = low[0]; x < low[0] + edge; ++x) {
          const VoxelReading reading =
              read({static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y),
                    static_cast<std::uint16_t>(z)});
          occupancy += reading.known ? probability_of(reading.log_odds) : 0.5;
          uncertain += uncertainty(reading.observations);
        }
    const double voxels = static_cast<double>(edge) * edge * edge;
    return {static_cast<float>(occupancy / voxels), static_cast<float>(uncertain / voxels)};
  }

  // A leaf of one log odds whose voxels were observed a different number of times.
  void visit_counted(const VoxelLeaf& leaf,
                     const std::function<void(const VoxelLeaf&)>& visit) const {
    const octomap::OcTreeKey low = key_of(leaf.key);
    const octomap::OcTreeNode* node = counts_.search(low, kTreeDepth - leaf.level);
    VoxelLeaf part = leaf;
    if (leaf.level == 0 || !node || !counts_.nodeHasChildren(node)) {
      part.observations = node ? static_cast<std::uint16_t>(node->getLogOdds()) : 0;
      return visit(part);
    }
    part.level = leaf.level - 1;
    const int edge = 1 << part.level;
    for (int child = 0; child < 8; ++child) {
      part.key = {static_cast<std::uint16_t>(leaf.key.x + (child & 1) * edge),
                  static_cast<std::uint16_t>(leaf.key.y + (child >> 1 & 1) * edge),
                  static_cast<std::uint16_t>(leaf.key.z + (child >> 2) * edge)};
      visit_counted(part, visit);
    }
  }

  octomap::OcTree tree_;
  CountTree counts_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Octomap)
