// SPDX-License-Identifier: Apache-2.0
// Shipped configurations change effort and method, never what is asked for: budget, region, camera,
// range, flights, vehicle and keyframes are the user's own.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>

#include "framework/config/yaml.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

// Options that files of a folder may set. Whoever adds one has asked: could a script have stated it
// because only its author knows?
const std::map<std::string, std::set<std::string>> kMaySet = {
    {"filming", {"weights"}},
    {"solvers", {"solver"}},
    {"mapping", {"views", "pixel_step"}},
    {"scan", {"resolution", "effort", "surface", "candidates", "motions", "information"}},
    {"explore", {"steps", "compare"}},
};
const std::set<std::string> kFilesOfThings = {"vehicles", "cameras", "reproduce",
                                              "train"};  // no options of missions

TEST(ShippedConfigurations, SetNothingThatOnlyTheUserKnows) {
  std::size_t seen = 0;
  for (const auto& entry : fs::recursive_directory_iterator(LAPWING_SOURCE_DIR "/configs")) {
    if (entry.path().extension() != ".yaml") continue;
    const std::string folder = entry.path().parent_path().filename().string();
    if (kFilesOfThings.contains(folder)) continue;
    const auto allowed = kMaySet.find(folder);
    ASSERT_NE(allowed, kMaySet.end()) << entry.path() << ": say what it may set";
    const Value settings = read_yaml(entry.path());
    // Its subject is the size of vehicle and place: who names it has asked for these lengths.
    std::set<std::string> may = allowed->second;
    if (entry.path().stem() == "room")
      may.merge(std::set<std::string>{"body", "mesh_room", "margin", "floor", "reach", "flight"});
    for (const auto& [key, value] : settings.as_map())
      EXPECT_TRUE(may.contains(key))
          << entry.path() << " sets '" << key << "', which may be the user's own";
    ++seen;
  }
  EXPECT_GE(seen, 9u);
}

}  // namespace
}  // namespace lapwing
