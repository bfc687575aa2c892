// SPDX-License-Identifier: Apache-2.0
// The network of the learned utility against libtorch (preset `learn`): what it answers, its loss,
// and every derivative.
#include <torch/torch.h>

#include <gtest/gtest.h>

#include "plugins/utilities/learned/backpropagation.h"
#include "plugins/utilities/learned/model_file.h"
#include "tests/plugins/learned_state.h"

namespace lapwing::learned {
namespace {

namespace fn = torch::nn::functional;

torch::Tensor tensor_of(const std::vector<float>& all, std::size_t begin,
                        std::vector<std::int64_t> sizes) {
  return torch::from_blob(const_cast<float*>(all.data()) + begin, sizes, torch::kFloat32).clone();
}

// The definition in libtorch's words. Parameters are one leaf tensor, so that its gradient lies as
// ours does.
class TorchNetwork {
 public:
  TorchNetwork(const NetworkLayout& layout, const NetworkState& state)
      : layout_(layout),
        parameters(
            tensor_of(state.parameters, 0, {static_cast<std::int64_t>(state.parameters.size())})),
        statistics_(
            tensor_of(state.statistics, 0, {static_cast<std::int64_t>(state.statistics.size())})) {}

  // Inputs [sample, map, z, y, x]; `training`: normalised by the batch itself.
  torch::Tensor answers(torch::Tensor now, bool training) const {
    for (const UnitPlace& unit : layout_.units) {
      const torch::Tensor weights =
          take(unit.weights, {3, 3, 3, unit.in, unit.out}).permute({4, 3, 0, 1, 2});
      now = torch::conv3d(now, weights, {}, 1, 1);
      now = torch::batch_norm(now, take(unit.scale, {unit.out}), take(unit.shift, {unit.out}),
                              statistics_.narrow(0, at(unit.mean), unit.out).clone(),
                              statistics_.narrow(0, at(unit.variance), unit.out).clone(), training,
                              0.1, 1e-5, false);
      now = torch::relu(now);
      if (unit.last_of_block) now = torch::max_pool3d(now, 2);
    }
    // Maps fastest.
    now = now.permute({0, 2, 3, 4, 1}).reshape({now.size(0), layout_.flat});
    const NetworkShape& s = layout_.shape;
    now = torch::relu(dense(now, layout_.weights1, layout_.bias1, layout_.flat, s.hidden1));
    now = torch::relu(dense(now, layout_.weights2, layout_.bias2, s.hidden1, s.hidden2));
    return dense(now, layout_.weights3, layout_.bias3, s.hidden2, 1).squeeze(1);
  }

  // (5.4)
  torch::Tensor loss(const torch::Tensor& inputs, const torch::Tensor& targets,
                     double lambda) const {
    torch::Tensor sum = fn::mse_loss(answers(inputs, true), targets);
    for (const auto& [begin, end] : layout_.regularised)
      sum = sum + lambda * parameters.narrow(0, at(begin), at(end - begin)).square().sum();
    return sum;
  }

 private:
  static std::int64_t at(std::size_t place) { return static_cast<std::int64_t>(place); }
  torch::Tensor take(std::size_t begin, std::vector<std::int64_t> sizes) const {
    std::int64_t count = 1;
    for (const std::int64_t size : sizes) count *= size;
    return parameters.narrow(0, at(begin), count).view(sizes);
  }
  torch::Tensor dense(const torch::Tensor& in, std::size_t weights, std::size_t bias, int from,
                      int to) const {
    return torch::matmul(in, take(weights, {from, to})) + take(bias, {to});
  }

  NetworkLayout layout_;

 public:
  torch::Tensor parameters;

