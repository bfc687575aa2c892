// SPDX-License-Identifier: Apache-2.0
// A hut that is made here, flown over and scanned.
#pragma once

#include <gmock/gmock.h>

#include "tests/missions/flown_film.h"

namespace lapwing {

using testing::HasSubstr;

class Scanning : public Filming {
 protected:
  void SetUp() override {
    fs::create_directories(folder_ / "scene");
    write_file_atomically(folder_ / "scene/hut.lua", R"(
return function(options)
  local scene = lapwing.scene { name = "hut", seed = options.seed }
  scene:quad({-30, -30, 0}, {30, -30, 0}, {30, 30, 0}, {-30, 30, 0})
  scene:box({-4, -3, 0}, {4, 3, 4})
  scene:box({2, -1, 4}, {3, 0, 6})
  scene:region({-6, -5, -0.4}, {6, 5, 7})
  return scene
end
)");
    write("hut.lua", "");
  }

  // The hut's mission, after `before`.
  void write(const std::string& name, const std::string& before) {
    write_file_atomically(folder_ / name, before + R"(
local scan = require "mission.scan"
return scan.of_scene {
  name = "hut", scene = "hut", resolution = 0.4, range = 30, reach = 8,
  tour = { budget = 70, iterations = 60 },
  usable = { range = 30 },
  camera = { width = 80, height = 60, focal = 46 },
  flights = { { pattern = "ellipse", views = 8, reach = 3, pitch_deg = -40, height = 14 },
              { pattern = "meander", views = 12, reach = 1, height = 13 } },
  safe_height = 9, surface = { spacing = 0.8, cell = 1, trim = 2 },
  candidates = { most = 60, step = 2.5, distance_apart = 2 },
  motions = { alpha = 0.3, coarse = 40 },
}
)");
  }

  int run(const std::string& more, const std::string& name = "hut.lua",
          const std::string& out = "out") {
    const std::string line =
        std::string(LAPWING_BUILD_DIR) + "/bin/lapwing run '" + (folder_ / name).string() +
        "' --json --quiet --out '" + (folder_ / out).string() + "' " + more + " > '" +
        (folder_ / "stdout.json").string() + "' 2> '" + (folder_ / "stderr.txt").string() + "'";
    return WEXITSTATUS(std::system(line.c_str()));
  }
  Value answer() const { return from_json(read_file(folder_ / "stdout.json"), "stdout"); }
  std::string error() const { return read_file(folder_ / "stderr.txt"); }
  std::string plan(const std::string& out = "out") const {
    return read_file(folder_ / out / "plan.json");
  }
  std::string refused(const std::string& more) {
    const int status = run(more, "hut.lua", "refused");
    EXPECT_TRUE(status == 1 || status == 2) << status << ": " << more;
    EXPECT_FALSE(fs::exists(folder_ / "refused/plan.json")) << more;
    return error();
  }
};

}  // namespace lapwing
