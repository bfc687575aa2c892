// SPDX-License-Identifier: Apache-2.0
// What a plugin says of itself, and what it makes of rubbish.
#include <algorithm>
#include <cmath>

#include "framework/conformance/findings.h"
#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/export/exporter.h"
#include "framework/flight_log/flight_log_reader.h"
#include "framework/items/executor.h"
#include "framework/plugin/sidecar.h"
#include "framework/problem/invariance.h"
#include "framework/shape/shape.h"
#include "framework/vehicle/controller.h"

namespace lapwing {
namespace {

// Creates a plugin of any kind that the kernel knows, and deletes it.
void create_and_drop(const Registry& registry, const PluginEntry& entry, const Value& given) {
  const auto made = [&]<class Kind>(const Kind*) {
    if (entry.kind == Kind::kKind) registry.create<Kind>(entry.name, given);
  };
  made(static_cast<const CostTerm*>(nullptr));
  made(static_cast<const Constraint*>(nullptr));
  made(static_cast<const VehicleModel*>(nullptr));
  made(static_cast<const TrajectorySolver*>(nullptr));
  made(static_cast<const PathPlanner*>(nullptr));
  made(static_cast<const TourSolver*>(nullptr));
  made(static_cast<const Map*>(nullptr));
  made(static_cast<const ViewInformation*>(nullptr));
  made(static_cast<const ViewUtility*>(nullptr));
  made(static_cast<const Exporter*>(nullptr));
  made(static_cast<const FlightLogReader*>(nullptr));
  made(static_cast<const Executor*>(nullptr));
  made(static_cast<const Shape*>(nullptr));
  made(static_cast<const Controller*>(nullptr));
}

bool is_snake_case(const std::string& name) {
  const auto fits = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  };
  return !name.empty() && name[0] >= 'a' && name[0] <= 'z' &&
         std::all_of(name.begin(), name.end(), fits);
}

// Words that are checked must be spelled as they are known, on plugins of the kind they speak of.
bool may_declare(const std::string& kind, const std::string& id) {
  const bool term = kind == CostTerm::kKind || kind == Constraint::kKind;
  if (id == kMonotone || id == kSubmodular) return kind == ViewUtility::kKind;
  if (!id.starts_with("invariant")) return true;
  return term && (id == kInvariantToTranslation || id == kInvariantToRotationAboutZ ||
                  id == kInvariantToTime);
}

bool is_version(const std::string& version) {
  int dots = 0, digits = 0;
  for (const char c : version) {
    if (c == '.' && digits > 0) {
      ++dots;
      digits = 0;
    } else if (c >= '0' && c <= '9') {
      ++digits;
    } else {
      return false;
    }
  }
  return dots == 2 && digits > 0;
}

void check_spec(const ParameterSpec& spec, const std::string& path, Findings& findings) {
  const auto need = [&](bool ok, const std::string& message) {
    findings.expect("description", ok, [&] { return "parameter '" + path + "' " + message; });
  };
  need(is_snake_case(spec.name), "has a name that is not snake_case");
  need(!spec.summary.empty() || spec.table, "has no summary");
  need(spec.range.minimum <= spec.range.maximum, "has a range in which nothing lies");
  const Value& given = spec.default_value;
  if (given.is_number())
    need(spec.range.contains(given.as_number()), "has a default outside of its own range");
  if (spec.type == ParameterType::choice && given.is_text())
    need(std::find(spec.choices.begin(), spec.choices.end(), given.as_text()) != spec.choices.end(),
         "has a default that is not one of its choices");
  need(!spec.required || given.is_null(), "is required and has a default");
  if (!spec.table) return;
  for (const ParameterSpec& inner : spec.table->specs())
    check_spec(inner, path + "." + inner.name, findings);
}

// Values that a parameter must not take.
std::vector<Value> rubbish_for(const ParameterSpec& spec) {
  std::vector<Value> rubbish;
  if (spec.type != ParameterType::text) rubbish.emplace_back("rubbish");
  if (spec.type != ParameterType::boolean) rubbish.emplace_back(true);
  if (spec.type != ParameterType::number && spec.type != ParameterType::integer)
    rubbish.emplace_back(12.5);
  if (spec.type == ParameterType::number) {
    rubbish.emplace_back(std::nan(""));
    if (std::isfinite(spec.range.maximum))
      rubbish.emplace_back(spec.range.maximum + std::abs(spec.range.maximum) + 1);
    if (std::isfinite(spec.range.minimum))
      rubbish.emplace_back(spec.range.minimum - std::abs(spec.range.minimum) - 1);
  }
  return rubbish;
}

}  // namespace

