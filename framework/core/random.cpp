// SPDX-License-Identifier: Apache-2.0
#include "framework/core/random.h"

#include <bit>
#include <cmath>

#include "framework/core/error.h"

namespace lapwing {

namespace {

// Steele, Lea and Flood 2014: spreads any seed, zero included, over 64 well-mixed bits.
std::uint64_t splitmix64(std::uint64_t& state) {
  state += 0x9e3779b97f4a7c15ULL;
  std::uint64_t z = state;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

}  // namespace

Random::Random(std::uint64_t seed) {
  for (std::uint64_t& word : state_) word = splitmix64(seed);
}

std::uint64_t Random::bits() {
  auto& s = state_;
  const std::uint64_t result = std::rotl(s[0] + s[3], 23) + s[0];
  const std::uint64_t t = s[1] << 17;
  s[2] ^= s[0];
  s[3] ^= s[1];
  s[1] ^= s[2];
  s[0] ^= s[3];
  s[2] ^= t;
  s[3] = std::rotl(s[3], 45);
  return result;
}

double Random::uniform() {
  return static_cast<double>(bits() >> 11) * 0x1.0p-53;
}

double Random::uniform(double low, double high) {
  if (!(low < high) || !std::isfinite(high - low)) {
    throw Error("Random::uniform: the interval is empty or not finite");
  }
  const double value = low + uniform() * (high - low);
  return value < high ? value : std::nextafter(high, low);  // the sum may round up to `high`
}

std::int64_t Random::integer(std::int64_t low, std::int64_t high) {
  if (low > high) throw Error("Random::integer: the interval is empty");
  const std::uint64_t span = static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low) + 1;
  if (span == 0) return static_cast<std::int64_t>(bits());  // every 64-bit number
  // The lowest 2^64 mod span values would make some results likelier; draw again.
  const std::uint64_t reject_below = (0 - span) % span;
  std::uint64_t draw = bits();
  while (draw < reject_below) draw = bits();
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(low) + draw % span);
}

double Random::normal() {
  // Marsaglia's polar method; the second number is dropped, so that the state is all there is.
  for (;;) {
    const double u = 2.0 * uniform() - 1.0;
    const double v = 2.0 * uniform() - 1.0;
    const double s = u * u + v * v;
    if (s > 0.0 && s < 1.0) return u * std::sqrt(-2.0 * std::log(s) / s);
  }
}

Random Random::split(std::uint64_t index) const {
  std::uint64_t seed = index;
  for (const std::uint64_t word : state_) {
    seed ^= word;
    seed = splitmix64(seed);
  }
  return Random(seed);
}

}  // namespace lapwing
