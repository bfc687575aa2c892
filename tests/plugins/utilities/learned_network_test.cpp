// SPDX-License-Identifier: Apache-2.0
// The network's arithmetic against slow and plain arithmetic in double precision, and every
// derivative against differences of it.
#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "plugins/utilities/learned/backpropagation.h"
#include "plugins/utilities/learned/kernels.h"
#include "plugins/utilities/learned/network.h"
#include "tests/plugins/learned_state.h"

namespace lapwing {
namespace {

using namespace learned;

NetworkShape small_shape(bool residual = false) {
  NetworkShape shape;
  shape.grid = {8, 4, 4, 1};
  shape.blocks = 2;
  shape.units = 2;
  shape.growth = 8;
  shape.hidden1 = 16;
  shape.hidden2 = 8;
  shape.residual = residual;
  return shape;
}

// The same network, written as its definition: [sample][map][z][y][x].
class PlainNetwork {
 public:
  PlainNetwork(const NetworkLayout& layout, std::vector<std::vector<double>> inputs)
      : layout_(layout), inputs_(std::move(inputs)) {}

  double loss(const std::vector<double>& p, const std::vector<float>& targets,
              double lambda) const {
    std::vector<std::vector<double>> now = inputs_;
    for (const UnitPlace& unit : layout_.units) {
      const std::vector<std::vector<double>> before = now;
      now = rectified_unit(unit, p, now);
      if (layout_.shape.residual) add(unit, before, now);
      if (unit.last_of_block) now = maxima(unit, now);
    }
    double sum = 0;
    for (std::size_t n = 0; n < now.size(); ++n) {
      const std::vector<double> a =
          dense(p, layout_.weights1, layout_.bias1, now[n], layout_.shape.hidden1, true);
      const std::vector<double> b =
          dense(p, layout_.weights2, layout_.bias2, a, layout_.shape.hidden2, true);
      const double out = dense(p, layout_.weights3, layout_.bias3, b, 1, false)[0];
      const double error = out - static_cast<double>(targets[n]);
      sum += error * error / static_cast<double>(now.size());
    }
    for (const auto& [begin, end] : layout_.regularised)
      for (std::size_t k = begin; k < end; ++k) sum += lambda * p[k] * p[k];
    return sum;
  }

