// SPDX-License-Identifier: Apache-2.0
// What of a mesh the default region of a scan holds, and what is said of the rest.
#include "tests/missions/scan_hut.h"

namespace lapwing {
namespace {

class ScanRegion : public Scanning {
 protected:
  void SetUp() override {
    Scanning::SetUp();
    // A closed house of 10 m x 8 m x 6 m: its roof is 80 m^2.
    write_file_atomically(folder_ / "house.obj", R"(v 0 0 0
v 10 0 0
v 10 8 0
v 0 8 0
v 0 0 6
v 10 0 6
v 10 8 6
v 0 8 6
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
)");
    write_file_atomically(folder_ / "house.lua", R"(
return require("mission.scan").of_mesh { name = "house", tour = { budget = 120, iterations = 40 } }
)");
  }
  Value surface(const std::string& more) {
    EXPECT_EQ(run("--config scan/small --set input=house.obj --set ground=true --data '" +
                      folder_.string() + "' " + more,
                  "house.lua"),
              0)
        << error();
    const Value said = answer();
    return said.at("tour").at("surface");
  }
  std::string notes() const {
    std::string all;
    const Value said = answer();
    for (const Value& note : said.at("notes").as_list()) all += note.as_text() + "\n";
    return all;
  }
};

// A coarse map moves a roof up, and it still counts.
TEST_F(ScanRegion, HoldsTheRoofOfACoarseMap) {
  const Value found = surface("");
  EXPECT_LT(found.at("outside").as_number(), 8) << to_json(found);
  // Roof, walls and ground are 656 m^2, rounded off at coarse edges; 576 m^2 without the roof.
  EXPECT_GT(found.at("known").as_number(), 610) << to_json(found);
  EXPECT_EQ(notes().find("outside the region"), std::string::npos) << notes();
}

TEST_F(ScanRegion, WhatLiesOverItIsSaid) {
  const Value found =
      surface("--set region.lower=[-6,-6,-1] --set region.upper=[16,14,4] --set safe_height=10");
  EXPECT_GT(found.at("outside").as_number(), 80) << to_json(found);
  EXPECT_THAT(notes(), HasSubstr("m^2 of the known surface lie outside the region (above it) and "
                                 "are not counted"));
  EXPECT_THAT(read_file(folder_ / "out/report.html"), HasSubstr("known above or below the region"));
}

}  // namespace
}  // namespace lapwing
