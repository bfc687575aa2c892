// SPDX-License-Identifier: Apache-2.0
#include "framework/vehicle/state_predictor.h"

#include <cmath>

namespace lapwing {

StatePredictor::StatePredictor(const Vehicle& vehicle, const KnownDelays& delays)
    : body_(vehicle), delay_(delays.estimator + delays.command) {}

BodyState StatePredictor::predicted(const BodyState& known, double step) {
  const auto late = step > 0 ? static_cast<std::size_t>(std::llround(delay_ / step)) : 0;
  if (sent_.empty()) sent_.assign(late + 1, known.rotor_thrusts);
  while (sent_.size() > late + 1) sent_.pop_front();
  BodyState state = known;
  for (std::size_t k = 1; k < sent_.size(); ++k)
    state = body_.after(state, sent_[k], Eigen::Vector3d::Zero(), step);
  return state;
}

void StatePredictor::sent(const Eigen::Vector4d& thrusts) {
  sent_.push_back(thrusts);
}

}  // namespace lapwing
