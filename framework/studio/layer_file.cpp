// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/layer_file.h"

#include "framework/config/annotated.h"
#include "framework/config/yaml.h"
#include "framework/core/checksum.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/studio/patch.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSum = "# sha256 of what follows: ";

void add_lists(const Value& layer, const Value& script, const std::string& path,
               std::string& text) {
  for (const auto& [key, value] : layer.as_map()) {
    const Value* own = script.find(key);
    const std::string here = (path.empty() ? "" : path + ".") + key;
    if (value.is_map() && own && own->is_map()) add_lists(value, *own, here, text);
    if (!value.is_list()) continue;
    text += "# " + here + " stands in place of the script's, sha256 " +
            (own ? sha256(to_json(*own, -1)) : std::string("none")) + "\n";
  }
}

}  // namespace

fs::path beside_script(const fs::path& script, const char* ending) {
  return script.parent_path() / (script.stem().string() + ending);
}

std::string layer_text(const fs::path& script, std::uint64_t revision, const Value& layer,
                       const Value& script_options) {
  const std::string name = beside_script(script, ".studio.yaml").filename().string();
  std::string rest;
  add_lists(layer, script_options, "", rest);
  rest += annotated_yaml(without_origins(layer));
  return "# Edits by lapwing studio: lapwing run " + script.filename().string() + " --config " +
         name + "\n# revision " + std::to_string(revision) + "\n" + kSum + sha256(rest) + "\n" +
         rest;
}

void write_layer(const fs::path& script, std::uint64_t revision, const Value& layer,
                 const Value& script_options) {
  const fs::path file = beside_script(script, ".studio.yaml");
  if (!layer.as_map().empty())
    return write_file_atomically(file, layer_text(script, revision, layer, script_options));
  std::error_code code;
  fs::remove(file, code);
  if (code) throw InputError("cannot remove '" + file.string() + "': " + code.message());
}

std::optional<LayerFile> read_layer(const fs::path& script) {
  const fs::path file = beside_script(script, ".studio.yaml");
  std::error_code code;
  if (!fs::exists(file, code)) return std::nullopt;
  const std::string text = read_file(file, kMaximumYamlBytes);
  LayerFile read;
  read.layer = from_yaml(text, file.string());
  if (!read.layer.is_map())
    throw InputError("'" + file.string() + "': expected options, got " +
                     read.layer.describe_type());
  const std::size_t sum = text.find(kSum);
  if (sum != text.npos) {
    const std::size_t begin = sum + std::string(kSum).size(), end = text.find('\n', begin);
    read.as_written =
        end != text.npos && text.substr(begin, end - begin) == sha256(text.substr(end + 1));
  }
  return read;
}

}  // namespace lapwing
