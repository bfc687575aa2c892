// SPDX-License-Identifier: Apache-2.0
// The convolutional network that tells for each ray of an image of rays (explore/ray_image.h) how
// much surface its cell would show that is not observed yet.
//
// A ray's numbers are mixed by a dense layer. Then come residual convolutions of 3 x 3 rays, each
// dilated twice as far as the one before, so that a ray knows what its neighbours meet (Yu and
// Koltun 2016; He et al. 2016). Two more dense layers end in one number z a ray; the answer is
// log(1 + exp(z)) voxels.
// The value of a view is the sum over its rays: what is learned of one part of an image holds for
// every part.
//
// Arrays hold maps fastest, then columns, then rows.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "framework/core/random.h"
#include "framework/explore/ray_image.h"

namespace lapwing::learned {

struct RayNetworkShape {
  static constexpr int kMostWidth = 256, kMostConvolutions = 5;

  RayShape rays;
  int width = 32;        // maps; a multiple of 8
  int convolutions = 3;  // number k = 0, 1, ... joins rays that are 2^k apart

  bool operator==(const RayNetworkShape&) const = default;
};
// InputError for a width that is no multiple of 8 and for a number of convolutions out of range.
void require_sense(const RayNetworkShape& shape);
Value to_value(const RayNetworkShape& shape);
RayNetworkShape ray_network_shape_from(const Value& value);

// Where everything lies in the vector of parameters. Weights of a dense layer: [input][output];
// of a convolution: [row][column][input][output]. Biases follow their weights.
struct RayNetworkLayout {
  // Beside a ray's numbers: where it lies, -1 at the upper edge to 1 at the lower one, and its
  // distance from the middle column, 0 to 1. Then zeros up to a multiple of 8.
  static constexpr int kPlaces = 2;
  static constexpr int kInputs = (RayShape::kChannels + kPlaces + 7) / 8 * 8;

  explicit RayNetworkLayout(const RayNetworkShape& shape);

  RayNetworkShape shape;
  std::size_t first = 0;  // of the first dense layer
  std::vector<std::size_t> convolutions;
  std::size_t last = 0, output = 0;  // of the two dense layers at the end
  std::size_t parameters = 0;
  int border = 0;  // points of zeros around padded arrays

  int rays() const { return shape.rays.rays(); }
  std::size_t points() const {
    return static_cast<std::size_t>(rays()) * static_cast<std::size_t>(shape.width);
  }
  int padded_columns() const { return shape.rays.columns + 2 * border; }
  std::size_t padded() const {
    return static_cast<std::size_t>((shape.rays.rows + 2 * border) * padded_columns()) *
           static_cast<std::size_t>(shape.width);
  }
  // Of the point in column 0 of a row, in a padded array.
  std::size_t row(int row) const {
    return static_cast<std::size_t>((row + border) * padded_columns() + border) *
           static_cast<std::size_t>(shape.width);
  }
};
// He initialisation; answers begin at about a third of a voxel a ray.
std::vector<float> initial_parameters(const RayNetworkLayout& layout, Random random);

// Inputs of one sample as the network reads them: rays() times kInputs numbers. `bytes` as a file
// of samples holds them; `mirrored`: right and left exchanged.
void decode_rays(const RayNetworkLayout& layout, const std::uint8_t* bytes, bool mirrored,
                 float* inputs);
// Its targets, one for each ray.
void decode_targets(const RayShape& rays, const float* targets, bool mirrored, float* to);

// As it is asked. Thread-safe. `cells` gets an answer for each ray, in voxels.
class RayNetwork {
 public:
  RayNetwork(const RayNetworkLayout& layout, std::vector<float> parameters)
      : layout_(layout), parameters_(std::move(parameters)) {}
  // Of an image as sample_rays writes it.
  void answer(std::span<const float> image, std::span<float> cells) const;
  void answer(const std::uint8_t* bytes, std::span<float> cells) const;
  const RayNetworkLayout& layout() const { return layout_; }

 private:
  RayNetworkLayout layout_;
  std::vector<float> parameters_;
};

inline constexpr double kRayFloor = 1e-4;  // voxels, within the logarithm
inline constexpr double kRaySpread = 5;    // voxels, added to the variance of a view's value

// While it is trained. The loss of a sample with answers p and targets t of R rays, and with their
// sums P and T, is
//   1/R sum (p - t log(p + kRayFloor)) + (P - T)^2 / (R (T + kRaySpread)) :
// the likelihood of counts whose mean is p (Poisson), and the error of the view's value over the
// deviation of such a count.
class RayBackpropagation {
 public:
  RayBackpropagation(const RayNetworkLayout& layout, int batch, int threads);
  ~RayBackpropagation();

  float* input(int sample);   // of decode_rays
  float* target(int sample);  // rays() numbers

  // The mean loss of the batch; `gradient` gets its derivatives. The result does not depend on the
  // number of threads.
  double loss(std::span<const float> parameters, std::span<float> gradient);

 private:
  struct Sample;
  RayNetworkLayout layout_;
  int batch_, threads_;
  std::vector<Sample> samples_;
  std::vector<std::vector<float>> sums_;  // gradients of the parts of a batch
};
// The loss of one sample.
double ray_loss(std::span<const float> answers, std::span<const float> targets);

}  // namespace lapwing::learned
