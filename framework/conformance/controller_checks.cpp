// SPDX-License-Identifier: Apache-2.0
// What every controller must pass: it answers within the limits, the same to the same question, in
// time, and it flies what can be flown.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include <Eigen/LU>

#include "framework/conformance/differences.h"
#include "framework/conformance/every_case.h"
#include "framework/core/parallel.h"
#include "framework/core/random.h"
#include "framework/core/units.h"
#include "framework/vehicle/closed_loop.h"

namespace lapwing {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::Vector4d;

constexpr double kControlStep = 0.002;    // s
constexpr double kFollowedWithin = 0.25;  // m, what a certificate allows
constexpr double kCallLimit = 0.004;      // s, of the median call, on one thread
constexpr double kFlightDuration = 4.0;   // s
// States in a world that a controller is asked about: with its defaults, and with every other value
// of a parameter.
constexpr int kAsked = 300, kAskedOther = 60;

Vehicle flown_vehicle(double lag) {
  Vehicle v;
  v.name = "a quadrotor";
  v.mass = 1.2;
  v.inertia = {0.008, 0.009, 0.015};
  v.drag = 0.2;
  v.rotors = {.thrust_max = 9,
              .thrust_min = 0.1,
              .torque_coefficient = 0.02,
              .arm_length = 0.2,
              .lag = lag,
              .diagonal = true};
  v.yaw_share = 0.2;
  v.flight_time = 600;
  return v;
}

// A wave: forces linear from sample to sample.
Trajectory wave_of_forces(const Vehicle& vehicle) {
  Trajectory trajectory;
  trajectory.inputs_held = false;
  const double h = 0.02, w = 1.5;
  Sample s;
  for (int i = 0; i <= static_cast<int>(kFlightDuration / h); ++i) {
    s.time = i * h;
    const auto acceleration = [&](double t) {
      return Vector3d(2 * std::sin(w * t), std::sin(2 * w * t), 0.5 * std::sin(w * t));
    };
    const Vector3d a = acceleration(s.time), next = acceleration(s.time + h);
    s.acceleration = a;
    s.columns.set("force", Vector3d(vehicle.mass * (a + Vector3d(0, 0, kGravity))));
    s.columns.set("yaw_torque", 0.0);
    trajectory.samples.push_back(s);
    s.position += h * s.velocity + h * h / 6 * (2 * a + next);
    s.velocity += h / 2 * (a + next);
  }
  return trajectory;
}

// Up, once round about the x axis, and on: thrusts, and what they do to the body. Upside down for a
// while.
Trajectory flip_of_rotors(Vehicle vehicle) {
  vehicle.rotors.lag = 0;
  const RotorBody body(vehicle);
  const Eigen::Matrix4d mixer = mixer_of(vehicle.rotors);
  const Eigen::Matrix4d unmix = mixer.inverse();
  Trajectory trajectory;
  trajectory.motion = rotors_motion();
  trajectory.inputs_held = false;
  // A roll angle of 2 pi s(t), s smooth from 0 to 1 between begin and end.
  const double begin = 0.6, length = 1.0, h = 0.01, weight = vehicle.mass * kGravity;
  const auto moment = [&](double t) {
    const double x = (t - begin) / length;
    if (x <= 0 || x >= 1) return 0.0;
    // s = 10 x^3 - 15 x^4 + 6 x^5
    return 2 * std::numbers::pi * (60 * x - 180 * x * x + 120 * x * x * x) / (length * length) *
           vehicle.inertia.x();
  };
  const auto thrusts = [&](double t) -> Vector4d {
    const double lift = t < begin ? 1.5 : 1.0;
    return unmix * Vector4d(lift * weight, moment(t), 0, 0);
  };
  BodyState state;
  for (int i = 0; i <= 220; ++i) {
    Sample s;
    s.time = i * h;
    s.position = state.position;
    s.velocity = state.velocity;
    s.columns.set("orientation", state.orientation);
    s.columns.set("body_rates", state.body_rates);
    s.columns.set("rotor_thrusts", thrusts(s.time));
    trajectory.samples.push_back(s);
    const Vector4d now = thrusts(s.time), next = thrusts(s.time + h);
    constexpr int kSub = 10;
    for (int k = 0; k < kSub; ++k)
      state = body.after(state, now + (k + 0.5) / kSub * (next - now), Vector3d::Zero(), h / kSub);
  }
  return trajectory;
}

struct ControllerWorld {
  std::string name;
  Vehicle vehicle;
  Trajectory trajectory;
  bool upright;  // every controller follows it, or refuses
};

std::vector<ControllerWorld> controller_worlds() {
  std::vector<ControllerWorld> worlds;
  for (const double lag : {0.0, 0.03}) {
    const Vehicle vehicle = flown_vehicle(lag);
    const std::string rotors = lag > 0 ? ", rotors that lag" : "";
    worlds.push_back({"a wave of forces" + rotors, vehicle, wave_of_forces(vehicle), true});
    worlds.push_back({"a flip" + rotors, vehicle, flip_of_rotors(vehicle), false});
  }
  return worlds;
}

// Near the plan, far from it, upside down, spinning.
BodyState drawn_state(const BodyPoint& point, int kind, Random& random) {
  const auto three = [&](double most) {
    return Vector3d(random.uniform(-most, most), random.uniform(-most, most),
                    random.uniform(-most, most));
  };
  const double size = kind == 0 ? 0.02 : kind == 1 ? 1 : 1000;
  BodyState state;
  state.position = point.position + three(size);
  state.velocity = point.velocity + three(size);
  const Vector3d turn = three(kind == 0 ? 0.05 : 4);
  state.orientation =
      point.orientation * Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
  state.body_rates = point.body_rates + three(size);
  state.rotor_thrusts = point.rotor_thrusts;
  return state;
}

class ControllerCheck {
 public:
  ControllerCheck(const Specimen<Controller>& subject, const CheckOptions& options,
                  Findings& findings)
      : subject_(subject), options_(options), findings_(findings) {}

