// SPDX-License-Identifier: Apache-2.0
// The writing half of the map files.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/map/map_file.h"

namespace lapwing {
namespace {

constexpr std::uint64_t kMostPoints = 50'000'000;

struct Node {
  float value = 0;          // of an inner node its children's greatest
  std::uint32_t first = 0;  // of its children, which lie together
  std::uint8_t children = 0;
};

// The tree of all leaves, in which eight equal leaves are one.
class Tree {
 public:
  explicit Tree(std::vector<VoxelLeaf> leaves) : leaves_(std::move(leaves)) {
    std::sort(leaves_.begin(), leaves_.end(), [](const VoxelLeaf& a, const VoxelLeaf& b) {
      return a.key.morton() < b.key.morton();
    });
    if (leaves_.empty()) return;
    root_ = node(kTreeDepth, 0, leaves_.size());
    empty_ = false;
  }

  bool empty() const { return empty_; }
  const Node& root() const { return root_; }
  const Node* children(const Node& node) const { return nodes_.data() + node.first; }
  std::size_t size() const { return empty_ ? 0 : nodes_.size() + 1; }

 private:
  Node node(int level, std::size_t begin, std::size_t end) {
    if (leaves_[begin].level == level) return {leaves_[begin].log_odds, 0, 0};
    Node result;
    Node below[8];
    int count = 0;
    result.value = -HUGE_VALF;
    bool alike = true;
    for (std::size_t at = begin; at < end;) {
      const auto child_of = [&](std::size_t k) {
        return leaves_[k].key.morton() >> 3 * (level - 1) & 7;
      };
      const std::uint64_t child = child_of(at);
      std::size_t next = at + 1;
      while (next < end && child_of(next) == child) ++next;
      below[count] = node(level - 1, at, next);
      result.children |= static_cast<std::uint8_t>(1u << child);
      alike &= below[count].children == 0 && below[count].value == below[0].value;
      result.value = std::max(result.value, below[count++].value);
      at = next;
    }
    if (alike && count == 8) return {result.value, 0, 0};
    result.first = static_cast<std::uint32_t>(nodes_.size());
    nodes_.insert(nodes_.end(), below, below + count);
    return result;
  }

  std::vector<VoxelLeaf> leaves_;
  std::vector<Node> nodes_;
  Node root_;
  bool empty_ = true;
};

std::string header(const char* first_line, const Tree& tree, std::size_t nodes, double resolution) {
  char digits[64];
  std::snprintf(digits, sizeof digits, "%.17g", resolution);
  for (int precision = 1; precision < 17; ++precision) {
    char shorter[64];
    std::snprintf(shorter, sizeof shorter, "%.*g", precision, resolution);
    if (std::strtod(shorter, nullptr) != resolution) continue;
    std::memcpy(digits, shorter, sizeof shorter);
    break;
  }
  return std::string(first_line) +
         "\n# (feel free to add / change comments, but leave the first line as it is!)\n#\n" +
         "id OcTree\nsize " + std::to_string(tree.empty() ? 0 : nodes) + "\nres " + digits +
         "\ndata\n";
}

void append_two_states(const Tree& tree, const Node& node, std::string& out) {
  const Node* child = tree.children(node);
  std::uint16_t codes = 0;
  int k = 0;
  for (int i = 0; i < 8; ++i) {
    if (!(node.children >> i & 1)) continue;
    const int code = child[k].children ? 3 : child[k].value < 0 ? 1 : 2;
    codes |= static_cast<std::uint16_t>(code << 2 * i);
    ++k;
  }
  out.append(reinterpret_cast<const char*>(&codes), 2);
  for (int i = 0; i < k; ++i)
    if (child[i].children) append_two_states(tree, child[i], out);
}

std::string two_states(const Map& map) {
  std::vector<VoxelLeaf> leaves;
  map.for_each_leaf([&](const VoxelLeaf& leaf) {
    const VoxelState state = map.settings().state(leaf.log_odds);
    if (state == VoxelState::unknown) return;
    leaves.push_back(leaf);
    leaves.back().log_odds = state == VoxelState::free ? -1.0f : 1.0f;
  });
  const Tree tree(std::move(leaves));
  const bool whole = !tree.empty() && tree.root().children == 0;  // everything is alike
  std::string out = header("# Octomap OcTree binary file", tree, whole ? 9 : tree.size(),
                           map.settings().resolution);
  if (whole) {
    const std::uint16_t codes = tree.root().value < 0 ? 0x5555 : 0xaaaa;
    out.append(reinterpret_cast<const char*>(&codes), 2);
  } else if (!tree.empty()) {
    append_two_states(tree, tree.root(), out);
  }
  return out;
}

void append_log_odds(const Tree& tree, const Node& node, std::string& out) {
  out.append(reinterpret_cast<const char*>(&node.value), sizeof node.value);
  out.push_back(static_cast<char>(node.children));
  const int count = std::popcount(node.children);
  for (int i = 0; i < count; ++i) append_log_odds(tree, tree.children(node)[i], out);
}

std::string log_odds(const Map& map) {
  std::vector<VoxelLeaf> leaves;
  map.for_each_leaf([&](const VoxelLeaf& leaf) { leaves.push_back(leaf); });
  const Tree tree(std::move(leaves));
  std::string out = header("# Octomap OcTree file", tree, tree.size(), map.settings().resolution);
  if (!tree.empty()) append_log_odds(tree, tree.root(), out);
  return out;
}

std::string points(const Map& map) {
  std::vector<VoxelLeaf> voxels;
  std::uint64_t count = 0;
  map.for_each_leaf([&](const VoxelLeaf& leaf) {
    if (map.settings().state(leaf.log_odds) != VoxelState::occupied) return;
    count += std::uint64_t{1} << 3 * leaf.level;
    if (count > kMostPoints)
      throw InputError("a .ply holds at most 50 million points; the map has more occupied voxels");
    voxels.push_back(leaf);
  });
  std::sort(voxels.begin(), voxels.end(),
            [](const VoxelLeaf& a, const VoxelLeaf& b) { return a.key.morton() < b.key.morton(); });
  std::string out =
      "ply\nformat binary_little_endian 1.0\ncomment occupied voxels of " +
      std::to_string(map.settings().resolution) + " m\nelement vertex " + std::to_string(count) +
      "\nproperty float x\nproperty float y\nproperty float z\nproperty float log_odds\n"
      "end_header\n";
  for (const VoxelLeaf& leaf : voxels) {
    const int edge = 1 << leaf.level;
    for (int z = 0; z < edge; ++z)
      for (int y = 0; y < edge; ++y)
        for (int x = 0; x < edge; ++x) {
          const float vertex[4] = {static_cast<float>(map.grid().center(leaf.key.x + x)),
                                   static_cast<float>(map.grid().center(leaf.key.y + y)),
                                   static_cast<float>(map.grid().center(leaf.key.z + z)),
                                   leaf.log_odds};
          out.append(reinterpret_cast<const char*>(vertex), sizeof vertex);
        }
  }
  return out;
}

}  // namespace

std::string map_file_bytes(std::string_view ending, const Map& map) {
  if (ending == ".bt") return two_states(map);
  if (ending == ".ot") return log_odds(map);
  if (ending == ".ply") return points(map);
  throw InputError("a map cannot be written as '" + std::string(ending) +
                   "'; endings are .bt, .ot and .ply");
}

void write_map_file(const std::filesystem::path& path, const Map& map) {
  write_file_atomically(path, map_file_bytes(path.extension().string(), map));
}

}  // namespace lapwing
