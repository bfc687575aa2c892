// SPDX-License-Identifier: Apache-2.0
#include "framework/explore/view_grid.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/fields.h"
#include "framework/core/json.h"
#include "framework/core/number_text.h"

namespace lapwing {
namespace {

constexpr double kAlike = 1e-6;  // of two numbers of a mapping
constexpr const char* kMappingKeys[] = {
    "resolution",  "mode",  "hit",   "miss",   "clamp_min", "clamp_max", "pixel_step",
    "information", "range", "width", "height", "focal_x",   "focal_y",   "pitch"};

// One level: the cubes around the camera are copied, then interpolated.
void sample_level(const EpisodeView& known, const Viewpoint& view, const GridShape& shape,
                  int level, std::vector<MeanReading>& cubes, std::span<float> grid) {
  const VoxelGrid& voxels = known.map->grid();
  const double edge = voxels.resolution() * (1 << level);
  const CameraAxes<double> axes = camera_axes(view.yaw, view.pitch);
  // In units of cubes, counted so that the middle of cube c is at c.
  const Eigen::Vector3d middle =
      view.position.array() / edge + kCenterKey / static_cast<double>(1 << level) - 0.5;
  const int count[3] = {shape.across, shape.ahead, shape.up};
  const Eigen::Vector3d along[3] = {axes.right, axes.forward, -axes.down};
  Eigen::Vector3d reach = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) reach += along[i].cwiseAbs() * (count[i] - 1) / 2.0;
  int low[3], size[3];
  for (int i = 0; i < 3; ++i) {
    low[i] = static_cast<int>(std::floor(middle[i] - reach[i] - 1e-6));
    size[i] = static_cast<int>(std::floor(middle[i] + reach[i] + 1e-6)) + 2 - low[i];
  }
  known.means->copy(level, low, size, cubes);
  const std::size_t row = static_cast<std::size_t>(size[0]),
                    layer = row * static_cast<std::size_t>(size[1]);
  const auto channels = static_cast<std::size_t>(shape.channels());
  float* out = grid.data() + 2 * (level - 1);
  for (int k = 0; k < count[2]; ++k)
    for (int j = 0; j < count[1]; ++j) {
      const Eigen::Vector3d first = middle + (k - (count[2] - 1) / 2.0) * along[2] +
                                    (j - (count[1] - 1) / 2.0) * along[1] -
                                    (count[0] - 1) / 2.0 * along[0];
      for (int i = 0; i < count[0]; ++i, out += channels) {
        const Eigen::Vector3d p = first + i * along[0];
        std::size_t at[3];
        float part[3];
        for (int a = 0; a < 3; ++a) {
          const double from = p[a] - low[a];
          at[a] = static_cast<std::size_t>(from);
          part[a] = static_cast<float>(from - static_cast<double>(at[a]));
        }
        const MeanReading* c = cubes.data() + at[0] + row * at[1] + layer * at[2];
        const auto between = [&](auto member) {
          const auto line = [&](const MeanReading* q) {
            return q->*member + part[0] * ((q + 1)->*member - q->*member);
          };
          const auto face = [&](const MeanReading* q) {
            const float a = line(q);
            return a + part[1] * (line(q + row) - a);
          };
          const float a = face(c);
          return a + part[2] * (face(c + layer) - a);
        };
        out[0] = between(&MeanReading::occupancy);
        out[1] = between(&MeanReading::uncertainty);
      }
    }
}

// As a mission's options say it: log odds as a probability, angles in degrees.
std::string in_words(const std::string& key, const Value& value) {
  if (!value.is_number()) return to_json(value, -1);
  const double number = value.as_number();
  if (key == "hit" || key == "miss" || key.starts_with("clamp_"))
    return plain_number(1 / (1 + std::exp(-number)));
  if (key == "pitch") return plain_number(number * 180 / EIGEN_PI) + " deg";
  return plain_number(number) + (key == "resolution" || key == "range" ? " m" : "");
}

}  // namespace

