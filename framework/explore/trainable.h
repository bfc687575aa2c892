// SPDX-License-Identifier: Apache-2.0
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
  bool resume = false;  // go on from the checkpoint, if there is one, with the same result
  std::uint64_t seed = 1;
  int threads = 1;  // the result is the same for any number, unless parameters say otherwise
  const CancellationToken* cancellation = nullptr;
  std::function<void(const std::string&)> log = [](const std::string&) {};
};

// What a model says of samples.
struct Prediction {
  std::vector<float> values;  // one a sample, in the oracle's unit
  double loss = 0;            // of (5.4) without its weights' part: mean squared error, normalised
};

// Static data of a library (plugin/plugin.h). InputError as everywhere.
struct Trainable {
  ParameterTable (*sample_parameters)();
  // Of what samples hold; InputError for what no network takes.
  ViewInput (*sample_input)(const Parameters& parameters);
  ParameterTable (*fit_parameters)();  // of samples, architecture and training
  // Figures of the best epoch, as the model's provenance holds them.
  Value (*fit)(const Parameters& parameters, const FitRequest& request);
  // Refused where the samples are of another mapping or shape.
  Prediction (*predict)(const std::filesystem::path& model, const SampleSet& samples, int threads);
  // InputError for parameters of a fit that this build cannot follow. Null: it follows all.
  void (*require_fit)(const Parameters& parameters) = nullptr;
};

// Spearman's rho: the correlation of ranks, ties sharing their mean rank. NaN for fewer than two
// values, where all of one side are equal or one is NaN. Error when the sizes differ.
double rank_correlation(std::span<const float> a, std::span<const float> b);

}  // namespace lapwing
