// SPDX-License-Identifier: Apache-2.0
#include "framework/export/map_pictures.h"

#include <algorithm>
#include <cmath>

namespace lapwing {
namespace {

using Byte3 = std::array<std::uint8_t, 3>;

constexpr Byte3 kUnknown = {58, 62, 70}, kFree = {236, 236, 230}, kOccupied = {30, 34, 44};

// From dark blue over green to yellow, even to the eye: a few stops of viridis (van der Walt and
// Smith, 2015).
Byte3 height_color(double share) {
  static constexpr double kStops[5][3] = {
      {68, 1, 84}, {59, 82, 139}, {33, 145, 140}, {94, 201, 98}, {253, 231, 37}};
  const double at = std::clamp(share, 0.0, 1.0) * 4;
  const int k = std::min(3, static_cast<int>(at));
  Byte3 color;
  for (int c = 0; c < 3; ++c)
    color[c] =
        static_cast<std::uint8_t>(kStops[k][c] + (at - k) * (kStops[k + 1][c] - kStops[k][c]));
  return color;
}

Byte3 lit(Byte3 color, double light) {
  for (std::uint8_t& c : color)
    c = static_cast<std::uint8_t>(std::clamp(std::lround(c * light), 0l, 255l));
  return color;
}

// Of the voxels that are free or occupied; of all known ones where there is none.
std::optional<VoxelBox> decided_bounds(const Map& map) {
  VoxelBox box{{65535, 65535, 65535}, {0, 0, 0}};
  bool found = false;
  map.for_each_leaf([&](const VoxelLeaf& leaf) {
    if (map.settings().state(leaf.log_odds) == VoxelState::unknown) return;
    found = true;
    const auto last = static_cast<std::uint16_t>((1 << leaf.level) - 1);
    box.lower.x = std::min(box.lower.x, leaf.key.x);
    box.lower.y = std::min(box.lower.y, leaf.key.y);
    box.lower.z = std::min(box.lower.z, leaf.key.z);
    box.upper.x = std::max<std::uint16_t>(box.upper.x, leaf.key.x + last);
    box.upper.y = std::max<std::uint16_t>(box.upper.y, leaf.key.y + last);
    box.upper.z = std::max<std::uint16_t>(box.upper.z, leaf.key.z + last);
  });
  return found ? box : map.bounds();
}

// Small pictures larger, each pixel as a square.
void magnify(MapPicture& made, int most_pixels) {
  Picture& from = made.picture;
  const int factor = most_pixels / std::max({1, from.width, from.height});
  if (factor < 2) return;
  Picture to{from.width * factor, from.height * factor, {}};
  to.rgb.reserve(static_cast<std::size_t>(to.width) * to.height * 3);
  for (int y = 0; y < to.height; ++y)
    for (int x = 0; x < to.width; ++x) {
      const auto pixel = from.rgb.begin() + 3 * (y / factor * from.width + x / factor);
      to.rgb.insert(to.rgb.end(), pixel, pixel + 3);
    }
  from = std::move(to);
}

// Columns of voxels seen from above, several to a pixel where there are too many.
struct Columns {
  VoxelBox box;
  int per_pixel = 1, width = 0, height = 0;

