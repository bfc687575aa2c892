// SPDX-License-Identifier: Apache-2.0
// A document as a script of its own.
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdio>

#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/studio/patch.h"
#include "framework/studio/worker_errands.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMark = "-- Written by lapwing studio from ";

bool is_lua_name(const std::string& key) {
  static const std::vector<std::string> kWords{
      "and",      "break",  "do",   "else", "elseif", "end",  "false", "for",
      "function", "goto",   "if",   "in",   "local",  "nil",  "not",   "or",
      "repeat",   "return", "then", "true", "until",  "while"};
  if (key.empty() || std::isdigit(static_cast<unsigned char>(key[0]))) return false;
  for (const char c : key)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_') return false;
  return std::find(kWords.begin(), kWords.end(), key) == kWords.end();
}

// Bytes that are no plain ASCII stay as they are but for what would end the text.
std::string lua_text(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    char escape[8];
    if (c == '"' || c == '\\') {
      quoted += '\\';
      quoted += c;
    } else if (byte < 0x20 || byte == 0x7f) {
      std::snprintf(escape, sizeof escape, "\\%03d", byte);
      quoted += escape;
    } else {
      quoted += c;
    }
  }
  return quoted + "\"";
}

bool has_tables(const Value& value) {
  if (value.is_map()) return true;
  if (!value.is_list()) return false;
  return std::any_of(value.as_list().begin(), value.as_list().end(), has_tables);
}

std::string lua_value(const Value& value, const std::string& indent) {
  if (value.is_text()) return lua_text(value.as_text());
  if (value.is_null()) return "nil";
  if (!value.is_map() && !value.is_list()) return to_json(value, -1);
  const bool inner = value.is_list() && has_tables(value);  // an entry a line
  const std::string deeper = indent + "  ";
  std::string text = "{";
  const auto add = [&](const std::string& entry) {
    text += text.size() > 1 ? "," : "";
    text += inner ? "\n" + deeper + entry : " " + entry;
  };
  if (value.is_map())
    for (const auto& [key, child] : value.as_map())
      add((is_lua_name(key) ? key : "[" + lua_text(key) + "]") + " = " + lua_value(child, deeper));
  else
    for (const Value& child : value.as_list()) add(lua_value(child, deeper));
  if (text.size() == 1) return "{}";
  return text + (inner ? "\n" + indent + "}" : " }");
}

// The script of these options of a film; `mark` names where it comes from.
std::string script_text(const std::string& name, const std::string& mark, const Value& options) {
  const bool of_file = options.find("input") != nullptr;
  std::string text = "-- SPDX-License-Identifier: Apache-2.0\n" + mark +
                     "\nlocal film = require \"mission.film\"\n\nreturn film." +
                     (of_file ? "from_file" : "shot") + " {\n  name = " + lua_text(name) + ",\n";
  for (const auto& [key, value] : options.as_map())
    text += "  " + (is_lua_name(key) ? key : "[" + lua_text(key) + "]") + " = " +
            lua_value(value, "  ") + ",\n";
  return text + "}\n";
}

// Beside the script, so that it may read the same files; gone when this is.
class TriedScript {
 public:
  TriedScript(const fs::path& beside, const std::string& text)
      : file_(beside.parent_path() /
              ("." + beside.stem().string() + "." + std::to_string(::getpid()) + ".lua")) {
    write_file_atomically(file_, text);
  }
  ~TriedScript() {
    std::error_code code;
    fs::remove(file_, code);
  }
  const fs::path& file() const { return file_; }

 private:
  fs::path file_;
};

Value options_of(const fs::path& beside, const MissionSettings& settings, const std::string& text) {
  const TriedScript script(beside, text);
  return configured_mission(script.file(), settings, Value::map())->configuration();
}

void require_no_functions(const Value& options) {
  for (const char* key : {"costs", "constraints"}) {
    const Value* list = options.find(key);
    if (!list || !list->is_list()) continue;
    for (std::size_t i = 0; i < list->as_list().size(); ++i)
      if (!list->as_list()[i].find("type"))
        throw InputError(std::string(key) + "[" + std::to_string(i + 1) +
                         "] is a function of the script, and cannot be written out: keep the "
                         "script with its layer");
  }
}

void require_own(const fs::path& target) {
  std::error_code code;
  if (!fs::exists(target, code)) return;
  if (read_file(target).find(kMark) == std::string::npos)
    throw InputError("'" + target.string() +
                     "' is there already, and no studio wrote it; move it away");
}

}  // namespace

void write_flat_script(const fs::path& script, const MissionSettings& settings,
                       const Mission& mission, const fs::path& target) {
  if (mission.kind() != "film")
    throw InputError("a mission of kind '" + mission.kind() + "' cannot be written as a film");
  require_own(target);
  const Value& whole = mission.configuration();
  require_no_functions(whole);
  const std::string mark = kMark + script.filename().string();
  // What has a default and keeps it is left out.
  Value least = Value::map();
  for (const char* key : {"input", "keyframes"})
    if (const Value* value = whole.find(key)) least.set(key, *value);
  const Value defaults = options_of(target, settings, script_text(mission.name(), mark, least));
  Value options = least;
  const Value layer = layer_of(defaults, whole);
  for (const auto& [key, value] : layer.as_map()) options.set(key, value);
  const std::string text = script_text(mission.name(), mark, options);
  if (!same_options(options_of(target, settings, text), whole))
    throw InputError("the options cannot be written as a script that comes to the same ones");
  write_file_atomically(target, text);
}

}  // namespace lapwing
