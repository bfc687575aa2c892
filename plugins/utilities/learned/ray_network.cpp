// SPDX-License-Identifier: Apache-2.0
#include "plugins/utilities/learned/ray_network.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "framework/core/error.h"
#include "framework/core/fields.h"
#include "framework/core/parallel.h"
#include "plugins/utilities/learned/backpropagation.h"
#include "plugins/utilities/learned/kernels.h"

namespace lapwing::learned {
namespace {

constexpr double kFirstAnswer = -1;  // z of an untrained network

// rows x depth times depth x columns, plus a bias.
void dense(const float* a, int rows, int depth, const float* weights, int columns, bool rectified,
           float* c) {
  Product product;
  product.a = &a;
  product.a_stride = depth;
  product.depth = depth;
  product.b = weights;
  product.bias = weights + static_cast<std::ptrdiff_t>(depth) * columns;
  product.rows = rows;
  product.columns = columns;
  product.c = c;
  product.c_stride = columns;
  product.rectified = rectified;
  multiply(product);
}

// The padded rows that the nine taps of a convolution read for one row of results.
void taps(const RayNetworkLayout& layout, const float* padded, int dilation, int row,
          const float* parts[9]) {
  const int width = layout.shape.width;
  for (int k = 0; k < 9; ++k)
    parts[k] = padded + static_cast<std::ptrdiff_t>(layout.row(row + (k / 3 - 1) * dilation)) +
               (k % 3 - 1) * dilation * width;
}

// `padded` has a border of zeros, `out` has none.
void convolve(const RayNetworkLayout& layout, const float* padded, int dilation,
              const float* weights, const float* bias, bool rectified, float* out) {
  const int width = layout.shape.width, columns = layout.shape.rays.columns;
  const float* parts[9];
  Product product;
  product.a = parts;
  product.parts = 9;
  product.a_stride = width;
  product.depth = width;
  product.b = weights;
  product.bias = bias;
  product.rows = columns;
  product.columns = width;
  product.c_stride = width;
  product.rectified = rectified;
  for (int row = 0; row < layout.shape.rays.rows; ++row) {
    taps(layout, padded, dilation, row, parts);
    product.c = out + static_cast<std::ptrdiff_t>(row) * columns * width;
    multiply(product);
  }
}

void pad(const RayNetworkLayout& layout, const float* points, float* padded) {
  const std::size_t row = static_cast<std::size_t>(layout.shape.rays.columns) *
                          static_cast<std::size_t>(layout.shape.width);
  for (int k = 0; k < layout.shape.rays.rows; ++k)
    std::copy_n(points + static_cast<std::size_t>(k) * row, row, padded + layout.row(k));
}

template <class Read>
void decode(const RayNetworkLayout& layout, bool mirrored, float* inputs, Read read) {
  const RayShape& rays = layout.shape.rays;
  std::size_t from = 0;
  for (int row = 0; row < rays.rows; ++row)
    for (int column = 0; column < rays.columns; ++column) {
      const int at = mirrored ? rays.columns - 1 - column : column;
      float* to =
          inputs + static_cast<std::ptrdiff_t>(row * rays.columns + at) * RayNetworkLayout::kInputs;
      for (int c = 0; c < RayShape::kChannels; ++c) to[c] = read(from++);
      to[RayShape::kChannels] =
          -1 + 2 * static_cast<float>(row) / static_cast<float>(rays.rows - 1);
      to[RayShape::kChannels + 1] =
          std::abs(-1 + 2 * static_cast<float>(at) / static_cast<float>(rays.columns - 1));
      std::fill(to + RayShape::kChannels + RayNetworkLayout::kPlaces,
                to + RayNetworkLayout::kInputs, 0.0f);
    }
}

float softplus(float z) {
  return z > 15 ? z : std::log1p(std::exp(z));
}

}  // namespace

void require_sense(const RayNetworkShape& shape) {
  lapwing::require_sense(shape.rays);
  if (shape.width < kLanes || shape.width > RayNetworkShape::kMostWidth ||
      shape.width % kLanes != 0)
    throw InputError("width must be a multiple of 8 up to " +
                     std::to_string(RayNetworkShape::kMostWidth) + ", not " +
                     std::to_string(shape.width));
  if (shape.convolutions < 0 || shape.convolutions > RayNetworkShape::kMostConvolutions)
    throw InputError("convolutions: expected 0 to " +
                     std::to_string(RayNetworkShape::kMostConvolutions) + ", not " +
                     std::to_string(shape.convolutions));
}

Value to_value(const RayNetworkShape& shape) {
  Value value = Value::map();
  value.set("rays", lapwing::to_value(shape.rays));
  value.set("width", shape.width);
  value.set("convolutions", shape.convolutions);
  return value;
}

RayNetworkShape ray_network_shape_from(const Value& value) {
  Diagnostics errors;
  Fields fields(value, "network", errors);
  RayNetworkShape shape;
  const Value rays = fields.opaque("rays");
  shape.width = fields.integer("width", kLanes, RayNetworkShape::kMostWidth);
  shape.convolutions = fields.integer("convolutions", 0, RayNetworkShape::kMostConvolutions);
  fields.finish();
  errors.throw_if_any();
  shape.rays = ray_shape_from(rays);
  require_sense(shape);
  return shape;
}

RayNetworkLayout::RayNetworkLayout(const RayNetworkShape& given) : shape(given) {
  require_sense(shape);
  const auto width = static_cast<std::size_t>(shape.width);
  const auto take = [&](std::size_t inputs, std::size_t outputs) {
    const std::size_t begin = parameters;
    parameters += (inputs + 1) * outputs;
    return begin;
  };
  first = take(kInputs, width);
  for (int k = 0; k < shape.convolutions; ++k) {
    convolutions.push_back(take(9 * width, width));
    border = 1 << k;
  }
  last = take(width, width);
  output = take(width, 1);
}

std::vector<float> initial_parameters(const RayNetworkLayout& layout, Random random) {
  std::vector<float> parameters(layout.parameters, 0);
  const auto width = static_cast<std::size_t>(layout.shape.width);
  const auto draw = [&](std::size_t begin, std::size_t inputs, std::size_t outputs, double sigma) {
    for (std::size_t k = 0; k < inputs * outputs; ++k)
      parameters[begin + k] = static_cast<float>(sigma * random.normal());
  };
  const auto he = [](std::size_t inputs) { return std::sqrt(2 / static_cast<double>(inputs)); };
  constexpr std::size_t kUsed = RayShape::kChannels + RayNetworkLayout::kPlaces;
  draw(layout.first, kUsed, width, he(kUsed));
  for (const std::size_t begin : layout.convolutions) draw(begin, 9 * width, width, he(9 * width));
  draw(layout.last, width, width, he(width));
  draw(layout.output, width, 1, 0.05);
  parameters[layout.output + width] = static_cast<float>(kFirstAnswer);
  return parameters;
}

void decode_rays(const RayNetworkLayout& layout, const std::uint8_t* bytes, bool mirrored,
                 float* inputs) {
  decode(layout, mirrored, inputs,
         [&](std::size_t k) { return static_cast<float>(bytes[k]) * (1 / 255.0f); });
}

void decode_targets(const RayShape& rays, const float* targets, bool mirrored, float* to) {
  for (int row = 0; row < rays.rows; ++row)
    for (int column = 0; column < rays.columns; ++column)
      to[row * rays.columns + (mirrored ? rays.columns - 1 - column : column)] = *targets++;
}

namespace {

// Everything that one sample leaves behind on its way forward.
struct Forward {
  std::vector<float> inputs;
  std::vector<float> first;                 // what the first dense layer gives
  std::vector<std::vector<float>> padded;   // what each convolution reads
  std::vector<std::vector<float>> results;  // what it gives, rectified, before it is added
  std::vector<float> points, hidden;        // before and behind the last dense layer
  std::vector<float> z;

