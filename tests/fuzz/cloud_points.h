// SPDX-License-Identifier: Apache-2.0
// A point cloud from memory, whatever the bytes: its points or an InputError.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "framework/core/error.h"
#include "framework/survey/cloud_reader.h"

namespace lapwing {

// Reads all points in batches. Aborts where there are more than the header says, or more than the
// bytes could hold: a point takes two bytes at least, and packed ones a hundredth of that.
inline void read_all_points(const std::uint8_t* data, std::size_t size, const char* ending,
                            const CloudFileOptions& options = {}) {
  try {
    const auto reader = open_cloud(
        StreamBytes({reinterpret_cast<const char*>(data), size}, "input"), ending, options);
    std::vector<CloudPoint> batch(100);
    std::uint64_t read = 0;
    for (std::size_t count = 0; (count = reader->read(batch)) > 0;) read += count;
    if (reader->header().points && read != *reader->header().points) std::abort();
    if (read > 100 * static_cast<std::uint64_t>(size)) std::abort();
  } catch (const InputError&) {
  }
}

}  // namespace lapwing
