// SPDX-License-Identifier: Apache-2.0
#include "plugins/utilities/learned/backpropagation.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/parallel.h"
#include "plugins/utilities/learned/kernels.h"

namespace lapwing::learned {
namespace {

constexpr float kVariance = 1e-5f;  // added to variances

// A number from 0 to 1 for one place of one batch.
double place_uniform(std::uint64_t seed, std::uint64_t place) {
  std::uint64_t z = seed + 0x9e3779b97f4a7c15ull * (place + 1);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

}  // namespace

double dropout_factor(const BatchOptions& options, int layer, std::size_t number) {
  const std::uint64_t place = number + (static_cast<std::uint64_t>(layer) << 40);
  const bool stays = options.dropout <= 0 || place_uniform(options.seed, place) >= options.dropout;
  return stays ? 1 / (1 - options.dropout) : 0;
}

struct Backpropagation::Unit {
  std::vector<float> input;     // padded, of all samples
  std::vector<float> result;    // of the convolution, before its normalisation
  std::vector<float> gradient;  // of the result, padded
  std::vector<float> active;    // of the last unit of a block: what is pooled
  std::vector<float> shortcut;  // residual: gradient of what the input was added to, its maps
  std::vector<std::uint8_t> place;
  std::vector<float> mean, inverse;  // of the batch: mean, one over the deviation
};

Backpropagation::Backpropagation(const NetworkLayout& layout, int batch, int threads)
    : layout_(layout),
      batch_(batch),
      threads_(threads),
      units_(layout.units.size()),
      shard_sums_(kShards) {
  const auto n = static_cast<std::size_t>(batch);
  std::size_t most_points = 0, most_weights = 0;
  for (std::size_t k = 0; k < units_.size(); ++k) {
    const UnitPlace& place = layout_.units[k];
    Unit& unit = units_[k];
    const auto in = static_cast<std::size_t>(place.in), out = static_cast<std::size_t>(place.out);
    const auto points = static_cast<std::size_t>(place.points());
    unit.input.assign(n * place.padded() * in, 0);
    unit.result.assign(n * points * out, 0);
    unit.mean.assign(out, 0);
    unit.inverse.assign(out, 0);
    if (place.last_of_block) {
      unit.active.assign(n * points * out, 0);
      unit.place.assign(n * points / 8 * out, 0);
    }
    unit.gradient.assign(n * place.padded() * out, 0);
    if (layout_.shape.residual && k > 0) unit.shortcut.assign(n * points * in, 0);
    most_points = std::max(most_points, n * points * std::max(in, out));
    most_weights = std::max(most_weights, 27 * in * out);
  }
  points_gradient_.assign(most_points, 0);
  flat_.assign(n * static_cast<std::size_t>(layout_.flat), 0);
  flat_gradient_ = flat_;
  for (auto& sums : shard_sums_) sums.assign(most_weights, 0);
}

Backpropagation::~Backpropagation() = default;

float* Backpropagation::input(int sample) {
  const UnitPlace& place = layout_.units.front();
  return units_.front().input.data() +
         static_cast<std::size_t>(sample) * place.padded() * static_cast<std::size_t>(place.in);
}

template <class Body>
void Backpropagation::for_samples(const Body& body) {
  parallel_for(static_cast<std::size_t>(batch_), threads_, body);
}

// body(shard, first sample, end)
template <class Body>
void Backpropagation::for_shards(const Body& body) {
  const auto n = static_cast<std::size_t>(batch_);
  parallel_for(kShards, threads_,
               [&](std::size_t s) { body(s, n * s / kShards, n * (s + 1) / kShards); });
}

void Backpropagation::forward_unit(std::size_t k, NetworkState& state, bool keep) {
  const UnitPlace& place = layout_.units[k];
  Unit& unit = units_[k];
  const auto out = static_cast<std::size_t>(place.out),
             points = static_cast<std::size_t>(place.points());
  const std::size_t each_in = place.padded() * static_cast<std::size_t>(place.in);
  for_samples([&](std::size_t n) {
    convolve(place, unit.input.data() + n * each_in, place.in,
             state.parameters.data() + place.weights, nullptr, false, place.out,
             unit.result.data() + n * points * out);
  });
  // Mean and variance over samples and points.
  std::vector<std::vector<double>> sums(kShards, std::vector<double>(2 * out, 0.0));
  for_shards([&](std::size_t s, std::size_t first, std::size_t end) {
    std::vector<double>& sum = sums[s];
    std::vector<float> part(2 * out);
    for (std::size_t n = first; n < end; ++n) {
      const float* y = unit.result.data() + n * points * out;
      // A row of points at a time in single precision.
      for (std::size_t p = 0; p < points; p += 8, y += 8 * out) {
        std::fill(part.begin(), part.end(), 0.0f);
        for (std::size_t q = 0; q < 8; ++q)
          for (std::size_t c = 0; c < out; ++c) {
            part[c] += y[q * out + c];
            part[out + c] += y[q * out + c] * y[q * out + c];
          }
        for (std::size_t c = 0; c < 2 * out; ++c) sum[c] += part[c];
      }
    }
  });
  const double count = static_cast<double>(batch_) * static_cast<double>(points);
  std::vector<float> factor(out), shift(out);
  for (std::size_t c = 0; c < out; ++c) {
    double sum = 0, squares = 0;
    for (const auto& part : sums) {
      sum += part[c];
      squares += part[out + c];
    }
    const double mean = sum / count, variance = std::max(squares / count - mean * mean, 0.0);
    unit.mean[c] = static_cast<float>(mean);
    unit.inverse[c] = static_cast<float>(1 / std::sqrt(variance + static_cast<double>(kVariance)));
    if (keep) {
      float& m = state.statistics[place.mean + c];
      float& v = state.statistics[place.variance + c];
      m += static_cast<float>(kStatisticsMomentum * (mean - static_cast<double>(m)));
      v += static_cast<float>(kStatisticsMomentum * (variance - static_cast<double>(v)));
    }
    factor[c] = state.parameters[place.scale + c] * unit.inverse[c];
    shift[c] = state.parameters[place.shift + c] - unit.mean[c] * factor[c];
  }
  const bool last = k + 1 == units_.size();
  for_samples([&](std::size_t n) {
    const float* y = unit.result.data() + n * points * out;
    if (place.last_of_block) {
      float* active = unit.active.data() + n * points * out;
      for (std::size_t p = 0; p < points; ++p)
        for (std::size_t c = 0; c < out; ++c)
          active[p * out + c] = std::max(y[p * out + c] * factor[c] + shift[c], 0.0f);
      if (layout_.shape.residual) add_input(place, unit.input.data() + n * each_in, active);
      float* to = last ? flat_.data() + n * static_cast<std::size_t>(layout_.flat)
                       : units_[k + 1].input.data() + n * layout_.units[k + 1].padded() * out;
      pool(place.size, place.out, active, !last, to, unit.place.data() + n * points / 8 * out);
      return;
    }
    float* next = units_[k + 1].input.data() + n * place.padded() * out;
    const auto row = static_cast<std::size_t>(place.size[0]),
               in = static_cast<std::size_t>(place.in);
    for (int z = 0; z < place.size[2]; ++z)
      for (int i = 0; i < place.size[1]; ++i, y += row * out) {
        float* to = next + place.row(i, z, place.out) + out;
        for (std::size_t x = 0; x < row; ++x)
          for (std::size_t c = 0; c < out; ++c)
            to[x * out + c] = std::max(y[x * out + c] * factor[c] + shift[c], 0.0f);
        if (!layout_.shape.residual) continue;
        const float* from = unit.input.data() + n * each_in + place.row(i, z, place.in) + in;
        for (std::size_t x = 0; x < row; ++x)
          for (std::size_t c = 0; c < in; ++c) to[x * out + c] += from[x * in + c];
      }
  });
}

// `points_gradient_` holds the gradient of the unit's rectified results; afterwards that of the
// unit before, or of what was pooled before it.
void Backpropagation::backward_unit(std::size_t k, const NetworkState& state,
                                    std::span<float> gradient) {
  const UnitPlace& place = layout_.units[k];
  Unit& unit = units_[k];
  const auto out = static_cast<std::size_t>(place.out), in = static_cast<std::size_t>(place.in),
             points = static_cast<std::size_t>(place.points());
  const float* scale = state.parameters.data() + place.scale;
  const float* shift = state.parameters.data() + place.shift;
  if (!unit.shortcut.empty())
    for_samples([&](std::size_t n) {
      for (std::size_t p = n * points; p < (n + 1) * points; ++p)
        std::copy_n(points_gradient_.data() + p * out, in, unit.shortcut.data() + p * in);
    });
  // Through rectification and normalisation.
  std::vector<std::vector<double>> sums(kShards, std::vector<double>(2 * out, 0.0));
  for_shards([&](std::size_t s, std::size_t first, std::size_t end) {
    const Normalisation normalisation{out, unit.mean.data(), unit.inverse.data(), scale, shift};
    for (std::size_t n = first; n < end; ++n)
      back_through(normalisation, points, unit.result.data() + n * points * out,
                   points_gradient_.data() + n * points * out, sums[s].data());
  });
  const double count = static_cast<double>(batch_) * static_cast<double>(points);
  std::vector<float> mean_shift(out), mean_scale(out);
  for (std::size_t c = 0; c < out; ++c) {
    double of_shift = 0, of_scale = 0;
    for (const auto& part : sums) {
      of_shift += part[c];
      of_scale += part[out + c];
    }
    gradient[place.shift + c] = static_cast<float>(of_shift);
    gradient[place.scale + c] = static_cast<float>(of_scale);
    mean_shift[c] = static_cast<float>(of_shift / count);
    mean_scale[c] = static_cast<float>(of_scale / count);
  }
  const std::size_t each_out = place.padded() * out, each_in = place.padded() * in;
  for_samples([&](std::size_t n) {
    const float* y = unit.result.data() + n * points * out;
    const float* g = points_gradient_.data() + n * points * out;
    float* to = unit.gradient.data() + n * each_out;
    const auto row = static_cast<std::size_t>(place.size[0]);
    for (int z = 0; z < place.size[2]; ++z)
      for (int i = 0; i < place.size[1]; ++i, y += row * out, g += row * out) {
        float* d = to + place.row(i, z, place.out) + out;
        for (std::size_t x = 0; x < row; ++x)
          for (std::size_t c = 0; c < out; ++c) {
            const float normal = (y[x * out + c] - unit.mean[c]) * unit.inverse[c];
            d[x * out + c] = scale[c] * unit.inverse[c] *
                             (g[x * out + c] - mean_shift[c] - normal * mean_scale[c]);
          }
      }
  });
  // Of the weights: nine offsets of rows, three points and all maps at a time.
  const std::size_t weights = 27 * in * out;
  for_shards([&](std::size_t s, std::size_t first, std::size_t end) {
    std::fill_n(shard_sums_[s].begin(), weights, 0.0f);
    const auto lines = static_cast<std::size_t>(place.size[1] * place.size[2]);
    std::vector<const float*> a(lines), g(lines);
    for (std::size_t n = first; n < end; ++n)
      for (int part = 0; part < 9; ++part) {
        std::size_t line = 0;
        for (int z = 0; z < place.size[2]; ++z)
          for (int i = 0; i < place.size[1]; ++i, ++line) {
            a[line] = unit.input.data() + n * each_in +
                      place.row(i + part % 3 - 1, z + part / 3 - 1, place.in);
            g[line] = unit.gradient.data() + n * each_out + place.row(i, z, place.out) + out;
          }
        OuterProduct product;
        product.a = a.data();
        product.g = g.data();
        product.lines = static_cast<int>(lines);
        product.rows = place.size[0];
        product.a_stride = place.in;
        product.g_stride = place.out;
        product.depth = 3 * place.in;
        product.columns = place.out;
        product.d = shard_sums_[s].data() + static_cast<std::size_t>(part) * 3 * in * out;
        accumulate(product);
      }
  });
  for (std::size_t w = 0; w < weights; ++w) {
    float sum = 0;
    for (const auto& part : shard_sums_) sum += part[w];
    gradient[place.weights + w] = sum;
  }
  if (k == 0) return;
  // Of the input: the same convolution with the weights turned round.
  std::vector<float> turned(weights);
  for (std::size_t tap = 0; tap < 27; ++tap)
    for (std::size_t i = 0; i < in; ++i)
      for (std::size_t o = 0; o < out; ++o)
        turned[((26 - tap) * out + o) * in + i] =
            state.parameters[place.weights + (tap * in + i) * out + o];
  for_samples([&](std::size_t n) {
    convolve(place, unit.gradient.data() + n * each_out, place.out, turned.data(), nullptr, false,
             place.in, points_gradient_.data() + n * points * in);
    if (unit.shortcut.empty()) return;
    for (std::size_t i = n * points * in; i < (n + 1) * points * in; ++i)
      points_gradient_[i] += unit.shortcut[i];
  });
}

double Backpropagation::dense_layers(const NetworkState& state, std::span<const float> targets,
                                     const BatchOptions& options, std::span<float> gradient) {
  const auto n = static_cast<std::size_t>(batch_);
  const int width[4] = {layout_.flat, layout_.shape.hidden1, layout_.shape.hidden2, 1};
  const std::size_t weights[3] = {layout_.weights1, layout_.weights2, layout_.weights3};
  const std::size_t bias[3] = {layout_.bias1, layout_.bias2, layout_.bias3};
  std::vector<float> layers[2], slopes[2];  // hidden numbers; what they were multiplied with
  const float* in = flat_.data();
  for (int layer = 0; layer < 2; ++layer) {
    const auto w = static_cast<std::size_t>(width[layer + 1]);
    layers[layer].assign(n * w, 0);
    slopes[layer].assign(n * w, 0);
    Product product;
    product.a = &in;
    product.a_stride = width[layer];
    product.depth = width[layer];
    product.b = state.parameters.data() + weights[layer];
    product.bias = state.parameters.data() + bias[layer];
    product.rows = batch_;
    product.columns = width[layer + 1];
    product.c = layers[layer].data();
    product.c_stride = width[layer + 1];
    product.rectified = true;
    multiply(product);
    for (std::size_t k = 0; k < n * w; ++k) {
      float& at = layers[layer][k];
      const auto factor = static_cast<float>(dropout_factor(options, layer, k));
      slopes[layer][k] = at > 0 ? factor : 0.0f;
      at *= factor;
    }
    in = layers[layer].data();
  }
  // The output and the loss.
  const auto last = static_cast<std::size_t>(width[2]);
  const float* w3 = state.parameters.data() + weights[2];
  std::vector<float> g2(n * last, 0);
  std::vector<double> of_w3(last, 0.0);
  double loss = 0, of_b3 = 0;
  for (std::size_t i = 0; i < n; ++i) {
    double answer = static_cast<double>(state.parameters[bias[2]]);
    for (std::size_t c = 0; c < last; ++c)
      answer += static_cast<double>(layers[1][i * last + c]) * static_cast<double>(w3[c]);
    const double error = answer - static_cast<double>(targets[i]);
    loss += error * error / static_cast<double>(n);
    const double slope = 2 * error / static_cast<double>(n);
    of_b3 += slope;
    for (std::size_t c = 0; c < last; ++c) {
      of_w3[c] += slope * static_cast<double>(layers[1][i * last + c]);
      g2[i * last + c] = static_cast<float>(slope) * w3[c] * slopes[1][i * last + c];
    }
  }
  gradient[bias[2]] = static_cast<float>(of_b3);
  for (std::size_t c = 0; c < last; ++c) gradient[weights[2] + c] = static_cast<float>(of_w3[c]);
  // Back through the hidden layers.
  std::vector<float> g1(n * static_cast<std::size_t>(width[1]), 0);
  const auto back = [&](int layer, const float* input, const std::vector<float>& g,
                        std::vector<float>& g_input) {
    const auto wide = static_cast<std::size_t>(width[layer]),
               narrow = static_cast<std::size_t>(width[layer + 1]);
    const float* a = input;
    const float* gp = g.data();
    float* d = gradient.data() + weights[layer];
    std::fill_n(d, wide * narrow, 0.0f);
    accumulate(
        {&a, &gp, 1, batch_, width[layer], width[layer + 1], width[layer], width[layer + 1], d});
    for (std::size_t c = 0; c < narrow; ++c) {
      double sum = 0;
      for (std::size_t i = 0; i < n; ++i) sum += static_cast<double>(g[i * narrow + c]);
      gradient[bias[layer] + c] = static_cast<float>(sum);
    }
    std::vector<float> turned(wide * narrow);
    for (std::size_t i = 0; i < wide; ++i)
      for (std::size_t o = 0; o < narrow; ++o)
        turned[o * wide + i] = state.parameters[weights[layer] + i * narrow + o];
    Product product;
    product.a = &gp;
    product.a_stride = width[layer + 1];
    product.depth = width[layer + 1];
    product.b = turned.data();
    product.rows = batch_;
    product.columns = width[layer];
    product.c = g_input.data();
    product.c_stride = width[layer];
    multiply(product);
  };
  back(1, layers[0].data(), g2, g1);
  for (std::size_t k = 0; k < g1.size(); ++k) g1[k] *= slopes[0][k];
  back(0, flat_.data(), g1, flat_gradient_);
  return loss;
}

double Backpropagation::loss(NetworkState& state, std::span<const float> targets,
                             const BatchOptions& options, std::span<float> gradient) {
  if (targets.size() != static_cast<std::size_t>(batch_) || gradient.size() != layout_.parameters)
    throw Error("a batch of another size");
  for (std::size_t k = 0; k < units_.size(); ++k) forward_unit(k, state, options.keep_statistics);
  double loss = dense_layers(state, targets, options, gradient);
  for (std::size_t k = units_.size(); k-- > 0;) {
    const UnitPlace& place = layout_.units[k];
    if (place.last_of_block) {
      // Each maximum hands its gradient to where it came from.
      const bool last = k + 1 == units_.size();
      const std::vector<float> pooled =
          last ? flat_gradient_
               : std::vector<float>(points_gradient_.begin(),
                                    points_gradient_.begin() +
                                        static_cast<std::ptrdiff_t>(units_[k].place.size()));
      const auto out = static_cast<std::size_t>(place.out),
                 points = static_cast<std::size_t>(place.points());
      for_samples([&](std::size_t n) {
        float* to = points_gradient_.data() + n * points * out;
        std::fill_n(to, points * out, 0.0f);
        const float* from = pooled.data() + n * points / 8 * out;
        const std::uint8_t* which = units_[k].place.data() + n * points / 8 * out;
        for (int z = 0; z < place.size[2] / 2; ++z)
          for (int y = 0; y < place.size[1] / 2; ++y)
            for (int x = 0; x < place.size[0] / 2; ++x)
              for (std::size_t c = 0; c < out; ++c, ++from, ++which) {
                const int dz = *which >> 2, dy = *which >> 1 & 1, dx = *which & 1;
                const int point =
                    ((2 * z + dz) * place.size[1] + 2 * y + dy) * place.size[0] + 2 * x + dx;
                to[static_cast<std::size_t>(point) * out + c] = *from;
              }
      });
    }
    backward_unit(k, state, gradient);
  }
  double squares = 0;
  for (const auto& [begin, end] : layout_.regularised)
    for (std::size_t k = begin; k < end; ++k) {
      const double w = static_cast<double>(state.parameters[k]);
      squares += w * w;
      gradient[k] += static_cast<float>(2 * options.regularisation * w);
    }
  return loss + options.regularisation * squares;
}

void Adam::step(std::span<float> parameters, std::span<const float> gradient, double rate) {
  constexpr double kFirst = 0.9, kSecond = 0.999, kSmall = 1e-8;
  ++steps;
  const double t = static_cast<double>(steps);
  const float factor =
      static_cast<float>(rate * std::sqrt(1 - std::pow(kSecond, t)) / (1 - std::pow(kFirst, t)));
  const float small = static_cast<float>(kSmall * std::sqrt(1 - std::pow(kSecond, t)));
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const float g = gradient[k];
    first[k] += static_cast<float>(1 - kFirst) * (g - first[k]);
    second[k] += static_cast<float>(1 - kSecond) * (g * g - second[k]);
    parameters[k] -= factor * first[k] / (std::sqrt(second[k]) + small);
  }
}

}  // namespace lapwing::learned
