// SPDX-License-Identifier: Apache-2.0
// Bytes by their SHA-256: pictures and triangles that pages fetch.
#pragma once

#include <list>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "framework/geometry/triangle_mesh.h"

namespace lapwing {

class BlobStore {
 public:
  // Beyond so many bytes those that were put or asked for longest ago are forgotten; a blob that is
  // larger by itself is kept alone.
  explicit BlobStore(std::size_t most_bytes) : most_(most_bytes) {}

  // Its name: 64 hexadecimal digits.
  std::string put(std::string bytes);
  // The same, of a name that is known to be right.
  void put(const std::string& name, std::string bytes);
  // Null where there is none.
  std::shared_ptr<const std::string> find(std::string_view name);
  bool holds(std::string_view name) const { return blobs_.find(name) != blobs_.end(); }
  std::size_t bytes() const { return total_; }

 private:
  struct Blob {
    std::shared_ptr<const std::string> bytes;
    std::list<std::string>::iterator used;
  };
  void touch(Blob& blob);

  std::size_t most_, total_ = 0;
  std::list<std::string> by_use_;  // the latest first
  std::map<std::string, Blob, std::less<>> blobs_;
};

// Triangles as a blob: the text "WLB1", then as 32-bit little-endian numbers the counts of vertices
// and triangles and 0, three floats a vertex (m) and three places of vertices a triangle.
std::string triangles_blob(const TriangleMesh& mesh);

}  // namespace lapwing
