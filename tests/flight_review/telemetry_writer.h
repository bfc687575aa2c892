// SPDX-License-Identifier: Apache-2.0
// A writer of telemetry logs, of code of its own: packets of MAVLink 1 and 2 from bytes, with the
// CRC_EXTRA of MAVLink's published common definitions.
#pragma once

#include <functional>

#include "tests/flight_review/log_writers.h"

namespace lapwing {

inline constexpr double kTelemetryBegin = 1.7e9;  // s since 1970, of time 0 of a state

struct WireSender {
  std::uint8_t system = 1, component = 1, version = 2, sequence = 0;
};

inline std::uint16_t wire_checksum(const std::string& bytes) {
  std::uint16_t crc = 0xffff;
  for (const char c : bytes) {
    crc = static_cast<std::uint16_t>(crc ^ static_cast<std::uint8_t>(c));
    for (int bit = 0; bit < 8; ++bit)
      crc = static_cast<std::uint16_t>(crc & 1 ? crc >> 1 ^ 0x8408 : crc >> 1);
  }
  return crc;
}

inline std::string wire_packet(std::uint32_t message, std::uint8_t crc_extra,
                               const std::string& payload, WireSender& sender) {
  std::string out;
  put(out, static_cast<std::uint8_t>(payload.size()));
  if (sender.version == 2) out += std::string(2, '\0');
  put(out, sender.sequence++);
  put(out, sender.system);
  put(out, sender.component);
  for (int i = 0; i < (sender.version == 2 ? 3 : 1); ++i)
    put(out, static_cast<std::uint8_t>(message >> 8 * i & 255));
  out += payload;
  const std::uint16_t crc = wire_checksum(out + static_cast<char>(crc_extra));
  put(out, crc);
  return (sender.version == 2 ? "\xfd" : "\xfe") + out;
}

// `time`: s of the states, when the packet was received.
inline std::string tlog_record(double time, const std::string& packet) {
  const std::uint64_t stamp = microseconds(kTelemetryBegin + time);
  std::string out;
  for (int shift = 56; shift >= 0; shift -= 8) out += static_cast<char>(stamp >> shift & 255);
  return out + packet;
}

inline std::uint32_t boot_ms(double time) {
  return static_cast<std::uint32_t>(std::llround(1000 * time));
}

inline std::string wire_heartbeat(WireSender& sender, std::uint32_t mode = 4,
                                  std::uint8_t autopilot = 12, std::uint8_t type = 2) {
  std::string body;
  put(body, mode);
  for (const int byte : {int{type}, int{autopilot}, 129, 4, 3})
    put(body, static_cast<std::uint8_t>(byte));
  return wire_packet(0, 50, body, sender);
}

inline std::string wire_local(WireSender& sender, const RecordedState& s) {
  std::string body;
  put(body, boot_ms(s.time));
  put_floats(body, {s.position.y(), s.position.x(), -s.position.z(), s.velocity.y(), s.velocity.x(),
                    -s.velocity.z()});
  return wire_packet(32, 185, body, sender);
}

inline std::int32_t wire_degrees(double degrees) {
  return static_cast<std::int32_t>(std::llround(1e7 * degrees));
}

inline std::string wire_global(WireSender& sender, const RecordedState& s) {
  const GeodeticPoint p = place_of(s.position);
  std::string body;
  put(body, boot_ms(s.time));
  put(body, wire_degrees(p.latitude_deg));
  put(body, wire_degrees(p.longitude_deg));
  put(body, static_cast<std::int32_t>(std::llround(1000 * p.altitude)));
  put(body, static_cast<std::int32_t>(std::llround(1000 * (p.altitude - kWaveHeight))));
  for (const double v : {s.velocity.y(), s.velocity.x(), -s.velocity.z()})
    put(body, static_cast<std::int16_t>(std::lround(100 * v)));
  put(body, std::uint16_t{65535});
  return wire_packet(33, 104, body, sender);
}

inline std::string wire_attitude(WireSender& sender, const RecordedState& s) {
  const Eigen::Matrix3d r = s.orientation.toRotationMatrix();
  std::string body;
  put(body, boot_ms(s.time));
  put_floats(body, {std::atan2(r(2, 1), r(2, 2)), std::asin(std::clamp(r(2, 0), -1.0, 1.0)),
                    std::remainder(M_PI / 2 - std::atan2(r(1, 0), r(0, 0)), 2 * M_PI),
                    s.body_rates.x(), -s.body_rates.y(), -s.body_rates.z()});
  return wire_packet(30, 39, body, sender);
}

// With its yaw locked to north.
inline std::string wire_gimbal(WireSender& sender, const RecordedState& s) {
  const double y = 0.5 * (M_PI / 2 - s.camera.x()), p = 0.5 * s.camera.y();
  std::string body;
  put(body, boot_ms(s.time));
  put_floats(body, {std::cos(y) * std::cos(p), -std::sin(y) * std::sin(p),
                    std::cos(y) * std::sin(p), std::sin(y) * std::cos(p), 0, 0, 0});
  put(body, std::uint32_t{0});
  put(body, std::uint16_t{16});
  body += std::string(2, '\0');
  return wire_packet(285, 137, body, sender);
}

inline std::string wire_origin(WireSender& sender) {
  std::string body;
  put(body, wire_degrees(kWaveLatitude));
  put(body, wire_degrees(kWaveLongitude));
  put(body, static_cast<std::int32_t>(std::llround(1000 * kWaveHeight)));
  return wire_packet(49, 39, body, sender);
}

// As a vehicle of PX4 tells of its flight; packets take `late` (s), by their number.
inline std::string tlog_of(const std::vector<RecordedState>& states,
                           const std::function<double(std::size_t)>& late = {},
                           WireSender sender = {}) {
  std::string out = tlog_record(states.front().time, wire_heartbeat(sender));
  out += tlog_record(states.front().time, wire_origin(sender));
  for (std::size_t i = 0; i < states.size(); ++i) {
    const double time = states[i].time + (late ? late(i) : 0);
    for (const auto& packet : {wire_local, wire_global, wire_attitude, wire_gimbal})
      out += tlog_record(time, packet(sender, states[i]));
  }
  return out;
}

}  // namespace lapwing
