// SPDX-License-Identifier: Apache-2.0
#include "tests/architecture/rules.h"

#include "framework/core/files.h"

namespace lapwing::architecture {
namespace {

void append(Violations& all, const Violations& some) {
  all.insert(all.end(), some.begin(), some.end());
}

std::string listed(const Violations& violations) {
  std::string text;
  for (const std::string& violation : violations) text += "\n  " + violation;
  return text;
}

TEST(Architecture, TheTreeKeepsItsRules) {
  const std::vector<SourceFile> files = read_tree(LAPWING_SOURCE_DIR);
  ASSERT_GT(files.size(), 50u);
  Violations all = check_tree(files);
  for (const SourceFile& file : files) {
    append(all, check_includes(file));
    append(all, check_third_party(file));
    append(all, check_style(file));
    append(all, check_licence(file));
  }
  EXPECT_TRUE(all.empty()) << listed(all);
}

TEST(Architecture, TheMapIsTrue) {
  const std::filesystem::path root = std::filesystem::path(LAPWING_SOURCE_DIR) / "framework";
  std::vector<std::string> existing;
  for (const auto& item : std::filesystem::directory_iterator(root)) {
    if (item.is_directory()) existing.push_back(item.path().filename().string());
  }
  const Violations found =
      check_map({"framework/README.md", read_file(root / "README.md")}, existing);
  EXPECT_TRUE(found.empty()) << listed(found);
}

// Each rule is shown to bite: a file that breaks it, and one beside it that does not.

std::string included(const std::string& path, const std::string& include) {
  const Violations found = check_includes({path, "// text\n#include \"" + include + "\"\n"});
  return found.empty() ? "" : found.front();
}

struct Pair {
  const char* file;
  const char* include;
};

TEST(Rules, RoomsIncludeWhatTheTableAllows) {
  const Pair allowed[] = {
      {"framework/core/a.h", "framework/core/b.h"},
      {"framework/verify/a.cpp", "framework/vehicle/b.h"},
      {"framework/verify/a.cpp", "framework/core/b.h"},
      {"framework/solve/a.cpp", "framework/problem/b.h"},
      {"framework/solve/a.cpp", "framework/geometry/b.h"},
      {"framework/conformance/a.cpp", "framework/plugin/registry.h"},
      {"framework/mission/a.cpp", "framework/conformance/b.h"},
      {"framework/app/a.cpp", "framework/mission/b.h"},
      {"plugins/cost_terms/a/a.cpp", "framework/problem/cost_term.h"},
      {"plugins/cost_terms/a/a.cpp", "framework/trajectory/b.h"},
      {"plugins/cost_terms/a/a.cpp", "framework/plugin/plugin.h"},
      {"plugins/cost_terms/a/a.cpp", "framework/core/units.h"},
      {"plugins/cost_terms/a/a.cpp", "plugins/cost_terms/a/parts.h"},
      {"plugins/trajectory_solvers/a/a.cpp", "framework/solve/b.h"},
      {"tests/solve/a.cpp", "framework/app/b.h"},
      {"tests/solve/a.cpp", "tests/solve/b.h"},
  };
  for (const Pair& pair : allowed) EXPECT_EQ(included(pair.file, pair.include), "") << pair.include;
  const Pair refused[] = {
      {"framework/core/a.h", "framework/geometry/b.h"},
      {"framework/geometry/a.h", "framework/trajectory/b.h"},
      {"framework/trajectory/a.h", "framework/vehicle/b.h"},
      {"framework/verify/a.cpp", "framework/problem/b.h"},
      {"framework/verify/a.cpp", "framework/solve/b.h"},
      {"framework/verify/a.cpp", "framework/plugin/plugin.h"},
      {"framework/problem/a.cpp", "framework/solve/b.h"},
      {"framework/problem/a.cpp", "framework/config/yaml.h"},
      {"framework/export/a.cpp", "framework/problem/b.h"},
      {"framework/config/a.cpp", "framework/plugin/b.h"},
      {"framework/plugin/a.cpp", "framework/config/b.h"},
      {"framework/conformance/a.cpp", "framework/mission/b.h"},
      {"framework/conformance/a.cpp", "framework/app/b.h"},
      {"framework/mission/a.cpp", "framework/app/b.h"},
      {"framework/app/a.cpp", "framework/kitchen/b.h"},
      {"framework/kitchen/a.cpp", "framework/core/b.h"},
      {"framework/solve/a.cpp", "plugins/cost_terms/a/a.h"},
      {"framework/solve/a.cpp", "qp.h"},
      {"plugins/cost_terms/a/a.cpp", "a.h"},
      {"plugins/cost_terms/a/a.cpp", "plugins/cost_terms/b/b.h"},
      {"plugins/cost_terms/a/a.cpp", "plugins/constraints/a/a.h"},
      {"plugins/cost_terms/a/a.cpp", "framework/solve/b.h"},
      {"plugins/cost_terms/a/a.cpp", "framework/plugin/registry.h"},
      {"plugins/cost_terms/a/a.cpp", "framework/config/yaml.h"},
      {"plugins/exporters/a/a.cpp", "framework/problem/b.h"},
      {"plugins/toys/a/a.cpp", "framework/core/b.h"},
      {"tests/solve/a.cpp", "helpers.h"},
  };
  for (const Pair& pair : refused) {
    EXPECT_NE(included(pair.file, pair.include), "") << pair.file << " " << pair.include;
  }
  EXPECT_EQ(
      included("framework/core/a.h", "framework/geometry/b.h"),
      "framework/core/a.h:2: framework/geometry/b.h: room core may not include room geometry");
  EXPECT_FALSE(check_includes({"framework/solve/a.h", "#include <framework/core/b.h>"}).empty());
  EXPECT_FALSE(
      check_includes({"framework/core/a.h", "  #  include \"framework/app/b.h\""}).empty());
}

TEST(Rules, ThirdPartyHeadersStayInTheirRoom) {
  const auto count = [](const char* path, const char* include) {
    return check_third_party({path, std::string("#include <") + include + ">\n"}).size();
  };
  EXPECT_EQ(count("framework/mission/a.h", "lua.hpp"), 0u);
  EXPECT_EQ(count("framework/app/a.cpp", "lua.hpp"), 1u);
  EXPECT_EQ(count("plugins/maps/a/a.cpp", "lauxlib.h"), 1u);
  EXPECT_EQ(count("framework/config/yaml.cpp", "yaml-cpp/yaml.h"), 0u);
  EXPECT_EQ(count("framework/config/yaml.h", "yaml-cpp/yaml.h"), 1u);
  EXPECT_EQ(count("framework/vehicle/a.cpp", "yaml-cpp/yaml.h"), 1u);
  EXPECT_EQ(count("framework/app/a.cpp", "CLI/CLI.hpp"), 0u);
  EXPECT_EQ(count("framework/mission/a.cpp", "CLI/CLI.hpp"), 1u);
  for (const char* header : {"spdlog/spdlog.h", "nlohmann/json.hpp", "fmt/format.h"}) {
    EXPECT_EQ(count("framework/core/a.cpp", header), 0u);
    EXPECT_EQ(count("framework/core/a.h", header), 1u);
  }
  EXPECT_EQ(count("framework/map/a.cpp", "embree3/rtcore.h"), 1u);
  EXPECT_EQ(check_third_party({"framework/solve/a.cpp", "x = dlopen(path, 1);"}).size(), 1u);
  EXPECT_EQ(check_third_party({"framework/plugin/a.cpp", "x = dlopen(path, 1);"}).size(), 0u);
  const SourceFile one{"framework/geometry/a.cpp", "#include <GeographicLib/Geodesic.hpp>"};
  const SourceFile two{"framework/geometry/b.cpp", "#include <GeographicLib/Geocentric.hpp>"};
  EXPECT_TRUE(check_tree({one}).empty());
  EXPECT_EQ(check_tree({one, two}).size(), 1u);
}

TEST(Rules, FilesAndTypesHaveNamesThatSaySomething) {
  const auto count = [](const std::string& path, const std::string& text) {
    return check_style({path, "#pragma once\n" + text}).size();
  };
  EXPECT_EQ(count("framework/core/units.h", "class Unit {};"), 0u);
  for (const char* name : {"utils", "common", "helper", "manager", "context", "plan_utils",
                           "string_helpers", "plugin_manager"}) {
    EXPECT_EQ(count(std::string("framework/core/") + name + ".h", ""), 1u) << name;
  }
  for (const char* type : {"class PlanManager {", "struct RunContext {", "class StringUtils;",
                           "namespace utils {", "struct Helper {"}) {
    EXPECT_EQ(count("framework/core/a.h", type), 1u) << type;
  }
  EXPECT_EQ(count("framework/core/a.h", "class Contexture;"), 0u);
  EXPECT_EQ(count("framework/core/PlanReader.h", ""), 1u);
  EXPECT_EQ(count("framework/core/plan-reader.cpp", ""), 1u);
}

TEST(Rules, TextIsFinishedAndFitsTheScreen) {
  const auto count = [](const std::string& path, const std::string& text) {
    return check_style({path, text}).size();
  };
  EXPECT_EQ(count("framework/core/a.h", "int a;\n"), 1u);  // no #pragma once
  EXPECT_EQ(count("framework/core/a.h", "#pragma once\nusing namespace std;\n"), 1u);
  for (const char* path : {"framework/core/a.cpp", "scripts/mission/film.lua"}) {
    EXPECT_EQ(count(path, std::string(100, 'x')), 0u);
    EXPECT_EQ(count(path, std::string(101, 'x')), 1u);
  }
  std::string accents;
  for (int i = 0; i < 100; ++i) accents += "ä";
  EXPECT_EQ(count("framework/core/a.cpp", accents), 0u);
  for (const char* path : {"framework/core/a.cpp", "plugins/a/README.md", "scripts/run.sh"}) {
    EXPECT_EQ(count(path, std::string("// TO") + "DO later"), 1u);
    EXPECT_EQ(count(path, std::string("# FIX") + "ME(me): now"), 1u);
  }
  std::string lines;
  for (int i = 0; i < 249; ++i) lines += "x = 1\n";
  EXPECT_EQ(count("scripts/mission/film.lua", lines), 0u);
  EXPECT_EQ(count("scripts/mission/film.lua", lines + "x = 1\n"), 1u);
  EXPECT_EQ(count("scripts/scene/castle.lua", lines + "x = 1\n"), 0u);
}

TEST(Rules, SourcesStateTheirLicence) {
  const auto count = [](const std::string& path, const std::string& text) {
    return check_licence({path, text}).size();
  };
  const std::string licence = " SPDX-License-Identifier: Apache-2.0\n";
  EXPECT_EQ(count("framework/core/a.cpp", "//" + licence + "int a;\n"), 0u);
  EXPECT_EQ(count("framework/core/a.cpp", "int a;\n//" + licence), 0u);
  EXPECT_EQ(count("framework/core/a.cpp", "int a;\nint b;\n//" + licence), 1u);
  EXPECT_EQ(count("scripts/test.sh", "#!/usr/bin/env bash\n#" + licence), 0u);
  EXPECT_EQ(count("scripts/test.sh", "#!/usr/bin/env bash\n"), 1u);
  EXPECT_EQ(count("plugins/CMakeLists.txt", "# Plugins.\n"), 1u);
  EXPECT_EQ(count("scripts/templates/CMakeLists.txt", "# Yours.\n"), 0u);
  EXPECT_EQ(count("scripts/README.md", "Scripts.\n"), 0u);
}

TEST(Rules, SourcesWithTestsAreNamedAlike) {
  const auto count = [](const std::string& path, const std::string& text) {
    return check_style({path, text}).size();
  };
  const std::string test = "int a;\nTEST(A, Holds) {}\n";
  EXPECT_EQ(count("tests/core/json_test.cpp", test), 0u);
  EXPECT_EQ(count("tests/core/test_json.cpp", test), 1u);
  EXPECT_EQ(count("tests/core/json.cpp", "TEST_P(A, Holds) {}\n"), 1u);
  EXPECT_EQ(count("tests/core/scenes.cpp", "// MY_TEST(a)\nint a;\n"), 0u);
}

TEST(Rules, TheMapSaysWhatTheRulesSay) {
  const std::string rows =
      "| room | holds | may include |\n|---|---|---|\n"
      "| `core` | errors | \u2013 |\n"
      "| `verify` | checks | geometry, vehicle |\n"
      "| `app` | commands | everything |\n";
  const auto count = [&](const std::string& from, const std::string& to) {
    std::string text = rows;
    text.replace(text.find(from), from.size(), to);
    return check_map({"README.md", text}, {"core", "verify", "app", "geometry", "vehicle"}).size();
  };
  EXPECT_EQ(count("core", "core"), 2u);  // geometry and vehicle are not listed
  EXPECT_EQ(count("\u2013", "geometry"), 3u);
  EXPECT_EQ(count("geometry, vehicle", "geometry"), 3u);
  EXPECT_EQ(count("geometry, vehicle", "geometry, vehicle, solve"), 3u);
  EXPECT_EQ(count("| `app`", "| app"), 3u);
}

TEST(Rules, AClassHasOneHeader) {
  const auto count = [](const std::string& one, const std::string& other) {
    return check_tree({{"framework/view/a.h", one}, {"framework/verify/b.h", other}}).size();
  };
  const std::string motion = "namespace lapwing {\nstruct Motion {\n";
  EXPECT_EQ(count(motion, motion), 1u);
  EXPECT_EQ(count(motion, "namespace lapwing {\nclass Motion final : public A {\n"), 1u);
  EXPECT_EQ(count(motion, "namespace lapwing {\nclass Motion;\n"), 0u);
  EXPECT_EQ(count(motion, "namespace lapwing::verify {\nclass Motion {\n"), 0u);
  EXPECT_EQ(count(motion, "namespace lapwing {\nclass Other {\n  struct Motion {\n"), 0u);
}

TEST(Rules, APluginHasOneName) {
  const std::string folder = "plugins/cost_terms/keep_low/";
  const std::vector<SourceFile> good{
      {folder + "keep_low.cpp",
       "class KeepLow final { static constexpr PluginText kText{\"keep_low\", \"1\"}; };\n"
       "LAPWING_PLUGINS(lapwing::KeepLow)\n"},
      {folder + "CMakeLists.txt", "lapwing_add_plugin(cost_term keep_low)\n"},
      {folder + "README.md", "# keep_low\n"},
  };
  EXPECT_TRUE(check_tree(good).empty()) << listed(check_tree(good));
  const auto changed = [&](std::size_t file, const std::string& from, const std::string& to) {
    std::vector<SourceFile> files = good;
    const std::size_t where = files[file].text.find(from);
    files[file].text.replace(where, from.size(), to);
    return check_tree(files).size();
  };
  EXPECT_EQ(changed(0, "\"keep_low\"", "\"keeplow\""), 1u);
  EXPECT_EQ(changed(0, "class KeepLow", "class Keep_low"), 1u);
  EXPECT_EQ(changed(0, "lapwing::KeepLow", "lapwing::KeepHigh"), 1u);
  EXPECT_EQ(changed(1, "keep_low", "keep_high"), 1u);
  EXPECT_EQ(changed(1, "cost_term ", "constraint "), 1u);
  EXPECT_EQ(changed(0, "lapwing::KeepLow", "lapwing::KeepLowForm"), 1u);
  std::vector<SourceFile> behind = good;
  for (const char* name : {"KeepLow final", "KeepLow)"}) {
    std::string& text = behind[0].text;
    text.insert(text.find(name) + 7, "CostTerm");
  }
  EXPECT_TRUE(check_tree(behind).empty()) << listed(check_tree(behind));
  std::vector<SourceFile> renamed = good;
  renamed[0].path = folder + "low.cpp";
  EXPECT_EQ(check_tree(renamed).size(), 4u);  // the file, its kText, its class, its macro
  // A family: the library's name is the folder's alone.
  std::vector<SourceFile> family = good;
  family[1].text =
      "lapwing_add_plugin(cost_term keep_low FAMILY low lower\n SOURCES keep_low.cpp)\n";
  EXPECT_EQ(check_tree(family).size(), 6u);  // of each its kText, its class, its place in the list
  family[0].text =
      "class Low { PluginText kText{\"low\"}; }; class Lower { PluginText kText{\"lower\"}; };\n"
      "LAPWING_PLUGINS(lapwing::Low, lapwing::Lower)\n";
  EXPECT_TRUE(check_tree(family).empty()) << listed(check_tree(family));
  EXPECT_EQ(check_tree({good[0], good[1]}).size(), 1u);  // no README
  EXPECT_EQ(check_tree({good[0], good[2]}).size(), 1u);  // no CMake line
}

}  // namespace
}  // namespace lapwing::architecture
