// SPDX-License-Identifier: Apache-2.0
// lapwing evaluate scan, as a user runs it, on a hut that is written here.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <map>

#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/random.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

// A box of 6 m x 5 m x 4 m.
constexpr const char* kHut =
    "v -3 -2.5 0\nv 3 -2.5 0\nv 3 2.5 0\nv -3 2.5 0\nv -3 -2.5 4\nv 3 -2.5 4\nv 3 2.5 4\n"
    "v -3 2.5 4\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\nf 5 6 7 8\nf 4 3 2 1\n";

constexpr const char* kMission = R"(local scan = require "mission.scan"
return scan.of_mesh {
  name = "hut", input = "hut.obj", ground = true,
  region = { lower = {-4, -3.5, -0.5}, upper = {4, 3.5, 4.5} },
  safe_height = 7,
  flights = { { pattern = "circle", height = 9, views = 8, reach = 4 } },
  tour = { budget = 60, iterations = 30 },
  reach = 8, resolution = 0.4,
  camera = { width = 120, height = 90, focal = 70 },
  surface = { spacing = 0.5, cell = 0.6, trim = 1.2 },
  usable = { range = 30 },
  candidates = { most = 80, step = 3, distance_apart = 2 },
  motions = { coarse = 40, alpha = 0.2 },
})";

class EvaluateScan : public ::testing::Test {
 protected:
  void SetUp() override {
    base_ = fs::temp_directory_path() / ("lapwing_evaluate_" + std::to_string(::getpid()));
    fs::remove_all(base_);
    fs::create_directories(base_);
    write_file_atomically(base_ / "hut.obj", kHut);
    write_file_atomically(base_ / "hut.lua", std::string(kMission) + "\n");
  }
  void TearDown() override { fs::remove_all(base_); }

