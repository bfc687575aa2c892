// SPDX-License-Identifier: Apache-2.0
// What must hold of every plugin of this build, fixtures included.
#include <cstdio>
#include <filesystem>

#include "framework/core/files.h"
#include "framework/plugin/registry.h"
#include "tests/tool.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> built_libraries() {
  std::vector<fs::path> libraries;
  const fs::path build = LAPWING_BUILD_DIR;
  for (const fs::path& root : {build / "lib/plugins", build / "tests/plugin_fixtures/whole"}) {
    if (!fs::exists(root)) continue;
    for (const auto& item : fs::recursive_directory_iterator(root)) {
      if (item.path().extension() == ".so") libraries.push_back(item.path());
    }
  }
  std::sort(libraries.begin(), libraries.end());
  return libraries;
}

// Names that the library defines for others, one a line, as nm prints them.
std::vector<std::string> exported_symbols(const fs::path& library) {
  std::vector<std::string> names;
  FILE* pipe = ::popen(("nm -D --defined-only '" + library.string() + "'").c_str(), "r");
  if (!pipe) return names;
  char line[4096];
  char name[4096];
  while (std::fgets(line, sizeof line, pipe)) {
    if (std::sscanf(line, "%*s %*s %4095s", name) == 1) names.push_back(name);
  }
  ::pclose(pipe);
  return names;
}

TEST(BuiltPlugins, SidecarsEqualTheirLibraries) {
  const std::vector<fs::path> libraries = built_libraries();
  ASSERT_GE(libraries.size(), 2u);
  for (const fs::path& library : libraries) {
    fs::path sidecar = library;
    sidecar.replace_extension(".json");
    ASSERT_TRUE(fs::exists(sidecar)) << sidecar;
    EXPECT_EQ(read_file(sidecar), describe_library(library)) << library;
  }
}

TEST(BuiltPlugins, ExportOneSymbol) {
  if (tool_on_path({"nm"}).empty()) GTEST_SKIP() << "there is no nm (package binutils)";
  for (const fs::path& library : built_libraries()) {
    EXPECT_EQ(exported_symbols(library), std::vector<std::string>{kPluginLibrarySymbol}) << library;
  }
  // The check itself can fail: a library of another making exports another name.
  const fs::path other = fs::path(LAPWING_BUILD_DIR) / "tests/plugin_fixtures/broken/no_symbol.so";
  EXPECT_EQ(exported_symbols(other), std::vector<std::string>{"lapwing_fixture_answer"});
}

TEST(BuiltPlugins, AreFoundOnTheDefaultPath) {
  const std::vector<fs::path> path = plugin_search_path({});
  ASSERT_FALSE(path.empty());
  EXPECT_EQ(path.back(), fs::canonical(fs::path(LAPWING_BUILD_DIR)) / "lib/plugins");
  for (const PluginEntry& entry : Registry({path.back()}).entries()) {
    EXPECT_NE(entry.kind, "fixture") << "fixtures must not be visible to users";
  }
}

}  // namespace
}  // namespace lapwing
