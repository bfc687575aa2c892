// SPDX-License-Identifier: Apache-2.0
#include "framework/app/descriptions.h"
#include "framework/app/output_target.h"

#include <cstdio>

#include "framework/config/shipped.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/mission/script_interface.h"

namespace lapwing {

namespace {

ScriptInterface interface_of_scripts() {
  MissionSettings settings;
  settings.scripts = shipped_folder("scripts");
  settings.configs = shipped_folder("configs");
  return read_script_interface(settings);
}

ExitStatus write_description(const std::filesystem::path& target, const std::string& text) {
  if (target.empty()) {
    std::printf("%s", text.c_str());
  } else {
    require_output(target);
    write_file_atomically(target, text);
  }
  return ExitStatus::done;
}

std::string joined_with_commas(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts)
    if (!part.empty()) text += (text.empty() ? "" : ", ") + part;
  return text;
}

std::string default_cell(const ParameterSpec& spec) {
  if (spec.required) return "required";
  const Value& value = spec.default_value;
  const bool nothing = value.is_null() || spec.table || value == Value("") ||
                       (value.is_list() && value.as_list().empty());
  if (nothing) return "–";
  if (value.is_text()) return "`" + value.as_text() + "`";
  if (value.is_list()) {
    std::vector<std::string> numbers;
    for (const Value& entry : value.as_list()) numbers.push_back(to_json(entry, -1));
    return joined_with_commas(numbers);
  }
  return to_json(value, -1);
}

std::string meaning_cell(const ParameterSpec& spec) {
  std::vector<std::string> more;
  if (spec.type == ParameterType::choice) {
    std::string choices;
    for (const std::string& choice : spec.choices)
      choices += (choices.empty() ? "`" : ", `") + choice + "`";
    more.push_back(choices);
  } else if (spec.type != ParameterType::text && spec.type != ParameterType::table) {
    more.push_back(spec.type == ParameterType::number ? "" : spec.type_name());
  }
  more.push_back(spec.unit);
  more.push_back(spec.range.to_string());
  const std::string rest = joined_with_commas(more);
  if (rest.empty()) return spec.summary;
  return spec.summary.empty() ? rest : spec.summary + " (" + rest + ")";
}

void add_parameter_rows(const ParameterTable& table, const std::string& prefix, std::string& text) {
  for (const ParameterSpec& spec : table.specs()) {
    text += "| `" + prefix + spec.name + "` | " + default_cell(spec) + " | " + meaning_cell(spec) +
            " |\n";
    if (spec.table)
      add_parameter_rows(*spec.table,
                         prefix + spec.name + (spec.type == ParameterType::tables ? "[]." : "."),
                         text);
  }
}

}  // namespace

std::string parameters_as_markdown(const PluginEntry& entry) {
  if (entry.parameters.specs().empty()) return "No parameters.\n";
  std::string text = "| parameter | default | |\n|---|---|---|\n";
  add_parameter_rows(entry.parameters, "", text);
  return text;
}

ExitStatus write_annotations(const Description& asked, const Invocation& invocation) {
  const ScriptInterface interface = interface_of_scripts();
  return write_description(asked.target, asked.markdown
                                             ? call_table_of(interface)
                                             : annotations_of(interface, invocation.registry()));
}

ExitStatus write_schema(const Description& asked, const Invocation& invocation) {
  return write_description(
      asked.target,
      to_json(config_schema(interface_of_scripts(), invocation.registry(), asked.kind)) + "\n");
}

}  // namespace lapwing
