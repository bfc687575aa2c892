// SPDX-License-Identifier: Apache-2.0
// The network while it is trained: a batch forward, and the gradient of its loss (5.4).
#pragma once

#include "plugins/utilities/learned/network.h"

namespace lapwing::learned {

// Sums over the samples of a batch are made in this many parts, so that they do not depend on the
// number of threads.
inline constexpr int kShards = 8;

struct BatchOptions {
  double dropout = 0.5;         // share of hidden numbers that become 0
  double regularisation = 0;    // lambda
  std::uint64_t seed = 1;       // of the dropout
  bool keep_statistics = true;  // running statistics follow the batch's
};

// What hidden number `number` of a batch (sample times width plus place) is multiplied with: 0, or
// what makes up for those that are 0. `layer`: 0 or 1.
double dropout_factor(const BatchOptions& options, int layer, std::size_t number);

// Share of a batch in the running statistics.
inline constexpr double kStatisticsMomentum = 0.05;

class Backpropagation {
 public:
  Backpropagation(const NetworkLayout& layout, int batch, int threads);
  ~Backpropagation();

  // The padded input of a sample, to be filled by decode_grid.
  float* input(int sample);

  // The loss of the batch as it lies in the inputs: mean squared error plus lambda times the sum of
  // squares of the regularised parameters. `gradient` gets its derivatives, one for each parameter.
  double loss(NetworkState& state, std::span<const float> targets, const BatchOptions& options,
              std::span<float> gradient);

 private:
  struct Unit;
  void forward_unit(std::size_t k, NetworkState& state, bool keep);
  void backward_unit(std::size_t k, const NetworkState& state, std::span<float> gradient);
  double dense_layers(const NetworkState& state, std::span<const float> targets,
                      const BatchOptions& options, std::span<float> gradient);
  template <class Body>
  void for_samples(const Body& body);
  template <class Body>
  void for_shards(const Body& body);

  NetworkLayout layout_;
  int batch_, threads_;
  std::vector<Unit> units_;
  std::vector<float> flat_, flat_gradient_;
  std::vector<float> points_gradient_;          // of a unit's results
  std::vector<std::vector<float>> shard_sums_;  // of weights' gradients
};

// Adam (Kingma and Ba 2015) with its standard decays.
class Adam {
 public:
  explicit Adam(std::size_t parameters) : first(parameters, 0), second(parameters, 0) {}
  void step(std::span<float> parameters, std::span<const float> gradient, double rate);

  std::vector<float> first, second;  // moments
  std::int64_t steps = 0;
};

}  // namespace lapwing::learned
