// SPDX-License-Identifier: Apache-2.0
// Tools of tests are found when a test runs (tests/tool.h): what CMake looked for is what was there
// when the program was built, before the tests' packages were installed.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "framework/core/files.h"
#include "tests/tool.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = LAPWING_SOURCE_DIR;

// The files of CMake below a folder.
std::vector<fs::path> cmake_files(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& item : fs::recursive_directory_iterator(folder)) {
    const fs::path& path = item.path();
    if (path.filename() == "CMakeLists.txt" || path.extension() == ".cmake") files.push_back(path);
  }
  return files;
}

TEST(TestTools, AreLookedForByNoListOfCMake) {
  const std::vector<fs::path> files = cmake_files(kRoot / "tests");
  ASSERT_GT(files.size(), 10u);
  for (const fs::path& file : files)
    EXPECT_EQ(read_file(file).find("find_program"), std::string::npos) << file;
}

TEST(TestTools, AreFoundOnThePathWhenAsked) {
  const fs::path folder =
      fs::temp_directory_path() / ("lapwing_tool_" + std::to_string(::getpid()));
  fs::create_directories(folder / "bin");
  const std::string before = std::getenv("PATH");
  ::setenv("PATH", ("/nowhere::" + (folder / "bin").string()).c_str(), 1);
  const fs::path tool = folder / "bin" / "measure";
  EXPECT_EQ(tool_on_path({"measure"}), "");
  std::ofstream(tool) << "#!/bin/sh\n";
  EXPECT_EQ(tool_on_path({"measure"}), "") << "a file that may not be run";
  ::chmod(tool.c_str(), 0755);
  EXPECT_EQ(tool_on_path({"another", "measure"}), tool.string());
  ::setenv("PATH", before.c_str(), 1);
  fs::remove_all(folder);
}

// The words of an array of scripts/packages.sh.
std::set<std::string> packages_of(const std::string& name) {
  const std::string text = read_file(kRoot / "scripts/packages.sh");
  const std::size_t begin = text.find(name + "=(");
  if (begin == std::string::npos) return {};
  std::istringstream words(
      text.substr(begin + name.size() + 2, text.find(')', begin) - begin - name.size() - 2));
  std::set<std::string> found;
  for (std::string word; words >> word;) found.insert(word);
  return found;
}

// What a test may need by name, and the Debian package that holds it; "": every Debian has it.
const std::map<std::string, std::string> kPackages{// find_package and pkg_check_modules
                                                   {"Eigen3", "libeigen3-dev"},
                                                   {"GTest", "libgtest-dev"},
                                                   {"PkgConfig", "pkg-config"},
                                                   {"Torch", "libtorch-dev"},
                                                   {"benchmark", "libbenchmark-dev"},
                                                   {"ipopt", "coinor-libipopt-dev"},
                                                   {"lapwing", ""},
                                                   {"lua5.4-c++", "liblua5.4-dev"},
                                                   {"nlohmann_json", "nlohmann-json3-dev"},
                                                   {"octomap", "liboctomap-dev"},
                                                   {"yaml-cpp", "libyaml-cpp-dev"},
                                                   // #include <NAME/
                                                   {"arpa", ""},
                                                   {"boost", "libboost-dev"},
                                                   {"gmock", "libgmock-dev"},
                                                   {"gtest", "libgtest-dev"},
                                                   {"netinet", ""},
                                                   {"sys", ""},
                                                   {"torch", "libtorch-dev"},
                                                   // tool_on_path and installed
                                                   {"chromium", "chromium"},
                                                   {"cmake", "cmake"},
                                                   {"fish", "fish"},
                                                   {"gdal_create", "gdal-bin"},
                                                   {"gdallocationinfo", "gdal-bin"},
                                                   {"groff", "groff-base"},
                                                   {"make", "make"},
                                                   {"mpirun", "openmpi-bin"},
                                                   {"nm", "binutils"},
                                                   {"script", ""},
                                                   {"zsh", "zsh"}};

