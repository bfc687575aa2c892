// SPDX-License-Identifier: Apache-2.0
// Plans of rotors as the controller follows them.
#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/core/units.h"
#include "framework/vehicle/closed_loop.h"
#include "framework/vehicle/flight_controller.h"
#include "tests/verify/reference_plan.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

Vehicle dragging_vehicle() {
  Vehicle vehicle = reference_vehicle();
  vehicle.drag = 0.4;
  return vehicle;
}

// Even flight against the drag, with the nose askew to the way.
Trajectory even_flight(const Vehicle& vehicle, const Vector3d& velocity, double yaw) {
  const Vector3d thrust = vehicle.drag * velocity + Vector3d(0, 0, vehicle.mass * kGravity);
  Trajectory trajectory;
  trajectory.motion = rotors_motion();
  for (int i = 0; i <= 40; ++i) {
    Sample s;
    s.time = 0.1 * i;
    s.position = s.time * velocity;
    s.velocity = velocity;
    s.columns.set("orientation", attitude_of(thrust, yaw));
    s.columns.set("rotor_thrusts", Eigen::Vector4d(Eigen::Vector4d::Constant(thrust.norm() / 4)));
    trajectory.samples.push_back(s);
  }
  return trajectory;
}

TEST(RotorReference, AsksForThePlannedAttitudeAndThrust) {
  const Vehicle vehicle = dragging_vehicle();
  const Trajectory plan = even_flight(vehicle, {8, -5, 1}, 0.7);
  const ReferenceMotion reference(plan, vehicle);
  for (const double time : {0.0, 1.23, 3.9}) {
    const ReferencePoint point = reference.at(time);
    EXPECT_LT(point.acceleration.norm(), 1e-9);
    EXPECT_LT((point.position - time * Vector3d(8, -5, 1)).norm(), 1e-9);
    EXPECT_NEAR(reference.force(point).norm(),
                plan.samples[0].columns.vector<4>("rotor_thrusts").sum(), 1e-9);
    // Where the nose points is another yaw, and with it another attitude.
    EXPECT_LT(plan.samples[0]
                  .columns.quaternion("orientation")
                  .angularDistance(attitude_of(reference.force(point), point.yaw)),
              1e-7);
  }
}

TEST(RotorReference, IsFlownToTheCentimetre) {
  const Vehicle vehicle = dragging_vehicle();
  const FlownPath path = fly(even_flight(vehicle, {6, 3, 0}, -2), vehicle);
  EXPECT_FALSE(path.lost);
  EXPECT_LT(path.position_error_worst, 0.01);
  EXPECT_LT(path.yaw_error_worst, 0.01);
}

TEST(RotorReference, APathSaysWhatCanBeFlown) {
  Trajectory path = even_flight(dragging_vehicle(), {1, 0, 0}, 0);
  path.motion = path_motion();
  try {
    fly(path, dragging_vehicle());
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("Films, races, light paintings and scans"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace lapwing
