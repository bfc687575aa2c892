// SPDX-License-Identifier: Apache-2.0
#include "framework/verify/drone_distance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "framework/core/random.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

// From place to place at random, every `step` s.
TimedPath wandering(std::uint64_t seed, double start, double step, int count) {
  Random random(seed);
  TimedPath path;
  path.climb = 5;
  Vector3d place(random.uniform(-20, 20), random.uniform(-20, 20), random.uniform(10, 30));
  for (int k = 0; k < count; ++k) {
    path.times.push_back(start + k * step);
    path.places.push_back(place);
    Vector3d way;
    for (int axis = 0; axis < 3; ++axis) way[axis] = random.uniform(-0.3, 0.3);
    path.step = std::max(path.step, way.norm());
    place += way;
  }
  return path;
}

Vector3d place_at(const TimedPath& path, double time) {
  const auto k = static_cast<std::size_t>((time - path.times[0]) / (path.times[1] - path.times[0]));
  if (k + 1 >= path.times.size()) return path.places.back();
  const double share = (time - path.times[k]) / (path.times[k + 1] - path.times[k]);
  return path.places[k] + share * (path.places[k + 1] - path.places[k]);
}

TEST(DroneDistance, IsTheLeastOfDenseSamples) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const TimedPath a = wandering(seed, 0, 0.1, 2000), b = wandering(seed + 100, 3.03, 0.1, 1500);
    double least = std::numeric_limits<double>::infinity();
    for (double time = 3.03; time < 152.9; time += 0.01)
      least = std::min(least, (place_at(a, time) - place_at(b, time)).norm());
    // While one of them is on the line below its end, it may be nearer than in flight.
    const Approach found = nearest_approach(a, b);
    EXPECT_LE(found.distance, least + 1e-9) << seed;
    if (found.time > 3.03 && found.time < 152.9) {
      EXPECT_NEAR(found.distance, least, 0.01) << seed;
    }
    const Approach other = nearest_approach(b, a);
    EXPECT_NEAR(other.distance, found.distance, 1e-12);
    EXPECT_NEAR(other.time, found.time, 1e-9);
  }
}

// Two clocks whose times are equal but for rounding leave spans that nothing halves.
TEST(DroneDistance, EndsWhereTimesDifferByRoundingAlone) {
  TimedPath a = wandering(1, 0, 0.1, 2000), b = wandering(2, 0, 0.1, 2000);
  for (double& time : b.times) time = std::nextafter(time, 1e9);
  for (std::size_t k = 0; k < b.times.size(); k += 2) b.times[k] = std::nextafter(b.times[k], 1e9);
  const Approach found = nearest_approach(a, b);
  EXPECT_TRUE(std::isfinite(found.distance));
}

}  // namespace
}  // namespace lapwing
