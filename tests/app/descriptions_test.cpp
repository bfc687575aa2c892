// SPDX-License-Identifier: Apache-2.0
// What is described once: tables in READMEs, schemas beside configurations and annotations are what
// the program writes. LAPWING_DESCRIBE=write in the environment writes them anew.
#include <map>
#include <regex>
#include <set>

#include "framework/app/descriptions.h"
#include "framework/config/yaml.h"
#include "framework/core/json.h"
#include "framework/mission/script_interface.h"
#include "tests/app/json_schema.h"
#include "tests/app/program_fixture.h"

namespace lapwing {
namespace {

const fs::path kTree = LAPWING_SOURCE_DIR;

bool writes() {
  const char* asked = std::getenv("LAPWING_DESCRIBE");
  return asked && std::string(asked) == "write";
}

// Holds a whole file against what it should be.
void expect_fresh(const fs::path& file, const std::string& wanted) {
  if (writes()) write_file_atomically(file, wanted);
  ASSERT_TRUE(fs::exists(file)) << file;
  EXPECT_TRUE(read_file(file) == wanted)
      << file << " is stale; write it anew: LAPWING_DESCRIBE=write "
      << LAPWING_BUILD_DIR "/bin/test_app --gtest_filter=Described.*";
}

// The same for what stands between a mark and the next "<!-- end -->".
void expect_fresh_part(const fs::path& file, const std::string& mark, const std::string& wanted) {
  const std::string text = read_file(file), begin = "<!-- " + mark + " -->\n";
  const std::size_t at = text.find(begin);
  ASSERT_NE(at, std::string::npos) << file << " lacks the mark " << begin;
  const std::size_t from = at + begin.size(), to = text.find("<!-- end -->", from);
  ASSERT_NE(to, std::string::npos) << file << ": no end after the mark " << begin;
  expect_fresh(file, text.substr(0, from) + wanted + text.substr(to));
}

// The plugins of the tree; others may lie on the search path.
Registry shipped_plugins() {
  return Registry({fs::path(LAPWING_BUILD_DIR) / "lib/plugins"});
}

ScriptInterface shipped_interface() {
  MissionSettings settings;
  settings.scripts = kTree / "scripts";
  settings.configs = kTree / "configs";
  return read_script_interface(settings);
}

TEST(Described, ParametersOfPluginsInTheirReadmes) {
  int described = 0;
  const Registry registry = shipped_plugins();
  for (const PluginEntry& entry : registry.entries()) {
    if (!entry.preset_of.empty() || entry.parameters.specs().empty()) continue;
    const fs::path folder =
        kTree / "plugins" / entry.library.parent_path().filename() / entry.library.stem();
    expect_fresh_part(folder / "README.md", "parameters of " + entry.kind + " " + entry.name,
                      parameters_as_markdown(entry));
    ++described;
  }
  EXPECT_GT(described, 25);
}

TEST(Described, CallsInTheReadmeOfMissions) {
  expect_fresh_part(kTree / "framework/mission/README.md", "calls",
                    call_table_of(shipped_interface()));
}

TEST(Described, NamedShotsInTheReadmeOfMissionKinds) {
  expect_fresh_part(kTree / "scripts/mission/README.md", "named shots",
                    argument_table_of(shipped_interface(), "film.shots"));
}

TEST(Described, SchemasBesideConfigurations) {
  const ScriptInterface interface = shipped_interface();
  const Registry registry = shipped_plugins();
  const Value missions = config_schema(interface, registry, "");
  const Value vehicle = config_schema(interface, registry, "vehicle");
  expect_fresh(kTree / "configs/mission.schema.json", to_json(missions) + "\n");
  expect_fresh(kTree / "configs/vehicle.schema.json", to_json(vehicle) + "\n");
  int checked = 0;
  for (const auto& item : fs::recursive_directory_iterator(kTree / "configs")) {
    const fs::path file = item.path();
    const std::string room = file.parent_path().filename();
    if (file.extension() != ".yaml" || room == "cameras" || room == "reproduce" || room == "train")
      continue;
    const Value given = read_yaml(file);
    EXPECT_EQ(schema_error(room == "vehicles" ? vehicle : missions, given), "") << file;
    const std::string named = room == "vehicles" ? "vehicle" : "mission";
    EXPECT_EQ(
        read_file(file).rfind("# yaml-language-server: $schema=../" + named + ".schema.json\n", 0),
        0u)
        << file << " does not name its schema in its first line";
    ++checked;
  }
  EXPECT_GE(checked, 10);
  const auto error = [&](const char* text) {
    return schema_error(missions, from_yaml(text, "text"));
  };
  EXPECT_EQ(error("solver: ipopt"), "");
  EXPECT_EQ(error("solver: {type: iqp, iterations: 10}\nduration: 20 s"), "");
  EXPECT_EQ(error("tour: {budget: 120}"), "");
  EXPECT_EQ(error("costs: [{type: skewness, height: 6, weight: 2}, {name: low}]"), "");
  EXPECT_NE(error("costs: [{type: skewness, hieght: 6}]"), "");
  EXPECT_NE(error("costs: [{type: subject_distance, distance: 6}]"), "");
  EXPECT_EQ(error("duration: 20 s\nstretch: auto\nsandbox: {seconds: 60}"), "");
  EXPECT_NE(error("solvr: ipopt"), "");
  EXPECT_NE(error("solver: ipoppt"), "");
  EXPECT_NE(error("solver: {type: iqp, mu_strategy: adaptive}"), "");
  EXPECT_NE(error("duration: -3"), "");
  EXPECT_NE(error("duration: long"), "");
  EXPECT_NE(error("start_velocity: [1, 2]"), "");
  EXPECT_NE(error("keyframes: [{time: 3}]"), "");
  EXPECT_THROW(config_schema(interface, registry, "flim"), InputError);
}

// Whatever a line of the annotations speaks of is defined in them.
TEST(Described, AnnotationsNameNothingUnknown) {
  const std::string text = annotations_of(shipped_interface(), shipped_plugins());
  std::vector<std::string> defined;
  const std::regex definition("---@(?:class|alias) (lapwing[A-Za-z0-9_.]*)");
  for (std::sregex_iterator at(text.begin(), text.end(), definition), end; at != end; ++at)
    defined.push_back((*at)[1]);
  std::sort(defined.begin(), defined.end());
  EXPECT_EQ(std::adjacent_find(defined.begin(), defined.end()), defined.end())
      << *std::adjacent_find(defined.begin(), defined.end()) << " is defined twice";
  EXPECT_GT(defined.size(), 150u);
  const auto known = [&](std::string name) {
    while (!name.empty() && name.back() == '.') name.pop_back();
    return std::binary_search(defined.begin(), defined.end(), name);
  };
  const std::regex use("[( |:\\[]((?:lapwing\\.)[A-Za-z0-9_.]+)");
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("---@", 0) != 0) continue;
    // The type is the second word of a parameter or field; what follows a blank after it is text.
    std::istringstream words(line);
    std::string tag, name, type;
    words >> tag >> name >> type;
    if (tag == "---@return") type = name;
    if (tag == "---@class") type = "";
    const std::string typed = " " + type;
    for (std::sregex_iterator at(typed.begin(), typed.end(), use), end; at != end; ++at)
      EXPECT_TRUE(known((*at)[1])) << line;
  }
  for (const char* wanted :
       {"---@param given lapwing.film.shot", "M.of_scene = mission", "---@return lapwing.mission"})
    EXPECT_NE((read_file(kTree / "scripts/mission/film.lua") +
               read_file(kTree / "scripts/mission/scan.lua"))
                  .find(wanted),
              std::string::npos);
  for (const char* wanted : {"function it:add_cost(term) end", "|fun(time: number): number[] ",
                             "---@class lapwing.film.shot\n", "---@field mu_strategy? ",
                             "---@class lapwing.trajectory_solver.iqp\n",
                             "---@field keyframes lapwing.film.shot.keyframes[] "})
    EXPECT_NE(text.find(wanted), std::string::npos) << wanted;
}

