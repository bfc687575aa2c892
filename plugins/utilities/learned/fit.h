// SPDX-License-Identifier: Apache-2.0
// Training: samples, epochs, early stopping, checkpoints (thesis 5.5.1; reading 5.5).
#pragma once

#include "framework/explore/trainable.h"

namespace lapwing::learned {

ParameterTable sample_parameters();
GridShape sample_shape(const Parameters& parameters);
ParameterTable fit_parameters();
Value fit(const Parameters& parameters, const FitRequest& request);
Prediction predict(const std::filesystem::path& model, const SampleSet& samples, int threads);

}  // namespace lapwing::learned
