// The shipped scans at their full size, and meshes of others.
#include "tests/missions/flown_film.h"

namespace lapwing {
namespace {

void expect_scan(const Flown& flown, const char* name) {
  EXPECT_EQ(flown.status, 0) << to_json(flown.result);
  EXPECT_EQ(flown.result.at("status").as_text(), "ok") << name;
  const Value& tour = flown.result.at("tour");
  std::printf("%s: score %.0f, gap %.3f, %.0f s, %lld images\n", name, tour.at("score").as_number(),
              tour.at("gap").as_number(), tour.at("seconds").as_number(),
              static_cast<long long>(tour.at("images").as_integer()));
  EXPECT_GT(tour.at("images").as_integer(), 5) << name;
}

TEST_F(Filming, ShippedScansAreCertified) {
  for (const char* name : {"church", "street", "courtyard"})
    expect_scan(fly("../scan/" + std::string(name) + ".lua"), name);
}

TEST_F(Filming, MeshesOfOthersAreScanned) {
  if (data_folder().empty()) GTEST_SKIP() << "LAPWING_DATA names no folder with meshes";
  for (const char* name : {"delft_block.obj", "gz_powerplant.dae"})
    expect_scan(fly("../scan/own_mesh.lua", "--config scan/small --data '" + data_folder() +
                                                "' --set ground=true --set input=" + name),
                name);
}

}  // namespace
}  // namespace lapwing
