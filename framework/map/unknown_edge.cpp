// SPDX-License-Identifier: Apache-2.0
// How: every voxel of the region, and of a rim around it, has one byte of state.
//   1. read: never measured (kNever), air, or surface.
//   2. leave_out_known: never measured voxels that touch a surface voxel, or lie within 1.5 voxels
//      of the mesh, are the thickness of a known surface (kBeside).
//   3. close_gaps: a morphological opening (voxel_balls.h). Never measured voxels that lie in no
//      ball of such voxels are gaps between rays (kGap). The radius of the ball is half the gap
//      between rays there and half a voxel's diagonal (measure_gaps). A gap becomes air up to a
//      ball's radius from air, by breadth-first search across faces.
//   4. marked_edge: what is still kNever, in the region and across a face from air, is the edge. It
//      is roomy where a sphere of the stated width fits among kNever.
//   5. opening_from: a flood fill over 26 neighbours joins the edge to openings. Faces towards air
//      are added as vectors within cubes of 8 voxels, so that a slope has its own area and not that
//      of its stairs.
// Steps 2 to 4 work by tiles, in parallel. A tile without unmeasured voxels, or without air near
// it, is skipped. Tiles read states of the step before, so the result is the same for any number of
// threads.
#include "framework/map/unknown_edge.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>

#include "framework/core/error.h"
#include "framework/core/parallel.h"
#include "framework/map/region_voxels.h"
#include "framework/map/voxel_balls.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;
using Index = std::array<int, 3>;  // of a voxel of the space, or of a cube of them

constexpr double kMostVoxels = 268435456.0;  // 2^28
constexpr int kCube = 8;                     // voxels along an edge
constexpr int kTile = 64;   // likewise, at least, of what is looked through at once
constexpr int kFewest = 8;  // faces; fewer are specks
constexpr double kHalfDiagonal = std::numbers::sqrt3 / 2;        // of a voxel, in voxels
constexpr double kBesideMesh = 1.5;                              // voxels
constexpr std::uint8_t kNever = 0, kAir = 1, kSurface = 2;       // what was measured
constexpr std::uint8_t kBeside = 3, kGap = 4;                    // of what never was
constexpr std::uint8_t kEdge = 5, kRoomyEdge = 6, kCounted = 7;  // likewise

// Calls `visit` with every index of a box.
template <typename Visit>
void for_each_index(const Index& low, const Index& high, const Visit& visit) {
  for (int z = low[2]; z < high[2]; ++z)
    for (int y = low[1]; y < high[1]; ++y)
      for (int x = low[0]; x < high[0]; ++x) visit(Index{x, y, z});
}

Index moved(Index at, std::size_t axis, int by) {
  at[axis] += by;
  return at;
}

