// SPDX-License-Identifier: Apache-2.0
#include "framework/vehicle/controller.h"

#include <charconv>
#include <optional>
#include <sstream>

#include "framework/core/error.h"

namespace lapwing {

namespace {

// "true", "0.3" or a word.
Value value_of(const std::string& text) {
  if (text == "true" || text == "false") return Value(text == "true");
  double number = 0;
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, number);
  return error == std::errc{} && stopped == end ? Value(number) : Value(text);
}

// "position=0.05,velocity=0.3"; nothing for what is none.
std::optional<Value> parameters_of(const std::string& text) {
  if (text.empty() || text.back() == ',') return std::nullopt;
  Value parameters = Value::map();
  std::istringstream rest(text);
  for (std::string part; std::getline(rest, part, ',');) {
    const std::size_t equal = part.find('=');
    if (equal == std::string::npos || equal == 0 || equal + 1 == part.size()) return std::nullopt;
    const std::string name = part.substr(0, equal);
    if (parameters.find(name)) return std::nullopt;
    parameters.set(name, value_of(part.substr(equal + 1)));
  }
  return parameters;
}

}  // namespace

ControllerChoice controller_choice_from(const Value& value, const std::string& key) {
  const auto refuse = [&](const std::string& problem) {
    throw InputError(value.origin(), key + ": " + problem +
                                         "; expected a controller's name, "
                                         "NAME:KEY=VALUE,... or {type = NAME, ...}");
  };
  ControllerChoice choice;
  if (value.is_text()) {
    const std::string& text = value.as_text();
    const std::size_t colon = text.find(':');
    choice.name = text.substr(0, colon);
    if (colon != std::string::npos) {
      const std::optional<Value> parameters = parameters_of(text.substr(colon + 1));
      if (!parameters) refuse("'" + text + "' has no parameters that can be read");
      choice.parameters = *parameters;
    }
  } else if (value.is_map()) {
    const Value* type = value.find("type");
    if (!type || !type->is_text()) refuse("the table names no controller as `type`");
    choice.name = type->as_text();
    choice.parameters = Value::map();
    for (const auto& [name, entry] : value.as_map())
      if (name != "type") choice.parameters.set(name, entry);
  } else {
    refuse("neither a text nor a table");
  }
  if (choice.name.empty()) refuse("the name is empty");
  return choice;
}

ControllerChoice controller_of(const Vehicle& vehicle) {
  if (vehicle.controller.is_null()) return {};
  return controller_choice_from(vehicle.controller, "vehicle.controller");
}

Value to_value(const ControllerChoice& choice) {
  if (choice.parameters.is_null() || choice.parameters.as_map().empty()) return Value(choice.name);
  Value value = Value::map();
  value.set("type", choice.name);
  for (const auto& [name, entry] : choice.parameters.as_map()) value.set(name, entry);
  return value;
}

}  // namespace lapwing
