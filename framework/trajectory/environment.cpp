#include "framework/trajectory/environment.h"

#include <algorithm>

namespace lapwing {

Eigen::Vector3d Subject::position(double time) const {
  const auto next = std::upper_bound(times.begin(), times.end(), time);
  if (next == times.begin()) return positions.front();
  if (next == times.end()) return positions.back();
  const auto i = static_cast<std::size_t>(next - times.begin());
  const double share = (time - times[i - 1]) / (times[i] - times[i - 1]);
  return positions[i - 1] + share * (positions[i] - positions[i - 1]);
}

}  // namespace lapwing
