// SPDX-License-Identifier: Apache-2.0
// The episode of an exploration in a run's folder: read back whole, refused with both versions.
#include "framework/export/episode_file.h"

#include <unistd.h>

#include <cstring>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "tests/export/synthetic_flight.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "lapwing 1.2.3";

GridSlices slices() {
  GridSlices grid;
  grid.points = 2;
  for (int level = 0; level < 2; ++level) {
    const auto shade = static_cast<std::uint8_t>(10 * level);
    grid.occupancy.push_back({2, 2, std::vector<std::uint8_t>(12, shade)});
    grid.certainty.push_back({2, 2, std::vector<std::uint8_t>(12, 200)});
    grid.edges.push_back(1.5 * (level + 1));
  }
  return grid;
}

ExplorationRecord record() {
  ExplorationRecord record;
  record.utility = "frontier";
  record.end = "all requested images are taken";
  record.surface = 100;
  record.efficiency = 31;
  record.resolution = 0.25;
  record.images = {{0.5, {0, 0, 2}, 0.25, -0.125, 12, 1}, {3, {1, 0, 2}, 0.5, -0.125, 7, 9}};
  record.observed = {10, 21};
  record.oracle = {12, 25};
  record.candidates = {{{2, 0, 2}, {1, 0, 0}, 3}};
  record.growth = {{{1, 2, 3}, 1}, {{1, 2, 3.25f}, 2}};
  const ExplorationSight sight{slices(), {{{5, 0, 2}, 0.5f, 3}, {{0, 5, 2}, 1, 0}}};
  record.sights = {sight, sight};
  return record;
}

class EpisodeFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("lapwing_episode_" + std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    plan_.kind = "explore";
    write(plan_text(plan_));
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& plan) {
    write_file_atomically(folder_ / "plan.json", plan);
    for (const auto& [name, bytes] : episode_files(record(), plan, kProgram))
      write_file_atomically(folder_ / name, bytes);
  }
  std::string refusal(const std::string& program = kProgram) const {
    try {
      read_episode(folder_, program);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  void replace(const char* from, const std::string& to) {
    std::string text = read_file(folder_ / "episode.json");
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    write_file_atomically(folder_ / "episode.json", text.replace(at, std::strlen(from), to));
  }

  fs::path folder_;
  Plan plan_ = synthetic_flight(4, 9, 0.5);
};

TEST_F(EpisodeFile, IsReadBackWhole) {
  const ShownEpisode shown = read_episode(folder_, kProgram);
  EXPECT_EQ(shown.plan.mission, plan_.mission);
  EXPECT_EQ(to_json(shown.exploration, -1), to_json(exploration_value(record()), -1));
  EXPECT_EQ(shown.growth, growth_bytes(record()));
  EXPECT_EQ(shown.sights, sights_bytes(record().sights));
  // Counts, edges, then of each image its slices and rays.
  EXPECT_EQ(shown.sights.size(), 20 + 2 * 4 + 2 * (2 * 2 * 4 + 2 * 20u));
  EXPECT_EQ(static_cast<unsigned char>(shown.sights[28 + 4]), 10);
  EXPECT_EQ(shown.growth.size(), 12 + 2 * 16u);
}

TEST_F(EpisodeFile, AnotherVersionOrFormatIsRefusedWithBoth) {
  const std::string other = refusal("lapwing 2.0.0");
  for (const char* part :
       {"episode.json", "lapwing 1.2.3", "lapwing 2.0.0", "run the mission again"})
    EXPECT_NE(other.find(part), std::string::npos) << other;
  replace("\"format\": 1", "\"format\": 7");
  for (const char* part : {"in format 7", "shows format 1"})
    EXPECT_NE(refusal().find(part), std::string::npos) << refusal();
}

TEST_F(EpisodeFile, WhatIsNoEpisodeIsNamed) {
  fs::remove(folder_ / "episode.json");
  EXPECT_NE(refusal().find("has no episode.json"), std::string::npos) << refusal();
  plan_.kind = "film";
  write_file_atomically(folder_ / "plan.json", plan_text(plan_));
  EXPECT_NE(refusal().find("kind 'film'"), std::string::npos) << refusal();
  fs::remove(folder_ / "plan.json");
  EXPECT_NE(refusal().find("has no plan.json"), std::string::npos) << refusal();
  fs::remove_all(folder_);
  EXPECT_NE(refusal().find("is no folder"), std::string::npos) << refusal();
}

TEST_F(EpisodeFile, FilesThatDoNotBelongTogetherAreRefused) {
  for (const char* name : {"plan.json", "episode_growth.bin", "episode_sights.bin"}) {
    const std::string bytes = read_file(folder_ / name);
    write_file_atomically(folder_ / name, bytes + " ");
    EXPECT_NE(refusal().find(name), std::string::npos) << refusal();
    write_file_atomically(folder_ / name, bytes);
  }
  EXPECT_EQ(refusal(), "");
  replace("\"scored\": 9", "\"scored\": -9");
  EXPECT_NE(refusal().find("scored"), std::string::npos) << refusal();
}

}  // namespace
}  // namespace lapwing
