// SPDX-License-Identifier: Apache-2.0
// One motion as the verifier integrates it, by code of its own. Internal to this room.
//
// A source of this folder holds one motion; known_motions.cpp lists them by name.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "framework/trajectory/trajectory.h"
#include "framework/vehicle/vehicle.h"
#include "framework/verify/motion.h"

namespace lapwing {

// A limit that only one motion has, judged at every point.
struct OwnLimit {
  const char* check;  // a name of kMotionCheckKinds
  double limit = 0;
  bool at_least = false;
  std::function<double(const MotionPoint&)> value;
};

class MotionIntegrator {
 public:
  virtual ~MotionIntegrator() = default;

  // Steps between two neighbouring samples, so short as tolerances.h says; a number, because a
  // hostile plan may ask for more than fit anything.
  virtual double steps(const Sample& a, const Sample& b) const = 0;
  // What a sample itself states.
  virtual MotionPoint stated(const Sample& s) const = 0;
  // The motion from `a` to the time of `b`, both ends included, in `count` steps. `points` is
  // empty.
  virtual void integrate(const Sample& a, const Sample& b, std::size_t count,
                         std::vector<MotionPoint>& points) const = 0;

  // Between what an interval reaches and what its last sample states: position in m, velocity in
  // m/s, angle of the heading in rad and its rate in rad/s.
  virtual std::array<double, 4> defects(const MotionPoint& reached,
                                        const MotionPoint& stated) const;
  // The same of the states beyond these, the worst of them as a share of what is allowed; negative
  // where there are none.
  virtual double state_defect(const MotionPoint&, const MotionPoint&) const { return -1; }
  virtual std::vector<OwnLimit> limits(const Vehicle&) const { return {}; }
  // Said in the certificate: where the equation comes from. Empty: it is this room's own.
  virtual std::string source() const { return ""; }
};

// Whether inputs of a trajectory are held; gimbals turn by theirs.
struct InputForm {
  bool held = true;
};

// The gimbal of points that were integrated from `a` to `b`: angles from their rates, exactly.
void turn_gimbal(const Sample& a, const Sample& b, InputForm inputs,
                 std::vector<MotionPoint>& points);

struct KnownMotion {
  const char* name;
  std::vector<MotionColumn> columns;  // that a plan must state
  std::unique_ptr<MotionIntegrator> (*make)(const Trajectory&, const Vehicle&);
  // What the vehicle lacks for it; empty: nothing.
  std::string (*lacks)(const Vehicle&);
};

// All that this version integrates by itself. Null where there is none of that name.
const KnownMotion* known_motion(std::string_view name);
std::string known_motion_names();  // "force, rotors, ..."

// Why the motion of a plan cannot be integrated: unknown and without derivatives, columns that are
// not those of its name, a vehicle that lacks what it needs. Empty where it can.
std::vector<std::string> motion_problems(const MotionRecord& motion, const Vehicle& vehicle);

// Of a motion without problems. Keeps references.
std::unique_ptr<MotionIntegrator> integrator_of(const Trajectory& trajectory,
                                                const Vehicle& vehicle);

// One for each source of this folder.
KnownMotion force_integrator();
KnownMotion rotors_integrator();
KnownMotion path_integrator();
KnownMotion velocity_integrator();
KnownMotion coordinated_turn_integrator();
std::unique_ptr<MotionIntegrator> table_integrator(const Trajectory& trajectory);

}  // namespace lapwing
