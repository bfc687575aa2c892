// SPDX-License-Identifier: Apache-2.0
// Both networks, written with libtorch. Tests compare our kernels with them; `backend: libtorch`
// trains them. For builds with LAPWING_LEARN. Everything runs on a GPU where libtorch finds one.
//
// Inputs, targets, parameters and gradients lie as those of network.h and ray_network.h. Errors of
// libtorch become Error, want of memory becomes std::bad_alloc.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "plugins/utilities/learned/backpropagation.h"
#include "plugins/utilities/learned/ray_network.h"

namespace lapwing::learned {

// Threads of libtorch on the CPU, at least 1.
void begin_torch(int threads);
// Version, device and threads: what rounding depends on.
std::string torch_here();

// The network of the thesis. `inputs`: of each sample as decode_grid pads them.
std::vector<float> torch_answers(const NetworkLayout& layout, const NetworkState& state,
                                 std::span<const float> inputs);
// As Backpropagation::loss.
double torch_loss(const NetworkLayout& layout, NetworkState& state, std::span<const float> inputs,
                  std::span<const float> targets, const BatchOptions& options,
                  std::span<float> gradient);

// The network that reads rays. `inputs`: of each sample as decode_rays makes them; an answer for
// each ray.
std::vector<float> torch_answers(const RayNetworkLayout& layout, std::span<const float> parameters,
                                 std::span<const float> inputs);
// As RayBackpropagation::loss.
double torch_loss(const RayNetworkLayout& layout, std::span<const float> parameters,
                  std::span<const float> inputs, std::span<const float> targets,
                  std::span<float> gradient);

}  // namespace lapwing::learned
