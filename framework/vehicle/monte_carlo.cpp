// SPDX-License-Identifier: Apache-2.0
#include "framework/vehicle/monte_carlo.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "framework/core/parallel.h"
#include "framework/core/random.h"

namespace lapwing {

namespace {
constexpr std::uint64_t kErrorStream = 17;  // apart from those of closed_loop.cpp
}

FlightConditions drawn_conditions(const FlightConditions& spread, std::uint64_t seed) {
  FlightConditions drawn = spread;
  drawn.seed = seed;
  Random random = Random(seed).split(kErrorStream);
  drawn.mass_error = spread.mass_error * random.uniform(-1, 1);
  drawn.disturbances.inertia_error = spread.disturbances.inertia_error * random.uniform(-1, 1);
  return drawn;
}

std::vector<SeededRun> fly_runs(const ControlledPlan& plan, const FlightConditions& spread,
                                int runs, int threads, const CancellationToken* cancellation) {
  std::vector<SeededRun> flown(static_cast<std::size_t>(std::max(0, runs)));
  parallel_for(flown.size(), threads, [&](std::size_t i) {
    flown[i].conditions = drawn_conditions(spread, spread.seed + i);
    flown[i].path = plan.fly(flown[i].conditions, cancellation);
  });
  return flown;
}

double quantile_of(std::vector<double> values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const double at = std::clamp(share, 0.0, 1.0) * static_cast<double>(values.size() - 1);
  const auto low = static_cast<std::size_t>(at);
  const auto high = std::min(low + 1, values.size() - 1);
  const double part = at - static_cast<double>(low);
  return part == 0 ? values[low] : values[low] + part * (values[high] - values[low]);
}

}  // namespace lapwing
