// SPDX-License-Identifier: Apache-2.0
// Gusts of the Dryden spectra (MIL-F-8785C, 3.7.1 and 3.7.2; low altitude).
#pragma once

#include <array>

#include <Eigen/Core>

#include "framework/core/random.h"

namespace lapwing {

struct DrydenScales {
  double along = 0, up = 0;  // m, lengths L_u = L_v and L_w
  double up_share = 0;       // sigma_w / sigma_u
};
// At a height above the ground, m; between 3.05 and 304.8 m (10 to 1000 ft, where the formulas
// hold), else that of the nearer end.
DrydenScales dryden_scales(double height);

// A gust along, across and up, with zero mean. Each axis is white noise through the standard's
// filter: along 1/(1 + T s), across and up (1 + sqrt(3) T s)/(1 + T s)^2, T the length over the
// airspeed. The filters are advanced exactly for any step.
class DrydenGust {
 public:
  // `sigma`: standard deviation of each horizontal axis, m/s. Starts in the stationary state.
  DrydenGust(double sigma, Random random);

  // After `step` seconds at this height (m) and airspeed (m/s, at least 1 is taken: the air drifts
  // past a vehicle that hovers).
  Eigen::Vector3d next(double height, double airspeed, double step);

 private:
  struct Pair {
    double a = 0, b = 0;
    void advance(double share, Random& random);  // share: of the time T
    double value() const;
  };
  double sigma_;
  Random random_;
  double along_ = 0;
  Pair across_, up_;
};

}  // namespace lapwing
