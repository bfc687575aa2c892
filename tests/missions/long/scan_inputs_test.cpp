// SPDX-License-Identifier: Apache-2.0
// What scans begin with: files of an earlier flight, shipped configurations.
#include "framework/map/map_file.h"
#include "tests/missions/scan_hut.h"

namespace lapwing {
namespace {

class ScanInputs : public Scanning {
 protected:
  // With what is printed on the way.
  int run_aloud(const std::string& arguments) {
    const std::string line = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing run " + arguments +
                             " --out '" + (folder_ / "out").string() + "' > '" +
                             (folder_ / "stdout.json").string() + "' 2> '" +
                             (folder_ / "stderr.txt").string() + "'";
    return WEXITSTATUS(std::system(line.c_str()));
  }
};

// What they leave open is said at once. A quick look takes the voxels that they have.
TEST_F(ScanInputs, FilesOfAnEarlierFlightAreLookedAtQuickly) {
  ASSERT_EQ(run(""), 0) << error();
  const std::string files =
      "--set prior.map=out/map.ot --set prior.mesh=out/prior.ply --data '" + folder_.string() + "'";
  const auto refused_with = [&](const std::string& more) {
    write_file_atomically(folder_ / "again.lua",
                          "return require('mission.scan').of_prior { " + more + " }\n");
    EXPECT_EQ(run(files, "again.lua", "again"), 2) << more;
    return error();
  };
  const std::string all = refused_with("");
  EXPECT_THAT(all, HasSubstr("the start of the tour and the region of interest"));
  EXPECT_THAT(all, HasSubstr("give start = {x, y, z} and region = { lower = {x, y, z}"));
  EXPECT_THAT(all, HasSubstr("The mesh 'out/prior.ply' lies between {"));
  const std::string no_start =
      refused_with("region = { lower = {-6, -5, -0.4}, upper = {6, 5, 7} }");
  EXPECT_THAT(no_start, HasSubstr("do not state the start of the tour: give start = {x, y, z}."));
  const std::string no_region = refused_with("start = {0, 0, 13}");
  EXPECT_THAT(no_region, HasSubstr("do not state the region of interest: give region"));

  write_file_atomically(folder_ / "again.lua", R"(
return require("mission.scan").of_prior {
  range = 30, reach = 8, safe_height = 9, ceiling = 15,
  region = { lower = {-6, -5, -0.4}, upper = {6, 5, 7} }, start = {0, 0, 13},
  usable = { range = 30 },
  tour = { budget = 70, iterations = 60 }, camera = { width = 80, height = 60, focal = 46 },
}
)");
  ASSERT_EQ(run(files + " --config scan/small", "again.lua", "again"), 0) << error();
  EXPECT_EQ(answer().at("status").as_text(), "ok");
  EXPECT_EQ(read_map_file(folder_ / "again/map.ot").resolution, 0.4);
  // Who states another one is told that it cannot be.
  EXPECT_EQ(run(files + " --set resolution=0.5", "again.lua", "again"), 2);
  EXPECT_THAT(error(), HasSubstr("resolution: 0.5 m, and the prior's map 'out/map.ot' has voxels "
                                 "of 0.4 m: leave resolution out"));
}

// A pair that is shipped works as it is shipped: the utility was trained with voxels of 0.4 m.
TEST_F(ScanInputs, TheShippedExplorationIsLookedAtQuickly) {
  ASSERT_EQ(run_aloud("'" LAPWING_SOURCE_DIR "/examples/explore/explore_then_scan.lua' --quiet "
                      "--json --config scan/small --set exploration.images=5 "
                      "--set tour.budget=40 --set tour.iterations=20"),
            0)
      << error();
  EXPECT_EQ(answer().at("status").as_text(), "ok");
  EXPECT_EQ(read_map_file(folder_ / "out/map.ot").resolution, 0.4);
}

}  // namespace
}  // namespace lapwing
