// SPDX-License-Identifier: Apache-2.0
#include "tests/architecture/rules.h"

#include <algorithm>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "framework/core/files.h"

namespace lapwing::architecture {

namespace fs = std::filesystem;

namespace {

using Names = std::set<std::string>;

// What a room may include besides itself and core.
const std::map<std::string, Names>& rooms() {
  static const Names kAllButApp{
      "geometry",    "trajectory",    "vehicle",       "map",     "path",   "problem",
      "solve",       "view",          "explore",       "verify",  "export", "config",
      "conformance", "plugin",        "mission",       "surface", "shape",  "picture",
      "symbolic",    "flight_log",    "flight_review", "mavlink", "fly",    "survey",
      "items",       "photogrammetry"};
  static const auto without = [](Names names, const std::string& name) {
    names.erase(name);
    return names;
  };
  static const auto with = [](Names names, const std::string& name) {
    names.insert(name);
    return names;
  };
  static const std::map<std::string, Names> kRooms{
      {"core", {}},
      {"geometry", {}},
      {"surface", {"geometry"}},
      {"picture", {"geometry"}},
      {"survey", {"geometry"}},
      {"photogrammetry", {"geometry", "surface"}},
      {"shape", {"geometry", "map"}},
      {"trajectory", {"geometry", "shape"}},
      {"vehicle", {"geometry", "trajectory"}},
      {"map", {"geometry"}},
      {"path", {"geometry", "map"}},
      {"problem", {"geometry", "shape", "trajectory", "vehicle"}},
      {"symbolic", {"geometry", "shape", "trajectory", "vehicle", "problem"}},
      {"solve", {"geometry", "shape", "trajectory", "vehicle", "problem"}},
      {"view", {"geometry", "map", "path"}},
      {"explore", {"geometry", "trajectory", "map", "view", "path"}},
      {"verify", {"geometry", "trajectory", "vehicle", "map"}},
      {"export",
       {"geometry", "picture", "shape", "trajectory", "vehicle", "verify", "map",  // limits
        "photogrammetry"}},
      {"flight_log", {"geometry", "mavlink"}},
      {"flight_review", {"geometry", "trajectory", "vehicle", "verify", "export", "flight_log"}},
      {"mavlink", {}},
      {"fly", {"geometry", "shape", "trajectory", "vehicle", "verify", "export", "map", "mavlink"}},
      {"config", {}},
      {"plugin", {}},
      {"items", {}},
      {"conformance", without(without(without(kAllButApp, "mission"), "fly"), "mavlink")},
      {"mission", without(without(kAllButApp, "fly"), "mavlink")},
      {"study", {"geometry", "surface", "view", "export", "config", "plugin", "items"}},
      {"studio", without(without(kAllButApp, "fly"), "mavlink")},
      {"app", with(with(with(kAllButApp, "app"), "study"), "studio")},
  };
  return kRooms;
}

struct Kind {
  std::string name;  // as descriptors and lapwing_add_plugin say it
  std::string room;
};

// By folder of plugins/.
const std::map<std::string, Kind>& kinds() {
  static const std::map<std::string, Kind> kKinds{
      {"vehicle_models", {"vehicle_model", "problem"}},
      {"cost_terms", {"cost_term", "problem"}},
      {"constraints", {"constraint", "problem"}},
      {"trajectory_solvers", {"trajectory_solver", "solve"}},
      {"path_planners", {"path_planner", "path"}},
      {"maps", {"map", "map"}},
      {"shapes", {"shape", "shape"}},
      {"information", {"information", "view"}},
      {"tour_solvers", {"tour_solver", "view"}},
      {"utilities", {"utility", "explore"}},
      {"controllers", {"controller", "solve"}},
      {"exporters", {"exporter", "export"}},
      {"flight_logs", {"flight_log", "flight_log"}},
      {"executors", {"executor", "items"}},
  };
  return kKinds;
}

// Third-party headers: the folders, by prefix, and the extension that may include them.
struct Containment {
  const char* header;  // prefix of the included path
  const char* folder;  // "" for any
  bool sources_only;
};
constexpr Containment kContained[] = {
    {"lua", "framework/mission/", false},
    {"lauxlib.h", "framework/mission/", false},
    {"yaml-cpp/", "framework/config/", true},
    {"boost/math/", "framework/study/", true},
    {"boost/asio/", "framework/studio/", true},
    {"boost/beast/", "framework/studio/", true},
    {"CLI/", "framework/app/", false},
    {"embree", "framework/geometry/", true},
    {"assimp/", "framework/geometry/", false},
    {"tbb/", "framework/core/", false},
    {"oneapi/tbb", "framework/core/", false},
    {"spdlog/", "", true},
    {"nlohmann/", "", true},
    {"fmt/", "", true},
    {"GeographicLib/", "", true},
    {"png.h", "framework/core/", true},
    {"octomap/", "", true},
    {"ompl/", "", true},
    {"coin/", "", true},
    {"nlopt", "", true},
    {"opencv2/", "", true},
    {"CGAL/", "", true},
    {"nanoflann", "", true},
    {"oneapi/dnnl", "", true},
    {"torch/", "", true},
    {"expat.h", "", true},
    {"zstd.h", "", true},
    {"lz4frame.h", "", true},
    {"proj.h", "framework/survey/", true},
    {"gdal", "framework/survey/", true},
    {"cpl_", "framework/survey/", true},
    {"ogr_", "framework/survey/", true},
    {"citygml/", "framework/survey/", true},
    {"mpi.h", "plugins/executors/mpi/", true},
    {"libexif/", "framework/photogrammetry/", true},
};
// Of these, one source file of the framework alone.
constexpr const char* kSingleSource[] = {"GeographicLib/", "assimp/", "png.h",     "octomap/",
                                         "opencv2/",       "CGAL/",   "nanoflann", "torch/",
                                         "boost/math/",    "proj.h",  "gdal.h",    "citygml/"};

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

bool has_extension(const std::string& path, std::initializer_list<const char*> extensions) {
  return std::any_of(extensions.begin(), extensions.end(),
                     [&](const char* extension) { return path.ends_with(extension); });
}

std::string at(const SourceFile& file, std::size_t line) {
  return file.path + ":" + std::to_string(line) + ": ";
}

struct Include {
  std::size_t line;
  bool quoted;
  std::string path;
};

std::vector<Include> includes_of(const SourceFile& file) {
  static const std::regex kInclude(R"(^\s*#\s*include\s*(["<])([^">]+)[">].*)");
  std::vector<Include> found;
  if (!has_extension(file.path, {".h", ".cpp"})) return found;
  const std::vector<std::string> lines = split(file.text, '\n');
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::smatch match;
    if (std::regex_match(lines[i], match, kInclude)) {
      found.push_back({i + 1, match[1] == "\"", match[2]});
    }
  }
  return found;
}

