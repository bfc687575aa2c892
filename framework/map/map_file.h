// SPDX-License-Identifier: Apache-2.0
// Maps as files: OctoMap's .bt (two states) and .ot (log odds), and .ply (points, written only).
//
// Written files are canonical: equal maps give equal bytes, whatever backend holds them. Files are
// taken to be hostile: nothing is allocated that the bytes themselves do not account for.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "framework/map/map.h"

namespace lapwing {

struct MapFile {
  double resolution = 0;          // m
  bool two_states = false;        // .bt: log odds are plus or minus infinity
  std::vector<VoxelLeaf> leaves;  // in order of their Morton numbers
};

// Tells .bt from .ot by its first line; ids OcTree and ColorOcTree (colours are left out).
// InputError naming the file, the place in it and what would be right.
MapFile read_map_file(const std::filesystem::path& path);
// The same from bytes; `name` stands in messages.
MapFile parse_map(std::string_view bytes, const std::string& name);

// By the name's ending, whole or not at all; InputError for another ending and for what cannot be
// written. A .bt holds what is free and what is occupied, a voxel in between is left out; a .ot
// holds every known voxel's log odds; a .ply the middles of occupied voxels with x, y, z (m) and
// log_odds, at most 50 million. Observations are in none of them.
void write_map_file(const std::filesystem::path& path, const Map& map);
// The same as bytes; `ending` is ".bt", ".ot" or ".ply".
std::string map_file_bytes(std::string_view ending, const Map& map);

}  // namespace lapwing
