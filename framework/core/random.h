// SPDX-License-Identifier: Apache-2.0
// Seeded random numbers with the same stream on every platform and standard library.
#pragma once

#include <array>
#include <cstdint>

namespace lapwing {

// xoshiro256++ (Blackman and Vigna, 2019), seeded through splitmix64. Not thread-safe; give each
// thread or task its own with `split`.
class Random {
 public:
  explicit Random(std::uint64_t seed);

  std::uint64_t bits();
  double uniform();                                           // in [0, 1)
  double uniform(double low, double high);                    // in [low, high)
  std::int64_t integer(std::int64_t low, std::int64_t high);  // in [low, high], unbiased
  double normal();                                            // mean 0, standard deviation 1
  // An independent stream, a function of this one's state and `index` alone.
  Random split(std::uint64_t index) const;

 private:
  std::array<std::uint64_t, 4> state_;
};

}  // namespace lapwing
