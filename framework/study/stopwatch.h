// SPDX-License-Identifier: Apache-2.0
// Wall-clock time of a piece of work.
#pragma once

#include <chrono>

namespace lapwing {

class Stopwatch {
 public:
  // s, since it was made.
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun_).count();
  }

 private:
  std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
};

}  // namespace lapwing
