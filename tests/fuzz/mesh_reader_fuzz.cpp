// SPDX-License-Identifier: Apache-2.0
// Mesh files: whatever the bytes, a sound mesh or an InputError. The first byte chooses the format.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <fstream>

#include "framework/core/error.h"
#include "framework/geometry/mesh_file.h"
#include "tests/fuzz/scratch_folder.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lapwing;
  if (size == 0) return 0;
  constexpr const char* kEndings[] = {"ply", "obj", "stl", "dae", "gltf", "glb"};
  const char* const ending = kEndings[data[0] % std::size(kEndings)];
  const std::filesystem::path path = scratch_folder() / ("mesh." + std::string(ending));
  {
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(data + 1), static_cast<std::streamsize>(size - 1));
  }
  try {
    const MeshFile file = read_mesh(path);
    if (!(file.unit > 0) || file.mesh.triangles.empty()) std::abort();
    for (const Eigen::Vector3d& vertex : file.mesh.vertices)
      if (!vertex.allFinite()) std::abort();
    const auto count = static_cast<std::int64_t>(file.mesh.vertices.size());
    for (const auto& triangle : file.mesh.triangles)
      for (const std::int32_t corner : triangle)
        if (corner < 0 || corner >= count) std::abort();
  } catch (const InputError&) {
  }
  return 0;
}
