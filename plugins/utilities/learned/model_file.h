// SPDX-License-Identifier: Apache-2.0
// A trained model as a file: architecture, weights, normalisation, mapping and provenance.
//
// A line "lapwing model 2", a line with the checksum of all that follows, a line of JSON, then
// 32-bit floats, little endian: parameters, running statistics and, in a checkpoint, the moments of
// Adam.
#pragma once

#include <filesystem>
#include <optional>
#include <variant>

#include "plugins/utilities/learned/backpropagation.h"
#include "plugins/utilities/learned/ray_network.h"

namespace lapwing::learned {

struct Model {
  std::variant<NetworkShape, RayNetworkShape> shape;
  Value mapping;                                 // what it was trained with (reading 5.2)
  bool root = false;                             // the network speaks of targets' square roots
  double target_mean = 0, target_deviation = 1;  // of the oracle's values, or of their roots
  Value provenance;                              // where it comes from, for people
  NetworkState state;
  // Of a checkpoint alone.
  std::optional<Adam> adam;
  Value progress;

  // What the network has to answer for a value of the oracle's, and the other way round.
  double answer_of(double target) const;
  double target_of(double answer) const;

  // InputError naming the file where the model is of the other network.
  const NetworkShape& grid_network(const std::filesystem::path& path) const;
  const RayNetworkShape& ray_network(const std::filesystem::path& path) const;
};

void write_model(const Model& model, const std::filesystem::path& path);
// InputError naming the file: none there, another format, truncated, a checksum that does not hold,
// sizes that contradict the architecture, a mapping that is not whole.
Model read_model(const std::filesystem::path& path);

}  // namespace lapwing::learned