 private:
  static std::vector<double> dense(const std::vector<double>& p, std::size_t weights,
                                   std::size_t bias, const std::vector<double>& in, int width,
                                   bool rectified) {
    std::vector<double> out;
    for (int o = 0; o < width; ++o) {
      double sum = p[bias + static_cast<std::size_t>(o)];
      for (std::size_t i = 0; i < in.size(); ++i)
        sum +=
            in[i] * p[weights + i * static_cast<std::size_t>(width) + static_cast<std::size_t>(o)];
      out.push_back(rectified ? std::max(sum, 0.0) : sum);
    }
    return out;
  }
  static std::size_t place(const int size[3], int maps, int x, int y, int z, int c) {
    return static_cast<std::size_t>(((z * size[1] + y) * size[0] + x) * maps + c);
  }
  std::vector<std::vector<double>> rectified_unit(
      const UnitPlace& u, const std::vector<double>& p,
      const std::vector<std::vector<double>>& in) const {
    std::vector<std::vector<double>> out(in.size());
    for (std::size_t n = 0; n < in.size(); ++n)
      for (int z = 0; z < u.size[2]; ++z)
        for (int y = 0; y < u.size[1]; ++y)
          for (int x = 0; x < u.size[0]; ++x)
            for (int o = 0; o < u.out; ++o) {
              double sum = 0;
              for (int tap = 0; tap < 27; ++tap) {
                const int at[3] = {x + tap % 3 - 1, y + tap / 3 % 3 - 1, z + tap / 9 - 1};
                if (at[0] < 0 || at[1] < 0 || at[2] < 0 || at[0] >= u.size[0] ||
                    at[1] >= u.size[1] || at[2] >= u.size[2])
                  continue;
                for (int i = 0; i < u.in; ++i)
                  sum += in[n][place(u.size, u.in, at[0], at[1], at[2], i)] *
                         p[u.weights + static_cast<std::size_t>((tap * u.in + i) * u.out + o)];
              }
              out[n].push_back(sum);
            }
    for (int o = 0; o < u.out; ++o) {
      const auto c = static_cast<std::size_t>(o);
      double mean = 0, variance = 0, count = 0;
      for (const auto& sample : out)
        for (std::size_t k = c; k < sample.size(); k += static_cast<std::size_t>(u.out)) {
          mean += sample[k];
          count += 1;
        }
      mean /= count;
      for (const auto& sample : out)
        for (std::size_t k = c; k < sample.size(); k += static_cast<std::size_t>(u.out))
          variance += (sample[k] - mean) * (sample[k] - mean) / count;
      for (auto& sample : out)
        for (std::size_t k = c; k < sample.size(); k += static_cast<std::size_t>(u.out))
          sample[k] = std::max(
              (sample[k] - mean) / std::sqrt(variance + 1e-5) * p[u.scale + c] + p[u.shift + c],
              0.0);
    }
    return out;
  }
  static void add(const UnitPlace& u, const std::vector<std::vector<double>>& in,
                  std::vector<std::vector<double>>& out) {
    for (std::size_t n = 0; n < in.size(); ++n)
      for (int z = 0; z < u.size[2]; ++z)
        for (int y = 0; y < u.size[1]; ++y)
          for (int x = 0; x < u.size[0]; ++x)
            for (int c = 0; c < u.in; ++c)
              out[n][place(u.size, u.out, x, y, z, c)] += in[n][place(u.size, u.in, x, y, z, c)];
  }
  static std::vector<std::vector<double>> maxima(const UnitPlace& u,
                                                 const std::vector<std::vector<double>>& in) {
    std::vector<std::vector<double>> out(in.size());
    for (std::size_t n = 0; n < in.size(); ++n)
      for (int z = 0; z < u.size[2]; z += 2)
        for (int y = 0; y < u.size[1]; y += 2)
          for (int x = 0; x < u.size[0]; x += 2)
            for (int c = 0; c < u.out; ++c) {
              double most = -1e9;
              for (int k = 0; k < 8; ++k)
                most = std::max(
                    most,
                    in[n][place(u.size, u.out, x + (k & 1), y + (k >> 1 & 1), z + (k >> 2), c)]);
              out[n].push_back(most);
            }
    return out;
  }

  NetworkLayout layout_;
  std::vector<std::vector<double>> inputs_;
};

struct Batch {
  NetworkLayout layout;
  int size = 8;
  std::vector<std::vector<std::uint8_t>> bytes;
  std::vector<std::vector<double>> plain;
  std::vector<float> targets;
  NetworkState state;

