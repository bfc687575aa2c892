// SPDX-License-Identifier: Apache-2.0
// Loads, configures and plans missions given as text.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/mission/mission.h"
#include "framework/verify/verify.h"

namespace lapwing {

namespace fs = std::filesystem;

inline constexpr const char* kFilm = R"(local film = require "mission.film"
return film.shot {
  name = "test",
  keyframes = {
    { position = {0, 0, 2} },
    { position = {6, 0, 4}, yaw_deg = 90 },
  },
)";

class MissionTest : public ::testing::Test {
 protected:
  MissionTest() : registry_({fs::path(LAPWING_BUILD_DIR) / "lib/plugins"}) {
    folder_ = fs::temp_directory_path() / ("lapwing_mission_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  ~MissionTest() override { fs::remove_all(folder_); }

  MissionSettings settings() const {
    MissionSettings settings;
    settings.scripts = fs::path(LAPWING_SOURCE_DIR) / "scripts";
    settings.configs = fs::path(LAPWING_SOURCE_DIR) / "configs";
    settings.registry = &registry_;
    return settings;
  }

  std::unique_ptr<Mission> load(const std::string& text) {
    write_file_atomically(folder_ / "shot.lua", text);
    return std::make_unique<Mission>(folder_ / "shot.lua", settings());
  }

  // What is wrong before planning begins is found by judging as well, in the same words.
  void judged_alike(const std::string& text, const std::vector<std::string>& overrides,
                    const std::vector<Value>& layers, const std::string& expected) {
    std::string message = "no error";
    try {
      const auto mission = load(text);
      mission->configure(layers, overrides);
      mission->judge();
    } catch (const InputError& e) {
      message = e.what();
    }
    EXPECT_EQ(message, expected) << text;
  }

  // The message of loading, configuring and planning, without the folder.
  std::string error(const std::string& text, std::vector<std::string> overrides = {},
                    std::vector<Value> layers = {}) {
    std::string message = "no error";
    try {
      const auto mission = load(text);
      mission->configure(layers, overrides);
      try {
        mission->plan();
      } catch (const InputError& e) {
        const bool judged = !mission->planning_began();
        judged_alike(text, overrides, layers, judged ? e.what() : "no error");
        throw;
      }
    } catch (const InputError& e) {
      message = e.what();
    }
    const std::string prefix = folder_.string() + "/";
    for (std::size_t at; (at = message.find(prefix)) != std::string::npos;) {
      message.erase(at, prefix.size());
    }
    return message;
  }

  void expect(const std::string& text, const std::string& fragment,
              std::vector<std::string> overrides = {}) {
    const std::string message = error(text, std::move(overrides));
    EXPECT_NE(message.find(fragment), std::string::npos) << text << "\ngave: " << message;
  }

  static std::string film(const std::string& more) { return kFilm + more + "\n}"; }

  Registry registry_;
  fs::path folder_;
};

}  // namespace lapwing
