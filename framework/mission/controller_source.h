// SPDX-License-Identifier: Apache-2.0
// Controllers from the registry, for those who may not open plugins themselves.
#pragma once

#include "framework/plugin/registry.h"
#include "framework/vehicle/closed_loop.h"

namespace lapwing {

// Keeps a reference to the registry.
inline ControllerSource controllers_of(const Registry& registry) {
  return [&registry](const ControllerChoice& choice) {
    return registry.create<Controller>(
        choice.name, choice.parameters.is_null() ? Value::map() : choice.parameters, "controller");
  };
}

// A plan bound to the controller that its vehicle names. Throws as ControlledPlan and the registry
// do; keeps references to trajectory and vehicle.
inline std::unique_ptr<ControlledPlan> plan_as_named(const Trajectory& trajectory,
                                                     const Vehicle& vehicle,
                                                     const Registry& registry) {
  const ControllerChoice choice = controller_of(vehicle);
  return std::make_unique<ControlledPlan>(
      trajectory, vehicle, choice.is_default() ? nullptr : controllers_of(registry)(choice));
}

}  // namespace lapwing
