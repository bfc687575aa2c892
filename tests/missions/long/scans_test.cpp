// SPDX-License-Identifier: Apache-2.0
// The shipped scans at their full size, and meshes of others.
#include <sys/resource.h>

#include "tests/missions/scan_hut.h"

namespace lapwing {
namespace {

void expect_scan(const Flown& flown, const char* name) {
  EXPECT_EQ(flown.status, 0) << to_json(flown.result);
  EXPECT_EQ(flown.result.at("status").as_text(), "ok") << name;
  const Value& tour = flown.result.at("tour");
  std::printf("%s: score %.0f, gap %.3f, %.0f s, %lld images\n", name, tour.at("score").as_number(),
              tour.at("gap").as_number(), tour.at("seconds").as_number(),
              static_cast<long long>(tour.at("images").as_integer()));
  // Of 400 candidates over a power plant neighbours are 20 m apart, and a leg takes 24 s.
  EXPECT_GE(tour.at("images").as_integer(), 5) << name;
  EXPECT_GT(tour.at("seconds").as_number(), 0.9 * tour.at("budget").as_number()) << name;
}

TEST_F(Scanning, SolversAreSwappedByConfigurationAlone) {
  write_file_atomically(folder_ / "greedy.yaml", "tour: {solver: greedy, lazy: false}\n");
  write("own.lua", "");
  ASSERT_EQ(run(""), 0) << error();
  const double best = answer().at("tour").at("score").as_number();
  // The script's own `iterations` is none of theirs.
  const std::string text = read_file(folder_ / "own.lua");
  write_file_atomically(folder_ / "own.lua",
                        std::string(text).replace(text.find(", iterations = 60"), 17, ""));
  for (const std::string& more :
       {std::string("--config '") + (folder_ / "greedy.yaml").string() + "'",
        std::string("--set tour.solver=cost_benefit"),
        std::string("--set tour.solver=recursive_greedy"), std::string("--set tour=greedy"),
        std::string("--set tour.solver=milp --set tour.guard=20"),
        std::string("--set tour.images=4 --set tour.iterations=30")}) {
    ASSERT_EQ(run(more, "own.lua"), 0) << more << ": " << error();
    EXPECT_LE(answer().at("tour").at("score").as_number(), 1.05 * best) << more;
    EXPECT_GT(answer().at("tour").at("images").as_integer(), 1) << more;
  }
  EXPECT_LE(answer().at("tour").at("images").as_integer(), 4);
  EXPECT_EQ(run("--set tour.solver=gredy", "own.lua"), 2);
  EXPECT_THAT(error(), HasSubstr("greedy"));
  EXPECT_EQ(run("--set tour.lazyness=1", "own.lua"), 2);
  EXPECT_THAT(error(), HasSubstr("tour.lazyness"));
}

// In less than 4 GB each, and five minutes of two cores.
TEST_F(Filming, ShippedScansAreCertified) {
  for (const char* name : {"church", "street", "courtyard"}) {
    rusage before{}, after{};
    ::getrusage(RUSAGE_CHILDREN, &before);
    expect_scan(fly("../scan/" + std::string(name) + ".lua"), name);
    ::getrusage(RUSAGE_CHILDREN, &after);
    const auto seconds = [](const rusage& used) {
      return static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec);
    };
    std::printf("%s: %.0f s of one core, %.2f GB at most so far\n", name,
                seconds(after) - seconds(before), 1e-6 * static_cast<double>(after.ru_maxrss));
    EXPECT_LT(seconds(after) - seconds(before), 600) << name;
    EXPECT_LT(after.ru_maxrss, 4'000'000) << name;  // kB
  }
}

TEST_F(Filming, ShippedMeshesAreScanned) {
  for (const char* name : {"tower.obj", "cottage.dae"})
    expect_scan(
        fly("../scan/own_mesh.lua",
            "--config scan/small --set candidates.most=400 --set ground=true --data '" +
                std::string(LAPWING_SOURCE_DIR "/tests/data") + "' --set input=meshes/" + name),
        name);
}

TEST_F(Filming, MeshesOfOthersAreScanned) {
  if (data_folder().empty()) GTEST_SKIP() << "LAPWING_DATA names no folder with meshes";
  for (const char* name : {"delft_block.obj", "gz_powerplant.dae"})
    expect_scan(fly("../scan/own_mesh.lua",
                    "--config scan/small --set tour.budget=120 --set range=100 "
                    "--set candidates.most=400 --set ground=true --data '" +
                        data_folder() + "' --set input=" + name),
                name);
}

}  // namespace
}  // namespace lapwing
