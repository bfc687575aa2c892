// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/trajectory/interpolate.h"

namespace lapwing {
namespace {

// Motion under an acceleration that changes linearly over one second, integrated by hand.
Sample cubic_sample(double t, const Eigen::Vector3d& a0, const Eigen::Vector3d& jerk) {
  Sample s;
  s.time = t;
  s.position = a0 * t * t / 2 + jerk * t * t * t / 6;
  s.velocity = a0 * t + jerk * t * t / 2;
  s.acceleration = a0 + jerk * t;
  s.yaw = 0.2 * t * t - 0.1 * t * t * t;
  s.yaw_rate = 0.4 * t - 0.3 * t * t;
  s.gimbal_pitch = -0.1 * t * t;
  s.gimbal_pitch_rate = -0.2 * t;
  return s;
}

void expect_near(const Sample& a, const Sample& b) {
  EXPECT_NEAR((a.position - b.position).norm(), 0, 1e-12);
  EXPECT_NEAR((a.velocity - b.velocity).norm(), 0, 1e-12);
  EXPECT_NEAR((a.acceleration - b.acceleration).norm(), 0, 1e-12);
  EXPECT_NEAR(a.yaw, b.yaw, 1e-12);
  EXPECT_NEAR(a.yaw_rate, b.yaw_rate, 1e-12);
  EXPECT_NEAR(a.gimbal_pitch, b.gimbal_pitch, 1e-12);
  EXPECT_NEAR(a.gimbal_pitch_rate, b.gimbal_pitch_rate, 1e-12);
}

TEST(Interpolate, LinearInputsGiveTheExactMotion) {
  const Eigen::Vector3d a0(1, -2, 0.5), jerk(3, 1, -4);
  Trajectory trajectory;
  trajectory.inputs_held = false;
  trajectory.has_gimbal = true;
  for (const double t : {0.0, 0.4, 1.0}) trajectory.samples.push_back(cubic_sample(t, a0, jerk));
  for (const double t : {0.0, 0.1, 0.4, 0.77, 1.0}) {
    expect_near(sample_at(trajectory, t), cubic_sample(t, a0, jerk));
  }
}

TEST(Interpolate, HeldInputsStayUntilTheNextSample) {
  const Eigen::Vector3d a(1, -2, 0.5);
  Trajectory trajectory;
  trajectory.samples = {cubic_sample(0, a, {0, 0, 0}), cubic_sample(1, a, {0, 0, 0})};
  trajectory.samples[0].columns.set("force", Eigen::Vector3d(1, 2, 3));
  trajectory.samples[1].columns.set("force", Eigen::Vector3d(7, 8, 9));
  trajectory.samples[1].acceleration = {9, 9, 9};
  const Sample s = sample_at(trajectory, 0.6);
  EXPECT_NEAR((s.position - a * 0.18).norm(), 0, 1e-12);
  EXPECT_EQ(s.acceleration, a);
  EXPECT_EQ(s.columns.vector3("force"), Eigen::Vector3d(1, 2, 3));
}

// Forces that grow linearly from middle to middle of steps of 1, 2 and 0.5 s.
TEST(Interpolate, SmoothedInputsBelongToTheMiddlesOfTheirSteps) {
  const auto force = [](double middle) { return Eigen::Vector3d(1 + middle, -2 * middle, 3); };
  Trajectory trajectory;
  for (const double t : {0.0, 1.0, 3.0, 3.5}) {
    trajectory.samples.push_back(cubic_sample(t, {0, 0, 0}, {0, 0, 0}));
    const double middle = t + (t == 1 ? 1.0 : t >= 3 ? 0.25 : 0.5);
    Sample& sample = trajectory.samples.back();
    sample.columns.set("force", force(middle));
    sample.acceleration = 2 * force(middle);
    sample.gimbal_pitch_rate = 0.5 * middle;
  }
  for (const double middle : {0.5, 0.9, 2.0, 2.8, 3.25, 3.4, 3.75}) {
    Sample sample = trajectory.samples[0];
    smooth_held_inputs(trajectory, middle, sample);
    EXPECT_NEAR((sample.columns.vector3("force") - force(middle)).norm(), 0, 1e-12) << middle;
    EXPECT_NEAR((sample.acceleration - 2 * force(middle)).norm(), 0, 1e-12) << middle;
    EXPECT_NEAR(sample.gimbal_pitch_rate, 0.5 * middle, 1e-12) << middle;
    EXPECT_EQ(sample.position, trajectory.samples[0].position);
  }
  // Before the first middle and after the last, inputs are held.
  Sample sample = trajectory.samples[0];
  smooth_held_inputs(trajectory, 0.1, sample);
  EXPECT_EQ(sample.columns.vector3("force"), force(0.5));
  smooth_held_inputs(trajectory, 9, sample);
  EXPECT_EQ(sample.columns.vector3("force"), force(3.75));
  // Linear inputs stay.
  trajectory.inputs_held = false;
  smooth_held_inputs(trajectory, 2, sample);
  EXPECT_EQ(sample.columns.vector3("force"), force(3.75));
}

TEST(Interpolate, PathIsStraight) {
  Trajectory trajectory;
  trajectory.motion = path_motion();
  trajectory.samples.resize(2);
  trajectory.samples[1].time = 2;
  trajectory.samples[1].position = {4, 0, 2};
  trajectory.samples[1].yaw = 1;
  const Sample s = sample_at(trajectory, 0.5);
  EXPECT_EQ(s.position, Eigen::Vector3d(1, 0, 0.5));
  EXPECT_EQ(s.velocity, Eigen::Vector3d(2, 0, 1));
  EXPECT_DOUBLE_EQ(s.yaw, 0.25);
}

TEST(Interpolate, OutsideTheSamplesIsAnError) {
  Trajectory trajectory;
  EXPECT_THROW(sample_at(trajectory, 0), Error);
  trajectory.samples.resize(2);
  trajectory.samples[1].time = 1;
  EXPECT_THROW(sample_at(trajectory, 1.1), Error);
  EXPECT_THROW(sample_at(trajectory, -0.1), Error);
  EXPECT_THROW(sample_at(trajectory, std::nan("")), Error);
  EXPECT_EQ(sample_at(trajectory, 1 + 1e-9).time, 1);
}

}  // namespace
}  // namespace lapwing
