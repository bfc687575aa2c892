// SPDX-License-Identifier: Apache-2.0
// Triangle meshes from and to files: Wavefront OBJ, PLY, STL, glTF (.gltf, .glb), Collada (.dae).
//
// A mesh comes out in metres with z up, whatever the file says of itself, and the caller is told
// what was done:
//   Collada  states its unit and its up axis; absent, they are 1 m and y up, as its standard says
//   glTF     is in metres and y up by its standard
//   others   state neither: metres and z up are assumed
// Materials, textures, lines and points are left aside; the diffuse colour of a material stays.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "framework/geometry/triangle_mesh.h"

namespace lapwing {

enum class UpAxis { x, y, z };
// InputError for another name than "x", "y" and "z".
UpAxis up_axis(const std::string& name);

struct MeshFileOptions {
  // Metres that one unit of the file is; absent: as above.
  std::optional<double> unit = std::nullopt;
  std::optional<UpAxis> up = std::nullopt;  // absent: as above
};

// Where a unit or an axis comes from.
enum class StatedBy { file, standard, caller, assumption };

struct MeshFile {
  TriangleMesh mesh;   // welded: no vertex twice, no triangle without area
  std::string format;  // "Collada"
  double unit = 1;     // m
  StatedBy unit_from = StatedBy::assumption;
  UpAxis up = UpAxis::z;
  StatedBy up_from = StatedBy::assumption;
  std::size_t dropped = 0;  // triangles without area
  // What is odd about where it lies or how large it is, with what to do; "" (mesh_doubts.h).
  std::string doubt = {};

  // "Collada, 0.0254 m a unit (stated by the file), z up (stated by the file), 3021 triangles"
  std::string description() const;
};

// Throws InputError naming the file: another extension, unreadable, truncated, larger than 1 GB, a
// count in its header that its size cannot hold, and all that `check_mesh` refuses.
MeshFile read_mesh(const std::filesystem::path& path, const MeshFileOptions& options = {});

// Binary PLY: coordinates in single precision (8 um at 100 m), colours on the faces. Appears whole
// or not at all. Throws InputError as write_file_atomically and check_mesh do.
void write_ply(const TriangleMesh& mesh, const std::filesystem::path& path);
// The bytes of it.
std::string ply_bytes(const TriangleMesh& mesh);

}  // namespace lapwing
