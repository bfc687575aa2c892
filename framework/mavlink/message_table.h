// SPDX-License-Identifier: Apache-2.0
// The messages that a live flight needs, of MAVLink's minimal, standard and common definitions:
// each with its fields, their types, lengths and units.
//
// Units are those of the wire: degE7 is 1e-7 degrees, cdeg 0.01 degrees, d% 0.1 percent.
#pragma once

#include <cstdint>

#include "framework/mavlink/message_layout.h"

namespace lapwing::mavlink {

// Numbers of the messages.
inline constexpr std::uint32_t kHeartbeat = 0;
inline constexpr std::uint32_t kSysStatus = 1;
inline constexpr std::uint32_t kSystemTime = 2;
inline constexpr std::uint32_t kAttitude = 30;
inline constexpr std::uint32_t kLocalPosition = 32;
inline constexpr std::uint32_t kGlobalPosition = 33;
inline constexpr std::uint32_t kMissionRequest = 40;
inline constexpr std::uint32_t kMissionCount = 44;
inline constexpr std::uint32_t kMissionClearAll = 45;
inline constexpr std::uint32_t kMissionAck = 47;
inline constexpr std::uint32_t kGlobalOrigin = 49;
inline constexpr std::uint32_t kMissionRequestInt = 51;
inline constexpr std::uint32_t kMissionItemInt = 73;
inline constexpr std::uint32_t kCommandInt = 75;
inline constexpr std::uint32_t kCommandLong = 76;
inline constexpr std::uint32_t kCommandAck = 77;
inline constexpr std::uint32_t kLocalTarget = 84;
inline constexpr std::uint32_t kGlobalTarget = 86;
inline constexpr std::uint32_t kTimesync = 111;
inline constexpr std::uint32_t kBatteryStatus = 147;
inline constexpr std::uint32_t kAutopilotVersion = 148;
inline constexpr std::uint32_t kEstimatorStatus = 230;
inline constexpr std::uint32_t kHomePosition = 242;
inline constexpr std::uint32_t kExtendedSysState = 245;
inline constexpr std::uint32_t kStatusText = 253;
inline constexpr std::uint32_t kGimbalManagerInformation = 280;
inline constexpr std::uint32_t kGimbalManagerSetAttitude = 282;
inline constexpr std::uint32_t kGimbalDeviceAttitude = 285;

namespace fields {

inline constexpr FieldEntry kHeartbeatFields[] = {
    {"type", FieldType::u8},          {"autopilot", FieldType::u8},
    {"base_mode", FieldType::u8},     {"custom_mode", FieldType::u32},
    {"system_status", FieldType::u8}, {"mavlink_version", FieldType::u8}};
inline constexpr FieldEntry kSysStatusFields[] = {
    {"onboard_control_sensors_present", FieldType::u32},
    {"onboard_control_sensors_enabled", FieldType::u32},
    {"onboard_control_sensors_health", FieldType::u32},
    {"load", FieldType::u16, 0, "d%"},
    {"voltage_battery", FieldType::u16, 0, "mV"},
    {"current_battery", FieldType::i16, 0, "cA"},
    {"battery_remaining", FieldType::i8, 0, "%"},
    {"drop_rate_comm", FieldType::u16, 0, "c%"},
    {"errors_comm", FieldType::u16},
    {"errors_count1", FieldType::u16},
    {"errors_count2", FieldType::u16},
    {"errors_count3", FieldType::u16},
    {"errors_count4", FieldType::u16},
    {"onboard_control_sensors_present_extended", FieldType::u32, 0, "", true},
    {"onboard_control_sensors_enabled_extended", FieldType::u32, 0, "", true},
    {"onboard_control_sensors_health_extended", FieldType::u32, 0, "", true}};
inline constexpr FieldEntry kSystemTimeFields[] = {{"time_unix_usec", FieldType::u64, 0, "us"},
                                                   {"time_boot_ms", FieldType::u32, 0, "ms"}};
inline constexpr FieldEntry kAttitudeFields[] = {
    {"time_boot_ms", FieldType::u32, 0, "ms"}, {"roll", FieldType::f32, 0, "rad"},
    {"pitch", FieldType::f32, 0, "rad"},       {"yaw", FieldType::f32, 0, "rad"},
    {"rollspeed", FieldType::f32, 0, "rad/s"}, {"pitchspeed", FieldType::f32, 0, "rad/s"},
    {"yawspeed", FieldType::f32, 0, "rad/s"}};
inline constexpr FieldEntry kLocalPositionFields[] = {{"time_boot_ms", FieldType::u32, 0, "ms"},
                                                      {"x", FieldType::f32, 0, "m"},
                                                      {"y", FieldType::f32, 0, "m"},
                                                      {"z", FieldType::f32, 0, "m"},
                                                      {"vx", FieldType::f32, 0, "m/s"},
                                                      {"vy", FieldType::f32, 0, "m/s"},
                                                      {"vz", FieldType::f32, 0, "m/s"}};
inline constexpr FieldEntry kGlobalPositionFields[] = {
    {"time_boot_ms", FieldType::u32, 0, "ms"}, {"lat", FieldType::i32, 0, "degE7"},
    {"lon", FieldType::i32, 0, "degE7"},       {"alt", FieldType::i32, 0, "mm"},
    {"relative_alt", FieldType::i32, 0, "mm"}, {"vx", FieldType::i16, 0, "cm/s"},
    {"vy", FieldType::i16, 0, "cm/s"},         {"vz", FieldType::i16, 0, "cm/s"},
    {"hdg", FieldType::u16, 0, "cdeg"}};
inline constexpr FieldEntry kMissionRequestFields[] = {
    {"target_system", FieldType::u8},
    {"target_component", FieldType::u8},
    {"seq", FieldType::u16},
    {"mission_type", FieldType::u8, 0, "", true}};
inline constexpr FieldEntry kMissionCountFields[] = {{"target_system", FieldType::u8},
                                                     {"target_component", FieldType::u8},
                                                     {"count", FieldType::u16},
                                                     {"mission_type", FieldType::u8, 0, "", true},
                                                     {"opaque_id", FieldType::u32, 0, "", true}};
inline constexpr FieldEntry kMissionClearAllFields[] = {
    {"target_system", FieldType::u8},
    {"target_component", FieldType::u8},
    {"mission_type", FieldType::u8, 0, "", true}};
inline constexpr FieldEntry kMissionAckFields[] = {{"target_system", FieldType::u8},
                                                   {"target_component", FieldType::u8},
                                                   {"type", FieldType::u8},
                                                   {"mission_type", FieldType::u8, 0, "", true},
                                                   {"opaque_id", FieldType::u32, 0, "", true}};
inline constexpr FieldEntry kGlobalOriginFields[] = {{"latitude", FieldType::i32, 0, "degE7"},
                                                     {"longitude", FieldType::i32, 0, "degE7"},
                                                     {"altitude", FieldType::i32, 0, "mm"},
                                                     {"time_usec", FieldType::u64, 0, "us", true}};
inline constexpr FieldEntry kMissionRequestIntFields[] = {
    {"target_system", FieldType::u8},
    {"target_component", FieldType::u8},
    {"seq", FieldType::u16},
    {"mission_type", FieldType::u8, 0, "", true}};
inline constexpr FieldEntry kMissionItemIntFields[] = {
    {"target_system", FieldType::u8},
    {"target_component", FieldType::u8},
    {"seq", FieldType::u16},
    {"frame", FieldType::u8},
    {"command", FieldType::u16},
    {"current", FieldType::u8},
    {"autocontinue", FieldType::u8},
    {"param1", FieldType::f32},
    {"param2", FieldType::f32},
    {"param3", FieldType::f32},
    {"param4", FieldType::f32},
    {"x", FieldType::i32},
    {"y", FieldType::i32},
    {"z", FieldType::f32},
    {"mission_type", FieldType::u8, 0, "", true}};
inline constexpr FieldEntry kCommandIntFields[] = {{"target_system", FieldType::u8},
                                                   {"target_component", FieldType::u8},
                                                   {"frame", FieldType::u8},
                                                   {"command", FieldType::u16},
                                                   {"current", FieldType::u8},
                                                   {"autocontinue", FieldType::u8},
                                                   {"param1", FieldType::f32},
                                                   {"param2", FieldType::f32},
                                                   {"param3", FieldType::f32},
                                                   {"param4", FieldType::f32},
                                                   {"x", FieldType::i32},
                                                   {"y", FieldType::i32},
                                                   {"z", FieldType::f32}};
inline constexpr FieldEntry kCommandLongFields[] = {
    {"target_system", FieldType::u8}, {"target_component", FieldType::u8},
    {"command", FieldType::u16},      {"confirmation", FieldType::u8},
    {"param1", FieldType::f32},       {"param2", FieldType::f32},
    {"param3", FieldType::f32},       {"param4", FieldType::f32},
    {"param5", FieldType::f32},       {"param6", FieldType::f32},
    {"param7", FieldType::f32}};
inline constexpr FieldEntry kCommandAckFields[] = {
    {"command", FieldType::u16},
    {"result", FieldType::u8},
    {"progress", FieldType::u8, 0, "%", true},
    {"result_param2", FieldType::i32, 0, "", true},
    {"target_system", FieldType::u8, 0, "", true},
    {"target_component", FieldType::u8, 0, "", true}};
inline constexpr FieldEntry kLocalTargetFields[] = {{"time_boot_ms", FieldType::u32, 0, "ms"},
                                                    {"target_system", FieldType::u8},
                                                    {"target_component", FieldType::u8},
                                                    {"coordinate_frame", FieldType::u8},
                                                    {"type_mask", FieldType::u16},
                                                    {"x", FieldType::f32, 0, "m"},
                                                    {"y", FieldType::f32, 0, "m"},
                                                    {"z", FieldType::f32, 0, "m"},
                                                    {"vx", FieldType::f32, 0, "m/s"},
                                                    {"vy", FieldType::f32, 0, "m/s"},
                                                    {"vz", FieldType::f32, 0, "m/s"},
                                                    {"afx", FieldType::f32, 0, "m/s/s"},
                                                    {"afy", FieldType::f32, 0, "m/s/s"},
                                                    {"afz", FieldType::f32, 0, "m/s/s"},
                                                    {"yaw", FieldType::f32, 0, "rad"},
                                                    {"yaw_rate", FieldType::f32, 0, "rad/s"}};
inline constexpr FieldEntry kGlobalTargetFields[] = {{"time_boot_ms", FieldType::u32, 0, "ms"},
                                                     {"target_system", FieldType::u8},
                                                     {"target_component", FieldType::u8},
                                                     {"coordinate_frame", FieldType::u8},
                                                     {"type_mask", FieldType::u16},
                                                     {"lat_int", FieldType::i32, 0, "degE7"},
                                                     {"lon_int", FieldType::i32, 0, "degE7"},
                                                     {"alt", FieldType::f32, 0, "m"},
                                                     {"vx", FieldType::f32, 0, "m/s"},
                                                     {"vy", FieldType::f32, 0, "m/s"},
                                                     {"vz", FieldType::f32, 0, "m/s"},
                                                     {"afx", FieldType::f32, 0, "m/s/s"},
                                                     {"afy", FieldType::f32, 0, "m/s/s"},
                                                     {"afz", FieldType::f32, 0, "m/s/s"},
                                                     {"yaw", FieldType::f32, 0, "rad"},
                                                     {"yaw_rate", FieldType::f32, 0, "rad/s"}};
inline constexpr FieldEntry kTimesyncFields[] = {{"tc1", FieldType::i64, 0, "ns"},
                                                 {"ts1", FieldType::i64, 0, "ns"},
                                                 {"target_system", FieldType::u8, 0, "", true},
                                                 {"target_component", FieldType::u8, 0, "", true}};
inline constexpr FieldEntry kBatteryStatusFields[] = {
    {"id", FieldType::u8},
    {"battery_function", FieldType::u8},
    {"type", FieldType::u8},
    {"temperature", FieldType::i16, 0, "cdegC"},
    {"voltages", FieldType::u16, 10, "mV"},
    {"current_battery", FieldType::i16, 0, "cA"},
    {"current_consumed", FieldType::i32, 0, "mAh"},
    {"energy_consumed", FieldType::i32, 0, "hJ"},
    {"battery_remaining", FieldType::i8, 0, "%"},
    {"time_remaining", FieldType::i32, 0, "s", true},
    {"charge_state", FieldType::u8, 0, "", true},
    {"voltages_ext", FieldType::u16, 4, "mV", true},
    {"mode", FieldType::u8, 0, "", true},
    {"fault_bitmask", FieldType::u32, 0, "", true}};
inline constexpr FieldEntry kAutopilotVersionFields[] = {
    {"capabilities", FieldType::u64},
    {"flight_sw_version", FieldType::u32},
    {"middleware_sw_version", FieldType::u32},
    {"os_sw_version", FieldType::u32},
    {"board_version", FieldType::u32},
    {"flight_custom_version", FieldType::u8, 8},
    {"middleware_custom_version", FieldType::u8, 8},
    {"os_custom_version", FieldType::u8, 8},
    {"vendor_id", FieldType::u16},
    {"product_id", FieldType::u16},
    {"uid", FieldType::u64},
    {"uid2", FieldType::u8, 18, "", true}};
inline constexpr FieldEntry kEstimatorStatusFields[] = {
    {"time_usec", FieldType::u64, 0, "us"},
    {"flags", FieldType::u16},
    {"vel_ratio", FieldType::f32},
    {"pos_horiz_ratio", FieldType::f32},
    {"pos_vert_ratio", FieldType::f32},
    {"mag_ratio", FieldType::f32},
    {"hagl_ratio", FieldType::f32},
    {"tas_ratio", FieldType::f32},
    {"pos_horiz_accuracy", FieldType::f32, 0, "m"},
    {"pos_vert_accuracy", FieldType::f32, 0, "m"}};
inline constexpr FieldEntry kHomePositionFields[] = {{"latitude", FieldType::i32, 0, "degE7"},
                                                     {"longitude", FieldType::i32, 0, "degE7"},
                                                     {"altitude", FieldType::i32, 0, "mm"},
                                                     {"x", FieldType::f32, 0, "m"},
                                                     {"y", FieldType::f32, 0, "m"},
                                                     {"z", FieldType::f32, 0, "m"},
                                                     {"q", FieldType::f32, 4},
                                                     {"approach_x", FieldType::f32, 0, "m"},
                                                     {"approach_y", FieldType::f32, 0, "m"},
                                                     {"approach_z", FieldType::f32, 0, "m"},
                                                     {"time_usec", FieldType::u64, 0, "us", true}};
inline constexpr FieldEntry kExtendedSysStateFields[] = {{"vtol_state", FieldType::u8},
                                                         {"landed_state", FieldType::u8}};
inline constexpr FieldEntry kStatusTextFields[] = {{"severity", FieldType::u8},
                                                   {"text", FieldType::text, 50},
                                                   {"id", FieldType::u16, 0, "", true},
                                                   {"chunk_seq", FieldType::u8, 0, "", true}};
inline constexpr FieldEntry kGimbalManagerInformationFields[] = {
    {"time_boot_ms", FieldType::u32, 0, "ms"}, {"cap_flags", FieldType::u32},
    {"gimbal_device_id", FieldType::u8},       {"roll_min", FieldType::f32, 0, "rad"},
    {"roll_max", FieldType::f32, 0, "rad"},    {"pitch_min", FieldType::f32, 0, "rad"},
    {"pitch_max", FieldType::f32, 0, "rad"},   {"yaw_min", FieldType::f32, 0, "rad"},
    {"yaw_max", FieldType::f32, 0, "rad"}};
inline constexpr FieldEntry kGimbalManagerSetAttitudeFields[] = {
    {"target_system", FieldType::u8},
    {"target_component", FieldType::u8},
    {"flags", FieldType::u32},
    {"gimbal_device_id", FieldType::u8},
    {"q", FieldType::f32, 4},
    {"angular_velocity_x", FieldType::f32, 0, "rad/s"},
    {"angular_velocity_y", FieldType::f32, 0, "rad/s"},
    {"angular_velocity_z", FieldType::f32, 0, "rad/s"}};
inline constexpr FieldEntry kGimbalDeviceAttitudeFields[] = {
    {"target_system", FieldType::u8},
    {"target_component", FieldType::u8},
    {"time_boot_ms", FieldType::u32, 0, "ms"},
    {"flags", FieldType::u16},
    {"q", FieldType::f32, 4},
    {"angular_velocity_x", FieldType::f32, 0, "rad/s"},
    {"angular_velocity_y", FieldType::f32, 0, "rad/s"},
    {"angular_velocity_z", FieldType::f32, 0, "rad/s"},
    {"failure_flags", FieldType::u32},
    {"delta_yaw", FieldType::f32, 0, "rad", true},
    {"delta_yaw_velocity", FieldType::f32, 0, "rad/s", true},
    {"gimbal_device_id", FieldType::u8, 0, "", true}};

}  // namespace fields

inline constexpr MessageEntry kMessages[] = {
    message(kHeartbeat, "HEARTBEAT", fields::kHeartbeatFields),
    message(kSysStatus, "SYS_STATUS", fields::kSysStatusFields),
    message(kSystemTime, "SYSTEM_TIME", fields::kSystemTimeFields),
    message(kAttitude, "ATTITUDE", fields::kAttitudeFields),
    message(kLocalPosition, "LOCAL_POSITION_NED", fields::kLocalPositionFields),
    message(kGlobalPosition, "GLOBAL_POSITION_INT", fields::kGlobalPositionFields),
    message(kMissionRequest, "MISSION_REQUEST", fields::kMissionRequestFields),
    message(kMissionCount, "MISSION_COUNT", fields::kMissionCountFields),
    message(kMissionClearAll, "MISSION_CLEAR_ALL", fields::kMissionClearAllFields),
    message(kMissionAck, "MISSION_ACK", fields::kMissionAckFields),
    message(kGlobalOrigin, "GPS_GLOBAL_ORIGIN", fields::kGlobalOriginFields),
    message(kMissionRequestInt, "MISSION_REQUEST_INT", fields::kMissionRequestIntFields),
    message(kMissionItemInt, "MISSION_ITEM_INT", fields::kMissionItemIntFields),
    message(kCommandInt, "COMMAND_INT", fields::kCommandIntFields),
    message(kCommandLong, "COMMAND_LONG", fields::kCommandLongFields),
    message(kCommandAck, "COMMAND_ACK", fields::kCommandAckFields),
    message(kLocalTarget, "SET_POSITION_TARGET_LOCAL_NED", fields::kLocalTargetFields),
    message(kGlobalTarget, "SET_POSITION_TARGET_GLOBAL_INT", fields::kGlobalTargetFields),
    message(kTimesync, "TIMESYNC", fields::kTimesyncFields),
    message(kBatteryStatus, "BATTERY_STATUS", fields::kBatteryStatusFields),
    message(kAutopilotVersion, "AUTOPILOT_VERSION", fields::kAutopilotVersionFields),
    message(kEstimatorStatus, "ESTIMATOR_STATUS", fields::kEstimatorStatusFields),
    message(kHomePosition, "HOME_POSITION", fields::kHomePositionFields),
    message(kExtendedSysState, "EXTENDED_SYS_STATE", fields::kExtendedSysStateFields),
    message(kStatusText, "STATUSTEXT", fields::kStatusTextFields),
    message(kGimbalManagerInformation, "GIMBAL_MANAGER_INFORMATION",
            fields::kGimbalManagerInformationFields),
    message(kGimbalManagerSetAttitude, "GIMBAL_MANAGER_SET_ATTITUDE",
            fields::kGimbalManagerSetAttitudeFields),
    message(kGimbalDeviceAttitude, "GIMBAL_DEVICE_ATTITUDE_STATUS",
            fields::kGimbalDeviceAttitudeFields),
};

// Null for a message that is not in the table.
constexpr const MessageEntry* find_message(std::uint32_t id) {
  for (const MessageEntry& entry : kMessages)
    if (entry.id == id) return &entry;
  return nullptr;
}
constexpr const MessageEntry* find_message(std::string_view name) {
  for (const MessageEntry& entry : kMessages)
    if (entry.name == name) return &entry;
  return nullptr;
}

}  // namespace lapwing::mavlink
