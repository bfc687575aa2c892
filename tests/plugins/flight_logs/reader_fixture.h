// SPDX-License-Identifier: Apache-2.0
// Readers by their names, and what they read of a flight that is known.
#pragma once

#include <gmock/gmock.h>

#include <filesystem>

#include "framework/core/files.h"
#include "framework/flight_log/flight_log_reader.h"
#include "framework/plugin/registry.h"
#include "tests/flight_review/log_writers.h"

namespace lapwing {

inline std::unique_ptr<FlightLogReader> reader_named(const std::string& name,
                                                     const Value& parameters = {}) {
  static const Registry registry({LAPWING_BUILD_DIR "/lib/plugins"});
  return registry.create<FlightLogReader>(name, parameters);
}

inline std::vector<RecordedState> short_flight() {
  return recorded(ideal_flight(wave_plan(3), 10, 0.5, 0.5), {.clock = 100});
}

// What a reader says of bytes that it refuses; "" where it does not.
inline std::string refusal_of(const FlightLogReader& reader, const std::string& bytes) {
  try {
    reader.read(bytes);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// The numbers of a sample.
inline Eigen::VectorXd row_of(const FlightLog& log, const char* name, std::size_t i) {
  const int width = log_quantity(name).width;
  return Eigen::Map<const Eigen::VectorXd>(
      &log.find(name)->values[i * static_cast<std::size_t>(width)], width);
}

// Cut at every byte: a sound log, or a message. How many gave a log.
inline std::size_t read_cut(const FlightLogReader& reader, const std::string& bytes) {
  std::size_t read = 0;
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    try {
      const FlightLog log = reader.read(std::string_view(bytes).substr(0, size));
      EXPECT_THAT(faults_of(log), testing::IsEmpty()) << size;
      EXPECT_LE(log.bytes_read, size);
      ++read;
    } catch (const InputError& error) {
      EXPECT_GT(std::string(error.what()).size(), 10u) << size;
    }
  }
  return read;
}

// Where the inputs that nobody here made are; "" where they are not.
inline std::filesystem::path shared_log(const std::string& name) {
  const char* folder = std::getenv("LAPWING_DATA");
  for (const std::filesystem::path& root :
       {std::filesystem::path(folder ? folder : ""),
        std::filesystem::path(LAPWING_SOURCE_DIR) / "../shared/data"}) {
    std::filesystem::path file = root / "flight_logs" / name;
    if (std::filesystem::is_regular_file(file)) return file;
  }
  return {};
}

}  // namespace lapwing
