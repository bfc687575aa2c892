// SPDX-License-Identifier: Apache-2.0
// Scans of regions that are far larger than a battery's flight.
#include "tests/missions/scan_hut.h"

namespace lapwing {
namespace {

class LargeScans : public Scanning {
 protected:
  // A flat field of so many metres with a wide, low block in its middle.
  void write_field(double edge) {
    const std::string e = std::to_string(edge / 2), n = "-" + e;
    const std::string b = std::to_string(edge / 8), a = "-" + b;
    const auto vertex = [](const std::string& x, const std::string& y, const char* z) {
      return "v " + x + " " + y + " " + z + "\n";
    };
    std::string mesh = vertex(n, n, "0") + vertex(e, n, "0") + vertex(e, e, "0") +
                       vertex(n, e, "0") + "f 1 2 3 4\n";
    for (const char* z : {"0", "8"})
      mesh += vertex(a, a, z) + vertex(b, a, z) + vertex(b, b, z) + vertex(a, b, z);
    mesh += "f 9 10 11 12\nf 5 6 10 9\nf 6 7 11 10\nf 7 8 12 11\nf 8 5 9 12\n";
    write_file_atomically(folder_ / "field.obj", mesh);
    write_file_atomically(folder_ / "field.lua", R"(
return require("mission.scan").of_mesh {
  name = "field", resolution = 2, tour = { budget = 120, iterations = 20 },
  camera = { width = 40, height = 30, focal = 23 }, usable = { range = 60 },
  surface = { spacing = 4, cell = 6, trim = 12 },
  candidates = { most = 90, step = 8, distance_apart = 6 },
  motions = { alpha = 0.2, coarse = 20 },
}
)");
  }
  int fly(const std::string& more) {
    return run("--set input=field.obj --data '" + folder_.string() + "' " + more, "field.lua");
  }
  std::string notes() const {
    const Value said = answer();
    std::string notes;
    for (const Value& note : said.at("notes").as_list()) notes += note.as_text() + "\n";
    return notes;
  }
};

// A crosshatch and a grid that looks down, each with a bound; what that costs is said.
TEST_F(LargeScans, TheDefaultFirstFlightIsBoundedAndSaysSo) {
  write_field(300);
  ASSERT_EQ(fly("--set candidates.most=150"), 0) << error();
  EXPECT_LE(std::stoi(notes()), 600);
  EXPECT_GE(std::stoi(notes()), 400);
  EXPECT_THAT(notes(), HasSubstr("the region is large: the crosshatch has"));
  EXPECT_THAT(notes(), HasSubstr("times as far apart as overlap needs; 200 images look down"));
}

// So few pixels show nothing of use farther than 2 m away.
TEST_F(LargeScans, WhatIsTooFarToBeOfUseIsSaidWithTheDistance) {
  write_field(100);
  EXPECT_EQ(fly("--set usable.range=2"), 2);
  EXPECT_THAT(error(), HasSubstr("no surface within the usable range of 2 m"));
}

// Its images begin the tour's views, and leave most of them to be grown.
TEST_F(LargeScans, AFirstFlightOfManyImagesLeavesRoomForOtherCandidates) {
  write_field(100);
  ASSERT_EQ(fly(""), 0) << error();
  EXPECT_GT(std::stoi(notes()), 120);
  EXPECT_EQ(answer().at("tour").at("candidates").as_integer(), 90) << notes();
}

}  // namespace
}  // namespace lapwing