// What a file of the tests needs, by name: of several tools the first, which Debian has.
std::set<std::string> needs_of(const std::string& text, bool cmake) {
  static const std::vector<std::regex> lists{
      std::regex(R"(find_package\((\S+?)[ )])"),
      std::regex(R"(pkg_check_modules\(\w+ (?:REQUIRED |IMPORTED_TARGET )*([^ )]+))")};
  static const std::vector<std::regex> sources{std::regex(R"re(#include <([a-z_]+)/)re"),
                                               std::regex(R"re(tool_on_path\(\{([^,}]*))re"),
                                               std::regex(R"re([^_]installed\("([^"]*)"\))re")};
  std::set<std::string> needs;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    bool any = false;  // few lines ask for something, and expressions are slow
    for (const char* word :
         {"find_package", "pkg_check", "#include <", "tool_on_path", "installed("})
      any |= line.find(word) != line.npos;
    std::smatch match;
    for (const std::regex& pattern : cmake ? lists : sources) {
      if (!any || !std::regex_search(line, match, pattern)) continue;
      std::string name = match[1];
      std::erase(name, '"');
      needs.insert(name);
    }
  }
  return needs;
}

// Whatever a test finds, includes or calls is in a package that is installed before it is built:
// those of the benchmarks and of the learned utility have lists of their own.
TEST(TestTools, TheListsOfPackagesHoldWhatTestsNeed) {
  std::set<std::string> known = packages_of("lapwing_packages");
  known.merge(packages_of("lapwing_test_packages"));
  known.merge(packages_of("lapwing_cluster_packages"));  // test.sh installs them, too
  std::set<std::string> seen;
  for (const auto& item : fs::recursive_directory_iterator(kRoot / "tests")) {
    const fs::path& path = item.path();
    const std::string name = path.lexically_relative(kRoot / "tests").string();
    const bool cmake = path.filename() == "CMakeLists.txt" || path.extension() == ".cmake";
    if (!cmake && path.extension() != ".cpp" && path.extension() != ".h") continue;
    if (name.starts_with("architecture/") || name == "tool.h") continue;
    std::set<std::string> here = known;
    if (name.starts_with("bench/")) here.merge(packages_of("lapwing_bench_packages"));
    if (name.starts_with("plugins/")) here.merge(packages_of("lapwing_learn_packages"));
    for (const std::string& need : needs_of(read_file(path), cmake)) {
      seen.insert(need);
      const auto found = kPackages.find(need);
      if (found == kPackages.end()) {
        ADD_FAILURE() << name << " needs '" << need << "': name its Debian package here";
      } else if (!found->second.empty()) {
        EXPECT_TRUE(here.contains(found->second)) << name << ": " << found->second;
      }
    }
  }
  for (const char* need : {"GTest", "octomap", "gmock", "chromium", "nm", "zsh", "groff", "make"})
    EXPECT_TRUE(seen.contains(need)) << need << " was overlooked";
}

TEST(TestTools, WhatOnlyTestsNeedIsNotBuiltWith) {
  const std::set<std::string> build = packages_of("lapwing_packages");
  EXPECT_TRUE(build.contains("make")) << "the guide of plugins types `cmake -B build`";
  for (const char* package : {"libgtest-dev", "libgmock-dev", "chromium", "libbenchmark-dev"})
    EXPECT_FALSE(build.contains(package)) << package << " is for tests";
  EXPECT_TRUE(packages_of("lapwing_fresh_packages").contains("debootstrap"));
}

// What scripts/test_summary.sh makes of a log.
std::string summary(const std::string& log) {
  const fs::path folder =
      fs::temp_directory_path() / ("lapwing_summary_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  std::ofstream(folder / "log") << log;
  const std::string command = "bash '" + (kRoot / "scripts/test_summary.sh").string() + "' '" +
                              (folder / "log").string() + "' >'" + (folder / "said").string() + "'";
  EXPECT_EQ(std::system(command.c_str()), 0);
  const std::string said = read_file(folder / "said");
  fs::remove_all(folder);
  return said;
}

TEST(TestSummary, CountsAndNamesWhatWasSkippedByReason) {
  EXPECT_EQ(summary("1/2 Testing: core\n[ RUN      ] A.B\n[       OK ] A.B (0 ms)\n"),
            "No test was skipped\n");
  EXPECT_EQ(summary("1/2 Testing: core\n"
                    "[ RUN      ] Maps.Real\n/x/a.cpp:3: Skipped\nno maps\nin the folder\n\n"
                    "[  SKIPPED ] Maps.Real (0 ms)\n"
                    "[ RUN      ] Maps.Wrong\n/x/a.cpp:4: Failure\nno maps\n\n"
                    "[  FAILED  ] Maps.Wrong (0 ms)\n"
                    "[ RUN      ] Meshes.Real\n/x/b.cpp:9: Skipped\nno meshes\n\n"
                    "[  SKIPPED ] Meshes.Real (1 ms)\n"
                    "[  PASSED  ] 0 tests.\n"
                    "[  SKIPPED ] 2 tests, listed below:\n[  SKIPPED ] Maps.Real\n"
                    "2/2 Testing: too\n"
                    "[ RUN      ] Maps.Real\n/x/a.cpp:3: Skipped\nno maps\nin the folder\n\n"
                    "[  SKIPPED ] Maps.Real (0 ms)\n"
                    "[ RUN      ] Maps.Other\n/x/a.cpp:3: Skipped\nno maps\nin the folder\n\n"
                    "[  SKIPPED ] Maps.Other (0 ms)\n"),
            "3 tests were skipped:\n"
            "  no maps in the folder\n    Maps.Real\n    Maps.Other\n"
            "  no meshes\n    Meshes.Real\n"
            "1 test failed:\n  Maps.Wrong\n    /x/a.cpp:4: Failure\n    no maps\n");
}

// A crash, a failure outside of any test, a script, and a program that is not there.
TEST(TestSummary, NamesEveryFailureOfCtest) {
  EXPECT_EQ(summary("1/2 Testing: core\n"
                    "[ RUN      ] A.Good\n[       OK ] A.Good (1 ms)\n"
                    "[ RUN      ] A.Crash\n"
                    "<end of output>\nTest time =   0.20 sec\n-----\nTest Failed.\n"
                    "2/2 Testing: map\n"
                    "[ RUN      ] B.Wrong/0\n/x/a.cpp:4: Failure\n"
                    "[  FAILED  ] B.Wrong/0, where GetParam() = 4 (12 ms)\n"
                    "[  FAILED  ] 1 test, listed below:\n[  FAILED  ] B.Wrong/0\n"
                    "<end of output>\nTest time =   0.20 sec\n-----\nTest Failed.\n"),
            "No test was skipped\n2 tests failed:\n"
            "  A.Crash\n    core ended in this test\n"
            "  B.Wrong/0\n    /x/a.cpp:4: Failure\n");
  const auto whole = [](const std::string& name, const std::string& output) {
    return "1/2 Testing: " + name + "\nCommand: \"/x/" + name + "\"\nOutput:\n------\n" + output +
           "<end of output>\nTest time =   0.20 sec\n-----\nTest Failed.\n";
  };
  EXPECT_EQ(summary(whole("core", "[ RUN      ] A.Crash\nterminate called\n") +
                    whole("suite", "/x/a.cpp:4: Failure\nFailed\nno suite\n\n[  FAILED  ] S\n") +
                    whole("script", "one\n\ntwo\n") +
                    "2/2 Testing: missing\nCommand: \"\"\nOutput:\n-----\n<end of output>\n"
                    "Test Passed.\n"),
            "No test was skipped\n4 tests failed:\n"
            "  A.Crash\n    core ended in this test; its last lines:\n      terminate called\n"
            "  suite\n    it failed; its last lines:\n      /x/a.cpp:4: Failure\n      Failed\n"
            "      no suite\n"
            "  script\n    it failed; its last lines:\n      one\n      two\n"
            "  missing\n    its program is not there\n");
}

}  // namespace
}  // namespace lapwing
