// SPDX-License-Identifier: Apache-2.0
// City models in CityGML 1.0 and 2.0 as meshes. By libcitygml in the program `lapwing_city`
// (reader_program.h), where Lapwing was built with it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>

#include "framework/geometry/triangle_mesh.h"

namespace lapwing {

struct CityModel {
  // In the coordinates of the file. Of each object the polygons of its finest level of detail,
  // without what is inside of buildings.
  TriangleMesh mesh;
  std::string system;                  // reference system, as the file writes it; "" without
  std::map<int, std::size_t> objects;  // number of objects by their level of detail
  std::size_t prototypes = 0;          // implicit geometries, as of trees, which are left out
  std::size_t flat = 0;                // polygons without area, which are left out
};

// Whether libcitygml is built in.
bool city_models_available();

// Whether a file's name says that it is one: .gml, .citygml.
bool is_city_model(const std::filesystem::path& file);

// InputError, naming the file: libcitygml is not built in, what is no CityGML or damaged, a model
// without surface.
CityModel read_city_model(const std::filesystem::path& file);

}  // namespace lapwing
