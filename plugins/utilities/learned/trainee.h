// SPDX-License-Identifier: Apache-2.0
// What training (fit.h) asks of a network, whichever it is.
#pragma once

#include <memory>
#include <string>

#include "framework/explore/trainable.h"
#include "plugins/utilities/learned/model_file.h"

namespace lapwing::learned {

// The samples of several files, which all have one input and one mapping.
struct Samples {
  std::vector<SampleSet> sets;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> all;  // set, sample

  const std::uint8_t* input(std::size_t k) const {
    const SampleSet& set = sets[all[k].first];
    return set.inputs.data() + all[k].second * numbers_of(set.input);
  }
  // Its targets, one after the other.
  const float* targets(std::size_t k) const {
    const SampleSet& set = sets[all[k].first];
    return set.targets.data() + all[k].second * targets_of(set.input);
  }
  std::size_t size() const { return all.size(); }
};

struct Judged {
  double loss = 0, rho = 0;
};

// What of a batch is random.
struct BatchDraw {
  std::span<const std::uint32_t> samples;
  std::span<const std::uint8_t> mirrored;  // of each, whether right and left are exchanged
  std::uint64_t seed = 0;
};

inline constexpr const char* kOwnBackend = "own kernels";

class Trainee {
 public:
  virtual ~Trainee() = default;
  virtual std::string backend() const { return kOwnBackend; }  // what computes loss()
  virtual std::size_t parameters() const = 0;
  virtual ViewInput input() const = 0;
  // Architecture, initial weights, and what the targets of the samples are normalised by.
  virtual void begin(Model& model, const Samples& training, std::uint64_t seed) const = 0;
  // Whether a model has this architecture.
  virtual bool fits(const Model& model) const = 0;
  // The loss of a batch and its derivatives.
  virtual double loss(Model& model, const Samples& samples, const BatchDraw& batch,
                      std::span<float> gradient) = 0;
  virtual Judged judge(const Model& model, const Samples& samples, int threads) const = 0;
};
// A network of that architecture for batches of so many samples.
using NewTrainee = std::unique_ptr<Trainee> (*)(const Parameters& parameters, int batch,
                                                int threads);

std::unique_ptr<Trainee> grid_trainee(const Parameters& parameters, int batch, int threads);
std::unique_ptr<Trainee> ray_trainee(const Parameters& parameters, int batch, int threads);

// The same networks, whose loss and derivatives libtorch computes: on a GPU where libtorch finds
// one, else on the CPU. Rounding depends on the device and the number of threads. InputError in a
// build without libtorch, from `require_torch` as well.
void require_torch();
std::unique_ptr<Trainee> torch_grid_trainee(const Parameters& parameters, int batch, int threads);
std::unique_ptr<Trainee> torch_ray_trainee(const Parameters& parameters, int batch, int threads);

// What samples hold, by the parameters of samples; InputError for what no network takes.
ViewInput grid_input(const Parameters& parameters);
ViewInput ray_input(const Parameters& parameters);
Prediction predict_by_grid(const std::filesystem::path& model, const SampleSet& samples,
                           int threads);
Prediction predict_by_rays(const std::filesystem::path& model, const SampleSet& samples,
                           int threads);

// InputError naming the model's file where samples are of another input or mapping.
void require_fit(const SampleSet& samples, const ViewInput& input, const Model& model,
                 const std::filesystem::path& path);

}  // namespace lapwing::learned
