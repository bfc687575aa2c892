// SPDX-License-Identifier: Apache-2.0
// Values of MAVLink's enumerations, and of the flight modes of PX4 and ArduPilot, as far as a live
// flight uses them. Source: minimal.xml and common.xml of MAVLink; px4_custom_mode.h of PX4;
// ArduCopter's mode.h.
#pragma once

#include <cstdint>

namespace lapwing::mavlink {

// MAV_AUTOPILOT
inline constexpr std::uint8_t kArduPilot = 3, kNoAutopilot = 8, kPx4 = 12;
// MAV_TYPE
inline constexpr std::uint8_t kQuadrotor = 2, kCoaxial = 3, kHelicopter = 4, kGroundStation = 6,
                              kHexarotor = 13, kOctorotor = 14, kTricopter = 15, kGimbal = 26,
                              kDodecarotor = 29, kDecarotor = 35, kOnboardController = 18;
// MAV_MODE_FLAG
inline constexpr std::uint8_t kArmed = 128, kCustomMode = 1;
// MAV_STATE
inline constexpr std::uint8_t kStandby = 3, kActive = 4, kCritical = 5;
// MAV_COMPONENT
inline constexpr std::uint8_t kAutopilotComponent = 1, kComputer = 191;
// Of our own: a number that neither vehicles nor ground stations begin with.
inline constexpr std::uint8_t kOurSystem = 245;
// MAV_RESULT
inline constexpr std::uint8_t kAccepted = 0, kTemporarilyRejected = 1, kDenied = 2,
                              kUnsupported = 3, kFailed = 4, kInProgress = 5;
// MAV_MISSION_TYPE, MAV_MISSION_RESULT
inline constexpr std::uint8_t kFenceMission = 1;
inline constexpr std::uint8_t kMissionAccepted = 0, kMissionError = 1, kMissionUnsupported = 3,
                              kMissionNoSpace = 4, kMissionSequence = 13, kMissionDenied = 14,
                              kMissionCancelled = 15;
// MAV_FRAME
inline constexpr std::uint8_t kFrameGlobal = 0, kFrameLocalNed = 1, kFrameRelative = 3,
                              kFrameGlobalInt = 5, kFrameRelativeInt = 6;
// MAV_CMD
inline constexpr std::uint16_t kDoSetMode = 176, kDoSetRoiLocation = 195, kDoSetRoiNone = 197,
                               kComponentArmDisarm = 400, kSetMessageInterval = 511,
                               kRequestMessage = 512, kGimbalPitchYaw = 1000,
                               kGimbalConfigure = 1001, kFenceInclusion = 5001,
                               kFenceExclusion = 5002, kCircleInclusion = 5003,
                               kCircleExclusion = 5004;
// MAV_LANDED_STATE
inline constexpr std::uint8_t kOnGround = 1, kInAir = 2;
// MAV_SEVERITY
inline constexpr std::uint8_t kWarning = 4, kInformation = 6;
// ESTIMATOR_STATUS_FLAGS
inline constexpr std::uint16_t kAttitudeGood = 1, kVelocityAcrossGood = 2, kVelocityUpGood = 4,
                               kRelativePlaceGood = 8, kAbsolutePlaceGood = 16, kHeightGood = 32,
                               kHeightAboveGroundGood = 64, kGpsGlitch = 1024,
                               kAccelerometerError = 2048;
// MAV_SYS_STATUS_SENSOR
inline constexpr std::uint32_t kGpsSensor = 1u << 5, kFlowSensor = 1u << 6, kVisionSensor = 1u << 7,
                               kAttitudeSystem = 1u << 21;
// GIMBAL_MANAGER_FLAGS
inline constexpr std::uint32_t kRollLock = 4, kPitchLock = 8, kYawLock = 16;
// POSITION_TARGET_TYPEMASK
inline constexpr std::uint16_t kIgnorePosition = 1 | 2 | 4, kIgnoreVelocity = 8 | 16 | 32,
                               kIgnoreAcceleration = 64 | 128 | 256, kForceSet = 512,
                               kIgnoreYaw = 1024, kIgnoreYawRate = 2048;

// custom_mode of PX4: the main mode in byte 2, the part of `auto` in byte 3.
constexpr std::uint32_t px4_mode(std::uint32_t main, std::uint32_t part = 0) {
  return main << 16 | part << 24;
}
inline constexpr std::uint32_t kPx4Position = px4_mode(3), kPx4Offboard = px4_mode(6),
                               kPx4Hold = px4_mode(4, 3), kPx4Land = px4_mode(4, 6);
// custom_mode of ArduCopter.
inline constexpr std::uint32_t kCopterGuided = 4, kCopterLoiter = 5, kCopterLand = 9,
                               kCopterBrake = 17;

}  // namespace lapwing::mavlink
