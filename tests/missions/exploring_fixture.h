// SPDX-License-Identifier: Apache-2.0
// Explorations of a small yard, run from the shell.
#pragma once

#include "tests/missions/flown_film.h"

namespace lapwing {

// A yard with two houses, 40 m wide.
inline constexpr const char* kYard = R"(v -20 -20 0.1
v 20 -20 0.1
v 20 20 0.1
v -20 20 0.1
f 1 2 3 4
v 6.1 -8.1 0.1
v 14.1 -8.1 0.1
v 14.1 2.1 0.1
v 6.1 2.1 0.1
v 6.1 -8.1 7.1
v 14.1 -8.1 7.1
v 14.1 2.1 7.1
v 6.1 2.1 7.1
f 9 10 11 12
f 5 6 10 9
f 6 7 11 10
f 7 8 12 11
f 8 5 9 12
)";

class Exploring : public Filming {
 protected:
  // The yard, with few images of few pixels.
  std::string few(const std::string& more) {
    const fs::path mesh = folder_ / "yard.obj";
    write_file_atomically(mesh, kYard);
    return "--config explore/small --set compare=true --set utility=frontier "
           "--set camera.width=80 --set camera.height=60 --set start=[0,0,4] --set input='" +
           mesh.string() + "' " + more;
  }
  Flown explore(const std::string& more, const char* out) {
    return fly("../explore/own_mesh.lua", few(more), out);
  }
  // What is said of bad input; empty where it is taken.
  std::string refusal(const std::string& more) {
    const std::string errors = (folder_ / "errors.txt").string();
    const std::string line = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing run '" +
                             (kExamples / "../explore/own_mesh.lua").string() +
                             "' --quiet --out '" + (folder_ / "refused").string() + "' " + more +
                             " 2> '" + errors + "'";
    return WEXITSTATUS(std::system(line.c_str())) == 2 ? read_file(errors) : "";
  }
};

}  // namespace lapwing
