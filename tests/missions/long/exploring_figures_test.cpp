// SPDX-License-Identifier: Apache-2.0
// What the readme of the learned utility says of it, on fewer and shorter episodes.
#include <chrono>
#include <cmath>
#include <map>

#include "framework/core/json.h"
#include "tests/missions/flown_film.h"

namespace lapwing {
namespace {

class ExploringFigures : public Filming {
 protected:
  using Rows = std::map<std::pair<std::string, std::string>, Value>;  // by world and utility

  Value answer_of(const std::string& command) {
    const fs::path said = folder_ / "said.json";
    const std::string line = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing " + command +
                             " --json > '" + said.string() + "'";
    EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 0) << line;
    return from_json(read_file(said), command);
  }
  Rows evaluate(const std::string& more, const std::string& name) {
    const Value answer =
        answer_of("evaluate explore --quiet -o '" + (folder_ / name).string() + "' " + more);
    Rows rows;
    for (const Value& row : answer.at("rows").as_list())
      rows[{row.at("world").as_text(), row.at("utility").as_text()}] = row;
    return rows;
  }
};

TEST_F(ExploringFigures, TheLearnedUtilityComesNextToTheOracle) {
  const std::string worlds = "--world suburb --world downtown:202 --episodes 2 --steps 80 ";
  const Rows seeing = evaluate(worlds, "seeing");
  const Rows blind =
      evaluate(worlds + "--utility learned --utility oracle --set learned.blank=true", "blind");
  const auto relative = [](const Rows& rows, const char* world, const char* utility) {
    return rows.at({world, utility}).at("relative").as_number();
  };
  const auto efficiency = [](const Rows& rows, const char* world, const char* utility) {
    return rows.at({world, utility}).at("efficiency").as_number();
  };
  double mean = 0;
  for (const char* world : {"suburb 1", "downtown 202"}) {
    const double learned = relative(seeing, world, "learned");
    for (const char* other : {"frontier", "average_entropy", "proximity_count"})
      EXPECT_GT(learned, relative(seeing, world, other)) << world << " " << other;
    EXPECT_GT(learned, relative(blind, world, "learned") + 0.1) << world;
    EXPECT_GT(learned, 0.6) << world;
    // The greedy oracle is not the best that there is (reading 5.7): `learned` may be above it.
    for (const char* other : {"frontier", "average_entropy", "proximity_count"})
      EXPECT_LT(efficiency(seeing, world, other), efficiency(seeing, world, "oracle")) << other;
    mean += learned / 2;
  }
  EXPECT_GT(mean, 0.85);
}

// The readme's own episodes, from the same starts and with true depth: fewer or shorter ones tell
// 5 % from chance no more. A metre of noise costs more than that, unless it is smoothed.
TEST_F(ExploringFigures, NoiseAndStereoCostLittle) {
  const std::string flown =
      "--world street --world suburb --world downtown:201 --utility learned --episodes 10 ";
  evaluate(flown, "clear");
  const std::string against = "--against '" + (folder_ / "clear").string() + "'";
  int count = 0;
  for (const auto& [camera, least] : {std::pair{"--dropped 0.4 --sigma 0.2", 0.95},
                                      {"--dropped 0.4 --sigma 1", 0.8},
                                      {"--dropped 0.4 --sigma 1 --smooth-to 0.2", 0.94},
                                      {"--stereo 0.5", 0.95}}) {
    const Rows rows = evaluate(flown + camera + " " + against, "noisy" + std::to_string(++count));
    const Value& all = rows.at({"all", "learned"});
    const double kept = all.at("against").as_number();
    std::printf("%s: %.3f +- %.3f\n", camera, kept, all.at("against_interval").as_number());
    EXPECT_GT(kept, least) << camera;
    EXPECT_LT(kept, 1.05) << camera;
  }
}

// One thread an episode, two at once; of the oracle everything, the camera and the world as well.
TEST_F(ExploringFigures, StepsAreFast) {
  evaluate("--world street --episodes 2 --threads 2 --utility learned --utility frontier", "timed");
  const std::string seconds = read_file(folder_ / "timed/seconds.csv");
  const auto step = [&](const std::string& utility) {
    const std::string row = "street 1," + utility + ",2,";
    const std::size_t at = seconds.find(row);
    return at == seconds.npos ? HUGE_VAL : std::stod(seconds.substr(at + row.size()));
  };
  EXPECT_LT(step("learned"), 0.05 * slowness()) << seconds;
  EXPECT_LT(step("frontier"), 0.05 * slowness()) << seconds;
  const auto begin = std::chrono::steady_clock::now();
  evaluate("--world street --episodes 1 --utility oracle", "oracle");
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  EXPECT_LT(took.count(), 20);
}

// Spearman's rho of the default network: in episodes that it was not trained on of worlds that it
// was, and in worlds that it has never seen.
TEST_F(ExploringFigures, ItRanksViews) {
  const auto mean_rho = [&](const std::string& worlds, const std::vector<int>& seeds,
                            double least) {
    std::string samples;
    for (const int seed : seeds) {
      const std::string folder =
          "'" + (folder_ / ("samples" + std::to_string(seed))).string() + "' ";
      const std::string made = std::string(LAPWING_BUILD_DIR) +
                               "/bin/lapwing train dataset --episodes 1 --quiet --seed " +
                               std::to_string(seed) + " -o " + folder + worlds;
      EXPECT_EQ(std::system(made.c_str()), 0);
      samples += folder;
    }
    const Value answer =
        answer_of("train score " + samples +
                  " --model '" LAPWING_SOURCE_DIR "/plugins/utilities/learned/learned.model'");
    double sum = 0;
    for (const auto& [world, entry] : answer.as_map()) {
      EXPECT_GT(entry.at("samples").as_integer(), 300) << world;
      EXPECT_GT(entry.at("rho").as_number(), least) << world;
      sum += entry.at("rho").as_number();
    }
    return sum / static_cast<double>(answer.as_map().size());
  };
  EXPECT_GT(mean_rho("--world downtown:1 --world downtown:5 --world district:3", {99}, 0.85), 0.9);
  EXPECT_GT(mean_rho("--world street --world suburb --world church --world towers --world "
                     "downtown:201 --steps 60",
                     {1, 2}, 0.85),
            0.9);
}

}  // namespace
}  // namespace lapwing