  void run(const Value& parameters, const ControllerWorld& world, bool defaults) {
    const BodyReference reference(world.trajectory, world.vehicle);
    const auto controller = subject_.create(parameters);
    try {
      controller->follow(world.vehicle, reference);
    } catch (const InputError&) {
      findings_.expect("follows", !defaults || !world.upright,
                       [&] { return world.name + " is refused with the defaults"; });
      return;
    }
    if (options_.wants_any({"finite", "limits"}))
      answers(*controller, reference, world, defaults ? kAsked : kAskedOther);
    if (!defaults) return;
    if (options_.wants_any({"repeatable", "threads"})) repeats(*controller, reference, world);
    if (options_.wants("follows") && world.upright) flies(parameters, world);
    if (options_.wants("time")) is_quick(*controller, reference, world);
  }

 private:
  void answers(const Controller& controller, const BodyReference& reference,
               const ControllerWorld& world, int asked) {
    Random random(options_.seed);
    const auto flight = controller.begin();
    for (int k = 0; k < asked; ++k) {
      const double time = random.uniform(reference.start() - 0.1, reference.finish() + 0.5);
      const BodyState state = drawn_state(reference.at(time), k % 3, random);
      const RotorCommand command = flight->command(time, state, kControlStep);
      const auto at = [&] { return world.name + " at " + text_of(time) + " s: "; };
      findings_.expect("finite", command.thrusts.allFinite(),
                       [&] { return at() + "a thrust is no number"; });
      const Rotors& rotors = world.vehicle.rotors;
      const double least = command.thrusts.minCoeff(), most = command.thrusts.maxCoeff();
      findings_.expect(
          "limits", !(least < rotors.thrust_min - 1e-9) && !(most > rotors.thrust_max + 1e-9), [&] {
            return at() + "thrusts of " + text_of(least) + " to " + text_of(most) +
                   " N; a rotor takes " + text_of(rotors.thrust_min) + " to " +
                   text_of(rotors.thrust_max);
          });
    }
  }

  // The commands of one flight along the plan, a little beside it.
  static std::vector<Vector4d> commands(const Controller& controller,
                                        const BodyReference& reference) {
    std::vector<Vector4d> commands;
    const auto flight = controller.begin();
    Random random(7);
    for (double time = reference.start(); time < reference.finish(); time += 5 * kControlStep)
      commands.push_back(
          flight->command(time, drawn_state(reference.at(time), 0, random), 5 * kControlStep)
              .thrusts);
    return commands;
  }

  void repeats(const Controller& controller, const BodyReference& reference,
               const ControllerWorld& world) {
    const std::vector<Vector4d> once = commands(controller, reference);
    findings_.expect("repeatable", commands(controller, reference) == once, [&] {
      return world.name + ": a second flight gets other commands for the same states";
    });
    std::vector<std::vector<Vector4d>> at_once(4);
    parallel_for(at_once.size(), 4,
                 [&](std::size_t i) { at_once[i] = commands(controller, reference); });
    for (const auto& one : at_once)
      findings_.expect("threads", one == once, [&] {
        return world.name + ": flights of several threads get other commands than one alone";
      });
  }

  void flies(const Value& parameters, const ControllerWorld& world) {
    const FlownPath path =
        ControlledPlan(world.trajectory, world.vehicle, subject_.create(parameters)).fly();
    findings_.expect("follows", !path.lost && path.position_error_worst <= kFollowedWithin, [&] {
      return world.name + (path.lost
                               ? ": the vehicle is lost"
                               : ": strays by " + text_of(path.position_error_worst) +
                                     " m; at most " + text_of(kFollowedWithin) + " m in still air");
    });
  }

  void is_quick(const Controller& controller, const BodyReference& reference,
                const ControllerWorld& world) {
    using Clock = std::chrono::steady_clock;
    const auto flight = controller.begin();
    Random random(3);
    std::vector<double> times;
    for (int k = 0; k < 101; ++k) {
      const double time = reference.start() + k * kControlStep;
      const BodyState state = drawn_state(reference.at(time), 0, random);
      const auto before = Clock::now();
      flight->command(time, state, kControlStep);
      times.push_back(std::chrono::duration<double>(Clock::now() - before).count());
    }
    std::nth_element(times.begin(), times.begin() + 50, times.end());
    if (times[50] > kCallLimit)
      findings_.warn("time", world.name + ": half of the calls take more than " +
                                 text_of(1000 * times[50]) + " ms; 4 ms are wished for");
    else
      findings_.expect("time", true, {});
  }

  const Specimen<Controller>& subject_;
  const CheckOptions& options_;
  Findings& findings_;
};

}  // namespace

std::vector<CheckResult> check_controller(const Specimen<Controller>& subject,
                                          const CheckOptions& options) {
  const std::vector<ControllerWorld> worlds = controller_worlds();
  return check_with_every_case(
      subject, options, "its commands",
      [&](Controller&, const Value& parameters, Findings& findings, bool first) {
        for (const ControllerWorld& world : worlds)
          ControllerCheck(subject, options, findings).run(parameters, world, first);
      });
}

}  // namespace lapwing
