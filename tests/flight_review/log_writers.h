// SPDX-License-Identifier: Apache-2.0
// Writers of flight logs, of code of their own: what the readers are tested with.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "framework/geometry/geodetic.h"
#include "tests/flight_review/recorded_flight.h"

namespace lapwing {

template <class T>
void put(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

inline GeodeticPoint place_of(const Eigen::Vector3d& p) {
  // Heights above the sea, the frame of the wave's origin.
  return to_geodetic({kWaveLatitude, kWaveLongitude, kWaveHeight}, p);
}

// --- ULog -----------------------------------------------------------------------------------

inline std::string ulog_record(char type, const std::string& body) {
  std::string out;
  put(out, static_cast<std::uint16_t>(body.size()));
  return out + type + body;
}

inline std::string ulog_head(std::uint64_t appended = 0, unsigned char incompatible = 0) {
  std::string out("ULog\x01\x12\x35\x01", 8), flags(40, '\0');
  put(out, std::uint64_t{0});
  flags[8] = static_cast<char>(incompatible | (appended ? 1 : 0));
  std::memcpy(flags.data() + 16, &appended, sizeof appended);
  return out + ulog_record('B', flags);
}

inline std::string ulog_format(const std::string& text) {
  return ulog_record('F', text);
}

inline std::string ulog_topic(std::uint16_t id, const std::string& name, char instance = 0) {
  std::string body(1, instance);
  put(body, id);
  return ulog_record('A', body + name);
}

inline std::string ulog_formats() {
  std::string out =
      ulog_format(
          "vehicle_local_position:uint64_t timestamp;double ref_lat;double ref_lon;float "
          "x;float y;float z;float vx;float vy;float vz;float ref_alt;bool xy_valid;bool "
          "z_valid;bool v_xy_valid;bool v_z_valid;bool xy_global;bool z_global;") +
      ulog_format("vehicle_attitude:uint64_t timestamp;float[4] q;") +
      ulog_format(
          "gimbal_device_attitude_status:uint64_t timestamp;float[4] q;uint16_t "
          "device_flags;") +
      ulog_format("camera_capture:uint64_t timestamp;uint32_t seq;");
  std::string name("char[3] sys_name"), info(1, static_cast<char>(name.size()));
  out += ulog_record('I', info + name + "PX4");
  return out + ulog_topic(1, "vehicle_local_position") + ulog_topic(2, "vehicle_attitude") +
         ulog_topic(3, "gimbal_device_attitude_status") + ulog_topic(4, "camera_capture");
}

inline std::uint64_t microseconds(double seconds) {
  return static_cast<std::uint64_t>(std::llround(1e6 * seconds));
}

inline void put_floats(std::string& out, std::initializer_list<double> values) {
  for (const double value : values) put(out, static_cast<float>(value));
}

inline std::string ulog_state(const RecordedState& s, bool global) {
  std::string out, body;
  put(body, std::uint16_t{1});
  put(body, microseconds(s.time));
  put(body, kWaveLatitude);
  put(body, kWaveLongitude);
  put_floats(body, {s.position.y(), s.position.x(), -s.position.z(), s.velocity.y(), s.velocity.x(),
                    -s.velocity.z(), kWaveHeight});
  for (const bool valid : {true, true, true, true, global, global}) put(body, valid);
  out += ulog_record('D', body);
  // North, east, down and forward, right, down.
  const double h = std::numbers::sqrt2 / 2;
  const Eigen::Quaterniond q = Eigen::Quaterniond(0, h, h, 0).conjugate() * s.orientation *
                               Eigen::Quaterniond(0, 1, 0, 0).conjugate();
  std::string attitude;
  put(attitude, std::uint16_t{2});
  put(attitude, microseconds(s.time));
  put_floats(attitude, {q.w(), q.x(), q.y(), q.z()});
  out += ulog_record('D', attitude);
  const Eigen::Quaterniond camera =
      Eigen::AngleAxisd(M_PI / 2 - s.camera.x(), Eigen::Vector3d::UnitZ()) *
      Eigen::AngleAxisd(s.camera.y(), Eigen::Vector3d::UnitY());
  std::string gimbal;
  put(gimbal, std::uint16_t{3});
  put(gimbal, microseconds(s.time));
  put_floats(gimbal, {camera.w(), camera.x(), camera.y(), camera.z()});
  put(gimbal, std::uint16_t{16});
  return out + ulog_record('D', gimbal);
}

inline std::string ulog_photograph(double time) {
  std::string body;
  put(body, std::uint16_t{4});
  put(body, microseconds(time));
  put(body, std::uint32_t{1});
  return ulog_record('D', body);
}

inline std::string ulog_of(const std::vector<RecordedState>& states, bool global = true,
                           const std::vector<double>& photographs = {}) {
  std::string out = ulog_head() + ulog_formats();
  for (const RecordedState& state : states) out += ulog_state(state, global);
  for (const double time : photographs) out += ulog_photograph(time);
  return out;
}

// --- DataFlash ------------------------------------------------------------------------------

inline std::string padded_text(std::string text, std::size_t size) {
  text.resize(size, '\0');
  return text;
}

inline std::string dataflash_kind(unsigned char number, unsigned char size, const char* name,
                                  const char* types, const char* labels) {
  std::string out("\xa3\x95\x80", 3);
  out += static_cast<char>(number);
  out += static_cast<char>(size);
  return out + padded_text(name, 4) + padded_text(types, 16) + padded_text(labels, 64);
}

inline std::string dataflash_head(unsigned char number) {
  std::string out("\xa3\x95", 2);
  return out + static_cast<char>(number);
}

inline std::string dataflash_of(const std::vector<RecordedState>& states) {
  std::string out = dataflash_kind(128, 89, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns") +
                    dataflash_kind(10, 36, "XKF1", "QBffffff", "TimeUS,C,VN,VE,VD,PN,PE,PD") +
                    dataflash_kind(11, 17, "ATT", "Qccc", "TimeUS,Roll,Pitch,Yaw") +
                    dataflash_kind(12, 24, "ORGN", "QBLLf", "TimeUS,Type,Lat,Lng,Alt") +
                    dataflash_kind(13, 19, "MNT", "Qff", "TimeUS,Pitch,YawE");
  out += dataflash_head(12);
  put(out, microseconds(states.front().time));
  put(out, std::uint8_t{0});
  put(out, static_cast<std::int32_t>(std::llround(1e7 * kWaveLatitude)));
  put(out, static_cast<std::int32_t>(std::llround(1e7 * kWaveLongitude)));
  put(out, static_cast<float>(kWaveHeight));
  for (const RecordedState& s : states) {
    for (const int core : {0, 1}) {  // the second core is off by 7 m
      out += dataflash_head(10);
      put(out, microseconds(s.time));
      put(out, static_cast<std::uint8_t>(core));
      put_floats(out, {s.velocity.y(), s.velocity.x(), -s.velocity.z(), s.position.y() + 7 * core,
                       s.position.x(), -s.position.z()});
    }
    out += dataflash_head(11);
    put(out, microseconds(s.time));
    const double heading = std::fmod(360 + 90 - s.yaw * 180 / M_PI, 360);
    for (const double angle : {0.0, 0.0, heading})
      put(out, static_cast<std::int16_t>(std::lround(100 * std::remainder(angle, 360))));
    out += dataflash_head(13);
    put(out, microseconds(s.time));
    put_floats(out, {s.camera.y() * 180 / M_PI, 90 - s.camera.x() * 180 / M_PI});
  }
  return out;
}

// --- Text -----------------------------------------------------------------------------------

template <class... Arguments>
std::string printed(const char* format, Arguments... arguments) {
  char text[512];
  std::snprintf(text, sizeof text, format, arguments...);
  return text;
}

// Airdata's headings, in feet and miles per hour as users in the United States have them.
inline std::string airdata_of(const std::vector<RecordedState>& states) {
  std::string out =
      "time(millisecond),datetime(utc),latitude,longitude,altitude_above_seaLevel(feet), "
      "xSpeed(mph), ySpeed(mph), zSpeed(mph), compass_heading(degrees), pitch(degrees), "
      "roll(degrees),isPhoto,gimbal_heading(degrees),gimbal_pitch(degrees)\r\n";
  for (const RecordedState& s : states) {
    const GeodeticPoint p = place_of(s.position);
    const double mph = 0.44704;
    out += printed(
        "%.3f,2024-05-12 09:30:00,%.9f,%.9f,%.4f,%.6f,%.6f,%.6f,%.4f,0,0,%d,%.4f,%.4f\r\n",
        1000 * s.time, p.latitude_deg, p.longitude_deg, p.altitude / 0.3048, s.velocity.y() / mph,
        s.velocity.x() / mph, -s.velocity.z() / mph, 90 - s.yaw * 180 / M_PI, 0,
        90 - s.camera.x() * 180 / M_PI, s.camera.y() * 180 / M_PI);
  }
  return out;
}

inline std::string gpx_of(const std::vector<RecordedState>& states) {
  std::string out =
      "<?xml version=\"1.0\"?>\n<gpx version=\"1.1\" creator=\"test\"><trk><trkseg>\n";
  for (const RecordedState& s : states) {
    const GeodeticPoint p = place_of(s.position);
    const int minutes = static_cast<int>(s.time / 60);
    out += printed(
        "<trkpt lat=\"%.9f\" lon=\"%.9f\"><ele>%.4f</ele>"
        "<time>2024-05-12T09:%02d:%09.6fZ</time></trkpt>\n",
        p.latitude_deg, p.longitude_deg, p.altitude, minutes, s.time - 60 * minutes);
  }
  return out + "</trkseg></trk></gpx>\n";
}

}  // namespace lapwing
