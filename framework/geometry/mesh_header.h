// What the beginning of a mesh file claims, looked at before a reader believes it. Internal to this
// room; callers include mesh_file.h.
#pragma once

#include <optional>
#include <string>

#include "framework/geometry/mesh_file.h"

namespace lapwing {

// Throws InputError naming the file when a PLY or binary STL claims more than its size can hold, or
// when its end is missing. `format` is MeshFile::format.
void check_mesh_header(const std::string& bytes, const std::string& format,
                       const std::string& name);

// What a Collada document states of its frame.
struct ColladaFrame {
  std::optional<double> unit;  // m
  std::optional<UpAxis> up;
};
ColladaFrame collada_frame(const std::string& text);

}  // namespace lapwing