  Columns(const VoxelBox& bounds, int most_pixels) : box(bounds) {
    const int across = bounds.upper.x - bounds.lower.x + 1;
    const int up = bounds.upper.y - bounds.lower.y + 1;
    per_pixel = std::max(1, (std::max(across, up) + most_pixels - 1) / most_pixels);
    width = (across + per_pixel - 1) / per_pixel;
    height = (up + per_pixel - 1) / per_pixel;
  }
  // Calls f(pixel) for every pixel that a leaf covers; north is up.
  template <class F>
  void cover(const VoxelLeaf& leaf, F f) const {
    const int size = 1 << leaf.level;
    if (leaf.key.x > box.upper.x || leaf.key.y > box.upper.y || leaf.key.x + size <= box.lower.x ||
        leaf.key.y + size <= box.lower.y)
      return;
    const int left = (std::max(leaf.key.x, box.lower.x) - box.lower.x) / per_pixel;
    const int right = (std::min<int>(leaf.key.x + size - 1, box.upper.x) - box.lower.x) / per_pixel;
    const int low = (std::max(leaf.key.y, box.lower.y) - box.lower.y) / per_pixel;
    const int high = (std::min<int>(leaf.key.y + size - 1, box.upper.y) - box.lower.y) / per_pixel;
    for (int y = low; y <= high; ++y)
      for (int x = left; x <= right; ++x) f((height - 1 - y) * width + x);
  }
};

MapPicture blank(const Columns& columns, const Map& map) {
  MapPicture made;
  made.picture.width = columns.width;
  made.picture.height = columns.height;
  made.picture.rgb.resize(static_cast<std::size_t>(columns.width) * columns.height * 3);
  made.metres = columns.per_pixel * map.grid().resolution();
  return made;
}

void paint(Picture& picture, std::size_t pixel, const Byte3& color) {
  std::copy(color.begin(), color.end(),
            picture.rgb.begin() + static_cast<std::ptrdiff_t>(3 * pixel));
}

// Colours the pixels whose columns a leaf at this height covers; later leaves are laid over
// earlier.
template <class Color>
MapPicture cut(const Map& map, double height, int most_pixels, Color color_of) {
  const auto bounds = decided_bounds(map);
  if (!bounds) return {};
  const Columns columns(*bounds, most_pixels);
  MapPicture made = blank(columns, map);
  for (std::size_t i = 0; i < made.picture.rgb.size() / 3; ++i) paint(made.picture, i, kUnknown);
  const int key = map.grid().index(height);
  std::vector<bool> occupied(made.picture.rgb.size() / 3);
  map.for_each_leaf([&](const VoxelLeaf& leaf) {
    if (key < leaf.key.z || key >= leaf.key.z + (1 << leaf.level)) return;
    const VoxelState state = map.settings().state(leaf.log_odds);
    columns.cover(leaf, [&](int pixel) {
      const auto at = static_cast<std::size_t>(pixel);
      if (occupied[at]) return;  // where several share a pixel, what is in the way shows
      occupied[at] = state == VoxelState::occupied;
      paint(made.picture, at, color_of(leaf, state));
    });
  });
  made.lowest = made.highest = height;
  magnify(made, most_pixels);
  return made;
}

}  // namespace

MapColumns map_columns(const Map& map, double below) {
  const auto bounds = decided_bounds(map);
  if (!bounds) return {};
  MapColumns columns;
  columns.box = *bounds;
  columns.grid = map.grid();
  const Columns each(*bounds, 1 << 16);
  const auto count = static_cast<std::size_t>(each.width) * each.height;
  columns.top.assign(count, MapColumns::kNone);
  columns.free.assign(count, false);
  const int last =
      std::isfinite(below) ? map.grid().index(below) : std::numeric_limits<std::uint16_t>::max();
  map.for_each_leaf([&](const VoxelLeaf& leaf) {
    if (leaf.key.z > last) return;
    const VoxelState state = map.settings().state(leaf.log_odds);
    const auto top = static_cast<std::uint16_t>(std::min(leaf.key.z + (1 << leaf.level) - 1, last));
    each.cover(leaf, [&](int pixel) {
      const auto at = static_cast<std::size_t>(pixel);
      if (state == VoxelState::occupied)
        columns.top[at] = std::max(columns.top[at], top);
      else if (state == VoxelState::free)
        columns.free[at] = true;
    });
  });
  return columns;
}

MapPicture height_picture(const Map& map, int most_pixels) {
  const MapColumns columns = map_columns(map);
  return height_picture(columns, columns, most_pixels);
}

MapPicture height_picture(const MapColumns& shown, const MapColumns& frame, int most_pixels) {
  if (frame.empty()) return {};
  const Columns columns(frame.box, most_pixels);
  MapPicture made;
  made.picture.width = columns.width;
  made.picture.height = columns.height;
  made.picture.rgb.resize(static_cast<std::size_t>(columns.width) * columns.height * 3);
  made.metres = columns.per_pixel * frame.grid.resolution();
  const std::size_t pixels = made.picture.rgb.size() / 3;
  constexpr int kNothing = -1;
  std::vector<int> top(pixels, kNothing);
  std::vector<bool> free(pixels);
  std::size_t k = 0;
  for (int y = shown.box.upper.y; !shown.empty() && y >= shown.box.lower.y; --y)
    for (int x = shown.box.lower.x; x <= shown.box.upper.x; ++x, ++k)
      columns.cover({{static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y), 0}, 0, 0, 0},
                    [&](int pixel) {
                      const auto at = static_cast<std::size_t>(pixel);
                      if (shown.top[k] != MapColumns::kNone)
                        top[at] = std::max<int>(top[at], shown.top[k]);
                      free[at] = free[at] || shown.free[k];
                    });
  int low = 65535, high = 0;
  for (const std::uint16_t z : frame.top)
    if (z != MapColumns::kNone) low = std::min<int>(low, z), high = std::max<int>(high, z);
  if (low > high) low = high = frame.box.lower.z;
  const auto metres = [&](int key) { return (key - kCenterKey) * frame.grid.resolution(); };
  made.lowest = metres(low), made.highest = metres(high + 1);
  const double span = std::max(1, high - low);
  for (std::size_t i = 0; i < pixels; ++i) {
    if (top[i] == kNothing) {
      paint(made.picture, i, free[i] ? kFree : kUnknown);
      continue;
    }
    const auto neighbour = [&](bool there, std::size_t j) {
      return there && top[j] != kNothing ? top[j] : top[i];
    };
    const std::size_t x = i % static_cast<std::size_t>(columns.width);
    const auto row = static_cast<std::size_t>(columns.width);
    const double slope =
        (top[i] - neighbour(x > 0, i - 1)) + (top[i] - neighbour(i >= row, i - row));
    const double light = 1 + 0.25 * std::tanh(slope * 0.5 / columns.per_pixel);
    paint(made.picture, i, lit(height_color((top[i] - low) / span), light));
  }
  magnify(made, most_pixels);
  return made;
}