 private:
  torch::Tensor statistics_;
};

// Random grids as a file of samples holds them.
std::vector<std::vector<std::uint8_t>> grids_of(const NetworkLayout& layout, int count) {
  Random random(17);
  std::vector<std::vector<std::uint8_t>> grids;
  for (int n = 0; n < count; ++n) {
    grids.emplace_back();
    // Some smooth, some rough, some of nothing known.
    const auto step = static_cast<std::size_t>(1 + 7 * (n % 3));
    std::uint8_t value = 0;
    for (std::size_t k = 0; k < layout.shape.grid.size(); ++k) {
      if (k % step == 0) value = static_cast<std::uint8_t>(random.integer(0, 255));
      grids.back().push_back(n == 4 ? (k % 2 == 0 ? 128 : 255) : value);
    }
  }
  return grids;
}

torch::Tensor inputs_of(const NetworkLayout& layout,
                        const std::vector<std::vector<std::uint8_t>>& grids) {
  const GridShape& g = layout.shape.grid;
  std::vector<float> all;
  for (const auto& grid : grids)
    for (std::size_t k = 0; k < grid.size(); ++k) {
      const float v = static_cast<float>(grid[k]) / 255.0f;
      all.push_back(k % 2 == 0 ? 2 * v - 1 : 1 - v);
    }
  return tensor_of(all, 0,
                   {static_cast<std::int64_t>(grids.size()), g.up, g.ahead, g.across, g.channels()})
      .permute({0, 4, 1, 2, 3});
}

void expect_the_same_answers(const NetworkLayout& layout, const NetworkState& state) {
  const auto grids = grids_of(layout, 24);
  const torch::NoGradGuard no_gradient;
  const torch::Tensor theirs = TorchNetwork(layout, state).answers(inputs_of(layout, grids), false);
  const FoldedNetwork ours(layout, state);
  double most = 0, spread = 0;
  for (std::size_t n = 0; n < grids.size(); ++n) {
    const double expected = theirs[static_cast<std::int64_t>(n)].item<double>();
    most = std::max(most, std::abs(ours.answer(grids[n].data()) - expected));
    spread = std::max(spread, std::abs(expected - theirs[0].item<double>()));
  }
  EXPECT_LT(most, 1e-4);
  EXPECT_GT(spread, 0.01) << "all grids are the same to it";
}

NetworkState state_with_statistics(const NetworkLayout& layout) {
  NetworkState state = initial_state(layout, Random(3));
  Random random(4);
  scatter_normalisations(layout, state, random);
  return state;
}

TEST(LearnedAgainstTorch, TheShippedModelAnswersTheSame) {
  const std::string path = LAPWING_SOURCE_DIR "/plugins/utilities/learned/learned_grid.model";
  const Model model = read_model(path);
  expect_the_same_answers(NetworkLayout(model.grid_network(path)), model.state);
}

TEST(LearnedAgainstTorch, OtherShapesAnswerTheSame) {
  NetworkShape thesis;  // reading 5.5
  NetworkShape wide;
  wide.grid = {8, 8, 8, 2};
  wide.blocks = 3;
  wide.units = 2;
  wide.growth = 16;
  wide.hidden1 = 24;
  wide.hidden2 = 8;
  for (const NetworkShape& shape : {thesis, wide}) {
    const NetworkLayout layout(shape);
    expect_the_same_answers(layout, state_with_statistics(layout));
  }
}

TEST(LearnedAgainstTorch, LossAndEveryDerivative) {
  NetworkShape shape;
  shape.grid = {8, 8, 4, 2};
  shape.units = 2;
  shape.hidden1 = 32;
  shape.hidden2 = 16;
  const NetworkLayout layout(shape);
  NetworkState state = state_with_statistics(layout);
  const int batch = 16;
  const double lambda = 0.01;
  const auto grids = grids_of(layout, batch);
  Random random(6);
  std::vector<float> targets;
  for (int n = 0; n < batch; ++n) targets.push_back(static_cast<float>(random.normal()));

  TorchNetwork theirs(layout, state);
  theirs.parameters.set_requires_grad(true);
  const torch::Tensor loss =
      theirs.loss(inputs_of(layout, grids), tensor_of(targets, 0, {batch}), lambda);
  loss.backward();
  const torch::Tensor expected = theirs.parameters.grad();

  Backpropagation ours(layout, batch, 2);
  for (int n = 0; n < batch; ++n)
    decode_grid(layout, grids[static_cast<std::size_t>(n)].data(), false, ours.input(n));
  BatchOptions options;
  options.dropout = 0;
  options.regularisation = lambda;
  std::vector<float> gradient(layout.parameters, 0);
  const double our_loss = ours.loss(state, targets, options, gradient);
  EXPECT_NEAR(our_loss, loss.item<double>(), 1e-5 * our_loss);
  const double scale = expected.abs().max().item<double>();
  const torch::Tensor difference =
      (tensor_of(gradient, 0, {static_cast<std::int64_t>(gradient.size())}) - expected).abs();
  EXPECT_GT(scale, 0.01);
  EXPECT_LT(difference.max().item<double>(), 1e-4 * scale);
}

}  // namespace
}  // namespace lapwing::learned
