// SPDX-License-Identifier: Apache-2.0
// Samples, training and its recipes, as commands.
#include <gmock/gmock.h>

#include "tests/missions/exploring_fixture.h"

namespace lapwing {
namespace {

// Another camera and map: the shipped model is not good for them, one trained with them is.
TEST_F(Exploring, AModelIsTrainedForAnotherMapping) {
  few("");  // writes the yard
  const std::string errors = (folder_ / "errors.txt").string();
  const auto run = [&](const std::string& command, const std::string& more) {
    const std::string line = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing " + command + " " +
                             more + " > /dev/null 2> '" + errors + "'";
    return WEXITSTATUS(std::system(line.c_str()));
  };
  const std::string world = "--world '" + (folder_ / "yard.obj").string() + "' ";
  const std::string mapping = "--mapping resolution=0.5 --mapping range=12 --mapping view_deg=70 ";
  const std::string samples = "'" + (folder_ / "samples").string() + "' ";
  const std::string others = "'" + (folder_ / "others").string() + "' ";
  const std::string model = "'" + (folder_ / "own.model").string() + "' ";
  const std::string small = "--set width=8 --set convolutions=1 --set batch=8 --set epochs=1 ";
  const auto evaluate = [&](const std::string& more) {
    return run("evaluate explore", world + mapping + more +
                                       "--utility learned --episodes 1 --steps 2 -o '" +
                                       (folder_ / "found").string() + "'");
  };
  EXPECT_EQ(evaluate(""), 2);
  EXPECT_THAT(read_file(errors), testing::HasSubstr("trained with another mapping: resolution"));
  for (const auto& [folder, seed] : {std::pair{samples, "1"}, {others, "2"}})
    ASSERT_EQ(run("train dataset",
                  world + mapping + "--episodes 1 --steps 4 --seed " + seed + " -o " + folder),
              0)
        << read_file(errors);
  ASSERT_EQ(run("train fit", samples + "--validation " + others + small + "-o " + model), 0)
      << read_file(errors);
  ASSERT_EQ(run("train score", others + "--model " + model), 0) << read_file(errors);
  EXPECT_EQ(evaluate("--set learned.model=" + model), 0) << read_file(errors);
  EXPECT_EQ(run("train score", others + others + "--model " + model), 2);
  EXPECT_THAT(read_file(errors), testing::HasSubstr("is named twice"));
  const fs::path sample = folder_ / "others" / "yard.obj_1.samples";
  std::string damaged = read_file(sample);
  damaged[damaged.size() - 9] ^= 1;
  write_file_atomically(sample, damaged);
  EXPECT_EQ(run("train score", others + "--model " + model), 2);
  EXPECT_THAT(read_file(errors), testing::HasSubstr("does not match its checksum"));
  EXPECT_EQ(run("train dataset", world + "--set epochs=3 -o " + samples), 2);
  EXPECT_THAT(read_file(errors), testing::HasSubstr("epochs: unknown key"));
  // What no network takes is refused before anything is flown.
  EXPECT_EQ(run("train dataset", world + "--set rays.columns=1 -o " + samples), 2);
  EXPECT_THAT(read_file(errors), testing::HasSubstr("rays.columns"));
  EXPECT_EQ(
      run("train dataset", world + "--utility learned_grid --set grid.across=3 -o " + samples), 2);
  EXPECT_THAT(read_file(errors), testing::HasSubstr("cannot be halved"));
}

// Samples are neither written over nor taken for others.
TEST_F(Exploring, SamplesAreKept) {
  few("");  // writes the yard
  const fs::path folder = folder_ / "samples", file = folder / "yard.obj_1.samples";
  const std::string errors = (folder_ / "errors.txt").string();
  const auto made = [&](const std::string& more) {
    const std::string line = std::string(LAPWING_BUILD_DIR) +
                             "/bin/lapwing train dataset --world '" +
                             (folder_ / "yard.obj").string() + "' --steps 2 --quiet -o '" +
                             folder.string() + "' " + more + " 2> '" + errors + "'";
    return WEXITSTATUS(std::system(line.c_str()));
  };
  ASSERT_EQ(made("--episodes 1"), 0) << read_file(errors);
  const std::string first = read_file(file);
  EXPECT_EQ(made("--episodes 1"), 2);
  EXPECT_THAT(read_file(errors), testing::HasSubstr("--resume keeps it"));
  for (const auto& [more, expected] : std::vector<std::pair<const char*, const char*>>{
           {"--seed 2", "seed is 1 there, 2 here"},
           {"--explorer frontier", "explorer is \"oracle\" there"},
           {"--moves clear=5", "moves is"},
           {"--sigma 0.3", "sigma is 0.0 there"},
           {"--set rays.rows=12", "input is"}}) {
    EXPECT_EQ(made(std::string("--resume --episodes 2 ") + more), 2) << more;
    EXPECT_THAT(read_file(errors), testing::HasSubstr(expected)) << more;
  }
  EXPECT_FALSE(fs::exists(folder / "yard.obj_2.samples"));
  ASSERT_EQ(made("--resume --episodes 2"), 0) << read_file(errors);
  EXPECT_TRUE(fs::exists(folder / "yard.obj_2.samples"));
  EXPECT_EQ(read_file(file), first);
  // Another episode's file in the place of one, and what is wrong is known before any is flown.
  fs::copy_file(file, folder / "yard.obj_3.samples");
  EXPECT_EQ(made("--resume --episodes 3"), 2);
  EXPECT_THAT(read_file(errors), testing::HasSubstr("it is episode 1"));
  fs::remove(folder / "yard.obj_3.samples");
  EXPECT_EQ(made("--resume --episodes 3 --world nowhere"), 2);
  EXPECT_FALSE(fs::exists(folder / "yard.obj_3.samples"));
}

// From nothing to a model: the same bytes however it was interrupted and by how many threads.
TEST_F(Exploring, AModelIsMadeByARecipe) {
  fs::create_directories(folder_);
  const fs::path recipe = folder_ / "tiny.yaml", errors = folder_ / "errors.txt";
  write_file_atomically(recipe, R"(utility: learned
hours: 2
validation:
  - {scenes: [mine], seeds: [901, 901], explorer: frontier, steps: 3}
rounds:
  - samples:
      - {scenes: [mine, depot], seeds: [1, 2], explorer: oracle, steps: 3}
    fit: {epochs: 1, width: 8, batch: 8}
  - samples:
      - {scenes: [depot], seeds: [11, 12], explorer: itself, steps: 3, sigma: 0.5, dropped: 0.4}
    fit: {epochs: 1, width: 8, batch: 8}
)");
  const auto train = [&](const std::string& name, const std::string& more) {
    const std::string line = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing train all --recipe '" +
                             recipe.string() + "' --quiet -o '" + (folder_ / name).string() + "' " +
                             more + " 2> '" + errors.string() + "'";
    return WEXITSTATUS(std::system(line.c_str()));
  };
  ASSERT_EQ(train("a.model", "--hours 1 --threads 1"), 0) << read_file(errors);
  const std::string whole = read_file(folder_ / "a.model");
  EXPECT_THAT(read_file(folder_ / "a.model.log"), testing::HasSubstr("round_2: {\"epoch\":1"));
  EXPECT_EQ(train("a.model", "--hours 1"), 2);
  EXPECT_THAT(read_file(errors), testing::HasSubstr("a.model' exists"));
  // What is missing is made again, and nothing else.
  fs::remove(folder_ / "a.model");
  EXPECT_EQ(train("a.model", "--hours 1"), 2);
  EXPECT_THAT(read_file(errors), testing::HasSubstr("a.model.log' exists"));
  fs::remove(folder_ / "a.model.log");
  EXPECT_EQ(train("a.model", "--hours 1"), 2);
  EXPECT_THAT(read_file(errors), testing::HasSubstr("continue it with --resume"));
  const fs::path work = folder_ / "a.model.training";
  for (const char* lost : {"round_2.model", "round_2.model.checkpoint"}) fs::remove(work / lost);
  fs::remove_all(work / "round_2");
  EXPECT_EQ(train("a.model", "--hours 2 --resume"), 2);
  EXPECT_THAT(read_file(errors), testing::HasSubstr("its hours is 1.0, not 2.0"));
  ASSERT_EQ(train("a.model", "--hours 1 --threads 2 --resume"), 0) << read_file(errors);
  EXPECT_EQ(read_file(folder_ / "a.model"), whole);
  // All of a recipe whose hours are its own: it is more than half of it.
  EXPECT_EQ(train("b.model", "--hours 3"), 2);
  EXPECT_THAT(read_file(errors), testing::HasSubstr("--hours: expected above 0 and at most 2"));
  // What is named is known before anything is flown.
  const std::string text = read_file(recipe);
  for (const auto& [part, other, expected] :
       {std::tuple{"explorer: frontier", "explorer: frontir", "frontir"},
        {"scenes: [depot]", "scenes: [depott]", "depott"},
        {"width: 8", "wdth: 8", "wdth"}}) {
    std::string wrong = text;
    wrong.replace(wrong.find(part), std::string(part).size(), other);
    write_file_atomically(recipe, wrong);
    EXPECT_EQ(train("b.model", "--hours 1"), 2) << other;
    EXPECT_THAT(read_file(errors), testing::HasSubstr(expected));
    EXPECT_FALSE(fs::exists(folder_ / "b.model.training")) << other;
  }
  write_file_atomically(recipe, text);
  EXPECT_EQ(train("b.model", "--hours 1 --mapping rang=10"), 2);
  EXPECT_THAT(read_file(errors), testing::HasSubstr("did you mean 'range'"));
  EXPECT_FALSE(fs::exists(folder_ / "b.model.training"));
  fs::remove(recipe);
  EXPECT_EQ(train("b.model", "--hours 1"), 2);
  EXPECT_THAT(read_file(errors), testing::HasSubstr("tiny.yaml"));
}

}  // namespace
}  // namespace lapwing
