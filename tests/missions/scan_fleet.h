// SPDX-License-Identifier: Apache-2.0
// The hut, scanned by several batteries.
#pragma once

#include "framework/trajectory/fleet.h"
#include "tests/missions/scan_hut.h"

namespace lapwing {

inline constexpr const char* kTwoDrones =
    "--set batteries=3 --set drones=2 --set fleet.swap=20 "
    "--set 'fleet.starts=[{position: [-8,-8,13]},{position: [8,8,13]}]'";

inline constexpr const char* kPond =
    "--set 'no_fly_zones=[{name: pond, corners: [9,-12,12,-12,12,-9,9,-9]}]'";

class FleetScans : public Scanning {
 protected:
  Fleet fleet() const {
    return fleet_from_value(from_json(read_file(folder_ / "out/fleet.json"), "fleet.json"));
  }
  Plan plan_of(const FleetTour& tour) const {
    return plan_from_value(from_json(read_file(folder_ / "out" / tour.file), tour.file));
  }
  int verify_again(const std::string& what) {
    const std::string line = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing verify '" +
                             (folder_ / what).string() + "' > '" +
                             (folder_ / "verified.txt").string() + "' 2>&1";
    return WEXITSTATUS(std::system(line.c_str()));
  }
  std::string verified() const { return read_file(folder_ / "verified.txt"); }
  std::string refused_fleet(const std::string& more) {
    EXPECT_EQ(run(more, "hut.lua", "refused"), 2) << more;
    EXPECT_FALSE(fs::exists(folder_ / "refused/fleet.json")) << more;
    const std::string said = error();
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 1) << said;
    return said;
  }
};

}  // namespace lapwing