void require_sense(const GridShape& shape) {
  for (const int points : {shape.across, shape.ahead, shape.up})
    if (points < GridShape::kLeastPoints || points > GridShape::kMostPoints)
      throw InputError("a grid of " + std::to_string(shape.across) + " x " +
                       std::to_string(shape.ahead) + " x " + std::to_string(shape.up) +
                       " points: expected 2 to 64 along each edge");
  if (shape.levels < 1 || shape.levels > MapMeans::kMostLevels)
    throw InputError("a grid of " + std::to_string(shape.levels) + " levels: expected 1 to " +
                     std::to_string(MapMeans::kMostLevels));
}

Value to_value(const GridShape& shape) {
  Value value = Value::map();
  value.set("across", shape.across);
  value.set("ahead", shape.ahead);
  value.set("up", shape.up);
  value.set("levels", shape.levels);
  return value;
}

GridShape grid_shape_from(const Value& value) {
  Diagnostics errors;
  Fields fields(value, "grid", errors);
  GridShape shape;
  shape.across = fields.integer("across", GridShape::kLeastPoints, GridShape::kMostPoints);
  shape.ahead = fields.integer("ahead", GridShape::kLeastPoints, GridShape::kMostPoints);
  shape.up = fields.integer("up", GridShape::kLeastPoints, GridShape::kMostPoints);
  shape.levels = fields.integer("levels", 1, MapMeans::kMostLevels);
  fields.finish();
  errors.throw_if_any();
  return shape;
}

void sample_grid(const EpisodeView& known, const Viewpoint& view, const GridShape& shape,
                 std::span<float> grid) {
  if (grid.size() != shape.size()) throw Error("the grid has another size than its shape");
  thread_local std::vector<MeanReading> cubes;
  for (int level = 1; level <= shape.levels; ++level)
    sample_level(known, view, shape, level, cubes, grid);
}

Value mapping_of(const EpisodeView& known) {
  const MapSettings& s = known.map->settings();
  Value value = Value::map();
  value.set("resolution", s.resolution);
  value.set("mode", s.mode == IntegrationMode::exact ? "exact" : "discretised");
  value.set("hit", static_cast<double>(s.hit));
  value.set("miss", static_cast<double>(s.miss));
  value.set("clamp_min", static_cast<double>(s.clamp_min));
  value.set("clamp_max", static_cast<double>(s.clamp_max));
  value.set("pixel_step", s.pixel_step);
  value.set("information", s.information);
  value.set("range", known.range);
  value.set("width", known.pinhole.width);
  value.set("height", known.pinhole.height);
  value.set("focal_x", known.pinhole.focal_x);
  value.set("focal_y", known.pinhole.focal_y);
  value.set("pitch", known.pitch);
  return value;
}

std::string mapping_fault(const Value& value) {
  if (!value.is_map()) return "it is not a map";
  for (const char* key : kMappingKeys) {
    const Value* found = value.find(key);
    if (!found) return std::string("it has no ") + key;
    const bool text = std::string_view(key) == "mode";
    if (text ? !found->is_text() : !found->is_number())
      return std::string("its ") + key + " is " + found->describe_type();
  }
  for (const auto& [key, given] : value.as_map())
    if (std::find(std::begin(kMappingKeys), std::end(kMappingKeys), key) == std::end(kMappingKeys))
      return "it has a " + key + ", which nothing reads";
  return "";
}

std::string mapping_difference(const Value& given, const Value& expected) {
  for (const auto& [key, value] : expected.as_map()) {
    const Value* other = given.find(key);
    if (!other) return key + " is missing";
    const bool same = value.is_number() && other->is_number()
                          ? std::abs(value.as_number() - other->as_number()) <=
                                kAlike * std::max(1.0, std::abs(value.as_number()))
                          : value == *other;
    if (!same)
      return key + " is " + in_words(key, *other) + ", the model's " + in_words(key, value);
  }
  return "";
}

}  // namespace lapwing
