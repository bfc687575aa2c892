// SPDX-License-Identifier: Apache-2.0
#include "framework/explore/ray_image.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/fields.h"
#include "framework/explore/view_rays.h"

namespace lapwing {
namespace {

constexpr int kRest = 30;             // voxels that count as all of the last segment
constexpr std::size_t kCounted = 64;  // observations: after more of them nothing is left

int voxels_of(int segment) {
  if (segment + 1 == RayShape::kSegments) return kRest;
  const auto at = static_cast<std::size_t>(segment);
  return RayShape::kEnds[at] - (segment > 0 ? RayShape::kEnds[at - 1] : 0);
}

// Reads along one ray.
class RayReader {
 public:
  RayReader(const Map& map, double range) : map_(map), range_(range) {
    for (std::size_t n = 0; n < left_.size(); ++n)
      left_[n] = static_cast<float>(map.uncertainty(static_cast<std::uint16_t>(n)));
  }

  void read(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, float* to) const {
    std::fill(to, to + RayShape::kChannels, 0.0f);
    to[0] = 1;
    int behind = -1, segment = 0;  // voxels behind the first one that is not free; -1: none yet
    float before[2] = {0, 0};
    walk_ray(map_, origin, direction, range_, [&](const VoxelReading& voxel, double entered) {
      if (behind < 0) {
        if (voxel.state == VoxelState::free) {
          before[1] = before[0];
          before[0] = left(voxel);
          return true;
        }
        to[0] = static_cast<float>(entered / range_);
        to[1] = voxel.known ? 0 : 1;
        if (voxel.known) {
          to[2] = occupancy(voxel);
          to[3] = to[2] * left(voxel);
        }
        to[4] = before[0];
        to[5] = before[1];
        behind = 0;
        return true;
      }
      while (segment + 1 < RayShape::kSegments &&
             behind >= RayShape::kEnds[static_cast<std::size_t>(segment)])
        ++segment;
      ++behind;
      float* part = to + RayShape::kFirst + RayShape::kOfSegment * segment;
      if (!voxel.known) {
        part[0] += 1;
      } else {
        const float p = occupancy(voxel);
        part[1] += p;
        part[2] = std::max(part[2], p * left(voxel));
      }
      return true;
    });
    for (int s = 0; s < RayShape::kSegments; ++s) {
      float* part = to + RayShape::kFirst + RayShape::kOfSegment * s;
      for (int c = 0; c < 2; ++c)
        part[c] = std::min(1.0f, part[c] / static_cast<float>(voxels_of(s)));
    }
  }

 private:
  float left(const VoxelReading& voxel) const {
    return left_[std::min<std::size_t>(voxel.observations, left_.size() - 1)];
  }
  static float occupancy(const VoxelReading& voxel) { return 1 / (1 + std::exp(-voxel.log_odds)); }

  const Map& map_;
  double range_;
  std::array<float, kCounted> left_;  // of a voxel, by its observations
};

}  // namespace

void require_sense(const RayShape& shape) {
  for (const int edge : {shape.columns, shape.rows})
    if (edge < RayShape::kLeastRays || edge > RayShape::kMostRays)
      throw InputError("an image of " + std::to_string(shape.columns) + " x " +
                       std::to_string(shape.rows) + " rays: expected " +
                       std::to_string(RayShape::kLeastRays) + " to " +
                       std::to_string(RayShape::kMostRays) + " along an edge");
}

Value to_value(const RayShape& shape) {
  Value value = Value::map();
  value.set("columns", shape.columns);
  value.set("rows", shape.rows);
  return value;
}

RayShape ray_shape_from(const Value& value) {
  Diagnostics errors;
  Fields fields(value, "rays", errors);
  RayShape shape;
  shape.columns = fields.integer("columns", RayShape::kLeastRays, RayShape::kMostRays);
  shape.rows = fields.integer("rows", RayShape::kLeastRays, RayShape::kMostRays);
  fields.finish();
  errors.throw_if_any();
  return shape;
}

void sample_rays(const EpisodeView& known, const Viewpoint& view, const RayShape& shape,
                 std::span<float> image) {
  if (image.size() != shape.size()) throw Error("an image of rays of another size");
  const Eigen::Matrix3d to_world = view.camera().orientation.toRotationMatrix();
  const RayReader reader(*known.map, known.range);
  float* to = image.data();
  for (int row = 0; row < shape.rows; ++row)
    for (int column = 0; column < shape.columns; ++column, to += RayShape::kChannels) {
      const double u = (column + 0.5) * known.pinhole.width / shape.columns - 0.5;
      const double v = (row + 0.5) * known.pinhole.height / shape.rows - 0.5;
      reader.read(view.position, to_world * pixel_ray(known.pinhole, u, v).normalized(), to);
    }
}

int ray_cell(const RayShape& shape, const Pinhole& pinhole, const Eigen::Vector3d& p_C) {
  const double z = std::max(p_C.z(), 1e-6);
  const double u = p_C.x() / z * pinhole.focal_x + pinhole.principal_x;
  const double v = p_C.y() / z * pinhole.focal_y + pinhole.principal_y;
  const auto cell = [](double pixel, int pixels, int cells) {
    return static_cast<int>(
        std::clamp(std::floor((pixel + 0.5) * cells / pixels), 0.0, cells - 1.0));
  };
  return cell(v, pinhole.height, shape.rows) * shape.columns +
         cell(u, pinhole.width, shape.columns);
}

}  // namespace lapwing
