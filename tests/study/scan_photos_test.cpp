// SPDX-License-Identifier: Apache-2.0
// What is asked of COLMAP and read of its answer, with a program of that name that writes down how
// it was called.
#include "framework/study/scan_photos.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <set>
#include <sstream>
#include <thread>

#include "framework/core/error.h"
#include "framework/core/files.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

class Photos : public ::testing::Test {
 protected:
  Photos() : base_(fs::temp_directory_path() / ("lapwing_photos_" + std::to_string(::getpid()))) {
    fs::remove_all(base_);
    fs::create_directories(base_ / "bin");
    const char* path = std::getenv("PATH");
    path_ = path ? path : "";
    ::setenv("PATH", ((base_ / "bin").string() + ":" + path_).c_str(), 1);
  }
  ~Photos() override {
    ::setenv("PATH", path_.c_str(), 1);
    fs::remove_all(base_);
  }

  // A shell script as COLMAP: `body` sees its step as $1.
  void colmap(const std::string& body) const {
    const fs::path program = base_ / "bin/colmap";
    write_file_atomically(
        program, "#!/bin/sh\necho \"$@\" >> '" + (base_ / "calls").string() + "'\n" + body + "\n");
    fs::permissions(program, fs::perms::owner_all);
  }

  // Two photographs of a wall three metres ahead.
  Registered take(const CancellationToken* cancellation = nullptr) const {
    TriangleMesh wall;
    wall.vertices = {{3, -9, -9}, {3, 9, -9}, {3, 9, 9}, {3, -9, 9}};
    wall.triangles = {{0, 1, 2}, {0, 2, 3}};
    return register_photos(MeshScene(wall),
                           {camera_pose({0, 0, 0}, 0, 0), camera_pose({0, 1, 0}, 0, 0)},
                           {32, 24, 30, 31, 15.5, 11.5}, base_ / "photos", 2, cancellation);
  }

  // What a call said for an option.
  static std::string option(const std::string& call, const std::string& name) {
    std::istringstream words(call);
    for (std::string word; words >> word;)
      if (word == name && words >> word) return word;
    return "none";
  }

  std::vector<std::string> calls() const {
    std::istringstream text(read_file(base_ / "calls"));
    std::vector<std::string> lines;
    for (std::string line; std::getline(text, line);) lines.push_back(line);
    return lines;
  }

  fs::path base_;
  std::string path_;
};

// A model's images.bin begins with its number of images, eight bytes, the least first.
constexpr const char* kModels = R"(
[ "$1" = mapper ] || exit 0
while [ $# -gt 0 ]; do [ "$1" = --output_path ] && out=$2; shift; done
mkdir "$out/0" "$out/1" "$out/2" "$out/3"
printf '\001\000\000\000\000\000\000\000rest' > "$out/0/images.bin"
printf '\002\001\000\000\000\000\000\000' > "$out/1/images.bin"
printf '\003\000' > "$out/2/images.bin")";

TEST_F(Photos, ModelsAreCountedByTheirImages) {
  colmap(kModels);
  const Registered found = take();
  EXPECT_EQ(found.images, 2);
  EXPECT_EQ(found.largest, 258);
  EXPECT_EQ(found.models, 2) << "one was cut short, and one has no images";
}

TEST_F(Photos, TheStepsAreAskedForInTurnWithTheSameCamera) {
  colmap("exit 0");
  const Registered found = take();
  EXPECT_EQ(found.largest, 0);
  EXPECT_EQ(found.models, 0);
  const std::vector<std::string> all = calls();
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].substr(0, all[0].find(' ')), "feature_extractor");
  EXPECT_EQ(all[1].substr(0, all[1].find(' ')), "exhaustive_matcher");
  EXPECT_EQ(all[2].substr(0, all[2].find(' ')), "mapper");
  // COLMAP's pixels count from the corner of the first, ours from its middle.
  EXPECT_EQ(option(all[0], "--ImageReader.camera_params"), "30,31,16,12");
  EXPECT_EQ(option(all[0], "--SiftExtraction.use_gpu"), "0");
  EXPECT_EQ(option(all[1], "--SiftMatching.num_threads"), "2");
  EXPECT_EQ(option(all[2], "--Mapper.ba_refine_focal_length"), "0");
  std::set<std::string> databases;
  for (const std::string& call : all) databases.insert(option(call, "--database_path"));
  EXPECT_EQ(databases, std::set<std::string>{(base_ / "photos/database.db").string()});
  for (const char* name : {"view_0001.png", "view_0002.png"})
    EXPECT_EQ(read_file(base_ / "photos/images" / name).substr(1, 3), "PNG") << name;
  EXPECT_NE(read_file(base_ / "photos/images/view_0001.png"),
            read_file(base_ / "photos/images/view_0002.png"));
}

TEST_F(Photos, WhatAnEndedRunLeftIsGone) {
  fs::create_directories(base_ / "photos/sparse/0");
  write_file_atomically(base_ / "photos/sparse/0/images.bin", std::string("\5\0\0\0\0\0\0\0", 8));
  colmap("exit 0");
  EXPECT_EQ(take().models, 0);
}

TEST_F(Photos, AStepThatFailsIsNamedWithItsLog) {
  for (const char* step : {"feature_extractor", "exhaustive_matcher", "mapper"}) {
    for (const char* end : {"exit 3", "kill -9 $$"}) {
      colmap(std::string("[ \"$1\" = ") + step + " ] || exit 0\necho what went wrong >&2\n" + end);
      try {
        take();
        ADD_FAILURE() << step;
      } catch (const InputError& error) {
        EXPECT_EQ(std::string(error.what()), std::string("colmap ") + step + " failed; see '" +
                                                 (base_ / "photos/colmap.log").string() + "'");
      }
      EXPECT_NE(read_file(base_ / "photos/colmap.log").find("what went wrong"), std::string::npos);
    }
  }
}

TEST_F(Photos, ItRunsWithoutAWindow) {
  colmap("echo platform $QT_QPA_PLATFORM");
  ::setenv("QT_QPA_PLATFORM", "xcb", 1);
  take();
  ::unsetenv("QT_QPA_PLATFORM");
  EXPECT_EQ(read_file(base_ / "photos/colmap.log").find("platform offscreen\n"), 0u);
}

// Told to stop, it does not wait for COLMAP, which sleeps for an hour.
TEST_F(Photos, ItStopsWhenItIsTold) {
  colmap("exec sleep 3600");
  CancellationToken token;
  std::thread teller([&] {
    while (!fs::exists(base_ / "calls")) ::usleep(2000);
    token.cancel();
  });
  EXPECT_THROW(take(&token), Cancelled);
  teller.join();
  EXPECT_EQ(calls().size(), 1u);
}

TEST_F(Photos, AMissingProgramIsNamed) {
  ::setenv("PATH", (base_ / "bin").c_str(), 1);
  EXPECT_THROW(require_colmap(), InputError);
  try {
    take();
    ADD_FAILURE() << "there is no program";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("colmap: No such file"), std::string::npos)
        << error.what();
  }
  write_file_atomically(base_ / "bin/colmap", "text");
  fs::permissions(base_ / "bin/colmap", fs::perms::owner_read);
  EXPECT_THROW(require_colmap(), InputError) << "it cannot be run";
  colmap("exit 0");
  EXPECT_NO_THROW(require_colmap());
  ::setenv("PATH", "", 1);
  EXPECT_THROW(require_colmap(), InputError);
}

}  // namespace
}  // namespace lapwing
