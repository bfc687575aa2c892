// SPDX-License-Identifier: Apache-2.0
#include "framework/study/training_recipe.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <set>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/study/reproduction.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

const char* const kWhole = R"(utility: learned
hours: 4
validation:
  - {scenes: [mine], seeds: [901, 902], explorer: frontier, steps: 5}
rounds:
  - samples:
      - {scenes: [mine, depot], seeds: [1, 10], explorer: oracle, steps: 5}
    fit: {epochs: 2}
  - samples:
      - {scenes: [mine], seeds: [11, 11], explorer: itself, steps: 5, sigma: 0.5, dropped: 0.4}
)";

class RecipeFile : public testing::Test {
 protected:
  ~RecipeFile() override { fs::remove(path_); }
  TrainingRecipe read(const std::string& text) const {
    write_file_atomically(path_, text);
    return read_recipe(path_);
  }
  // Of the whole recipe with one part exchanged.
  std::string refusal(const std::string& part, const std::string& other) const {
    std::string text = kWhole;
    text.replace(text.find(part), part.size(), other);
    try {
      read(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  const fs::path path_ =
      fs::temp_directory_path() / ("lapwing_recipe_" + std::to_string(::getpid()) + ".yaml");
};

TEST_F(RecipeFile, IsReadWhole) {
  const TrainingRecipe recipe = read(kWhole);
  EXPECT_EQ(recipe.utility, "learned");
  ASSERT_EQ(recipe.rounds.size(), 2u);
  EXPECT_EQ(recipe.rounds[0].samples.at(0).worlds(),
            (std::vector<std::string>{"mine:1-10", "depot:1-10"}));
  EXPECT_EQ(recipe.rounds[0].fit.at("epochs").as_integer(), 2);
  EXPECT_EQ(recipe.rounds[1].samples.at(0).explorer, "itself");
  EXPECT_EQ(recipe.rounds[1].samples.at(0).sigma, 0.5);
  EXPECT_EQ(recipe.validation.at(0).worlds(), std::vector<std::string>{"mine:901-902"});
}

TEST_F(RecipeFile, HoursAreAShareOfTheSeeds) {
  const TrainingRecipe recipe = read(kWhole);
  const TrainingRecipe one = recipe.within(1);
  EXPECT_EQ(one.rounds[0].samples.at(0).last, 3);   // 2.5 of 10
  EXPECT_EQ(one.rounds[1].samples.at(0).last, 11);  // at least one
  EXPECT_EQ(one.validation.at(0).last, 901);
  EXPECT_EQ(recipe.within(4).rounds[0].samples.at(0).last, 10);
  for (const double hours : {0.0, -1.0, 4.5, std::nan("")})
    EXPECT_THROW(recipe.within(hours), InputError) << hours;
}

TEST_F(RecipeFile, WhatIsWrongIsNamed) {
  const std::tuple<const char*, const char*, const char*> cases[] = {
      {"hours: 4", "hours: 0", "expected above 0 h"},
      {"hours: 4", "hour: 4", "hours"},
      {"seeds: [1, 10]", "seeds: [10, 1]", "the first and the last seed"},
      {"seeds: [1, 10]", "seeds: [1.5, 10]", "whole numbers"},
      {"explorer: oracle", "explorer: itself", "there is no model yet"},
      {"seeds: [11, 11]", "seeds: [10, 11]", "world 'mine' 10 is used for training twice"},
      {"seeds: [11, 11]", "seeds: [902, 902]", "for training and for validation"},
      {"scenes: [mine, depot]", "scenes: []", "names of scenes"},
      {"sigma: 0.5", "sigma: -1", "at least 0 m"},
      {"dropped: 0.4", "dropped: 2", "from 0 to 1"},
      {"dropped: 0.4", "droped: 2", "droped"}};
  for (const auto& [part, other, expected] : cases) {
    const std::string said = refusal(part, other);
    EXPECT_NE(said.find(expected), std::string::npos) << other << ": " << said;
    EXPECT_NE(said.find(path_.filename().string()), std::string::npos) << said;
  }
}

// NAME, NAME:SEED or NAME:FIRST-LAST as NAME:SEED each; a mesh as it is.
std::vector<std::string> worlds_of(const std::string& text) {
  if (text.starts_with("{data:")) return {text};
  const std::size_t colon = text.find(':');
  if (colon == text.npos) return {text + ":1"};
  const std::size_t dash = text.find('-', colon);
  if (dash == text.npos) return {text};
  std::vector<std::string> worlds;
  for (int seed = std::stoi(text.substr(colon + 1)); seed <= std::stoi(text.substr(dash + 1));
       ++seed)
    worlds.push_back(text.substr(0, colon + 1) + std::to_string(seed));
  return worlds;
}

// Whoever is judged by what it was trained with is told nothing.
TEST(ShippedRecipe, KnowsNoWorldOfTheFigures) {
  EXPECT_EQ(worlds_of("suburb:2-4"),
            (std::vector<std::string>{"suburb:2", "suburb:3", "suburb:4"}));
  const fs::path configs = fs::path(LAPWING_SOURCE_DIR) / "configs";
  const TrainingRecipe recipe = read_recipe(configs / "train/learned.yaml");
  std::set<std::string> trained;
  const auto add = [&](const RecipeSamples& samples) {
    for (const std::string& scene : samples.scenes)
      for (std::int64_t seed = samples.first; seed <= samples.last; ++seed)
        trained.insert(scene + ":" + std::to_string(seed));
  };
  for (const RecipeSamples& samples : recipe.validation) add(samples);
  for (const RecipeRound& round : recipe.rounds)
    for (const RecipeSamples& samples : round.samples) add(samples);
  EXPECT_GT(trained.size(), 300u);
  int worlds = 0;
  for (const std::string& name : reproduction_names(configs / "reproduce"))
    for (const ReproducedStudy& study : read_reproduction(configs / "reproduce", name).studies)
      for (const Value* options : {&study.options, &study.quick}) {
        const Value* given = options->find("world");
        if (!given) continue;
        const Value::List one{*given};
        for (const Value& world : given->is_list() ? given->as_list() : one) {
          for (const std::string& one_world : worlds_of(world.as_text())) {
            EXPECT_FALSE(trained.contains(one_world)) << one_world << " of " << name;
            ++worlds;
          }
        }
      }
  EXPECT_GT(worlds, 10);
}

}  // namespace
}  // namespace lapwing
