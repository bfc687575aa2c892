// SPDX-License-Identifier: Apache-2.0
// Answers about a map, to pages that look into scans and explorations: a voxel, a slice. Internal
// to this room.
#pragma once

#include <bit>
#include <optional>
#include <string>

#include "framework/map/map.h"
#include "framework/studio/frames.h"

namespace lapwing {

static_assert(std::endian::native == std::endian::little);

// Bytes of a blob: a text of four letters, then 32-bit little-endian numbers.
class BlobBytes {
 public:
  explicit BlobBytes(const char* name) : bytes_(name) {}
  template <class Number>
  BlobBytes& add(Number number) {
    static_assert(sizeof number == 4);
    bytes_.append(reinterpret_cast<const char*>(&number), sizeof number);
    return *this;
  }
  BlobBytes& add(const Eigen::Vector3d& v) {
    for (int i = 0; i < 3; ++i) add(static_cast<float>(v[i]));
    return *this;
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

Value point_list(const Eigen::Vector3d& v);

// The answer to a question: `members` as an object, then the blobs that are added.
Frame answer_with(const Value& members);
void add_blob(Frame& frame, const char* name, std::string bytes);

// The voxel of the place, or the first occupied one on the ray, that `at` of the question names.
// InputError where there is none.
VoxelKey asked_voxel(const Frame& question, const Map& map);

// What the map knows of a voxel: members of the answer `voxel`.
Value voxel_members(const Map& map, const VoxelKey& voxel);

// The layer across `axis` at `at` of the question. `images`: of an exploration, that are in the
// map.
Frame slice_answer(const Frame& question, const Map& map, std::optional<int> images = {});

}  // namespace lapwing