MapPicture cut_picture(const Map& map, double height, int most_pixels) {
  return cut(map, height, most_pixels, [](const VoxelLeaf&, VoxelState state) {
    return state == VoxelState::occupied ? kOccupied
           : state == VoxelState::free   ? kFree
                                         : Byte3{140, 140, 146};
  });
}

MapPicture uncertainty_picture(const Map& map, double height, int most_pixels) {
  return cut(map, height, most_pixels, [&](const VoxelLeaf& leaf, VoxelState) {
    return height_color(1 - map.uncertainty(leaf.observations));
  });
}

Picture depth_picture(const DepthImage& image) {
  Picture picture{image.pinhole.width, image.pinhole.height, {}};
  picture.rgb.resize(image.depth.size() * 3);
  float nearest = std::numeric_limits<float>::infinity(), farthest = 0;
  for (const float depth : image.depth)
    if (depth > 0 && std::isfinite(depth)) {
      nearest = std::min(nearest, depth);
      farthest = std::max(farthest, depth);
    }
  for (std::size_t i = 0; i < image.depth.size(); ++i) {
    const float depth = image.depth[i];
    if (!(depth > 0)) continue;  // black
    if (!std::isfinite(depth)) {
      paint(picture, i, {24, 30, 66});
      continue;
    }
    // By the inverse of the depth: as much room for the near as for the far.
    const double share =
        farthest > nearest ? (1 / depth - 1 / farthest) / (1 / nearest - 1 / farthest) : 1;
    paint(picture, i, height_color(0.08 + 0.92 * share));
  }
  return picture;
}

}  // namespace lapwing