  explicit Forward(const RayNetworkLayout& layout)
      : inputs(static_cast<std::size_t>(layout.rays() * RayNetworkLayout::kInputs)),
        first(layout.points()),
        padded(layout.convolutions.size(), std::vector<float>(layout.padded(), 0)),
        results(layout.convolutions.size(), std::vector<float>(layout.points())),
        points(layout.points()),
        hidden(layout.points()),
        z(static_cast<std::size_t>(layout.rays())) {}
};

void run(const RayNetworkLayout& layout, const float* parameters, Forward& f) {
  const int width = layout.shape.width, rays = layout.rays();
  const auto wide = static_cast<std::size_t>(width);
  dense(f.inputs.data(), rays, RayNetworkLayout::kInputs, parameters + layout.first, width, true,
        f.first.data());
  f.points = f.first;
  for (std::size_t k = 0; k < layout.convolutions.size(); ++k) {
    const float* weights = parameters + layout.convolutions[k];
    pad(layout, f.points.data(), f.padded[k].data());
    convolve(layout, f.padded[k].data(), 1 << k, weights, weights + 9 * wide * wide, true,
             f.results[k].data());
    for (std::size_t i = 0; i < f.points.size(); ++i) f.points[i] += f.results[k][i];
  }
  dense(f.points.data(), rays, width, parameters + layout.last, width, true, f.hidden.data());
  const float* weights = parameters + layout.output;
  for (std::size_t ray = 0; ray < f.z.size(); ++ray) {
    float sum = weights[wide];
    for (std::size_t c = 0; c < wide; ++c) sum += f.hidden[ray * wide + c] * weights[c];
    f.z[ray] = sum;
  }
}

Forward& scratch_of(const RayNetworkLayout& layout) {
  thread_local RayNetworkShape shape;
  thread_local std::unique_ptr<Forward> forward;
  if (!forward || !(shape == layout.shape)) {
    forward = std::make_unique<Forward>(layout);
    shape = layout.shape;
  }
  return *forward;
}

}  // namespace

void RayNetwork::answer(std::span<const float> image, std::span<float> cells) const {
  Forward& f = scratch_of(layout_);
  decode(layout_, false, f.inputs.data(), [&](std::size_t k) { return image[k]; });
  run(layout_, parameters_.data(), f);
  for (std::size_t k = 0; k < cells.size(); ++k) cells[k] = softplus(f.z[k]);
}

void RayNetwork::answer(const std::uint8_t* bytes, std::span<float> cells) const {
  Forward& f = scratch_of(layout_);
  decode_rays(layout_, bytes, false, f.inputs.data());
  run(layout_, parameters_.data(), f);
  for (std::size_t k = 0; k < cells.size(); ++k) cells[k] = softplus(f.z[k]);
}

double ray_loss(std::span<const float> answers, std::span<const float> targets) {
  double likelihood = 0, told = 0, there = 0;
  for (std::size_t k = 0; k < answers.size(); ++k) {
    const double p = static_cast<double>(answers[k]), t = static_cast<double>(targets[k]);
    likelihood += p - t * std::log(p + kRayFloor);
    told += p;
    there += t;
  }
  const double count = static_cast<double>(answers.size());
  return likelihood / count + (told - there) * (told - there) / (there + kRaySpread) / count;
}

// -- training ------------------------------------------------------------------------------------

struct RayBackpropagation::Sample {
  Forward forward;
  std::vector<float> targets;
  double loss = 0;
  // Gradients: of z, of the points behind the last dense layer, of the points, padded ones.
  std::vector<float> of_z, of_hidden, of_points, of_padded, back;