// Every kind and function of the shipped modules that a script may call is among them.
TEST(Described, EveryMissionFunctionIsAsked) {
  std::string all;
  const ScriptInterface interface = shipped_interface();
  for (const MissionFunction& mission : interface.missions) {
    all += mission.kind + "." + mission.name + " ";
    EXPECT_FALSE(mission.declarations.as_list().empty());
    const std::string module = read_file(kTree / "scripts/mission" / (mission.kind + ".lua"));
    EXPECT_NE(module.find("lapwing." + mission.kind + "." + mission.name), std::string::npos)
        << mission.kind << "." << mission.name << " is not annotated in its module";
  }
  EXPECT_EQ(all,
            "explore.of_mesh explore.of_scene film.from_file film.shot light_painting.picture "
            "light_painting.strokes light_painting.text map.of_file map.of_folder map.of_scene "
            "race.course scan.of_cloud scan.of_colmap scan.of_images scan.of_mesh scan.of_prior "
            "scan.of_scene scan.of_terrain ");
}

const std::vector<std::string> kKinds{"explore", "film", "light_painting", "map", "race", "scan"};

TEST(Described, OptionsInTheReadmeOfTheirMission) {
  const ScriptInterface interface = shipped_interface();
  std::set<std::string> kinds;
  for (const MissionFunction& mission : interface.missions) kinds.insert(mission.kind);
  EXPECT_EQ(kinds, std::set<std::string>(kKinds.begin(), kKinds.end()));
  for (const std::string& kind : kinds)
    expect_fresh_part(kTree / "scripts/mission/README.md", "options of " + kind,
                      option_table_of(interface, kind));
}