// What a file of `room` may not do with an include of framework/`other`; empty if it may.
std::string room_violation(const std::string& room, const std::string& other) {
  if (!rooms().count(other)) return "'" + other + "' is not a room";
  if (other == room || other == "core" || rooms().at(room).count(other)) return "";
  return "room " + room + " may not include room " + other;
}

std::string framework_violation(const std::vector<std::string>& file,
                                const std::vector<std::string>& include) {
  if (file.size() < 3) return "";
  if (!rooms().count(file[1])) return "'" + file[1] + "' is not a room";
  if (include[0] == "plugins") return "the framework knows no plugin";
  if (include[0] != "framework" || include.size() < 3) return "not written from the root";
  return room_violation(file[1], include[1]);
}

std::string plugin_violation(const std::vector<std::string>& file,
                             const std::vector<std::string>& include) {
  if (file.size() < 4) return "";
  const auto kind = kinds().find(file[1]);
  if (kind == kinds().end()) return "'" + file[1] + "' is not a kind of plugin";
  if (include[0] == "plugins") {
    const bool own = include.size() > 3 && include[1] == file[1] && include[2] == file[2];
    return own ? "" : "a plugin may not include another plugin";
  }
  if (include[0] != "framework" || include.size() < 3) return "not written from the root";
  if (include[1] == "plugin") {
    return include[2] == "plugin.h" ? "" : "of room plugin, a plugin may include plugin.h only";
  }
  const std::string& room = kind->second.room;
  const std::string why = room_violation(room, include[1]);
  return why.empty() ? "" : "a " + kind->second.name + " may not: " + why;
}

