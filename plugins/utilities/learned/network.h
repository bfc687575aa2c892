// SPDX-License-Identifier: Apache-2.0
// The convolutional network of thesis 5.4.3 (figure 5.8): blocks of units, each a 3 x 3 x 3
// convolution, batch normalisation and rectification, then maxima over 2 x 2 x 2; two hidden layers
// and a linear output (reading 5.5). With `residual`, each unit adds its input to its result (He et
// al. 2016, "Identity mappings in deep residual networks"); maps that the input lacks stay as they
// are.
//
// Arrays hold channels fastest, then x (right), y (forward), z (up). Unit k of all has growth (k+1)
// maps. Weights of a convolution: [z][y][x][input][output].
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "framework/core/random.h"
#include "framework/explore/view_grid.h"

namespace lapwing::learned {

struct NetworkShape {
  static constexpr int kMostBlocks = 5, kMostUnits = 16, kMostWidth = 1024;

  GridShape grid;
  int blocks = 2, units = 4;        // units of each block
  int growth = 8;                   // maps that every convolution adds; a multiple of 8
  int hidden1 = 128, hidden2 = 32;  // multiples of 8
  bool residual = false;            // the input may not have more maps than `growth` then

  bool operator==(const NetworkShape&) const = default;
};
// InputError: edges that cannot be halved once a block, widths that are no multiples of 8, an input
// that is too wide to be added.
void require_sense(const NetworkShape& shape);
Value to_value(const NetworkShape& shape);
NetworkShape network_shape_from(const Value& value);

// Where everything lies in the one vector of parameters, and in that of running statistics.
struct UnitPlace {
  int in = 0, out = 0;  // maps
  int size[3] = {};     // points
  bool last_of_block = false;
  std::size_t weights = 0, scale = 0, shift = 0;  // in the parameters
  std::size_t mean = 0, variance = 0;             // in the statistics

  int points() const { return size[0] * size[1] * size[2]; }
  // With a border of one point, which holds zeros.
  std::size_t padded() const {
    return static_cast<std::size_t>((size[0] + 2) * (size[1] + 2) * (size[2] + 2));
  }
  // Of the point (x - 1, y, z) in a padded array with so many maps: where its row begins.
  std::size_t row(int y, int z, int maps) const {
    return static_cast<std::size_t>(((z + 1) * (size[1] + 2) + y + 1) * (size[0] + 2)) *
           static_cast<std::size_t>(maps);
  }
};
struct NetworkLayout {
  static constexpr std::size_t kMostParameters = std::size_t{1} << 26;

  // InputError for a shape that cannot be, or of more parameters.
  explicit NetworkLayout(const NetworkShape& shape);

  NetworkShape shape;
  std::vector<UnitPlace> units;
  int flat = 0;  // numbers that the blocks hand to the first hidden layer
  // In the parameters: weights [input][output], then biases.
  std::size_t weights1 = 0, bias1 = 0, weights2 = 0, bias2 = 0, weights3 = 0, bias3 = 0;
  std::size_t parameters = 0, statistics = 0;
  // Ranges of the parameters that (5.4) regularises: weights, not biases, scales and shifts.
  std::vector<std::pair<std::size_t, std::size_t>> regularised;
};

struct NetworkState {
  std::vector<float> parameters, statistics;
};
// He initialisation (reading 5.5).
NetworkState initial_state(const NetworkLayout& layout, Random random);

// Occupancy 0 to 1 becomes -1 to 1, uncertainty becomes certainty, so that what is unknown is 0 as
// the border is. `bytes` as a file of samples holds them; `mirrored`: right and left exchanged.
// Into the padded array of the first unit, whose border stays as it is.
void decode_grid(const NetworkLayout& layout, const std::uint8_t* bytes, bool mirrored,
                 float* padded);
void decode_grid(const NetworkLayout& layout, std::span<const float> grid, float* padded);

// The network as it is asked: normalisations folded into the convolutions. Thread-safe.
class FoldedNetwork {
 public:
  FoldedNetwork(const NetworkLayout& layout, const NetworkState& state);
  // Of a grid as sample_grid writes it.
  float answer(std::span<const float> grid) const;
  float answer(const std::uint8_t* bytes) const;
  const NetworkLayout& layout() const { return layout_; }

 private:
  struct Scratch;
  Scratch& scratch() const;
  float run(Scratch& scratch) const;

  NetworkLayout layout_;
  std::vector<float> parameters_;           // scaled weights in their places
  std::vector<std::vector<float>> biases_;  // of the units
};

// Convolution of one sample: `in` padded, `out` not padded with `out_stride` numbers from point to
// point... rows of x lie together. `weights` as above; `bias` may be null.
void convolve(const UnitPlace& unit, const float* in, int maps_in, const float* weights,
              const float* bias, bool rectified, int maps_out, float* out);
// The shortcut of a residual unit: adds `in`, padded, to the first maps of `out`, which has the
// unit's maps and no border.
void add_input(const UnitPlace& unit, const float* in, float* out);
// Maxima over 2 x 2 x 2 of an array without border; `place` (may be null) tells which of the eight.
// Into `out`: padded by one point where `border`.
void pool(const int size[3], int maps, const float* in, bool border, float* out,
          std::uint8_t* place);

}  // namespace lapwing::learned
