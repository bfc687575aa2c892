// SPDX-License-Identifier: Apache-2.0
// A house whose mesh is a file, scanned with the defaults of flights and region.
#pragma once

#include "tests/missions/scan_hut.h"

namespace lapwing {

// A house whose walls are the edge of the mesh.
inline constexpr const char* kHouseMesh = R"(v -6 -5 0
v 6 -5 0
v 6 5 0
v -6 5 0
v -6 -5 7
v 6 -5 7
v 6 5 7
v -6 5 7
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
)";

// A court of 16 m x 16 m between wings of 3 m, 6 m high.
inline constexpr const char* kCourtMesh = R"(v -11 -11 0
v 11 -11 0
v 11 11 0
v -11 11 0
v -11 -11 6
v 11 -11 6
v 11 11 6
v -11 11 6
v -8 -8 0
v 8 -8 0
v 8 8 0
v -8 8 0
v -8 -8 6
v 8 -8 6
v 8 8 6
v -8 8 6
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
f 10 9 13 14
f 11 10 14 15
f 12 11 15 16
f 9 12 16 13
f 5 6 14 13
f 6 7 15 14
f 7 8 16 15
f 8 5 13 16
)";

class Covering : public Scanning {
 protected:
  void SetUp() override {
    Scanning::SetUp();
    write_file_atomically(folder_ / "house.obj", kHouseMesh);
    write_file_atomically(folder_ / "house.lua", R"(
return require("mission.scan").of_mesh {
  name = "house", resolution = 0.4, tour = { budget = 120, iterations = 60 },
  usable = { range = 30 },
  camera = { width = 80, height = 60, focal = 46 }, surface = { spacing = 0.8, cell = 1, trim = 2 },
  candidates = { most = 80, step = 2.5, distance_apart = 2 },
  motions = { alpha = 0.3, coarse = 40 },
}
)");
  }
  // With the mesh in place of a scene, and all defaults of flights and region.
  Value of_house(const std::string& more, const std::string& out = "out") {
    EXPECT_EQ(
        run("--set input=house.obj --set ground=true --data '" + folder_.string() + "' " + more,
            "house.lua", out),
        0)
        << error();
    return answer();
  }
  static double number(const Value& surface, const char* name) {
    return surface.at(name).as_number();
  }
};

// 264 m^2 of walls stand at the edge of the mesh's bounds, and the ground round them.

}  // namespace lapwing
