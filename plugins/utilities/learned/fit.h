// Training: samples, epochs, early stopping, checkpoints (thesis 5.5.1; reading 5.5).
#pragma once

#include "framework/explore/trainable.h"

namespace lapwing::learned {

ParameterTable fit_parameters();
GridShape fit_shape(const Parameters& parameters);
Value fit(const Parameters& parameters, const FitRequest& request);
std::vector<float> predict(const std::filesystem::path& model, const SampleSet& samples,
                           int threads);
double loss_of(const std::filesystem::path& model, std::span<const float> predicted,
               std::span<const float> targets);

}  // namespace lapwing::learned