  explicit Sample(const RayNetworkLayout& layout)
      : forward(layout),
        targets(static_cast<std::size_t>(layout.rays())),
        of_z(targets.size()),
        of_hidden(layout.points()),
        of_points(layout.points()),
        of_padded(layout.padded(), 0),
        back(layout.points()) {}
};

RayBackpropagation::RayBackpropagation(const RayNetworkLayout& layout, int batch, int threads)
    : layout_(layout),
      batch_(batch),
      threads_(threads),
      samples_(static_cast<std::size_t>(batch), Sample(layout)),
      sums_(kShards, std::vector<float>(layout.parameters)) {}

RayBackpropagation::~RayBackpropagation() = default;

float* RayBackpropagation::input(int sample) {
  return samples_[static_cast<std::size_t>(sample)].forward.inputs.data();
}

float* RayBackpropagation::target(int sample) {
  return samples_[static_cast<std::size_t>(sample)].targets.data();
}

double RayBackpropagation::loss(std::span<const float> parameters, std::span<float> gradient) {
  if (parameters.size() != layout_.parameters || gradient.size() != layout_.parameters)
    throw Error("parameters of another network");
  const int width = layout_.shape.width, rays = layout_.rays(),
            columns = layout_.shape.rays.columns;
  const auto wide = static_cast<std::size_t>(width);
  // What the gradients of inputs are multiplied with: the weights, turned round.
  std::vector<float> last_turned(wide * wide);
  for (std::size_t i = 0; i < wide; ++i)
    for (std::size_t o = 0; o < wide; ++o)
      last_turned[o * wide + i] = parameters[layout_.last + i * wide + o];
  std::vector<std::vector<float>> turned;
  for (const std::size_t begin : layout_.convolutions) {
    std::vector<float>& weights = turned.emplace_back(9 * wide * wide);
    for (std::size_t tap = 0; tap < 9; ++tap)
      for (std::size_t i = 0; i < wide; ++i)
        for (std::size_t o = 0; o < wide; ++o)
          weights[((8 - tap) * wide + o) * wide + i] =
              parameters[begin + (tap * wide + i) * wide + o];
  }
  const double share = 1 / (static_cast<double>(batch_) * static_cast<double>(rays));
  const auto backward = [&](Sample& s, float* sum) {
    Forward& f = s.forward;
    run(layout_, parameters.data(), f);
    double told = 0, there = 0, likelihood = 0;
    std::vector<float>& answers = s.of_z;
    for (std::size_t k = 0; k < f.z.size(); ++k) {
      answers[k] = softplus(f.z[k]);
      told += static_cast<double>(answers[k]);
      there += static_cast<double>(s.targets[k]);
    }
    const double excess = 2 * (told - there) / (there + kRaySpread);
    for (std::size_t k = 0; k < f.z.size(); ++k) {
      const double p = static_cast<double>(answers[k]), t = static_cast<double>(s.targets[k]);
      likelihood += p - t * std::log(p + kRayFloor);
      const double slope = 1 / (1 + std::exp(-static_cast<double>(f.z[k])));
      s.of_z[k] = static_cast<float>((1 - t / (p + kRayFloor) + excess) * slope * share);
    }
    s.loss = likelihood + (told - there) * (told - there) / (there + kRaySpread);
    // The output and the last dense layer.
    const float* output = parameters.data() + layout_.output;
    float* of_output = sum + layout_.output;
    for (std::size_t ray = 0; ray < f.z.size(); ++ray) {
      const float g = s.of_z[ray];
      of_output[wide] += g;
      for (std::size_t c = 0; c < wide; ++c) {
        const float h = f.hidden[ray * wide + c];
        of_output[c] += g * h;
        s.of_hidden[ray * wide + c] = h > 0 ? g * output[c] : 0.0f;
      }
    }
    const auto of_bias = [&](const std::vector<float>& g, float* to) {
      for (std::size_t k = 0; k < g.size(); k += wide)
        for (std::size_t c = 0; c < wide; ++c) to[c] += g[k + c];
    };
    const auto of_dense = [&](const float* a, int depth, const float* g, float* to) {
      accumulate({&a, &g, 1, rays, depth, width, depth, width, to});
    };
    of_dense(f.points.data(), width, s.of_hidden.data(), sum + layout_.last);
    of_bias(s.of_hidden, sum + layout_.last + wide * wide);
    {
      const float* a = s.of_hidden.data();
      Product product;
      product.a = &a;
      product.a_stride = width;
      product.depth = width;
      product.b = last_turned.data();
      product.rows = rays;
      product.columns = width;
      product.c = s.of_points.data();
      product.c_stride = width;
      multiply(product);
    }
    // The convolutions, last first: each hands its gradient on, and adds what came through it.
    for (std::size_t k = layout_.convolutions.size(); k-- > 0;) {
      const int dilation = 1 << k;
      for (std::size_t i = 0; i < s.back.size(); ++i)
        s.back[i] = f.results[k][i] > 0 ? s.of_points[i] : 0.0f;
      float* of_weights = sum + layout_.convolutions[k];
      of_bias(s.back, of_weights + 9 * wide * wide);
      pad(layout_, s.back.data(), s.of_padded.data());
      const auto lines = static_cast<std::size_t>(layout_.shape.rays.rows);
      std::vector<const float*> a(lines), g(lines);
      for (int tap = 0; tap < 9; ++tap) {
        for (std::size_t row = 0; row < lines; ++row) {
          const float* parts[9];
          taps(layout_, f.padded[k].data(), dilation, static_cast<int>(row), parts);
          a[row] = parts[tap];
          g[row] = s.of_padded.data() + layout_.row(static_cast<int>(row));
        }
        accumulate({a.data(), g.data(), static_cast<int>(lines), columns, width, width, width,
                    width, of_weights + static_cast<std::size_t>(tap) * wide * wide});
      }
      convolve(layout_, s.of_padded.data(), dilation, turned[k].data(), nullptr, false,
               s.back.data());
      for (std::size_t i = 0; i < s.back.size(); ++i) s.of_points[i] += s.back[i];
    }
    for (std::size_t i = 0; i < s.of_points.size(); ++i)
      if (!(f.first[i] > 0)) s.of_points[i] = 0;
    of_dense(f.inputs.data(), RayNetworkLayout::kInputs, s.of_points.data(), sum + layout_.first);
    of_bias(s.of_points, sum + layout_.first + RayNetworkLayout::kInputs * wide);
  };
  const auto n = static_cast<std::size_t>(batch_);
  parallel_for(kShards, threads_, [&](std::size_t shard) {
    std::fill(sums_[shard].begin(), sums_[shard].end(), 0.0f);
    for (std::size_t k = n * shard / kShards; k < n * (shard + 1) / kShards; ++k)
      backward(samples_[k], sums_[shard].data());
  });
  double loss = 0;
  for (const Sample& sample : samples_) loss += sample.loss * share;
  for (std::size_t k = 0; k < gradient.size(); ++k) {
    float sum = 0;
    for (const auto& part : sums_) sum += part[k];
    gradient[k] = sum;
  }
  return loss;
}

}  // namespace lapwing::learned