// The voxels of a region, whose middles lie in it, and a rim round them.
class Space {
 public:
  Space(const Map& map, const MeshScene* mesh, const EdgeSettings& settings)
      : map_(map), grid_(map.grid()), mesh_(mesh), settings_(settings) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto axis = static_cast<Eigen::Index>(i);
      const double reach = grid_.reach() - 2 * grid_.resolution();
      const double lowest = std::clamp(settings.region.bounds().min()[axis], -reach, reach);
      const double highest = std::clamp(settings.region.bounds().max()[axis], -reach, reach);
      low_[i] = grid_.index(lowest) + (grid_.center(grid_.index(lowest)) < lowest ? 1 : 0);
      const int high = grid_.index(highest) - (grid_.center(grid_.index(highest)) > highest);
      inner_[i] = block_.size[i] = std::max(0, high + 1 - low_[i]);
      cubes_.size[i] = inner_[i] / kCube + 1;
    }
    require_few();
    if (!settings.region.is_box()) prisms_.emplace(settings.region, grid_);
    measure_gaps();
    rim_ = 2 + 2 * static_cast<int>(std::ceil(*std::max_element(balls_.begin(), balls_.end())));
    for (std::size_t i = 0; i < 3; ++i) {
      low_[i] -= rim_;
      block_.size[i] = inner_[i] + 2 * rim_;
    }
    require_few();
    read();
    leave_out_known();
    close_gaps();
  }

  std::vector<Opening> openings() {
    std::vector<Index> edge;
    for (const std::vector<Index>& part : marked_edge())
      edge.insert(edge.end(), part.begin(), part.end());
    std::vector<Opening> found;
    for (const Index& at : edge) {
      if (state(at) == kCounted) continue;
      Opening one = opening_from(at);
      if (one.area > 0) found.push_back(std::move(one));
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const Opening& a, const Opening& b) { return a.area > b.area; });
    return found;
  }

 private:
  void require_few() const {
    double count = 1;
    for (const int size : block_.size) count *= size;
    if (count > kMostVoxels)
      throw InputError(
          "the region of interest has more than 2^28 voxels: set a larger resolution or a smaller "
          "region, or the unit of the mesh file");
  }
  std::uint8_t& state(const Index& at) { return block_.marked[block_.place(at[0], at[1], at[2])]; }
  std::uint8_t state(const Index& at) const {
    return block_.marked[block_.place(at[0], at[1], at[2])];
  }
  bool in_region(const Index& at) const {
    for (std::size_t i = 0; i < 3; ++i)
      if (at[i] < rim_ || at[i] >= rim_ + inner_[i]) return false;
    return !prisms_ || prisms_->contains(key(at));
  }
  VoxelKey key(const Index& at) const {
    const auto part = [&](std::size_t i) {
      return static_cast<std::uint16_t>(std::clamp(low_[i] + at[i], 0, kKeyCount - 1));
    };
    return {part(0), part(1), part(2)};
  }
  Vector3d center(const Index& at) const {
    return {grid_.center(low_[0] + at[0]), grid_.center(low_[1] + at[1]),
            grid_.center(low_[2] + at[2])};
  }
  // In the cubes of the region; the rim belongs to the nearest of them.
  std::size_t cube_of(const Index& at) const {
    Index cube;
    for (std::size_t i = 0; i < 3; ++i)
      cube[i] = std::clamp((at[i] - rim_) / kCube, 0, cubes_.size[i] - 1);
    return cubes_.place(cube[0], cube[1], cube[2]);
  }

  // Of every cube: the radius of the smallest ball, in voxels, that is no gap between rays in it.
  void measure_gaps() {
    const double edge = kCube * grid_.resolution();
    const Vector3d first = center({0, 0, 0}) + Vector3d::Constant((edge - grid_.resolution()) / 2);
    for (const double gap :
         widest_gaps({first, edge, cubes_.size}, settings_.rays, mesh_, settings_.threads))
      balls_.push_back(static_cast<float>(gap / 2 / grid_.resolution() + kHalfDiagonal));
  }

  void read() {
    block_.marked.resize(block_.count());
    parallel_for(static_cast<std::size_t>(block_.size[2]), settings_.threads, [&](std::size_t z) {
      const int at_z = static_cast<int>(z);
      for_each_index({0, 0, at_z}, {block_.size[0], block_.size[1], at_z + 1},
                     [&](const Index& at) {
                       const VoxelReading voxel = map_.read(key(at));
                       state(at) = !voxel.known ? kNever : voxel.log_odds > 0 ? kSurface : kAir;
                     });
    });
  }

  // Tiles of the whole space, each with its corners.
  std::vector<std::pair<Index, Index>> tiles() const {
    std::vector<std::pair<Index, Index>> found;
    const int edge = std::max(kTile, 3 * rim_);  // what is looked at twice is little beside it
    for (int z = 0; z < block_.size[2]; z += edge)
      for (int y = 0; y < block_.size[1]; y += edge)
        for (int x = 0; x < block_.size[0]; x += edge)
          found.push_back({{x, y, z}, clipped({x + edge, y + edge, z + edge}, 0)});
    return found;
  }
  Index clipped(Index at, int by) const {
    for (std::size_t i = 0; i < 3; ++i) at[i] = std::clamp(at[i] + by, 0, block_.size[i]);
    return at;
  }
  static bool any(const VoxelBlock& voxels, const Index& low, const Index& high,
                  std::uint8_t wanted) {
    for (int z = low[2]; z < high[2]; ++z)
      for (int y = low[1]; y < high[1]; ++y) {
        const auto begin =
            voxels.marked.begin() + static_cast<std::ptrdiff_t>(voxels.place(low[0], y, z));
        const auto end = begin + (high[0] - low[0]);
        if (std::find(begin, end, wanted) != end) return true;
      }
    return false;
  }

  // Whether a tile has voxels that were never measured, and air in it or round it.
  bool air_comes_to(const VoxelBlock& voxels, const Index& low, const Index& high) const {
    return any(voxels, low, high, kNever) &&
           any(voxels, clipped(low, -rim_), clipped(high, rim_), kAir);
  }

  // What lies beside a known surface is its own thickness and no opening.
  void leave_out_known() {
    const VoxelBlock before = block_;
    const auto all = tiles();
    parallel_for(all.size(), settings_.threads, [&](std::size_t t) {
      const auto& [low, high] = all[t];
      if (!air_comes_to(before, low, high)) return;
      for (int z = low[2]; z < high[2]; ++z)
        for (int y = low[1]; y < high[1]; ++y) {
          int clear = low[0];  // no mesh is near before this one
          for (int x = low[0]; x < high[0]; ++x) {
            const Index at{x, y, z};
            if (state(at) != kNever) continue;
            if (surface_beside(before, at)) {
              state(at) = kBeside;
            } else if (mesh_ && x >= clear) {
              const double away = voxels_to_mesh(at);
              if (away <= kBesideMesh)
                state(at) = kBeside;
              else
                clear = x + 1 + static_cast<int>(away - kBesideMesh);
            }
          }
        }
    });
  }
  // As far as the mesh is near; else how far was looked.
  double voxels_to_mesh(const Index& at) const {
    const double reach = kCube * grid_.resolution();
    const auto found = mesh_->nearest(center(at), reach);
    return (found ? found->distance : reach) / grid_.resolution();
  }
  static bool surface_beside(const VoxelBlock& voxels, const Index& at) {
    Index low, high;
    for (std::size_t i = 0; i < 3; ++i) {
      low[i] = std::max(at[i] - 1, 0);
      high[i] = std::min(at[i] + 2, voxels.size[i]);
    }
    bool found = false;
    for_each_index(low, high, [&](const Index& n) {
      found = found || voxels.marked[voxels.place(n[0], n[1], n[2])] == kSurface;
    });
    return found;
  }

  // Of a tile, which voxels lie in balls of never measured ones. `radius` in voxels, of a voxel;
  // two of them are at most `reach`.
  template <typename Radius>
  VoxelBlock balls_in(const Index& low, const Index& high, int reach, const Radius& radius) const {
    const Index from = clipped(low, -reach), to = clipped(high, reach);
    VoxelBlock around{{to[0] - from[0], to[1] - from[1], to[2] - from[2]}, {}};
    std::vector<float> radii;
    for_each_index(from, to, [&](const Index& at) {
      around.marked.push_back(state(at) == kNever);
      radii.push_back(radius(at));
    });
    keep_balls(around, radii);
    VoxelBlock kept{{high[0] - low[0], high[1] - low[1], high[2] - low[2]}, {}};
    for_each_index(low, high, [&](const Index& at) {
      kept.marked.push_back(
          around.marked[around.place(at[0] - from[0], at[1] - from[1], at[2] - from[2])]);
    });
    return kept;
  }

  // Never measured voxels in gaps between rays; those near air count as air.
  void close_gaps() {
    const auto all = tiles();
    std::vector<VoxelBlock> kept(all.size());
    parallel_for(all.size(), settings_.threads, [&](std::size_t t) {
      const auto& [low, high] = all[t];
      if (air_comes_to(block_, low, high))
        kept[t] = balls_in(low, high, rim_, [&](const Index& at) { return balls_[cube_of(at)]; });
    });
    std::vector<Index> gaps;
    for (std::size_t t = 0; t < all.size(); ++t) {
      if (kept[t].marked.empty()) continue;
      std::size_t k = 0;
      for_each_index(all[t].first, all[t].second, [&](const Index& at) {
        if (!kept[t].marked[k++] && state(at) == kNever) {
          state(at) = kGap;
          gaps.push_back(at);
        }
      });
    }
    // From the air inwards, face by face, as far as a ball's radius leads at its steepest.
    const double farthest = *std::max_element(balls_.begin(), balls_.end());
    const int steps = static_cast<int>(std::ceil(std::numbers::sqrt3 * farthest));
    std::vector<Index> reached;
    for (const Index& at : gaps)
      if (beside_air(at)) reached.push_back(at);
    for (int step = 0; step < steps && !reached.empty(); ++step) {
      for (const Index& at : reached) state(at) = kAir;
      std::vector<Index> next;
      for (const Index& at : reached)
        for_each_neighbour(at, [&](const Index& n, std::size_t, int) {
          if (state(n) == kGap) {
            state(n) = kAir;
            next.push_back(n);
          }
        });
      reached = std::move(next);
    }
  }

  // Calls `visit(neighbour, axis, side)` across each face within the space.
  template <typename Visit>
  void for_each_neighbour(const Index& at, const Visit& visit) const {
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int side : {-1, 1}) {
        const Index n = moved(at, axis, side);
        if (n[axis] >= 0 && n[axis] < block_.size[axis]) visit(n, axis, side);
      }
  }
  bool beside_air(const Index& at) const {
    bool found = false;
    for_each_neighbour(
        at, [&](const Index& n, std::size_t, int) { found = found || state(n) == kAir; });
    return found;
  }
  // The same within the region.
  bool at_edge(const Index& at) const {
    bool found = false;
    for_each_neighbour(at, [&](const Index& n, std::size_t, int) {
      found = found || (state(n) == kAir && in_region(n));
    });
    return found;
  }

  // Marks the edge, tile by tile: roomy where a sphere of the stated width fits among what was
  // never measured, and between known surface as it comes in. What lies beside known surface is
  // left out of the first, and not of the sphere.
  std::vector<std::vector<Index>> marked_edge() {
    const double wanted = settings_.width / 2 / grid_.resolution() - kBesideMesh;
    const auto radius = static_cast<float>(std::max(wanted, kHalfDiagonal));
    const auto all = tiles();
    std::vector<std::vector<Index>> edge(all.size());
    std::vector<std::vector<std::uint8_t>> roomy(all.size());
    parallel_for(all.size(), settings_.threads, [&](std::size_t t) {
      const auto& [low, high] = all[t];
      if (!any(block_, low, high, kNever)) return;
      for_each_index(low, high, [&](const Index& at) {
        if (state(at) == kNever && in_region(at) && at_edge(at)) edge[t].push_back(at);
      });
      if (edge[t].empty()) return;
      const int reach = 2 * static_cast<int>(std::ceil(radius));
      const VoxelBlock room = balls_in(low, high, reach, [&](const Index&) { return radius; });
      const Index from = clipped(low, -reach), to = clipped(high, reach);
      const std::vector<float> sides = squared_sides(from, to, static_cast<int>(radius) + 1);
      const VoxelBlock around{{to[0] - from[0], to[1] - from[1], to[2] - from[2]}, {}};
      for (const Index& at : edge[t]) {
        const bool fits = room.marked[room.place(at[0] - low[0], at[1] - low[1], at[2] - low[2])];
        const float side = sides[around.place(at[0] - from[0], at[1] - from[1], at[2] - from[2])];
        roomy[t].push_back(fits && side > radius * radius && clear_of_mesh(at, radius));
      }
    });
    for (std::size_t t = 0; t < all.size(); ++t)
      for (std::size_t k = 0; k < edge[t].size(); ++k)
        state(edge[t][k]) = roomy[t][k] ? kRoomyEdge : kEdge;
    return edge;
  }

  // Squared distances of the voxels of a box from measured surface within it, in voxels.
  std::vector<float> squared_sides(const Index& from, const Index& to, int reach) const {
    VoxelBlock open{{to[0] - from[0], to[1] - from[1], to[2] - from[2]}, {}};
    for_each_index(from, to,
                   [&](const Index& at) { open.marked.push_back(state(at) != kSurface); });
    return squared_rooms(open, reach);
  }
  bool clear_of_mesh(const Index& at, float voxels) const {
    return !mesh_ || !mesh_->nearest(center(at), voxels * grid_.resolution());
  }

  // Faces of a cube that look up an axis and that look down it.
  struct Faces {
    Eigen::Array3i up = Eigen::Array3i::Zero(), down = Eigen::Array3i::Zero();

    // As vectors; what looks up and what looks down are two surfaces as far as both are there.
    double area() const {
      return up.max(down).cast<double>().matrix().norm() +
             up.min(down).cast<double>().matrix().norm();
    }
  };

  // All of the edge that is connected to a voxel of it, which counts from then on. Without area
  // where it is a speck.
  Opening opening_from(const Index& start) {
    std::vector<Index> voxels{start};
    std::vector<std::size_t> roomy;
    std::map<std::size_t, Faces> cubes;
    int count = 0;
    const auto take = [&](const Index& at) {
      if (state(at) == kRoomyEdge) roomy.push_back(voxels.size() - 1);
      state(at) = kCounted;
      Faces& faces = cubes[cube_of(at)];
      for_each_neighbour(at, [&](const Index& n, std::size_t axis, int side) {
        if (state(n) != kAir || !in_region(n)) return;
        ++(side > 0 ? faces.up : faces.down)[static_cast<Eigen::Index>(axis)];
        ++count;
      });
    };
    take(start);
    for (std::size_t k = 0; k < voxels.size(); ++k) {
      const Index at = voxels[k];
      for_each_index({at[0] - 1, at[1] - 1, at[2] - 1}, {at[0] + 2, at[1] + 2, at[2] + 2},
                     [&](const Index& n) {
                       if (state(n) != kEdge && state(n) != kRoomyEdge) return;
                       voxels.push_back(n);
                       take(n);
                     });
    }
    Opening opening;
    if (count < kFewest) return opening;
    for (const auto& [cube, faces] : cubes) opening.area += faces.area();
    opening.area *= grid_.resolution() * grid_.resolution();
    opening.passable = settings_.width > 0 && !roomy.empty();
    for (const Index& at : voxels) opening.voxels.push_back(key(at));
    std::vector<Index> chosen;
    for (const std::size_t k : roomy) chosen.push_back(voxels[k]);
    opening.place = middle_of(largest_part(opening.passable ? chosen : voxels));
    return opening;
  }

  // Those of the voxels that look at air one way along one axis, the largest of the parts in which
  // they touch. An opening may go round a house, and then its mean lies within the house.
  std::vector<Index> largest_part(const std::vector<Index>& voxels) const {
    std::vector<Index> largest;
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int side : {-1, 1}) {
        std::set<Index> left;
        for (const Index& at : voxels) {
          const Index n = moved(at, axis, side);
          if (n[axis] >= 0 && n[axis] < block_.size[axis] && state(n) == kAir && in_region(n))
            left.insert(at);
        }
        while (!left.empty()) {
          std::vector<Index> part = part_from(*left.begin(), left);
          if (part.size() > largest.size()) largest = std::move(part);
        }
      }
    return largest.empty() ? voxels : largest;
  }
  // Takes all that is connected to `start`, at corners too.
  static std::vector<Index> part_from(const Index& start, std::set<Index>& left) {
    std::vector<Index> part{start};
    left.erase(start);
    for (std::size_t k = 0; k < part.size(); ++k) {
      const Index at = part[k];
      for_each_index({at[0] - 1, at[1] - 1, at[2] - 1}, {at[0] + 2, at[1] + 2, at[2] + 2},
                     [&](const Index& n) {
                       if (left.erase(n) > 0) part.push_back(n);
                     });
    }
    return part;
  }

  // The middle of the voxel nearest to the mean of all.
  Vector3d middle_of(const std::vector<Index>& voxels) const {
    Vector3d mean = Vector3d::Zero();
    for (const Index& at : voxels) mean += center(at);
    mean /= static_cast<double>(voxels.size());
    const auto away = [&](const Index& at) { return (center(at) - mean).squaredNorm(); };
    return center(
        *std::min_element(voxels.begin(), voxels.end(),
                          [&](const Index& a, const Index& b) { return away(a) < away(b); }));
  }

  const Map& map_;
  VoxelGrid grid_;
  const MeshScene* mesh_;
  const EdgeSettings& settings_;
  Index low_{}, inner_{};  // key of the first voxel; voxels of the region along each axis
  std::optional<RegionVoxels> prisms_;  // of a region that is no box
  int rim_ = 0;
  VoxelBlock block_;          // states, of region and rim
  VoxelBlock cubes_;          // of the region; without marks
  std::vector<float> balls_;  // of each cube, in voxels
};

}  // namespace

std::vector<Opening> unknown_openings(const Map& map, const MeshScene* mesh,
                                      const EdgeSettings& settings) {
  return Space(map, mesh, settings).openings();
}

}  // namespace lapwing
