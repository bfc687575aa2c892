// SPDX-License-Identifier: Apache-2.0
// Controllers: from a plan, the estimated state and the time to commands of the rotors. Plugin kind
// `controller`.
//
// A controller is bound to one plan and one vehicle, once; what it computes then is shared by all
// flights of the plan. A flight has a memory of its own (integrals, the last solution).
//
//   controller->follow(vehicle, reference);
//   const std::unique_ptr<ControlledFlight> flight = controller->begin();
//   command = flight->command(time, state, step);
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "framework/core/plugin_object.h"
#include "framework/core/value.h"
#include "framework/vehicle/body_reference.h"
#include "framework/vehicle/rotor_allocation.h"
#include "framework/vehicle/rotor_body.h"

namespace lapwing {

class ControlledFlight {
 public:
  virtual ~ControlledFlight() = default;
  // The command at `time` (s, of the plan) for a vehicle that is estimated to be in this state,
  // `step` seconds after the last call. Every thrust is finite and within the rotors' limits,
  // whatever the state. The same calls give the same answers. One thread at a time.
  virtual RotorCommand command(double time, const BodyState& state, double step) = 0;
  // The plan's time of the place to which the vehicle is led at `time`. It never falls. A
  // controller that lets the plan wait for a late vehicle is behind `time`; the flight ends when it
  // reaches the end of the plan, or at twice its duration.
  virtual double progress(double time) const { return time; }
};

class Controller : public PluginObject {
 public:
  static constexpr const char* kKind = "controller";
  using Interface = Controller;
  virtual ~Controller() = default;

  // Prepares for this plan; both references outlive the controller. Called once, before `begin`.
  // Throws InputError, with name and number, for a plan or a vehicle that it cannot follow.
  virtual void follow(const Vehicle& vehicle, const BodyReference& reference) = 0;

  // A flight from the start of the plan, which the controller outlives. Several threads may have
  // flights of one controller at once.
  virtual std::unique_ptr<ControlledFlight> begin() const = 0;
};

// Which controller a plan is flown with: a plugin's name and its parameters.
struct ControllerChoice {
  std::string name = kThesisController;
  Value parameters;  // a map, or null for none
  static constexpr const char* kThesisController = "thesis";
  bool is_default() const {
    return name == kThesisController && (parameters.is_null() || parameters.as_map().empty());
  }
};

// "geometric", "geometric:position=0.05,velocity=0.3" or {type = "geometric", position = 0.05}, as
// files, options and plans state it. Throws InputError naming `key` for anything else.
ControllerChoice controller_choice_from(const Value& value, const std::string& key);
// What this vehicle's plans are flown with.
ControllerChoice controller_of(const Vehicle& vehicle);
// Its inverse; a name alone where there are no parameters.
Value to_value(const ControllerChoice& choice);

// Opens a controller. Whoever may call plugins (the command line, a mission) hands one to those who
// may not (the verifier). Throws InputError for a name that is not known and for bad parameters.
using ControllerSource = std::function<std::unique_ptr<Controller>(const ControllerChoice&)>;

}  // namespace lapwing
