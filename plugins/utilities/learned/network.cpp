// SPDX-License-Identifier: Apache-2.0
#include "plugins/utilities/learned/network.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/fields.h"
#include "plugins/utilities/learned/kernels.h"

namespace lapwing::learned {

void require_sense(const NetworkShape& shape) {
  lapwing::require_sense(shape.grid);
  if (shape.blocks < 1 || shape.blocks > NetworkShape::kMostBlocks || shape.units < 1 ||
      shape.units > NetworkShape::kMostUnits)
    throw InputError("a network of " + std::to_string(shape.blocks) + " blocks of " +
                     std::to_string(shape.units) + " units: expected 1 to 5 and 1 to 16");
  for (const int edge : {shape.grid.across, shape.grid.ahead, shape.grid.up})
    if (edge % (1 << shape.blocks) != 0)
      throw InputError("an edge of " + std::to_string(edge) + " points cannot be halved " +
                       std::to_string(shape.blocks) + " times");
  for (const int width : {shape.growth, shape.hidden1, shape.hidden2})
    if (width < kLanes || width > NetworkShape::kMostWidth || width % kLanes != 0)
      throw InputError("growth and hidden layers must be multiples of 8 up to 1024, not " +
                       std::to_string(width));
  if (shape.residual && shape.grid.channels() > shape.growth)
    throw InputError("residual units cannot add an input of " +
                     std::to_string(shape.grid.channels()) + " maps to " +
                     std::to_string(shape.growth) + ": take fewer levels or a larger growth");
}

Value to_value(const NetworkShape& shape) {
  Value value = Value::map();
  value.set("grid", lapwing::to_value(shape.grid));
  value.set("blocks", shape.blocks);
  value.set("units", shape.units);
  value.set("growth", shape.growth);
  value.set("hidden1", shape.hidden1);
  value.set("hidden2", shape.hidden2);
  if (shape.residual) value.set("residual", true);
  return value;
}

NetworkShape network_shape_from(const Value& value) {
  Diagnostics errors;
  Fields fields(value, "network", errors);
  NetworkShape shape;
  const Value grid = fields.opaque("grid");
  shape.blocks = fields.integer("blocks", 1, NetworkShape::kMostBlocks);
  shape.units = fields.integer("units", 1, NetworkShape::kMostUnits);
  shape.growth = fields.integer("growth", kLanes, NetworkShape::kMostWidth);
  shape.hidden1 = fields.integer("hidden1", kLanes, NetworkShape::kMostWidth);
  shape.hidden2 = fields.integer("hidden2", kLanes, NetworkShape::kMostWidth);
  if (fields.has("residual")) shape.residual = fields.boolean("residual");
  fields.finish();
  errors.throw_if_any();
  shape.grid = grid_shape_from(grid);
  require_sense(shape);
  return shape;
}

NetworkLayout::NetworkLayout(const NetworkShape& given) : shape(given) {
  require_sense(shape);
  const auto take = [](std::size_t& end, std::size_t count) {
    const std::size_t begin = end;
    end += count;
    return begin;
  };
  int maps = shape.grid.channels();
  int size[3] = {shape.grid.across, shape.grid.ahead, shape.grid.up};
  for (int block = 0; block < shape.blocks; ++block) {
    for (int k = 0; k < shape.units; ++k) {
      UnitPlace unit;
      unit.in = maps;
      unit.out = maps = shape.growth * static_cast<int>(units.size() + 1);
      std::copy(size, size + 3, unit.size);
      unit.last_of_block = k + 1 == shape.units;
      const auto width = static_cast<std::size_t>(unit.out);
      const std::size_t count = 27 * static_cast<std::size_t>(unit.in) * width;
      unit.weights = take(parameters, count);
      regularised.emplace_back(unit.weights, unit.weights + count);
      unit.scale = take(parameters, width);
      unit.shift = take(parameters, width);
      unit.mean = take(statistics, width);
      unit.variance = take(statistics, width);
      units.push_back(unit);
    }
    for (int& edge : size) edge /= 2;
  }
  const auto numbers =
      static_cast<std::size_t>(size[0] * size[1] * size[2]) * static_cast<std::size_t>(maps);
  const std::size_t all = parameters + numbers * static_cast<std::size_t>(shape.hidden1);
  if (all > kMostParameters)
    throw InputError("a network of " + std::to_string(all) + " parameters; at most " +
                     std::to_string(kMostParameters) +
                     ": take fewer units, a smaller growth or fewer hidden numbers");
  flat = static_cast<int>(numbers);
  const auto dense = [&](int in, int out, std::size_t& weights, std::size_t& bias) {
    const auto count = static_cast<std::size_t>(in) * static_cast<std::size_t>(out);
    weights = take(parameters, count);
    regularised.emplace_back(weights, weights + count);
    bias = take(parameters, static_cast<std::size_t>(out));
  };
  dense(flat, shape.hidden1, weights1, bias1);
  dense(shape.hidden1, shape.hidden2, weights2, bias2);
  dense(shape.hidden2, 1, weights3, bias3);
}

NetworkState initial_state(const NetworkLayout& layout, Random random) {
  NetworkState state;
  state.parameters.assign(layout.parameters, 0);
  state.statistics.assign(layout.statistics, 0);
  const auto draw = [&](std::size_t begin, std::size_t count, int inputs, double gain) {
    const double sigma = std::sqrt(gain / inputs);
    for (std::size_t k = 0; k < count; ++k)
      state.parameters[begin + k] = static_cast<float>(sigma * random.normal());
  };
  for (const UnitPlace& unit : layout.units) {
    draw(unit.weights, static_cast<std::size_t>(27 * unit.in * unit.out), 27 * unit.in, 2);
    std::fill_n(state.parameters.begin() + static_cast<std::ptrdiff_t>(unit.scale), unit.out, 1.0f);
    std::fill_n(state.statistics.begin() + static_cast<std::ptrdiff_t>(unit.variance), unit.out,
                1.0f);
  }
  const NetworkShape& s = layout.shape;
  draw(layout.weights1, static_cast<std::size_t>(layout.flat * s.hidden1), layout.flat, 2);
  draw(layout.weights2, static_cast<std::size_t>(s.hidden1 * s.hidden2), s.hidden1, 2);
  draw(layout.weights3, static_cast<std::size_t>(s.hidden2), s.hidden2, 1);
  return state;
}

namespace {

template <class Read>
void decode(const NetworkLayout& layout, bool mirrored, float* padded, Read read) {
  const UnitPlace& unit = layout.units.front();
  const int maps = unit.in;
  std::size_t from = 0;
  for (int z = 0; z < unit.size[2]; ++z)
    for (int y = 0; y < unit.size[1]; ++y) {
      float* row = padded + unit.row(y, z, maps) + maps;
      for (int x = 0; x < unit.size[0]; ++x) {
        float* point = row + (mirrored ? unit.size[0] - 1 - x : x) * maps;
        for (int c = 0; c < maps; c += 2, from += 2) {
          point[c] = 2 * read(from) - 1;
          point[c + 1] = 1 - read(from + 1);
        }
      }
    }
}

}  // namespace

void decode_grid(const NetworkLayout& layout, const std::uint8_t* bytes, bool mirrored,
                 float* padded) {
  decode(layout, mirrored, padded,
         [&](std::size_t k) { return static_cast<float>(bytes[k]) * (1 / 255.0f); });
}

void decode_grid(const NetworkLayout& layout, std::span<const float> grid, float* padded) {
  decode(layout, false, padded, [&](std::size_t k) { return grid[k]; });
}

void convolve(const UnitPlace& unit, const float* in, int maps_in, const float* weights,
              const float* bias, bool rectified, int maps_out, float* out) {
  const float* parts[9];
  Product product;
  product.a = parts;
  product.parts = 9;
  product.a_stride = maps_in;
  product.depth = 3 * maps_in;
  product.b = weights;
  product.bias = bias;
  product.rows = unit.size[0];
  product.columns = maps_out;
  product.c_stride = maps_out;
  product.rectified = rectified;
  for (int z = 0; z < unit.size[2]; ++z)
    for (int y = 0; y < unit.size[1]; ++y) {
      for (int k = 0; k < 9; ++k) parts[k] = in + unit.row(y + k % 3 - 1, z + k / 3 - 1, maps_in);
      product.c =
          out + static_cast<std::ptrdiff_t>((z * unit.size[1] + y) * unit.size[0]) * maps_out;
      multiply(product);
    }
}

void add_input(const UnitPlace& unit, const float* in, float* out) {
  for (int z = 0; z < unit.size[2]; ++z)
    for (int y = 0; y < unit.size[1]; ++y) {
      const float* row = in + unit.row(y, z, unit.in) + unit.in;
      for (int x = 0; x < unit.size[0]; ++x, row += unit.in, out += unit.out)
        for (int c = 0; c < unit.in; ++c) out[c] += row[c];
    }
}

void pool(const int size[3], int maps, const float* in, bool border, float* out,
          std::uint8_t* place) {
  const int half[3] = {size[0] / 2, size[1] / 2, size[2] / 2};
  const int b = border ? 1 : 0;
  for (int z = 0; z < half[2]; ++z)
    for (int y = 0; y < half[1]; ++y)
      for (int x = 0; x < half[0]; ++x) {
        float* to = out + static_cast<std::ptrdiff_t>(
                              ((z + b) * (half[1] + 2 * b) + y + b) * (half[0] + 2 * b) + x + b) *
                              maps;
        for (int k = 0; k < 8; ++k) {
          const float* from =
              in + static_cast<std::ptrdiff_t>(
                       ((2 * z + (k >> 2)) * size[1] + 2 * y + (k >> 1 & 1)) * size[0] + 2 * x +
                       (k & 1)) *
                       maps;
          if (k == 0) {
            std::copy(from, from + maps, to);
            if (place) std::fill(place, place + maps, std::uint8_t{0});
            continue;
          }
          for (int c = 0; c < maps; ++c)
            if (from[c] > to[c]) {
              to[c] = from[c];
              if (place) place[c] = static_cast<std::uint8_t>(k);
            }
        }
        if (place) place += maps;
      }
}

// -- asked ---------------------------------------------------------------------------------------

struct FoldedNetwork::Scratch {
  NetworkShape shape;
  std::vector<std::vector<float>> inputs;  // padded, of every unit
  std::vector<float> points, flat, hidden1, hidden2;
};

FoldedNetwork::FoldedNetwork(const NetworkLayout& layout, const NetworkState& state)
    : layout_(layout), parameters_(state.parameters) {
  constexpr float kVariance = 1e-5f;  // as in training
  for (const UnitPlace& unit : layout_.units) {
    std::vector<float> bias(static_cast<std::size_t>(unit.out));
    for (int c = 0; c < unit.out; ++c) {
      const auto k = static_cast<std::size_t>(c);
      const float factor = state.parameters[unit.scale + k] /
                           std::sqrt(state.statistics[unit.variance + k] + kVariance);
      bias[k] = state.parameters[unit.shift + k] - state.statistics[unit.mean + k] * factor;
      for (int i = 0; i < 27 * unit.in; ++i)
        parameters_[unit.weights + static_cast<std::size_t>(i * unit.out + c)] *= factor;
    }
    biases_.push_back(std::move(bias));
  }
}

FoldedNetwork::Scratch& FoldedNetwork::scratch() const {
  thread_local Scratch scratch;
  if (!scratch.inputs.empty() && scratch.shape == layout_.shape) return scratch;
  scratch = {};
  scratch.shape = layout_.shape;
  std::size_t most = 0;
  for (const UnitPlace& unit : layout_.units) {
    scratch.inputs.emplace_back(unit.padded() * static_cast<std::size_t>(unit.in), 0.0f);
    most = std::max(most, static_cast<std::size_t>(unit.points() * unit.out));
  }
  scratch.points.resize(most);
  scratch.flat.resize(static_cast<std::size_t>(layout_.flat));
  scratch.hidden1.resize(static_cast<std::size_t>(layout_.shape.hidden1));
  scratch.hidden2.resize(static_cast<std::size_t>(layout_.shape.hidden2));
  return scratch;
}

float FoldedNetwork::run(Scratch& s) const {
  for (std::size_t k = 0; k < layout_.units.size(); ++k) {
    const UnitPlace& unit = layout_.units[k];
    convolve(unit, s.inputs[k].data(), unit.in, parameters_.data() + unit.weights,
             biases_[k].data(), true, unit.out, s.points.data());
    if (layout_.shape.residual) add_input(unit, s.inputs[k].data(), s.points.data());
    const bool last = k + 1 == layout_.units.size();
    if (unit.last_of_block) {
      pool(unit.size, unit.out, s.points.data(), !last,
           last ? s.flat.data() : s.inputs[k + 1].data(), nullptr);
      continue;
    }
    const int row = unit.size[0] * unit.out;
    for (int z = 0; z < unit.size[2]; ++z)
      for (int y = 0; y < unit.size[1]; ++y)
        std::copy_n(s.points.data() + (z * unit.size[1] + y) * row, row,
                    s.inputs[k + 1].data() + unit.row(y, z, unit.out) + unit.out);
  }
  const auto dense = [&](const std::vector<float>& in, std::size_t weights, std::size_t bias,
                         std::vector<float>& out) {
    const float* a = in.data();
    Product product;
    product.a = &a;
    product.depth = static_cast<int>(in.size());
    product.b = parameters_.data() + weights;
    product.bias = parameters_.data() + bias;
    product.rows = 1;
    product.columns = static_cast<int>(out.size());
    product.c = out.data();
    product.rectified = true;
    multiply(product);
  };
  dense(s.flat, layout_.weights1, layout_.bias1, s.hidden1);
  dense(s.hidden1, layout_.weights2, layout_.bias2, s.hidden2);
  float sum = parameters_[layout_.bias3];
  for (std::size_t k = 0; k < s.hidden2.size(); ++k)
    sum += s.hidden2[k] * parameters_[layout_.weights3 + k];
  return sum;
}

float FoldedNetwork::answer(std::span<const float> grid) const {
  Scratch& s = scratch();
  decode_grid(layout_, grid, s.inputs.front().data());
  return run(s);
}

float FoldedNetwork::answer(const std::uint8_t* bytes) const {
  Scratch& s = scratch();
  decode_grid(layout_, bytes, false, s.inputs.front().data());
  return run(s);
}

}  // namespace lapwing::learned
