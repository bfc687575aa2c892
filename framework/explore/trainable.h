// A utility that is learned from samples: the extension `trainable` of plugins of kind `utility`.
#pragma once

#include <filesystem>
#include <functional>

#include "framework/core/progress.h"
#include "framework/explore/sample_file.h"

namespace lapwing {

inline constexpr const char* kTrainable = "trainable";

struct FitRequest {
  std::vector<std::filesystem::path> training, validation;  // files of samples
  std::filesystem::path model;       // is written whenever the validation improves
  std::filesystem::path checkpoint;  // is written after every epoch
  bool resume = false;               // go on from the checkpoint, with the same result
  std::uint64_t seed = 1;
  int threads = 1;  // the result is the same for any number
  const CancellationToken* cancellation = nullptr;
  std::function<void(const std::string&)> log = [](const std::string&) {};
};

// Static data of a library (plugin/plugin.h). InputError as everywhere.
struct Trainable {
  ParameterTable (*parameters)();  // of architecture and training
  GridShape (*shape)(const Parameters& parameters);
  // Figures of the best epoch, as the model's provenance holds them.
  Value (*fit)(const Parameters& parameters, const FitRequest& request);
  // What a model says of samples; refused where they are of another mapping or shape.
  std::vector<float> (*predict)(const std::filesystem::path& model, const SampleSet& samples,
                                int threads);
  // The loss (5.4) without its weights' part: mean squared error of normalised targets.
  double (*loss)(const std::filesystem::path& model, std::span<const float> predicted,
                 std::span<const float> targets);
};

// Spearman's rho: the correlation of ranks, ties sharing their mean rank. NaN for fewer than two
// values, where all of one side are equal or one is NaN. Error when the sizes differ.
double rank_correlation(std::span<const float> a, std::span<const float> b);

}  // namespace lapwing