std::string pascal_case(const std::string& name) {
  std::string result;
  for (std::string part : split(name, '_')) {
    if (part.empty()) continue;
    part[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(part[0])));
    result += part;
  }
  return result;
}

std::size_t columns(const std::string& line) {
  // Bytes that continue a UTF-8 character take no column.
  return static_cast<std::size_t>(
      std::count_if(line.begin(), line.end(), [](unsigned char c) { return (c & 0xc0) != 0x80; }));
}

}  // namespace

Violations check_includes(const SourceFile& file) {
  Violations found;
  const std::vector<std::string> path = split(file.path, '/');
  for (const Include& include : includes_of(file)) {
    const std::vector<std::string> parts = split(include.path, '/');
    std::string why;
    if (!include.quoted) {
      if (parts[0] == "framework" || parts[0] == "plugins") why = "own headers take quotes";
    } else if (path[0] == "framework") {
      why = framework_violation(path, parts);
    } else if (path[0] == "plugins") {
      why = plugin_violation(path, parts);
    } else if (parts[0] != "framework" && parts[0] != "plugins" && parts[0] != "tests") {
      why = "not written from the root";
    }
    if (!why.empty()) found.push_back(at(file, include.line) + include.path + ": " + why);
  }
  return found;
}

Violations check_third_party(const SourceFile& file) {
  Violations found;
  const bool shipped = file.path.starts_with("framework/") || file.path.starts_with("plugins/");
  if (!shipped) return found;
  for (const Include& include : includes_of(file)) {
    if (include.quoted && include.path.starts_with("framework/")) continue;
    for (const Containment& rule : kContained) {
      if (!include.path.starts_with(rule.header)) continue;
      if (!file.path.starts_with(rule.folder)) {
        found.push_back(at(file, include.line) + include.path + " belongs in " + rule.folder);
      }
      if (rule.sources_only && !file.path.ends_with(".cpp")) {
        found.push_back(at(file, include.line) + include.path + " belongs in a .cpp");
      }
    }
  }
  static const std::regex kOpen(R"(\bdlopen\s*\()");
  const bool opens =
      file.path.starts_with("framework/plugin/") || file.path == "framework/core/side_library.cpp";
  if (!opens && has_extension(file.path, {".h", ".cpp"}) && std::regex_search(file.text, kOpen)) {
    found.push_back(file.path +
                    ": dlopen belongs in framework/plugin/ and framework/core/side_library.cpp");
  }
  return found;
}

Violations check_licence(const SourceFile& file) {
  // The templates become sources of somebody else.
  if (file.path.starts_with("scripts/templates/")) return {};
  if (!has_extension(file.path, {".h", ".cpp", ".lua", ".sh", ".cmake"}) &&
      !file.path.ends_with("CMakeLists.txt")) {
    return {};
  }
  const std::string head = file.text.substr(0, file.text.find('\n', file.text.find('\n') + 1));
  if (head.find("SPDX-License-Identifier: Apache-2.0") != head.npos) return {};
  return {file.path + ": no 'SPDX-License-Identifier: Apache-2.0' in its first two lines"};
}

