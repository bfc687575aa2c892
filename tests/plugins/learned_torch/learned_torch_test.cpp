// SPDX-License-Identifier: Apache-2.0
// The networks of the learned utilities against libtorch (preset `learn`): answers, loss, every
// derivative, and training by either.
#include <gtest/gtest.h>

#include "plugins/utilities/learned/backpropagation.h"
#include "plugins/utilities/learned/model_file.h"
#include "plugins/utilities/learned/torch_networks.h"
#include "tests/plugins/learned_state.h"
#include "tests/plugins/utilities/fit_fixture.h"

namespace lapwing::learned {
namespace {

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

// As the networks read them, one after the other.
std::vector<float> inputs_of(const NetworkLayout& layout,
                             const std::vector<std::vector<std::uint8_t>>& grids) {
  const UnitPlace& first = layout.units.front();
  const std::size_t each = first.padded() * static_cast<std::size_t>(first.in);
  std::vector<float> all(grids.size() * each, 0);
  for (std::size_t n = 0; n < grids.size(); ++n)
    decode_grid(layout, grids[n].data(), false, all.data() + n * each);
  return all;
}

void expect_the_same_answers(const NetworkLayout& layout, const NetworkState& state) {
  const auto grids = grids_of(layout, 24);
  const std::vector<float> theirs = torch_answers(layout, state, inputs_of(layout, grids));
  const FoldedNetwork ours(layout, state);
  double most = 0, spread = 0;
  for (std::size_t n = 0; n < grids.size(); ++n) {
    const double expected = static_cast<double>(theirs[n]);
    most = std::max(most, std::abs(ours.answer(grids[n].data()) - expected));
    spread = std::max(spread, std::abs(expected - static_cast<double>(theirs[0])));
  }
  EXPECT_LT(most, 1e-4);
  EXPECT_GT(spread, 0.01) << "all grids are the same to it";
}

// Derivatives, to 1e-4 of the largest.
void expect_the_same(const std::vector<float>& ours, const std::vector<float>& theirs) {
  double scale = 0, most = 0;
  for (std::size_t k = 0; k < ours.size(); ++k) {
    scale = std::max(scale, std::abs(static_cast<double>(theirs[k])));
    most = std::max(most, std::abs(static_cast<double>(ours[k] - theirs[k])));
  }
  EXPECT_GT(scale, 0.01);
  EXPECT_LT(most, 1e-4 * scale);
}

NetworkState state_with_statistics(const NetworkLayout& layout) {
  NetworkState state = initial_state(layout, Random(3));
  Random random(4);
  scatter_normalisations(layout, state, random);
  return state;
}

TEST(TorchNetworks, TheShippedModelAnswersTheSame) {
  const std::string path = LAPWING_SOURCE_DIR "/plugins/utilities/learned/learned_grid.model";
  const Model model = read_model(path);
  expect_the_same_answers(NetworkLayout(model.grid_network(path)), model.state);
}

TEST(TorchNetworks, OtherShapesAnswerTheSame) {
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

class LearnedAgainstTorch : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Units, LearnedAgainstTorch, testing::Bool());

TEST_P(LearnedAgainstTorch, LossAndEveryDerivative) {
  NetworkShape shape;
  shape.residual = GetParam();
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

  BatchOptions options;
  options.dropout = 0.3;
  options.regularisation = lambda;
  options.seed = 5;
  std::vector<float> expected(layout.parameters, 0), gradient(layout.parameters, 0);
  NetworkState theirs = state;
  const double loss =
      torch_loss(layout, theirs, inputs_of(layout, grids), targets, options, expected);

  Backpropagation ours(layout, batch, 2);
  for (int n = 0; n < batch; ++n)
    decode_grid(layout, grids[static_cast<std::size_t>(n)].data(), false, ours.input(n));
  EXPECT_NEAR(ours.loss(state, targets, options, gradient), loss, 1e-5 * loss);
  expect_the_same(gradient, expected);
  for (std::size_t k = 0; k < state.statistics.size(); ++k)
    EXPECT_NEAR(state.statistics[k], theirs.statistics[k], 1e-4);
}

TEST(TorchNetworks, TheShippedModelOfRaysAnswersTheSame) {
  const std::string path = LAPWING_SOURCE_DIR "/plugins/utilities/learned/learned.model";
  const Model model = read_model(path);
  const RayNetworkLayout layout(model.ray_network(path));
  const RayNetwork ours(layout, model.state.parameters);
  const RayShape& rays = layout.shape.rays;
  constexpr int kImages = 16;
  Random random(7);
  std::vector<float> inputs(static_cast<std::size_t>(kImages * layout.rays()) *
                            RayNetworkLayout::kInputs);
  std::vector<std::vector<float>> cells(kImages);
  for (int n = 0; n < kImages; ++n) {
    std::vector<std::uint8_t> bytes(rays.size());
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random.integer(0, 255));
    decode_rays(
        layout, bytes.data(), false,
        inputs.data() + static_cast<std::ptrdiff_t>(n) * layout.rays() * RayNetworkLayout::kInputs);
    cells[static_cast<std::size_t>(n)].resize(static_cast<std::size_t>(layout.rays()));
    ours.answer(bytes.data(), cells[static_cast<std::size_t>(n)]);
  }
  const std::vector<float> theirs = torch_answers(layout, model.state.parameters, inputs);
  double most = 0;
  for (std::size_t k = 0; k < theirs.size(); ++k)
    most = std::max(
        most,
        std::abs(static_cast<double>(theirs[k] - cells[k / cells[0].size()][k % cells[0].size()])));
  EXPECT_LT(most, 1e-4);
  const auto [least, greatest] = std::minmax_element(theirs.begin(), theirs.end());
  EXPECT_GT(*greatest - *least, 0.1);
}

TEST(TorchNetworks, RaysLossAndEveryDerivative) {
  RayNetworkShape shape;
  shape.rays = {7, 5};
  shape.width = 16;
  const RayNetworkLayout layout(shape);
  const std::vector<float> parameters = initial_parameters(layout, Random(3));
  constexpr int kBatch = 16;
  RayBackpropagation ours(layout, kBatch, 2);
  Random random(5);
  std::vector<float> inputs, targets;
  for (int n = 0; n < kBatch; ++n) {
    std::vector<std::uint8_t> bytes(shape.rays.size());
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random.integer(0, 255));
    decode_rays(layout, bytes.data(), n % 2 == 0, ours.input(n));
    for (int ray = 0; ray < layout.rays(); ++ray)
      ours.target(n)[ray] = static_cast<float>(random.uniform(0, 3));
    inputs.insert(inputs.end(), ours.input(n),
                  ours.input(n) + layout.rays() * RayNetworkLayout::kInputs);
    targets.insert(targets.end(), ours.target(n), ours.target(n) + layout.rays());
  }
  std::vector<float> expected(layout.parameters, 0), gradient(layout.parameters, 0);
  const double loss = torch_loss(layout, parameters, inputs, targets, expected);
  EXPECT_NEAR(ours.loss(parameters, gradient), loss, 1e-5 * loss);
  expect_the_same(gradient, expected);
}

