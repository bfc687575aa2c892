// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <filesystem>

#include "framework/plugin/registry.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

// Sets an environment variable and puts the former value back.
class Environment {
 public:
  Environment(const char* name, const char* value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    if (value)
      ::setenv(name, value, 1);
    else
      ::unsetenv(name);
  }
  ~Environment() {
    if (before_)
      ::setenv(name_, before_->c_str(), 1);
    else
      ::unsetenv(name_);
  }

 private:
  const char* name_;
  std::optional<std::string> before_;
};

TEST(SearchPath, HasTheFourSourcesInOrder) {
  const Environment path("LAPWING_PLUGIN_PATH", "/:/usr");
  const Environment data("XDG_DATA_HOME", "/data/home");
  const std::vector<fs::path> folders = plugin_search_path({"/tmp", "/bin"});
  ASSERT_EQ(folders.size(), 6u);
  EXPECT_EQ(folders[0], "/tmp");
  EXPECT_EQ(folders[1], "/bin");
  EXPECT_EQ(folders[2], "/");
  EXPECT_EQ(folders[3], "/usr");
  EXPECT_EQ(folders[4], "/data/home/lapwing/plugins");
  EXPECT_EQ(folders[5].filename(), "plugins");
}

TEST(SearchPath, FallsBackToTheHomeFolder) {
  const Environment path("LAPWING_PLUGIN_PATH", nullptr);
  const Environment home("HOME", "/home/someone");
  for (const char* unset : {static_cast<const char*>(nullptr), "", "relative"}) {
    const Environment data("XDG_DATA_HOME", unset);
    EXPECT_EQ(plugin_search_path({}).front(), "/home/someone/.local/share/lapwing/plugins");
  }
}

TEST(SearchPath, RefusesFoldersOfTheCommandLineThatAreNone) {
  EXPECT_THROW(plugin_search_path({"/no/such/folder"}), InputError);
  EXPECT_THROW(plugin_search_path({"/proc/self/status"}), InputError);
}

}  // namespace
}  // namespace lapwing