Violations check_style(const SourceFile& file) {
  static const Names kBanned{"util",    "utils",   "common",   "helper",
                             "helpers", "manager", "managers", "context"};
  static const std::regex kBannedType(
      R"(\b(?:class|struct|namespace)\s+\w*?(?:Util|Utils|Common|Helper|Helpers|Manager|Context|)"
      R"(utils|common|helpers?|context)\b)");
  static const std::regex kSnakeCase(R"([a-z][a-z0-9_]*)");
  // Written in two parts, or this line would break its own rule.
  static const std::regex kUnfinished(
      "\\b(TO"
      "DO|FIX"
      "ME|XX"
      "X)\\b");
  Violations found;
  const std::string name = file.path.substr(file.path.rfind('/') + 1);
  const std::string stem = name.substr(0, name.find('.'));
  for (const std::string& word : split(stem, '_')) {
    if (kBanned.count(word))
      found.push_back(file.path + ": a file named '" + word + "' says nothing");
  }
  const bool code = has_extension(name, {".h", ".cpp", ".lua"});
  if (code && !std::regex_match(stem, kSnakeCase)) {
    found.push_back(file.path + ": the name is not snake_case");
  }
  if (name.ends_with(".h") && file.text.find("#pragma once") == file.text.npos) {
    found.push_back(file.path + ": no #pragma once");
  }
  static const std::regex kTest(R"((^|\n)(TEST|TEST_F|TEST_P|TYPED_TEST)\()");
  if (name.ends_with(".cpp") && file.path.starts_with("tests/") &&
      std::regex_search(file.text, kTest) && !name.ends_with("_test.cpp")) {
    found.push_back(file.path + ": a source with tests is named WHAT_test.cpp");
  }
  const std::vector<std::string> lines = split(file.text, '\n');
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (code && columns(lines[i]) > 100) {
      found.push_back(at(file, i + 1) + "longer than 100 columns");
    }
    if (std::regex_search(lines[i], kUnfinished)) found.push_back(at(file, i + 1) + "unfinished");
    if (name.ends_with(".h") && lines[i].starts_with("using namespace")) {
      found.push_back(at(file, i + 1) + "a header opens a namespace for its readers");
    }
    std::smatch match;
    const bool shipped = has_extension(name, {".h", ".cpp"}) && !file.path.starts_with("tests/");
    if (shipped && std::regex_search(lines[i], match, kBannedType)) {
      found.push_back(at(file, i + 1) + "'" + match.str() + "' says nothing");
    }
  }
  const bool kind = file.path.starts_with("scripts/mission/") && name.ends_with(".lua");
  if (kind && lines.size() >= 250) {
    found.push_back(file.path + ": a mission kind has fewer than 250 lines, not " +
                    std::to_string(lines.size()));
  }
  return found;
}

namespace {

// The plugins that a library holds: those after FAMILY, or the one that bears its name.
std::vector<std::string> names_in(const std::string& cmake, const std::string& name) {
  static const std::regex kFamily(R"(\bFAMILY\s+([a-z0-9_\s]+))");
  std::smatch match;
  if (!std::regex_search(cmake, match, kFamily)) return {name};
  std::istringstream words(match[1]);
  std::vector<std::string> names;
  for (std::string word; words >> word;) names.push_back(word);
  return names;
}

// One plugin folder: its file, its CMake line, its kText, its class and its README.
void check_plugin(const std::string& folder, const std::map<std::string, std::string>& texts,
                  Violations& found) {
  const std::vector<std::string> parts = split(folder, '/');
  const std::string& name = parts[2];
  const auto text_of = [&](const std::string& file) -> std::string {
    const auto it = texts.find(folder + "/" + file);
    return it == texts.end() ? "" : it->second;
  };
  const auto require = [&](bool holds, const std::string& what) {
    if (!holds) found.push_back(folder + ": " + what);
  };
  const std::string source = text_of(name + ".cpp");
  require(!source.empty(), "no " + name + ".cpp");
  require(!text_of("README.md").empty(), "no README.md");
  const auto kind = kinds().find(parts[1]);
  if (kind == kinds().end()) {
    found.push_back(folder + ": '" + parts[1] + "' is not a kind of plugin");
    return;
  }
  const std::regex line("lapwing_add_plugin\\(\\s*" + kind->second.name + "\\s+" + name + "\\b");
  require(std::regex_search(text_of("CMakeLists.txt"), line),
          "CMakeLists.txt lacks lapwing_add_plugin(" + kind->second.name + " " + name + ")");
  const std::string code = text_of(name + ".h") + source;
  for (const std::string& one : names_in(text_of("CMakeLists.txt"), name)) {
    require(std::regex_search(code, std::regex("kText\\s*\\{\\s*\"" + one + "\"")),
            "no kText{\"" + one + "\"");
    // The kernel has classes Map, Mesh and Obstacle: the word of the kind may stand behind the
    // name.
    const std::string word = parts[1] == "shapes" ? "Form" : pascal_case(kind->second.name);
    const std::string type = pascal_case(one) + "(" + word + ")?";
    require(std::regex_search(code, std::regex("\\bclass\\s+" + type + "\\b")),
            "no class " + pascal_case(one));
    require(std::regex_search(code, std::regex("LAPWING_PLUGINS\\([^)]*\\b" + type + "\\b")),
            "no LAPWING_PLUGINS(" + pascal_case(one) + ")");
  }
}

}  // namespace

