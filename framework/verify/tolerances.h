// SPDX-License-Identifier: Apache-2.0
// Every tolerance of the verifier, with its unit.
#pragma once

namespace lapwing::tolerances {

// A limit may be passed by this share of itself, and by no less than the floor in its own unit:
// limits of zero exist (a gimbal that cannot turn), and numbers are rounded.
inline constexpr double kLimitShare = 1e-4;
inline constexpr double kLimitFloor = 1e-6;
inline constexpr double kGimbalAngle = 1e-4;  // rad; angles have limits of zero by nature
inline constexpr double kClearance = 1e-3;    // m
inline constexpr double kMeshReach = 50;      // m beyond the margin; farther meshes are far
inline constexpr double kMapReach = 2;        // m beyond the margin that distances of maps reach

// Between a sample and the motion integrated from the sample before it, per interval.
inline constexpr double kPositionDefect = 1e-3;         // m
inline constexpr double kVelocityDefect = 1e-2;         // m/s
inline constexpr double kYawDefect = 3.4906585e-3;      // rad, 0.2 degrees
inline constexpr double kYawRateDefect = 3.4906585e-2;  // rad/s, 2 degrees/s
inline constexpr double kGimbalDefect = kYawDefect;     // rad

// Of the states beyond position, velocity and yaw of a motion that the plan states: a share of
// their size, and of 1 at least.
inline constexpr double kTableDefect = 1e-3;

// Defects of many short intervals add up: their sum over any kDriftWindow may not exceed this many
// times the defect of one interval. Else samples a millisecond apart could teleport the vehicle.
inline constexpr double kDriftWindow = 1.0;  // s
inline constexpr double kDriftFactor = 10.0;

// Between the acceleration that a sample states and force / mass + gravity.
inline constexpr double kAcceleration = 1e-2;  // m/s^2

// How far the whole quadrotor under control may stray from the plan in still air, and the share of
// the time in which a rotor may be asked for more than it has.
inline constexpr double kTracking = 0.25;         // m
inline constexpr double kTrackingYaw = 0.087266;  // rad, 5 degrees
inline constexpr double kSaturated = 0.01;

// Resolution of the integrated motion: steps are short enough that between two of them the true
// motion leaves the straight line, or passes what both ends show, by no more than this.
inline constexpr double kStepMaximum = 0.02;    // s
inline constexpr double kRotorStep = 0.002;     // s, of the motion model `rotors`
inline constexpr double kTableStep = 0.002;     // s, of a motion that the plan states
inline constexpr double kBulge = 1e-4;          // m
inline constexpr double kHiddenSpeed = 2e-5;    // m/s, across, up or down
inline constexpr double kHiddenYawRate = 2e-5;  // rad/s
inline constexpr double kHiddenGimbal = 1e-6;   // rad

// Of the values of a constraint that the script states, whose unit nobody knows: a share of the
// bound, or of the range of the values where that is larger. Between two samples a value may pass
// its bound by this factor times an eighth of its second difference, and by at most a share of the
// range.
inline constexpr double kConstraintShare = 1e-4;
inline constexpr double kConstraintFloor = 1e-5;
inline constexpr double kConstraintBend = 2;
inline constexpr double kConstraintBetween = 0.01;
inline constexpr double kConstraintTime = 1e-9;     // s, nearer to a span's end is on it
inline constexpr double kMostConstraintWork = 5e9;  // operations, at all points together

// What a plan may hold at all.
inline constexpr double kLargestNumber = 1e7;  // any figure of a sample or of the task, SI
inline constexpr double kLargestSteps = 5e6;   // steps of integration
inline constexpr double kUnitLength = 1e-6;    // of quaternions and directions
inline constexpr double kStartTime = 1e-9;     // s, the first sample is at time 0
inline constexpr double kSpanTime = 1e-6;      // s, that a span may pass the ends of the flight
inline constexpr int kMostCorners = 1000;      // of a zone
inline constexpr double kMostRays = 1e9;       // of the images of a scan
inline constexpr double kLongestRay = 1000;    // m

}  // namespace lapwing::tolerances
