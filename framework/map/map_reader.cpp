// SPDX-License-Identifier: Apache-2.0
// The reading half of the map files.
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/map/map_file.h"

namespace lapwing {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::string_view kTwoStates = "# Octomap OcTree binary file";
constexpr std::string_view kLogOdds = "# Octomap OcTree file";
constexpr std::size_t kLargestMap = std::size_t{1} << 30;  // bytes
constexpr std::size_t kMostLeaves = std::size_t{1} << 27;

class Reader {
 public:
  Reader(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  MapFile read() {
    header();
    if (size_ == 0 && at_ == bytes_.size()) return std::move(file_);
    const std::size_t least = file_.two_states ? size_ / 4 : size_ * node_bytes();
    if (size_ > 8 * bytes_.size() || least > bytes_.size() - at_)
      fail("states " + std::to_string(size_) + " nodes, for which at least " +
           std::to_string(least) + " bytes are needed, but " + std::to_string(bytes_.size() - at_) +
           " bytes follow: it was cut off");
    if (file_.two_states) {
      ++nodes_;
      two_states({}, kTreeDepth);
    } else {
      log_odds({}, kTreeDepth);
    }
    if (nodes_ != size_)
      fail("states " + std::to_string(size_) + " nodes, but holds " + std::to_string(nodes_));
    if (at_ != bytes_.size())
      fail("goes on for " + std::to_string(bytes_.size() - at_) + " bytes after its last node");
    return std::move(file_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(name_ + ": the map " + what);
  }

  // One line without its end.
  std::string_view line() {
    const std::size_t end = bytes_.find('\n', at_);
    if (end == std::string_view::npos || end - at_ > 4096)
      fail("has a header without the line 'data'; it starts with '" + std::string(kTwoStates) +
           "' or '" + std::string(kLogOdds) + "', then id, size, res and data");
    std::string_view text = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    if (text.ends_with('\r')) text.remove_suffix(1);
    return text;
  }

  void header() {
    const std::string_view first = line();
    if (first.starts_with(kTwoStates))
      file_.two_states = true;
    else if (!first.starts_with(kLogOdds))
      fail("is not an OctoMap file: its first line is neither '" + std::string(kTwoStates) +
           "' nor '" + std::string(kLogOdds) + "'");
    bool has_size = false, has_id = false;
    for (std::string_view text = line(); text != "data"; text = line()) {
      if (text.empty() || text.starts_with('#')) continue;
      const std::size_t gap = std::min(text.find(' '), text.size());
      const std::string_view key = text.substr(0, gap);
      const std::string value(text.substr(std::min(gap + 1, text.size())));
      if (key == "id") {
        has_id = true;
        colored_ = value == "ColorOcTree";
        if (!colored_ && value != "OcTree")
          fail("is of id '" + value + "'; OcTree and ColorOcTree can be read");
      } else if (key == "size") {
        const char* end = value.data() + value.size();
        has_size = std::from_chars(value.data(), end, size_).ptr == end && !value.empty();
        if (!has_size) fail("has size '" + value + "', which is not a number of nodes");
      } else if (key == "res") {
        const char* end = value.data() + value.size();
        if (std::from_chars(value.data(), end, file_.resolution).ptr != end) file_.resolution = 0;
        if (!(file_.resolution > 1e-6 && file_.resolution < 1e6))
          fail("has resolution '" + value + "'; it must be a positive number of metres");
      } else {
        fail("has a header line '" + std::string(text.substr(0, 60)) +
             "'; id, size, res and data are known");
      }
    }
    if (!has_id) fail("has no line 'id' in its header");
    if (!has_size) fail("has no line 'size' in its header");
    if (file_.resolution == 0) fail("has no line 'res' in its header");
  }

  std::size_t node_bytes() const { return colored_ ? 8 : 5; }

  const char* take(std::size_t count) {
    if (bytes_.size() - at_ < count)
      fail("ends after " + std::to_string(bytes_.size()) + " bytes in the middle of its node " +
           std::to_string(nodes_) + " of " + std::to_string(size_) + ": it was cut off");
    at_ += count;
    return bytes_.data() + at_ - count;
  }

  static VoxelKey child_of(const VoxelKey& key, int child, int level) {
    const auto part = [&](std::uint16_t k, int bit) {
      return static_cast<std::uint16_t>(k | ((child >> bit) & 1) << level);
    };
    return {part(key.x, 0), part(key.y, 1), part(key.z, 2)};
  }

  void add_leaf(const VoxelKey& key, int level, float log_odds) {
    if (file_.leaves.size() >= kMostLeaves)
      fail("has more than " + std::to_string(kMostLeaves) +
           " leaves, the most that can be read: cut it to the region of the flight, or make it "
           "with larger voxels");
    file_.leaves.push_back({key, static_cast<std::uint8_t>(level), 0, log_odds});
  }

  [[noreturn]] void too_deep() const {
    fail("has a node below its 16th level, near byte " + std::to_string(at_));
  }

  // Two bits for each child: nothing, free, occupied, more below.
  void two_states(const VoxelKey& key, int level) {
    std::uint16_t codes;
    std::memcpy(&codes, take(2), 2);
    if (level == 0) too_deep();
    if (codes == 0) fail("has an inner node without children, near byte " + std::to_string(at_));
    for (int child = 0; child < 8; ++child) {
      const int code = codes >> 2 * child & 3;
      if (code == 0) continue;
      ++nodes_;
      const VoxelKey below = child_of(key, child, level - 1);
      if (code != 3) add_leaf(below, level - 1, code == 1 ? -HUGE_VALF : HUGE_VALF);
    }
    for (int child = 0; child < 8; ++child)
      if ((codes >> 2 * child & 3) == 3) two_states(child_of(key, child, level - 1), level - 1);
  }

  void log_odds(const VoxelKey& key, int level) {
    float value;
    const char* node = take(node_bytes());
    ++nodes_;
    std::memcpy(&value, node, sizeof value);
    if (!std::isfinite(value))
      fail("has a node whose log odds is not a finite number, near byte " + std::to_string(at_));
    const auto children = static_cast<unsigned char>(node[node_bytes() - 1]);
    if (children == 0) return add_leaf(key, level, value);
    if (level == 0) too_deep();
    for (int child = 0; child < 8; ++child)
      if (children >> child & 1) log_odds(child_of(key, child, level - 1), level - 1);
  }

  std::string_view bytes_;
  const std::string& name_;
  std::size_t at_ = 0;
  std::uint64_t size_ = 0, nodes_ = 0;
  bool colored_ = false;
  MapFile file_;
};

}  // namespace

MapFile parse_map(std::string_view bytes, const std::string& name) {
  MapFile file = Reader(bytes, name).read();
  std::sort(file.leaves.begin(), file.leaves.end(),
            [](const VoxelLeaf& a, const VoxelLeaf& b) { return a.key.morton() < b.key.morton(); });
  return file;
}

MapFile read_map_file(const std::filesystem::path& path) {
  std::error_code none;
  const std::uintmax_t size = std::filesystem::file_size(path, none);
  if (!none && size > kLargestMap)
    throw InputError(path.string() + ": the map has " + std::to_string(size) +
                     " bytes, and the largest that can be read has " + std::to_string(kLargestMap) +
                     ": cut it to the region of the flight, or make it with larger voxels");
  return parse_map(read_file(path, kLargestMap), path.string());
}

}  // namespace lapwing
