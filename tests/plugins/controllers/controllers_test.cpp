// SPDX-License-Identifier: Apache-2.0
// The controllers of the build tree, on flights that say what they can.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <numbers>

#include "framework/core/error.h"
#include "framework/core/units.h"
#include "framework/plugin/registry.h"
#include "framework/vehicle/closed_loop.h"
#include "framework/vehicle/riccati.h"
#include "plugins/controllers/tvlqr/error_dynamics.h"
#include "tests/verify/reference_plan.h"

namespace lapwing {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::Vector4d;
using Eigen::VectorXd;

const Registry& plugins() {
  static const Registry registry({LAPWING_BUILD_DIR "/lib/plugins"});
  return registry;
}

constexpr const char* kShipped[] = {"thesis", "geometric", "tvlqr", "mpc", "contouring"};

FlownPath flown(const Trajectory& plan, const Vehicle& vehicle, const char* controller,
                const FlightConditions& conditions = {}) {
  return ControlledPlan(plan, vehicle, plugins().create<Controller>(controller)).fly(conditions);
}

Vehicle agile(double lag) {
  Vehicle vehicle = reference_vehicle();
  vehicle.drag = 0.3;
  vehicle.rotors.lag = lag;
  vehicle.rotors.thrust_max = vehicle.mass * kGravity;
  vehicle.rotors.thrust_min = 0;
  return vehicle;
}

// Up, once round about the y axis, and on.
Trajectory flip(Vehicle vehicle) {
  vehicle.rotors.lag = 0;
  const RotorBody body(vehicle);
  const Eigen::Matrix4d unmix = body.mixer().inverse();
  const auto thrusts = [&](double t) -> Vector4d {
    const double x = std::clamp((t - 0.6) / 1.2, 0.0, 1.0);
    const double turn = 2 * std::numbers::pi * (60 * x - 180 * x * x + 120 * x * x * x) / 1.44;
    return unmix * Vector4d((t < 0.6 ? 1.6 : 1.0) * vehicle.mass * kGravity, 0,
                            vehicle.inertia.y() * turn, 0);
  };
  Trajectory trajectory;
  trajectory.motion = rotors_motion();
  trajectory.inputs_held = false;
  BodyState state;
  for (int i = 0; i <= 240; ++i) {
    Sample s;
    s.time = 0.01 * i;
    s.position = state.position;
    s.velocity = state.velocity;
    s.columns.set("orientation", state.orientation);
    s.columns.set("body_rates", state.body_rates);
    s.columns.set("rotor_thrusts", thrusts(s.time));
    trajectory.samples.push_back(s);
    const Vector4d now = thrusts(s.time), next = thrusts(s.time + 0.01);
    for (int k = 0; k < 10; ++k)
      state = body.after(state, now + (k + 0.5) / 10 * (next - now), Vector3d::Zero(), 0.001);
  }
  return trajectory;
}

TEST(BodyReference, IsWhatThePlanStatesAndMovesAsItSays) {
  const Vehicle vehicle = agile(0);
  const Trajectory plan = flip(vehicle);
  const BodyReference reference(plan, vehicle);
  ASSERT_TRUE(reference.states_attitude());
  double lowest = 1;
  for (std::size_t i = 0; i < plan.samples.size(); ++i) {
    const Sample& s = plan.samples[i];
    const BodyPoint p = reference.at(s.time);
    EXPECT_LT((p.position - s.position).norm(), 1e-9);
    EXPECT_LT(p.orientation.angularDistance(s.columns.quaternion("orientation")), 1e-7);
    lowest = std::min(lowest, (p.orientation * Vector3d::UnitZ()).z());
  }
  EXPECT_LT(lowest, -0.99);  // it does fly upside down
  // Derivatives against differences.
  const double h = 1e-4;
  for (const double t : {0.3, 0.75, 0.9, 1.21, 1.6}) {
    const BodyPoint a = reference.at(t - h), p = reference.at(t), b = reference.at(t + h);
    EXPECT_LT((p.velocity - (b.position - a.position) / (2 * h)).norm(), 1e-4) << t;
    EXPECT_LT((p.acceleration - (b.velocity - a.velocity) / (2 * h)).norm(), 1e-2) << t;
    EXPECT_LT((p.body_accelerations - (b.body_rates - a.body_rates) / (2 * h)).norm(), 0.3) << t;
  }
}

TEST(Tvlqr, ErrorsMoveAsLinearised) {
  for (const double lag : {0.0, 0.03}) {
    const Vehicle vehicle = agile(lag);
    const Trajectory plan = flip(vehicle);
    const BodyReference reference(plan, vehicle);
    const RotorBody body(vehicle);
    const double t = 1.1, h = 1e-5, d = 1e-5;
    const BodyPoint p = reference.at(t);
    const ErrorDynamics dynamics = error_dynamics(p, vehicle);
    const int n = static_cast<int>(dynamics.a.rows());
    const auto state_of = [&](const VectorXd& x) {
      BodyState s{p.position + x.segment<3>(3), p.velocity + x.segment<3>(6), p.orientation,
                  p.body_rates + x.segment<3>(12), p.rotor_thrusts};
      const Vector3d turn = x.segment<3>(9);
      if (turn.norm() > 0)
        s.orientation =
            s.orientation * Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
      if (n > kBodyErrors) s.rotor_thrusts += x.segment<4>(15);
      return s;
    };
    // The deviation after a short while, from that of the plan's own state.
    const auto after = [&](const VectorXd& x, const Vector4d& u) {
      const BodyState own =
          body.after(state_of(VectorXd::Zero(n)), p.rotor_thrusts, Vector3d::Zero(), h);
      const BodyState s = body.after(state_of(x), p.rotor_thrusts + u, Vector3d::Zero(), h);
      const BodyPoint moved{own.position, own.velocity,     {}, own.orientation, own.body_rates,
                            {},           own.rotor_thrusts};
      return deviation(s, moved, Vector3d::Zero(), n > kBodyErrors);
    };
    for (int j = 3; j < n; ++j) {
      VectorXd x = VectorXd::Zero(n);
      x(j) = d;
      const VectorXd rate =
          (after(x, Vector4d::Zero()) - after(-x, Vector4d::Zero()) - 2 * x) / (2 * d * h);
      for (int i = 3; i < n; ++i)
        EXPECT_NEAR(rate(i), dynamics.a(i, j), 2e-2 * (1 + std::abs(dynamics.a(i, j))))
            << i << " of " << j << ", lag " << lag;
    }
    for (int j = 0; j < 4; ++j) {
      const Vector4d u = d * Vector4d::Unit(j);
      const VectorXd zero = VectorXd::Zero(n);
      const VectorXd rate = (after(zero, u) - after(zero, -u)) / (2 * d * h);
      for (int i = 3; i < n; ++i)
        EXPECT_NEAR(rate(i), dynamics.b(i, j), 2e-2 * (1 + std::abs(dynamics.b(i, j))))
            << i << " of input " << j << ", lag " << lag;
    }
  }
}

// Hovering for long, the gains of the sweep are those of the algebraic equation.
TEST(Tvlqr, HasTheRegulatorsGainsInHover) {
  const Vehicle vehicle = agile(0.03);
  PlanBuilder builder(false, {}, vehicle);
  for (int i = 0; i < 40; ++i) builder.add(0.1, {});
  const Trajectory hover = builder.finish().trajectory;
  const BodyReference reference(hover, vehicle);
  const auto controller = plugins().create<Controller>("tvlqr");
  controller->follow(vehicle, reference);
  const ErrorDynamics dynamics = error_dynamics(reference.at(2), vehicle);
  VectorXd q = VectorXd::Zero(19);
  const double worth[] = {0.3, 0.1, 0.5, 0.2, 4};
  for (int k = 0; k < 5; ++k) q.segment<3>(3 * k).setConstant(1 / (worth[k] * worth[k]));
  const double r = 1 / std::pow(0.15 * vehicle.rotors.thrust_max, 2);
  const Eigen::MatrixXd k =
      regulator_gain(dynamics.a, dynamics.b, q.asDiagonal(), r * Eigen::Matrix4d::Identity());
  const auto command = [&](const Vector3d& off, const Vector3d& drift) {
    BodyState state = reference.starting_state();
    state.position += off;
    state.velocity += drift;
    return controller->begin()
        ->command(2, state, 0)
        .thrusts;  // no time passes: the integral is zero
  };
  for (int axis = 0; axis < 3; ++axis) {
    const double d = 1e-4;
    const Vector3d off = d * Vector3d::Unit(axis), none = Vector3d::Zero();
    const Vector4d by_place = (command(off, none) - command(-off, none)) / (2 * d);
    const Vector4d by_speed = (command(none, off) - command(none, -off)) / (2 * d);
    // The sweep's gains are for commands that are held over 0.01 s.
    EXPECT_LT((by_place + k.col(3 + axis)).norm(), 0.15 * k.col(3 + axis).norm()) << axis;
    EXPECT_LT((by_speed + k.col(6 + axis)).norm(), 0.15 * k.col(6 + axis).norm()) << axis;
  }
}

TEST(Controllers, UpsideDownIsFlownWhereThePlanIs) {
  for (const double lag : {0.0, 0.02}) {
    const Vehicle vehicle = agile(lag);
    const Trajectory plan = flip(vehicle);
    for (const char* name : {"geometric", "tvlqr", "mpc"}) {
      const FlownPath path = flown(plan, vehicle, name);
      EXPECT_FALSE(path.lost) << name << ", lag " << lag;
      EXPECT_LT(path.position_error_worst, 0.1) << name << ", lag " << lag;
      double lowest = 1;
      for (const FlownSample& s : path.samples)
        lowest = std::min(lowest, (s.state.orientation * Vector3d::UnitZ()).z());
      EXPECT_LT(lowest, -0.9) << name;
    }
  }
  // The thesis's knows places and forces alone. Without lag the forces lead it over as well.
  EXPECT_LT(flown(flip(agile(0)), agile(0), "thesis").position_error_worst, 0.1);
}

TEST(Controllers, FollowAFilmInWindWithAWrongMass) {
  Vehicle vehicle = reference_vehicle();
  vehicle.drag = 0.2;
  vehicle.rotors.lag = 0.03;
  const Trajectory film = reference_plan().trajectory;
  for (const char* name : kShipped) {
    EXPECT_LT(flown(film, vehicle, name).position_error_worst, 0.05) << name;
    const FlownPath blown =
        flown(film, vehicle, name, {.wind_mean = 4, .wind_gust = 0.5, .mass_error = 0.05});
    EXPECT_FALSE(blown.lost) << name;
    EXPECT_LT(blown.position_error_worst, 0.3) << name;
    EXPECT_LT(blown.samples.back().position_error, 0.1) << name;
  }
}

TEST(Controllers, ThePluginThesisIsTheKernelsOwn) {
  const Trajectory film = reference_plan().trajectory;
  const FlownPath plugin = flown(film, reference_vehicle(), "thesis");
  const FlownPath own = fly(film, reference_vehicle());
  EXPECT_EQ(plugin.position_error_worst, own.position_error_worst);
  EXPECT_EQ(plugin.samples.back().state.position, own.samples.back().state.position);
}

// A vehicle that cannot keep up is late, and not beside its plan; it flies to the end.
TEST(Contouring, WaitsForAVehicleThatIsTooHeavy) {
  Vehicle vehicle = reference_vehicle();
  vehicle.rotors.lag = 0.02;
  PlanBuilder builder(true, {}, vehicle);
  // To and fro with most of the thrust: held accelerations.
  const double strong = 0.8 * std::sqrt(std::pow(4 * vehicle.rotors.thrust_max / vehicle.mass, 2) -
                                        kGravity * kGravity);
  for (const double a : {1.0, -1.0, -1.0, 1.0})
    for (int i = 0; i < 6; ++i) builder.add(0.1, {{a * strong, 0, 0}});
  const Trajectory plan = builder.finish().trajectory;
  const FlownPath clocked = flown(plan, vehicle, "mpc", {.mass_error = 0.4});
  const FlownPath waited = flown(plan, vehicle, "contouring", {.mass_error = 0.4});
  EXPECT_FALSE(waited.lost);
  EXPECT_TRUE(waited.finished);
  EXPECT_GT(waited.late_worst, 0.05);
  EXPECT_GT(waited.duration(), plan.duration());
  EXPECT_LT(waited.position_error_worst, 0.7 * clocked.position_error_worst);
  EXPECT_GT(waited.clock_error_worst, waited.position_error_worst);
  EXPECT_EQ(clocked.late_worst, 0);
  EXPECT_EQ(clocked.clock_error_worst, clocked.position_error_worst);
}

TEST(ControllerChoice, IsReadAndRefused) {
  EXPECT_TRUE(controller_choice_from(Value("thesis"), "controller").is_default());
  Value table = Value::map();
  table.set("type", "tvlqr");
  table.set("rates", 3.0);
  const ControllerChoice choice = controller_choice_from(table, "controller");
  EXPECT_EQ(choice.name, "tvlqr");
  EXPECT_EQ(to_value(choice), table);
  const ControllerChoice short_one =
      controller_choice_from(Value("tvlqr:rates=3,limited=true,mode=soft"), "controller");
  EXPECT_EQ(short_one.name, "tvlqr");
  EXPECT_EQ(short_one.parameters.find("rates")->as_number(), 3);
  EXPECT_EQ(short_one.parameters.find("limited")->as_boolean(), true);
  EXPECT_EQ(short_one.parameters.find("mode")->as_text(), "soft");
  for (const char* wrong : {"tvlqr:", "tvlqr:rates", "tvlqr:=3", "tvlqr:rates=", ":rates=3",
                            "tvlqr:rates=3,rates=4", "tvlqr:rates=3,"})
    EXPECT_THROW(controller_choice_from(Value(wrong), "controller"), InputError) << wrong;
  EXPECT_THROW(controller_choice_from(Value(3.0), "controller"), InputError);
  EXPECT_THROW(controller_choice_from(Value(""), "controller"), InputError);
  EXPECT_THROW(controller_choice_from(Value::map(), "controller"), InputError);
}

}  // namespace
}  // namespace lapwing
