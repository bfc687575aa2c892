// SPDX-License-Identifier: Apache-2.0
// Collects the samples of a log as a file states them, and makes sound series of them.
#pragma once

#include <initializer_list>
#include <span>
#include <string>

#include "framework/flight_log/flight_log.h"

namespace lapwing {

class LogBuilder {
 public:
  // `format`: the reader's name; `bytes`: the size of the file.
  LogBuilder(std::string format, std::size_t bytes);

  // A sample of a quantity (log_quantities) at a time, s. Samples with numbers that are not finite
  // are left out and counted. Throws Error for a wrong name or number of values.
  void add(const char* quantity, double time, std::span<const double> values);
  void add(const char* quantity, double time, std::initializer_list<double> values) {
    add(quantity, time, std::span<const double>(values.begin(), values.size()));
  }
  // What the file calls the quantity.
  void name_source(const char* quantity, const std::string& source);
  bool has(const char* quantity) const;

  // Of the whole log; what is not a series is filled in directly.
  FlightLog log;

  // Brings samples into the order of their times. Drops all but the first of one time, and those
  // far from the time of the recording, and says in the remarks how many were left out. A series
  // without a sample is none. A log with orientations and without a yaw gets theirs.
  FlightLog finish();

 private:
  struct Dropped {
    std::size_t not_finite = 0, same_time = 0, out_of_order = 0, far = 0;
  };
  std::map<std::string, Dropped> dropped_;
};

// Turns of autopilots, whose local frame is north, east, down and whose body is forward, right,
// down, into those of logs; w first.
Eigen::Vector4d orientation_of_ned(double w, double x, double y, double z);
// The same of roll, pitch and yaw about x, y and z of the body (rad; yaw 0 north, clockwise).
Eigen::Vector4d orientation_of_euler(double roll, double pitch, double yaw);
// A heading that counts from north clockwise, rad, as one from east counter-clockwise.
double yaw_of_heading(double heading);

}  // namespace lapwing