// Both backends: the same draws, so that models differ by rounding alone.
template <class Folder>
void expect_the_same_training(const char* setting, const Value& value) {
  Model models[2];
  for (const bool torch : {false, true}) {
    Folder training;
    training.given.set("epochs", 2);
    if (!value.is_null()) training.given.set(setting, value);
    training.given.set("backend", torch ? "libtorch" : "own");
    training.request.threads = 0;  // one per core, as by default
    std::string told;
    training.request.log = [&](const std::string& line) { told += line + "\n"; };
    training.run();
    EXPECT_EQ(told.find("libtorch") != std::string::npos, torch) << told;
    models[torch] = read_model(training.request.model);
  }
  const NetworkState &own = models[0].state, &torch = models[1].state;
  ASSERT_EQ(own.parameters.size(), torch.parameters.size());
  ASSERT_EQ(own.statistics.size(), torch.statistics.size());
  // Measured: 1e-6 at most.
  double most = 0;
  for (std::size_t k = 0; k < own.parameters.size(); ++k)
    most = std::max(most, std::abs(static_cast<double>(own.parameters[k] - torch.parameters[k])));
  testing::Test::RecordProperty("most", std::to_string(most));
  EXPECT_LT(most, 1e-4);
  for (std::size_t k = 0; k < own.statistics.size(); ++k)
    EXPECT_NEAR(own.statistics[k], torch.statistics[k], 1e-3);
  EXPECT_NEAR(models[0].provenance.at("validation_loss").as_number(),
              models[1].provenance.at("validation_loss").as_number(), 1e-3);
}

TEST(TorchNetworks, TrainsRaysAlike) {
  expect_the_same_training<RayTraining>("convolutions", Value(2));
}

TEST(TorchNetworks, TrainsGridsAlike) {
  expect_the_same_training<GridTraining>("dropout", Value(0.3));
}

TEST(TorchNetworks, TrainsResidualGridsAlike) {
  expect_the_same_training<GridTraining>("residual", Value(true));
}

}  // namespace
}  // namespace lapwing::learned
