// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/map_answers.h"

#include <algorithm>
#include <cmath>

#include "framework/core/json.h"
#include "framework/core/number_text.h"
#include "framework/map/map_look.h"

namespace lapwing {
namespace {

constexpr std::size_t kMostSliced = std::size_t{1} << 20;  // of a slice

Eigen::Vector3d vector_in(const Value& list, std::size_t first = 0) {
  const auto& numbers = list.as_list();
  return {numbers.at(first).as_number(), numbers.at(first + 1).as_number(),
          numbers.at(first + 2).as_number()};
}

const char* name_of(const VoxelReading& reading) {
  if (!reading.known) return "unknown";
  return reading.state == VoxelState::free       ? "free"
         : reading.state == VoxelState::occupied ? "occupied"
                                                 : "between";
}

// Of each cell its log odds as a number of 0 to 255 between the clamps, then its state.
std::string bytes_of_slice(const MapSlice& slice, const MapSettings& settings) {
  BlobBytes head("WLS1");
  head.add(static_cast<std::uint32_t>(slice.columns)).add(static_cast<std::uint32_t>(slice.rows));
  std::string bytes = head.take();
  const float low = settings.clamp_min, wide = settings.clamp_max - settings.clamp_min;
  for (const float odds : slice.log_odds)
    bytes += static_cast<char>(
        static_cast<std::uint8_t>(std::lround(255 * std::clamp((odds - low) / wide, 0.0f, 1.0f))));
  for (const CellState state : slice.states) bytes += static_cast<char>(state);
  return bytes;
}

}  // namespace

Value point_list(const Eigen::Vector3d& v) {
  return Value(Value::List{v.x(), v.y(), v.z()});
}

Frame answer_with(const Value& members) {
  Frame frame;
  frame.header.set("said", "done");
  frame.header.set("blobs", Value::list());
  frame.parts.push_back(to_json(members, -1));
  return frame;
}

void add_blob(Frame& frame, const char* name, std::string bytes) {
  frame.header.find("blobs")->push_back(name);
  frame.parts.push_back(std::move(bytes));
}

VoxelKey asked_voxel(const Frame& question, const Map& map) {
  const Value& at = question.header.at("at");
  if (at.as_list().size() == 3) {
    const Eigen::Vector3d p = vector_in(at);
    if (!map.grid().contains(p))
      throw InputError("the place lies beyond the largest map, which reaches " +
                       plain_number(map.grid().reach()) + " m from the origin");
    return map.grid().key(p);
  }
  const Eigen::Vector3d direction = vector_in(at, 3);
  if (!(direction.norm() > 0)) throw InputError("ray: its direction has no length");
  const auto hit = first_occupied(map, vector_in(at), direction.normalized());
  if (!hit)
    throw InputError(
        "no occupied voxel lies there; free and unknown ones are found on a slice of the map");
  return *hit;
}

Value voxel_members(const Map& map, const VoxelKey& voxel) {
  const VoxelReading reading = map.read(voxel);
  Value value = Value::map();
  value.set("key", Value(Value::List{std::int64_t{voxel.x}, std::int64_t{voxel.y},
                                     std::int64_t{voxel.z}}));
  value.set("middle", point_list(map.grid().center(voxel)));
  value.set("edge", map.grid().resolution());
  value.set("state", name_of(reading));
  value.set("log_odds", static_cast<double>(reading.log_odds));
  value.set("observations",
            map.settings().observations ? Value(std::int64_t{reading.observations}) : Value());
  return value;
}

Frame slice_answer(const Frame& question, const Map& map, std::optional<int> images) {
  const VoxelGrid& grid = map.grid();
  const auto axis = static_cast<int>(question.header.at("axis").as_integer());
  const MapSlice slice = slice_of(map, axis, question.header.at("at").as_number(), kMostSliced);
  constexpr const char* kAxes[3] = {"x", "y", "z"};
  Value value = Value::map();
  value.set("axis", kAxes[axis]);
  value.set("at", grid.center(slice.layer));
  const VoxelBox bounds = map.bounds().value();
  value.set("extent",
            Value(Value::List{grid.center(bounds.lower[axis]), grid.center(bounds.upper[axis])}));
  if (images) value.set("image", std::int64_t{*images});
  value.set("edge", grid.resolution());
  value.set("level", std::int64_t{slice.level});
  value.set("lower", Value(Value::List{grid.face(slice.first[0]), grid.face(slice.first[1])}));
  value.set("columns", std::int64_t{slice.columns});
  value.set("rows", std::int64_t{slice.rows});
  Value& counts = value.set("counts", Value::map());
  counts.set("free", static_cast<std::int64_t>(slice.free));
  counts.set("occupied", static_cast<std::int64_t>(slice.occupied));
  counts.set("between", static_cast<std::int64_t>(slice.between));
  counts.set("unknown", static_cast<std::int64_t>(slice.unknown));
  value.set("clamps", Value(Value::List{static_cast<double>(map.settings().clamp_min),
                                        static_cast<double>(map.settings().clamp_max)}));
  Frame frame = answer_with(value);
  add_blob(frame, "cells", bytes_of_slice(slice, map.settings()));
  return frame;
}

}  // namespace lapwing
