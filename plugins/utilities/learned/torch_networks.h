// SPDX-License-Identifier: Apache-2.0
// Both networks, written with libtorch. Tests compare our kernels with them; `backend: libtorch`
// trains them. For builds with LAPWING_LEARN.
//
// All parameters are one leaf tensor. It has the order of our vector of parameters, and so does its
// gradient.
#pragma once

#include <torch/torch.h>

#include "plugins/utilities/learned/network.h"
#include "plugins/utilities/learned/ray_network.h"

namespace lapwing::learned {

// A copy, on `device`.
inline torch::Tensor tensor_of(std::span<const float> numbers, std::vector<std::int64_t> sizes,
                               torch::Device device = torch::kCPU) {
  return torch::from_blob(const_cast<float*>(numbers.data()), sizes, torch::kFloat32)
      .clone()
      .to(device);
}

class TorchParameters {
 public:
  TorchParameters(std::span<const float> all, torch::Device device)
      : all_(tensor_of(all, {static_cast<std::int64_t>(all.size())}, device)) {}

  torch::Tensor all() const { return all_; }
  torch::Tensor take(std::size_t begin, std::vector<std::int64_t> sizes) const {
    std::int64_t count = 1;
    for (const std::int64_t size : sizes) count *= size;
    return all_.narrow(0, static_cast<std::int64_t>(begin), count).view(sizes);
  }
  // `begin`: of the weights [input][output]; biases follow them.
  torch::Tensor dense(const torch::Tensor& in, std::size_t begin, std::int64_t from,
                      std::int64_t to) const {
    return torch::matmul(in, take(begin, {from, to})) +
           take(begin + static_cast<std::size_t>(from * to), {to});
  }

 private:
  torch::Tensor all_;
};

// The network of the thesis (network.h).
class TorchGridNetwork {
 public:
  // What a batch does beside its answers. Undefined masks leave out nothing.
  struct Batch {
    torch::Tensor mask1, mask2;                   // factors of hidden numbers (dropout)
    std::vector<torch::Tensor> means, variances;  // are set: of each unit, over the batch
  };

  TorchGridNetwork(const NetworkLayout& layout, const NetworkState& state,
                   torch::Device device = torch::kCPU)
      : layout_(layout),
        parameters_(state.parameters, device),
        statistics_(state.statistics, device) {}

  torch::Tensor parameters() const { return parameters_.all(); }

  // Inputs [sample, map, z, y, x]. Normalised by running statistics, or by those of a batch.
  torch::Tensor answers(torch::Tensor now, Batch* batch = nullptr) const {
    for (const UnitPlace& unit : layout_.units) {
      const torch::Tensor in = now;
      now = torch::conv3d(
          now,
          parameters_.take(unit.weights, {3, 3, 3, unit.in, unit.out}).permute({4, 3, 0, 1, 2}), {},
          1, 1);
      torch::Tensor mean, variance;
      if (batch) {
        mean = now.mean({0, 2, 3, 4});
        variance = now.var({0, 2, 3, 4}, false);
        batch->means.push_back(mean.detach());
        batch->variances.push_back(variance.detach());
      } else {
        mean = statistics_.take(unit.mean, {unit.out});
        variance = statistics_.take(unit.variance, {unit.out});
      }
      const torch::Tensor factor =
          parameters_.take(unit.scale, {unit.out}) * (variance + 1e-5).rsqrt();
      const auto by_map = [](const torch::Tensor& t) { return t.view({1, -1, 1, 1, 1}); };
      now = torch::relu((now - by_map(mean)) * by_map(factor) +
                        by_map(parameters_.take(unit.shift, {unit.out})));
      if (layout_.shape.residual)
        now = now + torch::constant_pad_nd(in, {0, 0, 0, 0, 0, 0, 0, unit.out - unit.in});
      if (unit.last_of_block) now = torch::max_pool3d(now, 2);
    }
    // Maps fastest.
    now = now.permute({0, 2, 3, 4, 1}).reshape({now.size(0), layout_.flat});
    const NetworkShape& s = layout_.shape;
    const auto masked = [](const torch::Tensor& t, const torch::Tensor& mask) {
      return mask.defined() ? t * mask : t;
    };
    now = torch::relu(parameters_.dense(now, layout_.weights1, layout_.flat, s.hidden1));
    if (batch) now = masked(now, batch->mask1);
    now = torch::relu(parameters_.dense(now, layout_.weights2, s.hidden1, s.hidden2));
    if (batch) now = masked(now, batch->mask2);
    return parameters_.dense(now, layout_.weights3, s.hidden2, 1).squeeze(1);
  }

  // (5.4)
  torch::Tensor loss(const torch::Tensor& inputs, const torch::Tensor& targets, double lambda,
                     Batch& batch) const {
    torch::Tensor sum = (answers(inputs, &batch) - targets).square().mean();
    for (const auto& [begin, end] : layout_.regularised)
      sum =
          sum +
          lambda * parameters_.take(begin, {static_cast<std::int64_t>(end - begin)}).square().sum();
    return sum;
  }

 private:
  NetworkLayout layout_;
  TorchParameters parameters_, statistics_;
};

// The network that reads rays (ray_network.h).
class TorchRayNetwork {
 public:
  TorchRayNetwork(const RayNetworkLayout& layout, std::span<const float> parameters,
                  torch::Device device = torch::kCPU)
      : layout_(layout), parameters_(parameters, device) {}

  torch::Tensor parameters() const { return parameters_.all(); }

  // Inputs [sample, row, column, number] of decode_rays; answers [sample, ray], in voxels.
  torch::Tensor answers(const torch::Tensor& inputs) const {
    const std::int64_t width = layout_.shape.width;
    torch::Tensor now =
        torch::relu(parameters_.dense(inputs, layout_.first, RayNetworkLayout::kInputs, width));
    now = now.permute({0, 3, 1, 2});
    for (std::size_t k = 0; k < layout_.convolutions.size(); ++k) {
      const std::size_t begin = layout_.convolutions[k];
      const std::int64_t dilation = std::int64_t{1} << k;
      now =
          now + torch::relu(torch::conv2d(
                    now, parameters_.take(begin, {3, 3, width, width}).permute({3, 2, 0, 1}),
                    parameters_.take(begin + static_cast<std::size_t>(9 * width * width), {width}),
                    1, dilation, dilation));
    }
    now = torch::relu(parameters_.dense(now.permute({0, 2, 3, 1}), layout_.last, width, width));
    return torch::softplus(parameters_.dense(now, layout_.output, width, 1)).flatten(1);
  }

  // The mean loss of a batch (RayBackpropagation); targets [sample, ray].
  torch::Tensor loss(const torch::Tensor& inputs, const torch::Tensor& targets) const {
    const torch::Tensor p = answers(inputs);
    const torch::Tensor likelihood = (p - targets * (p + kRayFloor).log()).mean(1);
    const torch::Tensor there = targets.sum(1);
    const torch::Tensor excess = (p.sum(1) - there).square() / (there + kRaySpread);
    return (likelihood + excess / static_cast<double>(layout_.rays())).mean();
  }

 private:
  RayNetworkLayout layout_;
  TorchParameters parameters_;
};

}  // namespace lapwing::learned
