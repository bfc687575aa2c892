// SPDX-License-Identifier: Apache-2.0
// Flies shipped films through the program and judges what it wrote.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/mission/controller_source.h"
#include "framework/trajectory/plan.h"
#include "framework/verify/verify.h"

namespace lapwing {

namespace fs = std::filesystem;

inline const fs::path kExamples = fs::path(LAPWING_SOURCE_DIR) / "examples/filming";

inline constexpr const char* kCameraFilms[] = {"castle_flyover.lua",  "two_actors.lua",
                                               "through_the_gap.lua", "orbit.lua",
                                               "follow_walker.lua",   "crane_and_cut.lua"};

struct Flown {
  int status = -1;
  Value result;
  fs::path folder;
};

class Filming : public ::testing::Test {
 protected:
  Filming() {
    folder_ = fs::temp_directory_path() / ("lapwing_filming_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  ~Filming() override { fs::remove_all(folder_); }

  // How many times slower this machine is now than one with two free cores.
  double slowness() const {
    const fs::path said = folder_ / "slowness.txt";
    const std::string script = LAPWING_SOURCE_DIR "/scripts/machine_speed.sh";
    EXPECT_EQ(std::system(("bash '" + script + "' > '" + said.string() + "'").c_str()), 0);
    return std::strtod(read_file(said).c_str(), nullptr);
  }

  // `worst`: the highest status that is no surprise.
  Flown fly(const std::string& example, const std::string& more = "", const char* name = "out",
            int worst = 1) {
    Flown flown;
    flown.folder = folder_ / name;
    const std::string output = (folder_ / "stdout.json").string();
    const std::string command = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing run '" +
                                (kExamples / example).string() + "' --json --quiet --out '" +
                                flown.folder.string() + "' " + more + " > '" + output + "' 2> '" +
                                (folder_ / "stderr.txt").string() + "'";
    const int status = std::system(command.c_str());
    flown.status = WIFEXITED(status) ? WEXITSTATUS(status) : 1000;
    EXPECT_LE(flown.status, worst) << read_file(folder_ / "stderr.txt");
    flown.result = from_json(read_file(output), "stdout");
    return flown;
  }

  // What the program says is what its plan says.
  static void expect_certified(const Flown& flown) {
    EXPECT_EQ(flown.status, 0) << to_json(flown.result);
    EXPECT_EQ(flown.result.at("status").as_text(), "ok");
    const Plan plan = read_plan(flown.folder / "plan.json");
    static const Registry registry({fs::path(LAPWING_BUILD_DIR) / "lib/plugins"});
    const VerifyRequest request{.controllers = controllers_of(registry)};
    for (const Check& check : verify(plan, request).failures()) ADD_FAILURE() << to_line(check);
    const std::string report = read_file(flown.folder / "report.html");
    EXPECT_NE(report.find("certified"), std::string::npos);
    EXPECT_EQ(report.find("src=\"http"), std::string::npos);
  }

  static double cost(const Flown& flown) {
    return flown.result.at("solver").at("cost").as_number();
  }
  // Share of the time that the subject is in the image, by the certificate.
  static double framing(const Flown& flown) {
    for (const Value& check : flown.result.at("certificate").at("checks").as_list())
      if (check.at("name").as_text() == "framing") return check.at("worst").as_number();
    ADD_FAILURE() << "no framing check";
    return 0;
  }

  fs::path folder_;
};

inline std::string data_folder() {
  const char* folder = std::getenv("LAPWING_DATA");
  return folder && fs::exists(fs::path(folder) / "shots") ? folder : "";
}

class DesignersShots : public Filming {
 protected:
  void SetUp() override {
    if (data_folder().empty()) GTEST_SKIP() << "LAPWING_DATA names no folder with shots";
  }

  Flown fly_shot(int number, const std::string& more = "") {
    char name[32];
    std::snprintf(name, sizeof name, "shot_%02d.json", number);
    return fly("own_shot.lua", "--data '" + data_folder() + "' --set input=" + name + " " + more);
  }
};

}  // namespace lapwing
