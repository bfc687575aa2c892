// SPDX-License-Identifier: Apache-2.0
// Every fenced block of every README does what it says: it is run as it stands, or within the least
// that its place in the text takes for granted. Blocks without a language are no code; "lua
// excerpt" marks the few that nobody could run.
#include <algorithm>
#include <map>

#include "framework/core/json.h"
#include "framework/study/reproduction.h"
#include "tests/app/program_fixture.h"
#include "tests/guide.h"

namespace lapwing {
namespace {

// A problem of a film, of which plugins' READMEs show single calls.
constexpr const char* kProblem = R"lua(return { kind = 'snippet', plan = function(run)
  local p = run:problem { vehicle = run:vehicle('vehicles/solo'), %HORIZON%, environment = {
    margin = 0.5, spheres = { { name = 'rock', center = {4, 9, 3}, radius = 1.5 } },
    boxes = { { name = 'hut', lower = {0, 9, 0}, upper = {2, 12, 3} } },
    zones = { { name = 'yard', corners = {20, 20, 30, 20, 30, 30}, floor = 0, ceiling = 9 } },
    flight_zones = { { name = 'field', corners = {-60, -60, 60, -60, 60, 60, -60, 60},
                       floor = 0, ceiling = 50 } },
    subjects = { { name = 'walker', height = 1.8, track = { { time = 0, position = {6, 9, 1} } } },
                 { name = 'actor', height = 1.8,
                   track = { { time = 0, position = {6, 7, 1} } } } } } }
%MODELS%
%SNIPPET%
  p:guess_path { times = {0, 8}, positions = { {0, 0, 3}, {9, 0, 3} }, yaws = {0, 0} }
  p:finish()
  lapwing.fail('the snippet holds')
end })lua";

// A film that fields shown alone belong to.
const std::string kFilm =
    "return require('mission.film').shot {\n"
    "  keyframes = { { position = {0, 0, 2} }, { position = {3, 4, 4} } },\n";

constexpr const char* kTower = R"({ "type": "FeatureCollection", "features": [
  { "type": "Feature", "properties": { "name": "tower", "from": 0, "to": 30 },
    "geometry": { "type": "Polygon", "coordinates":
      [[[4.36, 52], [4.3601, 52], [4.3601, 52.0001], [4.36, 52.0001], [4.36, 52]]] } }] })";

class Snippets : public CommandLine {
 protected:
  static bool has(const std::string& text, const std::string& piece) {
    return text.find(piece) != std::string::npos;
  }

  static std::string replaced(std::string text, const std::string& mark, const std::string& by) {
    return text.replace(text.find(mark), mark.size(), by);
  }

  void expect(const std::vector<std::string>& arguments, int status, const std::string& fragment) {
    const Finished finished = run(arguments);
    EXPECT_EQ(finished.status, status) << where_ << ":\n" << finished.out << finished.err;
    EXPECT_TRUE(has(finished.out + finished.err, fragment)) << where_ << ":\n" << finished.err;
  }

  void call_of_a_problem(const std::string& text) {
    std::string models = has(text, "add_model") ? "" : "  p:add_model { type = 'quadrotor' }\n";
    const bool looks = has(text, "camera_angle") || has(text, "framing") ||
                       has(text, "occlusion") || has(text, "skewness") ||
                       has(text, "subject_target");
    if (looks) models += "  p:add_model { type = 'gimbal' }\n";
    if (looks && !has(text, "add_block"))
      models += "  p:add_block { name = 'target', size = 3, unit = 'm' }\n";
    // Terms of legs and times need times that are free; derivatives need stages enough.
    const std::string leg = "{ duration = 2, intervals = 20 }, ";
    const bool free = has(text, "gate") || has(text, "flight_time");
    const std::string horizon =
        free ? "legs = { " + leg + leg + leg + leg + "}" : "duration = 8, step = 0.1";
    std::string script = replaced(kProblem, "%HORIZON%", horizon);
    script = replaced(script, "%MODELS%", models);
    write("snippet.lua", replaced(script, "%SNIPPET%", text));
    expect({"run", "snippet.lua"}, 2, "the snippet holds");
  }

