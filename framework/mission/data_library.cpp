// SPDX-License-Identifier: Apache-2.0
// What scripts read from data files, and errors that name the line of the file.
#include <algorithm>

#include <lua.hpp>

#include "framework/config/yaml.h"
#include "framework/mission/guard.h"
#include "framework/mission/lua_value.h"
#include "framework/mission/run.h"
#include "framework/mission/value_path.h"

namespace lapwing {
namespace {

// A file that was read, whose values know their lines; Lua's tables do not.
struct DataFile {
  Value content;
};

// Arguments of the three functions below: a file's name, and a sub-folder that is asked as well.
struct DataName {
  std::string name, folder;
  std::size_t bytes = 0;  // of the file
};

DataName data_argument(lua_State* state, const char* function) {
  DataName data{text_argument(state, 1, function), "", 0};
  if (!lua_isnoneornil(state, 2)) data.folder = text_argument(state, 2, function);
  std::error_code error;
  const auto size =
      std::filesystem::file_size(run_of(state).files.find(data.name, data.folder), error);
  if (!error) data.bytes = size;
  return data;
}

// A file's text, then its values beside it, then the tables made of them, which take less than half
// as much as the values.
void claim_data(lua_State* state, const DataName& data, std::size_t values) {
  Sandbox::of(state).claim(state, data.bytes + values + values / 2);
}

int push_file(lua_State* state, Value content) {
  push_value(state, content);
  new_object(state, kDataFileType, DataFile{std::move(content)});
  return 2;
}

// lapwing.read_json(name [, folder]): a table from a JSON file below the script's folder, the data
// folders or the shipped ones, and the file; `folder` is a sub-folder of these that is asked as
// well.
int read_json(lua_State* state) {
  const DataName data = data_argument(state, "lapwing.read_json");
  claim_data(state, data, 0);
  const HoldValues hold = [&](std::size_t bytes) { claim_data(state, data, bytes); };
  return push_file(state, run_of(state).files.read_json(data.name, data.folder, hold));
}

// lapwing.read_yaml(name [, folder]): the same from a YAML file.
int read_yaml_data(lua_State* state) {
  const DataName data = data_argument(state, "lapwing.read_yaml");
  claim_data(state, data, 0);
  return push_file(state,
                   from_yaml(run_of(state).files.read_text(data.name, data.folder), data.name));
}

// lapwing.read_text(name [, folder]): the text of a file, found as read_json finds it.
int read_text(lua_State* state) {
  const DataName data = data_argument(state, "lapwing.read_text");
  claim_data(state, data, data.bytes);
  push_text(state, run_of(state).files.read_text(data.name, data.folder));
  return 1;
}

const Value& content_of(lua_State* state) {
  return object_argument<DataFile>(state, 1, kDataFileType).content;
}

// Where the last key of the path is not there, but one that is written nearly so.
std::string slip_near(const Value& content, const std::string& path) {
  constexpr std::size_t kShortest = 3;  // of a key: any two letters are near each other
  const std::size_t mark = path.find_last_of('.');
  const std::string key = mark == path.npos ? path : path.substr(mark + 1);
  const Value* around = at_path(content, mark == path.npos ? "" : path.substr(0, mark));
  if (key.size() < kShortest || key.back() == ']') return "";
  if (!around || !around->is_map() || around->find(key)) return "";
  std::vector<std::string> written;
  for (const auto& [name, value] : around->as_map()) written.push_back(name);
  const std::string nearest = nearest_name(key, written);
  if (nearest.empty()) return "";
  return "; did you mean '" + key + "' by '" + nearest + "' on line " +
         std::to_string(around->find(nearest)->origin().line) + "?";
}

// file:fail("gates[2].radius", "message"): an error on that line of the file.
int fail_in_file(lua_State* state) {
  const Value& content = content_of(state);
  const std::string path = text_argument(state, 2, "fail");
  const std::string message = text_argument(state, 3, "fail");
  throw InputError(innermost_at(content, path).origin(),
                   (path.empty() ? "" : path + ": ") + message + slip_near(content, path));
}

// file:check("gates[2]", declarations): the table there, checked like options, with defaults.
int check_part(lua_State* state) {
  const Value& content = content_of(state);
  const std::string path = text_argument(state, 2, "check");
  const Origin origin = Sandbox::of(state).script_position(state);
  const ParameterTable table =
      ParameterTable::from_value(value_from_lua(state, 3, origin, "declarations"));
  const Value* part = at_path(content, path);
  if (!part)
    throw InputError(innermost_at(content, path).origin(),
                     path + ": missing; expected a table" + slip_near(content, path));
  push_value(state, check(table, *part, path).value());
  return 1;
}

struct WrongKey {
  Origin origin;
  std::string path, message;
};

// The keys of the table at `path` that are not `known`; with `slips` those alone that are nearly
// one of these.
void other_keys(const Value& content, const std::string& path, const Value& names, bool slips,
                std::vector<WrongKey>& errors) {
  std::vector<std::string> known;
  std::string all;
  for (const Value& name : names.as_list()) {
    known.push_back(name.as_text());
    all += (all.empty() ? "" : ", ") + known.back();
  }
  const Value& part = innermost_at(content, path);
  if (!part.is_map())
    throw InputError(part.origin(), (path.empty() ? "" : path + ": ") +
                                        "expected a table with the keys " + all + ", got " +
                                        part.describe_type());
  for (const auto& [key, value] : part.as_map()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    const std::string nearest = nearest_name(key, known);
    if (slips && nearest.empty()) continue;
    errors.push_back({value.origin(), path.empty() ? key : path + "." + key,
                      nearest.empty() ? "unknown key; known: " + all
                                      : "unknown key; did you mean '" + nearest + "'?"});
  }
}

// file:expect_keys("gates[2]", {"name", "shape"} [, slips]): an error for any other key of the
// table there; with `slips` for those alone that are nearly one of these. In place of the path a
// map from paths to their keys: one error for the wrong keys of all these tables, by line.
int expect_keys(lua_State* state) {
  const Value& content = content_of(state);
  const Origin origin = Sandbox::of(state).script_position(state);
  std::vector<WrongKey> found;
  if (lua_istable(state, 2)) {
    const Value paths = value_from_lua(state, 2, origin, "expect_keys");
    for (const auto& [path, names] : paths.as_map()) other_keys(content, path, names, false, found);
    std::stable_sort(found.begin(), found.end(), [](const WrongKey& a, const WrongKey& b) {
      return a.origin.line < b.origin.line;
    });
  } else {
    const std::string path = text_argument(state, 2, "expect_keys");
    other_keys(content, path, value_from_lua(state, 3, origin, "expect_keys"),
               lua_toboolean(state, 4), found);
  }
  Diagnostics errors;
  for (const WrongKey& one : found) errors.add(one.origin, one.path, one.message);
  errors.throw_if_any();
  return 0;
}

}  // namespace

void open_data_library(lua_State* state) {
  static const Binding methods[] = {
      {"fail", &guarded<fail_in_file>, "(path: string, message: string)",
       "raises an error on the line of the value at `path`, as \"gates[2].radius\""},
      {"check", &guarded<check_part>, "(path: string, declarations: lapwing.option[]): table",
       "the table at `path`, checked like options, with defaults"},
      {"expect_keys", &guarded<expect_keys>,
       "(path: string|table<string, string[]>, known?: string[], slips?: boolean)",
       "raises an error for every key of the table at `path` that is not in `known`; with `slips`, "
       "only for keys that resemble a known one. `path` may be a map from paths to lists of keys: "
       "one error then reports the wrong keys of all these tables"}};
  static const Binding functions[] = {
      {"read_json", &guarded<read_json>, "(name: string, folder?: string): any, lapwing.data_file",
       "a table from a JSON file, and an object for errors in it; the file is in the folder of the "
       "script, a --data folder or configs/"},
      {"read_yaml", &guarded<read_yaml_data>,
       "(name: string, folder?: string): any, lapwing.data_file", "as read_json, from a YAML file"},
      {"read_text", &guarded<read_text>, "(name: string, folder?: string): string",
       "the text of a file"}};
  define_type<DataFile>(state, kDataFileType, {methods});
  lua_getglobal(state, "lapwing");
  bind_functions(state, "lapwing", functions);
  lua_pop(state, 1);
}

}  // namespace lapwing
