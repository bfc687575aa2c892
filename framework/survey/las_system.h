// SPDX-License-Identifier: Apache-2.0
// What a .las file says of the reference system of its coordinates. Internal to this room.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace lapwing {

// What its records of user "LASF_Projection" hold.
struct LasSystemRecords {
  std::string keys;  // GeoKeyDirectoryTag (34735)
  std::string text;  // GeoAsciiParamsTag (34737), what keys refer to
  std::string wkt;   // 2112
};

struct LasSystem {
  std::string text;        // for ReferenceSystem::of; "" where nothing can be told
  double height_unit = 0;  // m; 0 where it is not stated
  std::string note;        // what is stated and cannot be used, "its system is ..."; or ""
};

// Of WKT where `prefer_wkt` says so and it is there, else of GeoTIFF keys (OGC 19-008r4): the EPSG
// codes of the projected or geographic system, and of the vertical one. Damaged keys give a note.
LasSystem system_of_las(const LasSystemRecords& records, bool prefer_wkt);

// m of a unit by its EPSG code, for metres and feet; 0 for others.
double metres_of_unit(int code);

}  // namespace lapwing
