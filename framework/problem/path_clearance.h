// SPDX-License-Identifier: Apache-2.0
// How far from an obstacle stages must be so that the path between them keeps its distance.
//
// Between two stages, h apart, the vehicle flies a parabola that leaves the chord of its ends by at
// most a h^2 / 8. A chord of length l whose ends are at least D from a set keeps sqrt(D^2 - l^2/4)
// from it: for a point q of the chord at share s, and c the point of the set nearest to q,
//   |q - c|^2 = (1 - s) |p_0 - c|^2 + s |p_1 - c|^2 - s (1 - s) l^2 >= D^2 - l^2 / 4.
// The set may have any shape. So distance(p_i) >= sqrt((d + a h^2/8)^2 + L_i^2/4), where L_i bounds
// the chords on both sides of stage i, keeps d everywhere: L_i = |v_i| h + a h^2 / 2.
#pragma once

#include <Eigen/Core>

#include "framework/core/dual.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {

// The largest acceleration that the vehicle's limits allow in any direction, m/s^2.
double largest_acceleration(const Vehicle& vehicle);

// What the path does around one stage.
template <class T>
struct PathReach {
  T bulge;          // m, by which it leaves its chords
  T quarter_chord;  // m^2, a quarter of the longest chord squared

  // The distance to ask of the stage, so that the path keeps `distance` (m).
  T asked(double distance) const {
    using std::sqrt;
    const T kept = distance + bulge;
    return sqrt(kept * kept + quarter_chord);
  }
};

class PathClearance {
 public:
  PathClearance() = default;
  explicit PathClearance(const Vehicle& vehicle) : acceleration_(largest_acceleration(vehicle)) {}

  // Around a stage with this velocity. An obstacle that moves along straight lines no faster than
  // `speed` (m/s) may turn between stages: it leaves its own chord by at most speed h / 2.
  template <class T>
  PathReach<T> around(const Eigen::Matrix<T, 3, 1>& velocity, const T& step,
                      double speed = 0) const {
    using std::sqrt;
    constexpr double kSmooth = 1e-4;  // (m/s)^2, so that the norm is smooth at rest
    const T squared =
        velocity.x() * velocity.x() + velocity.y() * velocity.y() + velocity.z() * velocity.z();
    const T half =
        step * (0.5 * sqrt(squared + kSmooth) + 0.5 * speed + (0.25 * acceleration_) * step);
    return {step * (0.125 * acceleration_ * step + 0.5 * speed), half * half};
  }

 private:
  double acceleration_ = 0;
};

}  // namespace lapwing
