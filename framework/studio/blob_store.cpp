// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/blob_store.h"

#include <bit>
#include <cstdint>
#include <cstring>

#include "framework/core/checksum.h"

namespace lapwing {

static_assert(std::endian::native == std::endian::little);

std::string BlobStore::put(std::string bytes) {
  std::string name = sha256(bytes);
  put(name, std::move(bytes));
  return name;
}

void BlobStore::put(const std::string& name, std::string bytes) {
  if (const auto found = blobs_.find(name); found != blobs_.end()) return touch(found->second);
  by_use_.push_front(name);
  total_ += bytes.size();
  blobs_[name] = {std::make_shared<const std::string>(std::move(bytes)), by_use_.begin()};
  while (total_ > most_ && by_use_.size() > 1) {
    const auto oldest = blobs_.find(by_use_.back());
    total_ -= oldest->second.bytes->size();
    blobs_.erase(oldest);
    by_use_.pop_back();
  }
}

std::shared_ptr<const std::string> BlobStore::find(std::string_view name) {
  const auto found = blobs_.find(name);
  if (found == blobs_.end()) return nullptr;
  touch(found->second);
  return found->second.bytes;
}

void BlobStore::touch(Blob& blob) {
  by_use_.splice(by_use_.begin(), by_use_, blob.used);
}

std::string triangles_blob(const TriangleMesh& mesh) {
  std::string blob = "WLB1";
  const auto add = [&blob](auto number) {
    char bytes[sizeof number];
    std::memcpy(bytes, &number, sizeof number);
    blob.append(bytes, sizeof number);
  };
  blob.reserve(16 + 12 * (mesh.vertices.size() + mesh.triangles.size()));
  add(static_cast<std::uint32_t>(mesh.vertices.size()));
  add(static_cast<std::uint32_t>(mesh.triangles.size()));
  add(std::uint32_t{0});
  for (const Eigen::Vector3d& vertex : mesh.vertices)
    for (int i = 0; i < 3; ++i) add(static_cast<float>(vertex[i]));
  for (const auto& triangle : mesh.triangles)
    for (const std::int32_t corner : triangle) add(static_cast<std::uint32_t>(corner));
  return blob;
}

}  // namespace lapwing
