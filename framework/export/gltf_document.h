// SPDX-License-Identifier: Apache-2.0
// A glTF 2.0 document in the making: JSON, and the one buffer that its accessors read.
//
// Points of the world (x east, y north, z up) become glTF's (y up): x east, y up, z south.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "framework/core/value.h"
#include "framework/geometry/triangle_mesh.h"

namespace lapwing {

// (east, north, up) to (east, up, south); a rotation.
Eigen::Vector3d y_up(const Eigen::Vector3d& world);

class GltfDocument {
 public:
  GltfDocument();

  // Each gives the place of what it added in its list of the document. Names that are no UTF-8 are
  // mended; an empty one becomes `fallback`.
  int add_node(const std::string& name, const std::string& fallback, Value node);
  int add_camera(Value camera);
  // Lines through points of the world (mode LINE_STRIP), or triangles with flat normals left to
  // the viewer; `color` red, green, blue, opacity, each 0 to 1, linear.
  int add_lines(const std::vector<std::vector<Eigen::Vector3d>>& lines,
                const Eigen::Vector4d& color);
  int add_triangles(const TriangleMesh& mesh, const Eigen::Vector4d& color);
  // Triangles with a colour each (sRGB, as in pictures) and, by name, a number each. The name of a
  // number begins with "_" and has capital letters, digits and "_".
  struct TriangleNumbers {
    std::string name;
    std::vector<float> values;
  };
  int add_colored_triangles(const TriangleMesh& mesh, const std::vector<Rgb>& colors,
                            const std::vector<TriangleNumbers>& numbers);

  // One key a time: places (world) and, unless empty, orientations of the node (in y up).
  void animate(int node, const std::vector<double>& times,
               const std::vector<Eigen::Vector3d>& places,
               const std::vector<Eigen::Quaterniond>& orientations);

  // The bytes of a .glb file.
  std::string binary(const std::string& scene) const;

 private:
  int add_accessor(const std::vector<float>& numbers, int width, bool bounds, int target);
  int add_colors(const std::vector<std::uint8_t>& colors);  // four parts a vertex, of 255
  int add_indices(const std::vector<std::uint32_t>& numbers);
  int add_material(const Eigen::Vector4d& color);
  int add_view(const void* bytes, std::size_t size, int target);

  Value nodes_ = Value::list(), cameras_ = Value::list(), meshes_ = Value::list(),
        materials_ = Value::list(), accessors_ = Value::list(), views_ = Value::list(),
        samplers_ = Value::list(), channels_ = Value::list();
  std::string buffer_;
};

}  // namespace lapwing
