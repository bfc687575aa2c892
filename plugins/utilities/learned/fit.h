// SPDX-License-Identifier: Apache-2.0
// Training: samples, epochs, early stopping, checkpoints (thesis 5.5.1; reading 5.5).
#pragma once

#include "framework/explore/trainable.h"

namespace lapwing::learned {

// The network that reads a grid around the camera (network.h), and the one that reads rays
// (ray_network.h).
extern const Trainable kGridTrainable, kRayTrainable;

}  // namespace lapwing::learned
