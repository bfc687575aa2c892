// SPDX-License-Identifier: Apache-2.0
// What was recorded of a flight, whatever the format: named series of numbers with their times.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "framework/geometry/geodetic_origin.h"

namespace lapwing {

// A quantity that logs hold. Frames: the log's local frame has x east, y north, z up; the body has
// x forward, y left, z up; yaw is about z, 0 along east, counter-clockwise.
struct LogQuantity {
  const char* name;
  int width;         // numbers per sample
  const char* unit;  // of each number; "" where they differ
  const char* summary;
};
// All of them, in the order of listings.
const std::vector<LogQuantity>& log_quantities();
// Throws Error for an unknown name.
const LogQuantity& log_quantity(std::string_view name);

struct LogSeries {
  std::string source;          // what the file calls it: "vehicle_local_position"
  std::vector<double> times;   // s of the log's clock, strictly increasing
  std::vector<double> values;  // `width` numbers for each time, one after the other, finite

  std::size_t size() const { return times.size(); }
};

struct LogMessage {
  double time = 0;   // s of the log's clock
  std::string text;  // as it was recorded
};

// Records of one kind that the file holds.
struct LogRecords {
  std::string name;
  std::size_t count = 0;
};

// A span of the log's clock in which the recorder lost data.
struct LogGap {
  double time = 0;      // s, of its end
  double duration = 0;  // s
};

struct FlightLog {
  std::string format;                       // the reader's name
  std::string recorder;                     // what wrote it, as far as it says: "PX4 1.15.0"
  std::string clock;                        // what time 0 is, in words: "the autopilot's boot"
  std::optional<double> utc;                // s since 1970, of time 0
  std::map<std::string, LogSeries> series;  // by the names of log_quantities()
  // What the heights of `place` and `gps` are above; absent: the file does not tell.
  std::optional<HeightOf> heights;
  // Where `position` is 0, 0, 0, its height above what `heights` says; absent: not known.
  std::optional<GeodeticPoint> reference;
  std::vector<double> photographs;  // s, when images were taken, in order
  std::vector<LogMessage> messages;
  std::vector<LogRecords> records;
  std::vector<LogGap> gaps;
  std::vector<std::string> remarks;  // sentences: what was left out, what is doubtful
  // How far the bytes could be read. `damage` says what is wrong; empty: the file is whole.
  std::size_t bytes = 0, bytes_read = 0;
  std::string damage;

  // Null where the log has none of it.
  const LogSeries* find(std::string_view name) const;
  // First and last time of all series, s; 0 and 0 where there are none.
  double start() const;
  double finish() const;
};

// What of the above the log does not keep, in words; empty where it is sound. For readers of one's
// own and for tests.
std::vector<std::string> faults_of(const FlightLog& log);

// The numbers at a time, linear between samples; angles (yaw, camera, yaw_setpoint) the shorter
// way, orientations along the shortest turn. Nothing outside of the series and in gaps between its
// samples longer than `longest_gap` (s).
std::optional<Eigen::VectorXd> value_at(const FlightLog& log, std::string_view name, double time,
                                        double longest_gap = 1);

}  // namespace lapwing