  explicit Batch(bool residual = false)
      : layout(small_shape(residual)), state(initial_state(layout, Random(5))) {
    Random random(9);
    for (int n = 0; n < size; ++n) {
      bytes.emplace_back();
      plain.emplace_back();
      for (std::size_t k = 0; k < layout.shape.grid.size(); ++k) {
        bytes.back().push_back(static_cast<std::uint8_t>(random.integer(0, 255)));
        const double v = bytes.back().back() / 255.0;
        plain.back().push_back(k % 2 == 0 ? 2 * v - 1 : 1 - v);
      }
      targets.push_back(static_cast<float>(random.normal()));
    }
    scatter_normalisations(layout, state, random);
  }
  double loss(std::vector<float>& gradient, const BatchOptions& options, int threads = 1) {
    Backpropagation network(layout, size, threads);
    for (int n = 0; n < size; ++n)
      decode_grid(layout, bytes[static_cast<std::size_t>(n)].data(), false, network.input(n));
    gradient.assign(layout.parameters, 0);
    return network.loss(state, targets, options, gradient);
  }
};

TEST(LearnedKernels, MultiplyAsTheyShould) {
  Random random(2);
  for (const int columns : {8, 16, 24, 40, 64})
    for (const int rows : {1, 3, 4, 8, 13}) {
      const int depth = 7, parts = 2;
      std::vector<float> a(400), b(static_cast<std::size_t>(parts * depth * columns)),
          bias(static_cast<std::size_t>(columns)), c(static_cast<std::size_t>(rows * columns));
      for (auto* v : {&a, &b, &bias})
        for (float& x : *v) x = static_cast<float>(random.normal());
      const float* starts[2] = {a.data(), a.data() + 200};
      multiply(
          {starts, parts, 5, depth, b.data(), bias.data(), rows, columns, c.data(), columns, true});
      std::vector<float> d(static_cast<std::size_t>(depth * columns), 1.0f);
      accumulate({starts, starts, 2, rows, 5, 5, depth, columns, d.data()});
      for (int i = 0; i < rows; ++i)
        for (int j = 0; j < columns; ++j) {
          double sum = static_cast<double>(bias[static_cast<std::size_t>(j)]);
          for (int p = 0; p < parts; ++p)
            for (int k = 0; k < depth; ++k)
              sum +=
                  static_cast<double>(starts[p][i * 5 + k]) *
                  static_cast<double>(b[static_cast<std::size_t>((p * depth + k) * columns + j)]);
          EXPECT_NEAR(c[static_cast<std::size_t>(i * columns + j)], std::max(sum, 0.0), 1e-4);
        }
      for (int k = 0; k < depth; ++k)
        for (int j = 0; j < columns; ++j) {
          double sum = 1;
          for (const float* start : starts)
            for (int i = 0; i < rows; ++i)
              sum += static_cast<double>(start[i * 5 + k]) * static_cast<double>(start[i * 5 + j]);
          EXPECT_NEAR(d[static_cast<std::size_t>(k * columns + j)], sum, 1e-3);
        }
    }
}

// The parameter: whether its units are residual.
class LearnedNetworks : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Units, LearnedNetworks, testing::Bool());

TEST_P(LearnedNetworks, EveryDerivativeIsThatOfItsDefinition) {
  Batch batch(GetParam());
  BatchOptions options;
  options.dropout = 0;
  options.regularisation = 0.01;
  std::vector<float> gradient;
  const double loss = batch.loss(gradient, options);
  const PlainNetwork plain(batch.layout, batch.plain);
  std::vector<double> p(batch.state.parameters.begin(), batch.state.parameters.end());
  EXPECT_NEAR(loss, plain.loss(p, batch.targets, 0.01), 1e-4 * loss);
  // Some of every group: scales, shifts, biases and weights.
  std::vector<std::size_t> asked;
  for (const UnitPlace& unit : batch.layout.units) {
    for (int c = 0; c < unit.out; c += 7) {
      asked.push_back(unit.scale + static_cast<std::size_t>(c));
      asked.push_back(unit.shift + static_cast<std::size_t>(c));
    }
    for (std::size_t k = unit.weights; k < unit.scale; k += 2503) asked.push_back(k);
  }
  for (std::size_t k = batch.layout.weights1; k < batch.layout.parameters; k += 71)
    asked.push_back(k);
  asked.push_back(batch.layout.bias3);
  double scale = 0;
  for (const std::size_t k : asked) scale = std::max(scale, std::abs(double(gradient[k])));
  int kinks = 0;
  for (const std::size_t k : asked) {
    const double at = p[k], step = 1e-5;
    p[k] = at + step;
    const double above = plain.loss(p, batch.targets, 0.01);
    p[k] = at - step;
    const double below = plain.loss(p, batch.targets, 0.01);
    p[k] = at;
    const double slope = (above - below) / (2 * step);
    const double error = std::abs(static_cast<double>(gradient[k]) - slope);
    // Where a maximum or a rectification changes sides within the step there is no derivative.
    if (error > 1e-4 * scale + 1e-3 * std::abs(slope)) ++kinks;
  }
  EXPECT_LE(kinks, static_cast<int>(asked.size()) / 50) << "of " << asked.size();
}

TEST(LearnedNetwork, DropoutIsDifferentiatedAsItIsDrawn) {
  Batch batch;
  BatchOptions options;
  options.keep_statistics = false;
  options.seed = 11;
  std::vector<float> gradient, other;
  const double with = batch.loss(gradient, options);
  options.seed = 12;
  EXPECT_NE(batch.loss(other, options), with);
  options.seed = 11;
  // Along the output's weights, in which the loss is quadratic.
  const std::size_t first = batch.layout.weights3;
  double slope = 0;
  for (std::size_t k = first; k < batch.layout.bias3; ++k)
    slope += static_cast<double>(gradient[k]) * static_cast<double>(gradient[k]);
  const auto moved = [&](double by) {
    const NetworkState before = batch.state;
    for (std::size_t k = first; k < batch.layout.bias3; ++k)
      batch.state.parameters[k] += static_cast<float>(by * static_cast<double>(gradient[k]));
    const double loss = batch.loss(other, options);
    batch.state = before;
    return loss;
  };
  EXPECT_GT(slope, 0);
  EXPECT_NEAR((moved(0.01) - moved(-0.01)) / 0.02, slope, 2e-3 * slope);
}

TEST_P(LearnedNetworks, IsTheSameForAnyNumberOfThreads) {
  Batch batch(GetParam());
  const NetworkState before = batch.state;
  std::vector<float> one, four;
  const double a = batch.loss(one, {});
  const NetworkState after = batch.state;
  batch.state = before;
  EXPECT_EQ(batch.loss(four, {}, 4), a);
  EXPECT_EQ(one, four);
  EXPECT_EQ(after.statistics, batch.state.statistics);
  EXPECT_NE(after.statistics, before.statistics);
}

// Asked, it uses its running statistics.
TEST_P(LearnedNetworks, FoldedItAnswersAsDefined) {
  // Where the running statistics are the batch's, the mean squared error is the batch's.
  Batch same(GetParam());
  std::vector<float> gradient;
  BatchOptions options;
  options.dropout = 0;
  for (int k = 0; k < 140; ++k) same.loss(gradient, options);
  const double loss = same.loss(gradient, options);
  const FoldedNetwork network(same.layout, same.state);
  double sum = 0;
  for (int n = 0; n < same.size; ++n) {
    const auto k = static_cast<std::size_t>(n);
    const double error = static_cast<double>(network.answer(same.bytes[k].data())) -
                         static_cast<double>(same.targets[k]);
    sum += error * error / same.size;
    std::vector<float> grid;
    for (const std::uint8_t byte : same.bytes[k]) grid.push_back(static_cast<float>(byte) / 255);
    EXPECT_NEAR(network.answer(grid), network.answer(same.bytes[k].data()), 1e-4);
  }
  EXPECT_NEAR(sum, loss, 1e-2 * loss);  // they have come so near after 140 batches
}

TEST(LearnedNetwork, MirroringExchangesRightAndLeft) {
  const Batch batch;
  const UnitPlace& unit = batch.layout.units.front();
  std::vector<float> plain(unit.padded() * 2), mirrored(plain);
  decode_grid(batch.layout, batch.bytes[0].data(), false, plain.data());
  decode_grid(batch.layout, batch.bytes[0].data(), true, mirrored.data());
  for (int z = 0; z < unit.size[2]; ++z)
    for (int y = 0; y < unit.size[1]; ++y)
      for (int x = 0; x < unit.size[0]; ++x)
        for (int c = 0; c < 2; ++c) {
          const std::size_t row = unit.row(y, z, 2) + static_cast<std::size_t>(c);
          EXPECT_EQ(plain[row + static_cast<std::size_t>(2 * (x + 1))],
                    mirrored[row + static_cast<std::size_t>(2 * (unit.size[0] - x))]);
        }
}

TEST(LearnedNetwork, RefusesShapesThatCannotBe) {
  NetworkShape shape = small_shape();
  shape.blocks = 3;
  EXPECT_THROW(NetworkLayout{shape}, InputError);
  shape = small_shape(true);
  shape.grid.levels = 5;  // ten maps cannot be added to eight
  EXPECT_THROW(NetworkLayout{shape}, InputError);
  shape = small_shape();
  shape.growth = 12;
  EXPECT_THROW(NetworkLayout{shape}, InputError);
  shape = small_shape();
  shape.units = 16;
  shape.growth = 1024;  // as many as no int counts
  EXPECT_THROW(NetworkLayout{shape}, InputError);
}

}  // namespace
}  // namespace lapwing