// Every entry of a declaration, of those in it too, by its dotted name.
void collect_entries(const Value& entries, const std::string& prefix,
                     std::map<std::string, std::string>& summaries) {
  for (const Value& entry : entries.as_list()) {
    const std::string name = prefix + entry.at("name").as_text();
    const std::string type = entry.at("type").as_text();
    const Value* summary = entry.find("summary");
    summaries[name] = summary ? summary->as_text() : "";
    for (const char* list : {"table", "functions"})
      if (const Value* inner = entry.find(list))
        collect_entries(*inner, name + (type == "tables" || type == "plugins" ? "[]." : "."),
                        summaries);
  }
}

// Counted here by other code than that which writes the tables.
TEST(Described, EveryOptionOfAMissionHasItsRowAndASummary) {
  const ScriptInterface interface = shipped_interface();
  for (const std::string& kind : kKinds) {
    std::map<std::string, std::string> summaries;
    for (const MissionFunction& mission : interface.missions)
      if (mission.kind == kind) collect_entries(mission.declarations, "", summaries);
    const std::string table = option_table_of(interface, kind);
    for (const auto& [name, summary] : summaries) {
      EXPECT_NE(summary, "") << kind << ": " << name;
      EXPECT_NE(table.find("\n| `" + name + "` | "), std::string::npos) << kind << ": " << name;
    }
    EXPECT_GT(summaries.size(), 15u) << kind;
  }
}

// A row tells name, default, meaning, form, unit and range; functions with options of their own are
// named.
TEST(Described, RowsOfOptions) {
  const auto options = [](const char* json) { return from_json(json, "declarations"); };
  ScriptInterface interface;
  interface.missions.push_back({"dive", "deep", options(R"([
        {"name": "depth", "type": "number", "unit": "m", "above": 0, "maximum": 40, "default": 3,
         "words": ["auto"], "summary": "below the surface"},
        {"name": "legs", "type": "tables", "summary": "one by one", "table": [
          {"name": "to", "type": "numbers", "size": 3, "unit": "m", "required": true,
           "summary": "its end"}]}])")});
  interface.missions.push_back({"dive", "shallow", options(R"([
        {"name": "depth", "type": "number", "unit": "m", "above": 0, "maximum": 40, "default": 3,
         "words": ["auto"], "summary": "below the surface"}])")});
  EXPECT_EQ(option_table_of(interface, "dive"),
            "| option | of | default | |\n|---|---|---|---|\n"
            "| `depth` | all | 3 m | below the surface (m, above 0 and at most 40 or `auto`) |\n"
            "| `legs` | `deep` | – | one by one (list of tables) |\n"
            "| `legs[].to` | | required | its end (3 numbers, m) |\n");
  interface.missions.pop_back();
  EXPECT_EQ(option_table_of(interface, "dive").rfind("| option | default | |\n", 0), 0u);
}

TEST_F(CommandLine, SaysWhatThereIs) {
  Finished finished = run({"annotations", "-o", "lapwing.lua"});
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_EQ(read_file(folder_ / "lapwing.lua").rfind("---@meta\n", 0), 0u);
  finished = run({"schema", "film"});
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_EQ(from_json(finished.out, "schema").at("title").as_text(),
            "Lapwing: options of missions of kind film");
  refused({"schema", "flim"}, {"did you mean 'film'?"});
  finished = run({"plugins", "show", "cost_term/derivative", "--markdown"});
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_NE(finished.out.find("| `order` | 4 | "), std::string::npos) << finished.out;
}

}  // namespace
}  // namespace lapwing
