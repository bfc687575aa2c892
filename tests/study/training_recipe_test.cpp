// SPDX-License-Identifier: Apache-2.0
#include "framework/study/training_recipe.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <regex>
#include <set>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
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
  EXPECT_EQ(recipe.default_hours, 4);
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
      {"hours: 4", "hours: 4\ndefault_hours: 5", "at most `hours`"},
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

using Worlds = std::set<std::string>;

const fs::path kConfigs = fs::path(LAPWING_SOURCE_DIR) / "configs";
const fs::path kLearned = fs::path(LAPWING_SOURCE_DIR) / "plugins/utilities/learned";

void add_worlds(const ReproducedStudy& study, Worlds& worlds) {
  for (const Value* options : {&study.options, &study.quick}) {
    const Value* given = options->find("world");
    if (!given) continue;
    const Value::List one{*given};
    for (const Value& text : given->is_list() ? given->as_list() : one)
      for (const std::string& world : worlds_of(text.as_text())) worlds.insert(world);
  }
}

// Of the explorations whose figures the readmes print: those of configs/reproduce, unless they are
// training of their own, and the commands of the experiments with the learned utilities.
Worlds worlds_of_figures() {
  Worlds worlds;
  for (const std::string& name : reproduction_names(kConfigs / "reproduce"))
    if (name != "5.5.1")
      for (const ReproducedStudy& study : read_reproduction(kConfigs / "reproduce", name).studies)
        add_worlds(study, worlds);
  const std::string text = read_file(kLearned / "EXPERIMENTS.md");
  const std::regex command("lapwing evaluate explore[^`]*"), world("--world\\s+([a-z_:0-9-]+)");
  for (std::sregex_iterator at(text.begin(), text.end(), command), end; at != end; ++at) {
    const std::string words = at->str();
    for (std::sregex_iterator one(words.begin(), words.end(), world); one != end; ++one)
      for (const std::string& found : worlds_of((*one)[1].str())) worlds.insert(found);
  }
  return worlds;
}

// "worlds" of a model's provenance and of the models that it began from: "downtown 12".
void add_provenance(const Value& provenance, Worlds& worlds) {
  if (const Value* list = provenance.find("worlds"))
    for (const Value& entry : list->as_list()) {
      std::string world = entry.as_text();
      std::replace(world.begin(), world.end(), ' ', ':');
      worlds.insert(world);
    }
  if (const Value* begin = provenance.find("begin")) add_provenance(*begin, worlds);
}

Worlds worlds_of_model(const fs::path& file) {
  const std::string bytes = read_file(file);
  const std::size_t header = bytes.find('{'), end = bytes.find('\n', header);
  Worlds worlds;
  add_provenance(from_json(bytes.substr(header, end - header), file.string()).at("provenance"),
                 worlds);
  return worlds;
}

void expect_apart(const Worlds& some, const Worlds& others, const std::string& what) {
  for (const std::string& world : some)
    EXPECT_FALSE(others.contains(world)) << what << ": " << world;
}

// Whoever is judged by what it was trained with is told nothing.
TEST(ShippedModels, KnowNoWorldOfTheFigures) {
  EXPECT_EQ(worlds_of("suburb:2-4"),
            (std::vector<std::string>{"suburb:2", "suburb:3", "suburb:4"}));
  const Worlds figures = worlds_of_figures();
  for (const char* world :
       {"street:1", "street:3", "suburb:1", "suburb:2", "church:1", "downtown:201", "district:201",
        "towers:1", "courtyard:1", "office:1", "office:2", "downtown:801"})
    EXPECT_TRUE(figures.contains(world)) << world;

  const TrainingRecipe recipe = read_recipe(kConfigs / "train/learned.yaml");
  EXPECT_EQ(recipe.default_hours, 1) << "the readme says how long it takes";
  Worlds of_recipe;
  const auto add = [&](const RecipeSamples& samples) {
    for (const std::string& scene : samples.scenes)
      for (std::int64_t seed = samples.first; seed <= samples.last; ++seed)
        of_recipe.insert(scene + ":" + std::to_string(seed));
  };
  for (const RecipeSamples& samples : recipe.validation) add(samples);
  for (const RecipeRound& round : recipe.rounds)
    for (const RecipeSamples& samples : round.samples) add(samples);
  EXPECT_GT(of_recipe.size(), 300u);
  expect_apart(figures, of_recipe, "the recipe");
  for (const char* name : {"learned", "learned_grid"}) {
    const Worlds trained = worlds_of_model(kLearned / (std::string(name) + ".model"));
    EXPECT_GT(trained.size(), 40u) << name;
    expect_apart(figures, trained, name);
  }
}

TEST(ShippedReproductions, TrainValidateAndTestInDifferentWorlds) {
  std::map<std::string, Worlds> by_use;
  for (const ReproducedStudy& study : read_reproduction(kConfigs / "reproduce", "5.5.1").studies)
    if (study.command == "train dataset")
      add_worlds(study, by_use[study.name.substr(0, study.name.find('_'))]);
  ASSERT_EQ(by_use.size(), 3u);
  expect_apart(by_use.at("training"), by_use.at("validation"), "training");
  expect_apart(by_use.at("training"), by_use.at("test"), "training");
  expect_apart(by_use.at("validation"), by_use.at("test"), "validation");
  for (const auto& [use, worlds] : by_use) EXPECT_FALSE(worlds.empty()) << use;
}

}  // namespace
}  // namespace lapwing