  // Runs the program in the folder; with a delay it is killed after so many microseconds. The exit
  // status, or -1 where it was killed.
  int run(const std::string& out, std::vector<std::string> more, long kill_after = 0) const {
    std::vector<std::string> words{
        LAPWING_BUILD_DIR "/bin/lapwing", "evaluate", "scan", "hut.lua", "--out", out};
    words.insert(words.end(), more.begin(), more.end());
    const pid_t child = ::fork();
    if (child == 0) {
      if (::chdir(base_.c_str()) != 0) ::_exit(99);
      const std::string log = out + ".log";
      if (!std::freopen(log.c_str(), "a", stdout) || !std::freopen(log.c_str(), "a", stderr)) {
        ::_exit(99);
      }
      std::vector<char*> arguments;
      for (std::string& word : words) arguments.push_back(word.data());
      arguments.push_back(nullptr);
      ::execv(arguments[0], arguments.data());
      ::_exit(99);
    }
    if (kill_after > 0) {
      ::usleep(static_cast<useconds_t>(kill_after));
      ::kill(child, SIGKILL);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  // Without times, and what a kill left half-written.
  std::map<std::string, std::string> bytes(const std::string& out) const {
    std::map<std::string, std::string> all;
    for (const auto& item : fs::recursive_directory_iterator(base_ / out)) {
      const std::string name = item.path().lexically_relative(base_ / out).string();
      const bool counts = !name.starts_with("times") && name.find(".tmp-") == name.npos;
      if (item.is_regular_file() && counts) all[name] = read_file(item.path());
    }
    return all;
  }
  std::string log(const std::string& out) const { return read_file(base_ / (out + ".log")); }

  fs::path base_;
};

const std::vector<std::string> kFew{"--method",  "cost_benefit+local_search",
                                    "--method",  "greedy",
                                    "--method",  "circle_9",
                                    "--seeds",   "1,2",
                                    "--threads", "2"};

class SlowEvaluateScan : public EvaluateScan {};

TEST_F(SlowEvaluateScan, KilledAtAnyMomentItGoesOnToTheSameBytes) {
  ASSERT_EQ(run("whole", kFew), 0) << log("whole");
  const auto whole = bytes("whole");
  for (const char* name : {"study.json", "rows.csv", "tables.csv", "tables.txt", "report.html"}) {
    ASSERT_TRUE(whole.count(name)) << name;
  }
  EXPECT_EQ(whole.size(), 5u + 6u + 1u);  // six rows, and the surface that counts
  EXPECT_NE(whole.at("tables.txt").find("2 seeds"), std::string::npos);
  std::vector<std::string> resumed = kFew;
  resumed.push_back("--resume");
  Random random(static_cast<std::uint64_t>(::getpid()));
  bool killed = false;
  for (int turn = 0; turn < 2; ++turn) {
    const bool begun = fs::exists(base_ / "broken" / "study.json");
    killed |= run("broken", begun ? resumed : kFew, random.integer(100'000, 900'000)) == -1;
  }
  EXPECT_TRUE(killed);
  const bool begun = fs::exists(base_ / "broken" / "study.json");
  ASSERT_EQ(run("broken", begun ? resumed : kFew), 0) << log("broken");
  EXPECT_EQ(bytes("broken"), whole);
  // Everyone is judged by the same surface, and the tours see something of it.
  for (const auto& [name, text] : whole) {
    if (!name.starts_with("rows/")) continue;
    const Value row = from_json(text, name);
    EXPECT_TRUE(row.at("found").as_boolean()) << text;
    EXPECT_GT(row.at("alone").at("surface_points").as_integer(), 10'000) << name;
    if (name.find("local_search") == name.npos) continue;
    EXPECT_GT(row.at("with_first").at("recall").as_number(), 0.1) << text;
    EXPECT_GT(row.at("with_first").at("precision").as_number(), 0.9) << text;
  }
}

TEST_F(SlowEvaluateScan, SeveralMissionsAreOneStudy) {
  fs::copy_file(base_ / "hut.lua", base_ / "shed.lua");
  ASSERT_EQ(run("two", {"shed.lua", "--method", "greedy", "--threads", "2"}), 0) << log("two");
  std::string table = read_file(base_ / "two" / "tables.txt");
  for (const std::string name : {"hut", "shed"}) {
    EXPECT_TRUE(fs::exists(base_ / "two" / "rows" / (name + "_seed1_greedy.json"))) << name;
    EXPECT_NE(table.find(name + ", a budget of "), std::string::npos) << table;
  }
}

// Rows of other options are not taken for one's own, though the configuration has the same name.
TEST_F(EvaluateScan, ResumingNeedsTheSameOptions) {
  write_file_atomically(base_ / "mine.yaml", "candidates: {most: 40}\n");
  const std::vector<std::string> few{"--method", "greedy", "--config", "mine.yaml"};
  ASSERT_EQ(run("same", few), 0) << log("same");
  std::vector<std::string> again = few;
  again.push_back("--resume");
  EXPECT_EQ(run("same", again), 0) << log("same");
  write_file_atomically(base_ / "mine.yaml", "candidates: {most: 30}\n");
  EXPECT_EQ(run("same", again), 2);
  EXPECT_NE(log("same").find("states another study"), std::string::npos) << log("same");
  write_file_atomically(base_ / "mine.yaml", "candidates: {most: 40}\n");
  write_file_atomically(base_ / "hut.obj", read_file(base_ / "hut.obj") + "# another\n");
  EXPECT_EQ(run("same", again), 2) << "another mesh";
}

// A stand-in for COLMAP that finds five of the images: what is asked of it, and what is made of its
// answer. Without any the error says what is missing.
TEST_F(EvaluateScan, PhotographsAreRegisteredByColmap) {
  const std::string path = std::getenv("PATH");
  write_file_atomically(base_ / "bin" / "colmap",
                        "#!/bin/sh\n"
                        "echo \"$@\" >> calls.txt\n"
                        "if [ $1 = mapper ]; then\n"
                        "  while [ $1 != --output_path ]; do shift; done\n"
                        "  mkdir -p $2/0 $2/1\n"
                        "  printf '\\003\\000\\000\\000\\000\\000\\000\\000' > $2/0/images.bin\n"
                        "  printf '\\005\\000\\000\\000\\000\\000\\000\\000' > $2/1/images.bin\n"
                        "fi\n");
  fs::permissions(base_ / "bin" / "colmap", fs::perms::owner_all);
  ::setenv("PATH", "/nowhere", 1);
  EXPECT_EQ(run("none", {"--method", "greedy", "--photos"}), 2);
  ::setenv("PATH", ((base_ / "bin").string() + ":" + path).c_str(), 1);
  EXPECT_EQ(run("photos", {"--method", "greedy", "--photos"}), 0) << log("photos");
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_NE(log("none").find("package colmap"), std::string::npos) << log("none");
  EXPECT_FALSE(fs::exists(base_ / "none"));
  const Value row =
      from_json(read_file(base_ / "photos" / "rows" / "hut_seed1_greedy.json"), "row");
  const auto images = row.at("images").as_integer();
  const fs::path folder = base_ / "photos" / "photos" / "hut_seed1_greedy";
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "images"), fs::directory_iterator()),
            images);
  EXPECT_TRUE(read_file(folder / "images" / "view_0001.png").starts_with("\x89PNG"));
  EXPECT_NE(read_file(base_ / "photos" / "photos.txt")
                .find("greedy: 5 of " + std::to_string(images) + ", 2 models"),
            std::string::npos);
  const std::string calls = read_file(base_ / "calls.txt");
  EXPECT_NE(calls.find("PINHOLE --ImageReader.camera_params 70,70,60,45"), std::string::npos)
      << calls;
}

TEST_F(EvaluateScan, BadInputIsRefusedBeforeAnythingIsWritten) {
  EXPECT_EQ(run("a", {"--method", "greedie"}), 2);
  EXPECT_NE(log("a").find("greedy"), std::string::npos) << log("a");
  EXPECT_EQ(run("b", {"--method", "circle_x"}), 2);
  EXPECT_EQ(run("c", {"--budgets", "0"}), 2);
  EXPECT_EQ(run("d", {"--seeds", "1,1"}), 2);
  EXPECT_EQ(run("e", {"--noise", "a"}), 2);
  for (const char* out : {"a", "b", "c", "d", "e"}) EXPECT_FALSE(fs::exists(base_ / out)) << out;
  write_file_atomically(base_ / "hut.lua", "return 5\n");
  EXPECT_EQ(run("f", {"--method", "greedy"}), 2);
}

}  // namespace
}  // namespace lapwing