std::vector<CheckResult> check_description(const PluginEntry& entry) {
  Findings findings;
  const auto need = [&](bool ok, const std::string& message) {
    findings.expect("description", ok, [&] { return message; });
  };
  need(is_snake_case(entry.name), "the name '" + entry.name + "' is not snake_case");
  need(is_version(entry.version), "the version '" + entry.version + "' is not like 1.0.0");
  need(!entry.summary.empty() && entry.summary.find('\n') == std::string::npos,
       "the summary is not one line");
  for (const std::string& id : entry.extensions)
    need(may_declare(entry.kind, id), "a " + entry.kind + " cannot declare '" + id + "'");
  for (const ParameterSpec& spec : entry.parameters.specs()) check_spec(spec, spec.name, findings);
  return std::move(findings).results();
}

std::vector<CheckResult> check_sidecar(const PluginEntry& entry) {
  Findings findings;
  const auto text_of = [](const Value& value) { return to_json(value, -1); };
  try {
    const std::filesystem::path file =
        std::filesystem::path(entry.library).replace_extension(".json");
    const Value library = describe_as_value(entry.library);
    const Value sidecar = from_json(read_file(file), file.string());
    findings.expect("sidecar", text_of(library) == text_of(sidecar), [&] {
      return "'" + file.string() + "' says another thing than the library: build it anew";
    });
    const std::vector<PluginEntry> entries = entries_from_sidecar(library, file);
    const auto same = std::find_if(entries.begin(), entries.end(), [&](const PluginEntry& other) {
      return other.kind == entry.kind && other.name == entry.name;
    });
    findings.expect("sidecar", same != entries.end(),
                    [&] { return "the library holds no " + entry.kind + " '" + entry.name + "'"; });
  } catch (const std::exception& error) {
    findings.fail("sidecar", error.what());
  }
  return std::move(findings).results();
}

std::vector<CheckResult> check_rubbish(const Registry& registry, const PluginEntry& entry) {
  Findings findings;
  // Whether it was taken; anything but an InputError fails.
  const auto taken = [&](const std::string& name, const Value& value) {
    Value given = Value::map();
    given.set(name, value);
    try {
      create_and_drop(registry, entry, given);
      findings.expect("rubbish", true, {});
      return true;
    } catch (const InputError&) {
      findings.expect("rubbish", true, {});
    } catch (const std::exception& error) {
      findings.fail("rubbish", "with a strange '" + name + "' it throws: " + error.what());
    }
    return false;
  };
  const auto refused = [&](const std::string& name, const Value& value) {
    const bool accepted = taken(name, value);
    findings.expect("rubbish", !accepted,
                    [&] { return "it takes a wrong '" + name + "' without a word"; });
  };
  refused("no_such_parameter", Value(1.0));
  for (const ParameterSpec& spec : entry.parameters.specs()) {
    for (const Value& value : rubbish_for(spec)) refused(spec.name, value);
    if (spec.type == ParameterType::text)
      for (const char* text : {"", "no such thing", "../../\n%s"}) taken(spec.name, Value(text));
    if (spec.type == ParameterType::numbers)
      for (const int count : {0, 1, 1000})
        taken(spec.name, Value(Value::List(count, Value(1e300))));
    if (spec.type == ParameterType::tables) taken(spec.name, Value::list());
  }
  return std::move(findings).results();
}

}  // namespace lapwing