// Two classes of one name in one namespace, each complete in a header of its own: programs that
// link both are undefined, though every source compiles.
void check_classes(const std::vector<SourceFile>& files, Violations& found) {
  static const std::regex kSpace(R"(namespace ([\w:]+) \{.*)");
  static const std::regex kClass(R"((?:struct|class) (\w+)(?: final)?(?: :[^;]*)?(?: \{.*)?)");
  std::map<std::string, std::string> headers;  // by class
  for (const SourceFile& file : files) {
    if (!file.path.starts_with("framework/") || !file.path.ends_with(".h")) continue;
    std::string space;
    for (const std::string& line : split(file.text, '\n')) {
      std::smatch match;
      if (std::regex_match(line, match, kSpace)) space = match[1];
      if (!std::regex_match(line, match, kClass)) continue;
      const auto [first, is_new] = headers.emplace(space + "::" + match[1].str(), file.path);
      if (!is_new && first->second != file.path)
        found.push_back(first->first + " is declared by " + first->second + " and by " + file.path);
    }
  }
}

Violations check_tree(const std::vector<SourceFile>& files) {
  Violations found;
  check_classes(files, found);
  std::map<std::string, std::string> texts;
  Names plugin_folders;
  std::map<std::string, Names> users;  // of single-source headers
  for (const SourceFile& file : files) {
    texts[file.path] = file.text;
    const std::vector<std::string> parts = split(file.path, '/');
    if (parts[0] == "plugins" && parts.size() > 3) {
      plugin_folders.insert(parts[0] + "/" + parts[1] + "/" + parts[2]);
    }
    if (parts[0] != "framework") continue;
    for (const Include& include : includes_of(file)) {
      for (const char* header : kSingleSource) {
        if (include.path.starts_with(header)) users[header].insert(file.path);
      }
    }
  }
  for (const std::string& folder : plugin_folders) check_plugin(folder, texts, found);
  for (const auto& [header, paths] : users) {
    if (paths.size() < 2) continue;
    std::string message = header + " is included by more than one source:";
    for (const std::string& path : paths) message += " " + path;
    found.push_back(message);
  }
  return found;
}

Violations check_map(const SourceFile& map, const std::vector<std::string>& existing) {
  static const std::regex kRow(R"(\| `(\w+)` \|[^|]*\| ([^|]*) \|)");
  Violations found;
  const Names there(existing.begin(), existing.end());
  Names listed;
  const std::vector<std::string> lines = split(map.text, '\n');
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::smatch match;
    if (!std::regex_match(lines[i], match, kRow) || !rooms().count(match[1])) continue;
    listed.insert(match[1]);
    Names allowed;
    for (const std::string& room : rooms().at(match[1])) {
      if (there.count(room)) allowed.insert(room);
    }
    Names stated;
    for (std::string room : split(match[2], ',')) {
      room.erase(0, room.find_first_not_of(' '));
      if (rooms().count(room)) stated.insert(room);
    }
    // "every room but app" is prose; only lists are compared.
    const bool is_list = match[2] == "\u2013" || !stated.empty();
    if (is_list && stated != allowed) {
      found.push_back(at(map, i + 1) + "what room " + match[1].str() + " may include is not so");
    }
  }
  for (const std::string& room : existing) {
    if (!listed.count(room)) found.push_back(map.path + ": room " + room + " is not listed");
  }
  return found;
}

std::vector<SourceFile> read_tree(const fs::path& root) {
  std::vector<SourceFile> files;
  for (const char* top : {"framework", "plugins", "scripts", "configs", "tests", "examples"}) {
    if (!fs::is_directory(root / top)) continue;
    for (auto at = fs::recursive_directory_iterator(root / top); at != fs::end(at); ++at) {
      const fs::directory_entry& item = *at;
      const std::string path = item.path().lexically_relative(root).generic_string();
      if (path.ends_with("/node_modules") || path.ends_with("/page/dist")) {  // of npm
        at.disable_recursion_pending();
        continue;
      }
      const bool text = has_extension(
          path, {".h", ".cpp", ".lua", ".md", ".txt", ".cmake", ".sh", ".yaml", ".py"});
      if (item.is_regular_file() && text) files.push_back({path, read_file(item.path())});
    }
  }
  return files;
}

}  // namespace lapwing::architecture