  void lua(const std::string& text) {
    if (text.rfind("p:", 0) == 0) return call_of_a_problem(text);
    if (has(text, "return function(")) {
      write("snippet.lua", text);
      return expect({"scene", "view", "snippet.lua", "-o", "page.html"}, 0, "");
    }
    if (text.rfind("regions", 0) == 0) {  // of a scan
      write("site.geojson", kTower);
      write("snippet.lua",
            "return require('mission.scan').of_scene { scene = 'church', safe_height = 60, heights "
            "= 'world', "
            "origin = { latitude_deg = 52, longitude_deg = 4.36, height = 0, height_of = 'ground' "
            "},\n" +
                text + "}");
      return expect({"config", "snippet.lua", "--data", folder_.string()}, 0, "");
    }
    const bool fields = !has(text, "return ") || text.rfind("costs", 0) == 0;
    write("snippet.lua", fields ? kFilm + text + "}" : text);
    // Maps, scans and explorations take minutes: tests/missions/long runs them.
    expect({"config", "snippet.lua"}, 0, "");
    if (fields || slow_kind(text).empty()) expect({"run", "snippet.lua"}, 0, ": certified");
  }

  // A configuration of whichever kind of mission has the key.
  void yaml(const std::string& text) {
    static const std::map<std::string, std::string> kinds = {
        {"solver", film("")},
        {"planner", film("")},
        {"controller", film("")},
        {"resolution", "return require('mission.map').of_scene { scene = 'street' }"},
        {"tour", "return require('mission.scan').of_scene { scene = 'church' }"},
        {"utility", "return require('mission.explore').of_scene { scene = 'downtown' }"}};
    if (has(text, "\nstudies:")) {  // a table of the thesis
      fs::create_directories(folder_ / "tables");
      write("tables/9.1.yaml", text);
      EXPECT_NO_THROW(read_reproduction(folder_ / "tables", "9.1")) << where_;
      return;
    }
    const auto found = kinds.find(text.substr(0, text.find(':')));
    ASSERT_NE(found, kinds.end()) << where_ << ": a configuration of what?\n" << text;
    write("mission.lua", found->second);
    write("snippet.yaml", text);
    expect({"config", "mission.lua", "--config", "snippet.yaml"}, 0, "snippet.yaml");
  }

  // Typed in a checkout: links to this one, and scripts/run.sh without its building.
  void shell(const std::string& text) {
    const fs::path source(LAPWING_SOURCE_DIR);
    if (!fs::exists(folder_ / "build")) {
      fs::create_directories(folder_ / "build");
      fs::create_directories(folder_ / "scripts");
      fs::create_symlink(LAPWING_BUILD_DIR, folder_ / "build/release");
      fs::create_symlink(source / "examples", folder_ / "examples");
      fs::create_symlink(source / "configs", folder_ / "configs");
      write("scripts/run.sh", "exec build/release/bin/lapwing run \"$@\"\n");
      write("scripts/test.sh", "exit 0\n");
    }
    write("typed.sh", "set -e\nPATH=" LAPWING_BUILD_DIR "/bin:$PATH\n" + text);
    const int status =
        std::system(("cd '" + folder_.string() + "' && bash typed.sh > log 2>&1").c_str());
    EXPECT_EQ(status, 0) << where_ << ":\n" << read_file(folder_ / "log");
  }

  std::string where_;
};

// Guides that are followed as a whole, by guides_test.cpp and authoring_test.cpp.
constexpr const char* kFollowed[] = {"scripts/README.md", "configs/README.md", "plugins/README.md",
                                     "CONTRIBUTING.md"};
constexpr std::size_t kMostExcerpts = 8;

TEST_F(Snippets, OfEveryReadmeHold) {
  const fs::path source(LAPWING_SOURCE_DIR);
  std::size_t excerpts = 0, run = 0;
  for (const fs::path& file : guides_in(source)) {
    const std::string name = file.lexically_relative(source).string();
    if (std::find(std::begin(kFollowed), std::end(kFollowed), name) != std::end(kFollowed))
      continue;
    for (const Snippet& snippet : snippets_of(file, "# ")) {
      where_ = name + ":" + std::to_string(snippet.line);
      if (snippet.excerpt) {
        excerpts += file.filename() != "EXPERIMENTS.md";  // a record of what was run once
      } else if (snippet.language == "lua") {
        ++run, lua(snippet.text);
      } else if (snippet.language == "yaml") {
        ++run, yaml(snippet.text);
      } else if (snippet.language == "sh") {
        ++run, shell(snippet.text);
      } else if (snippet.language == "json") {
        EXPECT_NO_THROW(from_json(snippet.text, where_)) << where_;
      } else {
        EXPECT_EQ(snippet.language, "") << where_ << ": mark it as an excerpt";
      }
    }
  }
  EXPECT_LE(excerpts, kMostExcerpts) << "excerpts are snippets that nobody can copy";
  EXPECT_GE(run, 45u);
}

}  // namespace
}  // namespace lapwing
