// SPDX-License-Identifier: Apache-2.0
// PLY meshes from memory, many more than through files: whatever the bytes, a mesh or an
// InputError.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "framework/core/error.h"
#include "framework/geometry/mesh_readers.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lapwing;
  try {
    const TriangleMesh mesh = read_ply({reinterpret_cast<const char*>(data), size}, "input");
    if (mesh.vertices.size() > size || mesh.triangles.size() > size) std::abort();
  } catch (const InputError&) {
  }
  return 0;
}
