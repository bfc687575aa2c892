// SPDX-License-Identifier: Apache-2.0
// Tables of READMEs from the declarations of mission kinds: their options, and the arguments of the
// functions that they describe.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "framework/core/json.h"
#include "framework/mission/declared_entry.h"
#include "framework/mission/script_interface.h"

namespace lapwing {

namespace {

// A part of the text in brackets behind a summary, or of a list.
void append_part(std::string& text, const std::string& part, const char* between = ", ") {
  if (part.empty()) return;
  if (!text.empty()) text += between;
  text += part;
}

std::string in_code(const std::string& text) {
  return "`" + text + "`";
}

std::string alternatives_in_code(const Value& list) {
  std::string text;
  for (const Value& choice : list.as_list()) append_part(text, in_code(choice.as_text()));
  return text;
}

// 12, 0.5, 1e-7, 1e6: shorter than JSON has them.
std::string number_in_table(double number) {
  if (number == 9007199254740991.0) return "2^53 - 1";  // the largest integer of a seed
  char text[40];
  const bool round = std::abs(number) >= 1e5 && std::fmod(number, 1e5) == 0;
  std::snprintf(text, sizeof text, round ? "%.0e" : "%.15g", number);
  if (round && std::strtod(text, nullptr) != number)
    std::snprintf(text, sizeof text, "%.15g", number);
  std::string result = text;
  for (const char* exponent : {"e+0", "e+", "e-0"})  // 1e+06 is 1e6
    if (const std::size_t at = result.find(exponent); at != std::string::npos)
      result.replace(at, std::string(exponent).size(), exponent[1] == '-' ? "e-" : "e");
  return result;
}

std::string range_in_table(const Range& range) {
  const bool low = std::isfinite(range.minimum), high = std::isfinite(range.maximum);
  const std::string least = number_in_table(range.minimum), most = number_in_table(range.maximum);
  if (low && high && !range.minimum_excluded) return "between " + least + " and " + most;
  std::string text = !low ? "" : (range.minimum_excluded ? "above " : "at least ") + least;
  append_part(text, high ? "at most " + most : "", " and ");
  return text;
}

std::string declared_default(const Value& entry) {
  if (declared_required(entry)) return "required";
  const Value* fallback = entry.find("default");
  if (!fallback || fallback->is_null() || *fallback == Value("")) return "–";
  if (fallback->is_text()) return in_code(fallback->as_text());
  std::string text;
  if (fallback->is_list()) {
    for (const Value& number : fallback->as_list())
      append_part(text, number_in_table(number.as_number()));
    text = "{" + text + "}";
  } else {
    text = fallback->type() == Value::Type::boolean ? to_json(*fallback, -1)
                                                    : number_in_table(fallback->as_number());
  }
  append_part(text, declared_text(entry, "unit"), " ");
  return text;
}

// What a value may be, in words; empty for a number, a text and a boolean, whose default shows it.
std::string declared_form(const Value& entry) {
  const std::string type = declared_text(entry, "type"), kind = declared_text(entry, "kind");
  if (type == "choice") return alternatives_in_code(entry.at("choices"));
  if (type == "integer") return "integer";
  if (type == "vehicle") return "name of a vehicle file, or a table";
  if (type == "plugin") return in_code(kind) + ": name, or table with parameters";
  if (type == "plugins") return "list; a " + in_code(kind) + " each";
  if (type == "table") return "table";
  if (type == "tables") return "list of tables";
  if (type != "numbers") return "";
  const Value* size = entry.find("size");
  if (!size || size->as_integer() == 0) return "list of numbers";
  return std::to_string(size->as_integer()) + " numbers";
}

std::string declared_meaning(const Value& entry) {
  std::string details = declared_form(entry);
  append_part(details, declared_text(entry, "unit"));
  append_part(details, range_in_table(declared_range(entry)));
  if (const Value* words = entry.find("words"))
    append_part(details, alternatives_in_code(*words), " or ");
  if (const std::string other = declared_text(entry, "replaced_by"); !other.empty())
    append_part(details, in_code(other) + " replaces it");
  const std::string summary = declared_text(entry, "summary");
  if (details.empty()) return summary;
  return summary + (summary.empty() ? "(" : " (") + details + ")";
}

struct OptionRow {
  std::string option, fallback, meaning;
  bool operator==(const OptionRow&) const = default;
};

// The rows of an option: its own, then those of the entries in it, with dotted names.
void add_option_rows(const Value& entry, const std::string& prefix, std::vector<OptionRow>& rows) {
  const std::string name = prefix + declared_text(entry, "name");
  rows.push_back({name, declared_default(entry), declared_meaning(entry)});
  const std::string type = declared_text(entry, "type");
  const std::string inner = name + (type == "tables" || type == "plugins" ? "[]." : ".");
  for (const char* list : {"table", "functions"})
    if (const Value* entries = entry.find(list))
      for (const Value& one : entries->as_list()) add_option_rows(one, inner, rows);
}

// An option as one or more functions of a kind declare it.
struct SharedOption {
  std::vector<OptionRow> rows;
  std::vector<std::string> functions;
};

}  // namespace

std::string option_table_of(const ScriptInterface& interface, const std::string& kind) {
  std::vector<const MissionFunction*> functions;
  for (const MissionFunction& mission : interface.missions)
    if (mission.kind == kind) functions.push_back(&mission);
  // The function with the most options gives the order.
  std::stable_sort(functions.begin(), functions.end(), [](const auto* a, const auto* b) {
    return a->declarations.as_list().size() > b->declarations.as_list().size();
  });
  std::vector<SharedOption> options;
  for (const MissionFunction* mission : functions) {
    auto place = options.begin();  // behind the option that this function has before it
    for (const Value& entry : mission->declarations.as_list()) {
      std::vector<OptionRow> rows;
      add_option_rows(entry, "", rows);
      const auto same = std::find_if(options.begin(), options.end(),
                                     [&](const auto& one) { return one.rows == rows; });
      if (same == options.end()) {
        place = options.insert(place, {std::move(rows), {mission->name}}) + 1;
      } else {
        same->functions.push_back(mission->name);
        place = same + 1;
      }
    }
  }
  const bool differ = std::any_of(options.begin(), options.end(), [&](const auto& one) {
    return one.functions.size() < functions.size();
  });
  std::string text = differ ? "| option | of | default | |\n|---|---|---|---|\n"
                            : "| option | default | |\n|---|---|---|\n";
  for (const SharedOption& option : options) {
    std::string of;
    for (const std::string& function : option.functions) append_part(of, in_code(function));
    if (option.functions.size() == functions.size()) of = "all";
    for (const OptionRow& row : option.rows) {
      text += "| " + in_code(row.option) + " | " +
              (differ ? of + (of.empty() ? "| " : " | ") : "") + row.fallback + " | " +
              row.meaning + " |\n";
      of.clear();
    }
  }
  return text;
}

std::string argument_table_of(const ScriptInterface& interface, const std::string& owner) {
  std::string text = "| shot | argument | default | |\n|---|---|---|---|\n";
  for (const DescribedFunction& function : interface.described) {
    if (function.owner != owner) continue;
    text += "| `" + function.name + "` | | | " + function.summary + " |\n";
    for (const Value& entry : function.declarations.as_list())
      text += "| | " + in_code(declared_text(entry, "name")) + " | " + declared_default(entry) +
              " | " + declared_meaning(entry) + " |\n";
  }
  return text;
}

}  // namespace lapwing
