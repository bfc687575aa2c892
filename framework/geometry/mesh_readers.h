// SPDX-License-Identifier: Apache-2.0
// Readers of single mesh formats, and what they share. Internal to this room; callers include
// mesh_file.h.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "framework/geometry/mesh_file.h"

namespace lapwing {

// Adds a polygon, given as places in the mesh's vertices: a fan where that does, else without ears.
// Fewer than three corners are left aside; places that do not exist stay, for check_mesh to name.
void append_polygon(const std::vector<std::int32_t>& corners, const Rgb& color, TriangleMesh& mesh);

// A PLY, in units and axes of its own. Throws InputError naming the file for anything that is not
// as its header says, a count that its size cannot hold first of all.
TriangleMesh read_ply(std::string_view bytes, const std::string& name);

// Throws InputError naming the file when a binary STL claims more triangles than it holds or a text
// lacks its end.
void check_stl(std::string_view bytes, const std::string& name);

// What a Collada document states of its frame.
struct ColladaFrame {
  std::optional<double> unit;  // m
  std::optional<UpAxis> up;
};
ColladaFrame collada_frame(const std::string& text);
// Throws InputError naming the file where it is neither JSON nor binary glTF: assimp then asks all
// its other readers, and some take minutes over a few bytes.
void check_gltf(std::string_view bytes, const std::string& name);
// Throws InputError naming the file where a list of numbers holds something else, or a count is
// more than the text could hold: assimp does not come back from those.
void check_collada(std::string_view text, const std::string& name);

}  // namespace lapwing
