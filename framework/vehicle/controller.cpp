// SPDX-License-Identifier: Apache-2.0
#include "framework/vehicle/controller.h"

#include <optional>

#include "framework/core/error.h"
#include "framework/core/named_parameters.h"

namespace lapwing {

ControllerChoice controller_choice_from(const Value& value, const std::string& key) {
  const auto refuse = [&](const std::string& problem) {
    throw InputError(value.origin(), key + ": " + problem +
                                         "; expected a controller's name, "
                                         "NAME:KEY=VALUE,... or {type = NAME, ...}");
  };
  ControllerChoice choice;
  if (value.is_text()) {
    const std::optional<NamedParameters> given = named_parameters_from(value.as_text());
    if (!given) refuse("'" + value.as_text() + "' has no parameters that can be read");
    choice = {given->name, given->parameters};
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
