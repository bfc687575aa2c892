// SPDX-License-Identifier: Apache-2.0
// Training samples of one episode: what the map looked like around viewpoints, and what the oracle
// said of them (thesis 5.4.5).
//
// A file is a line "lapwing samples 4", a line of JSON, then the targets (32-bit floats, little
// endian) and the inputs (a byte each, 255 times the value). Files are whole or not there.
#pragma once

#include <filesystem>
#include <vector>

#include "framework/explore/view_input.h"

namespace lapwing {

struct SampleSet {
  std::string world;  // "downtown 3": what must not be split between training and validation
  std::int64_t episode = 0;
  Value made_by;  // what explored and how, for whoever goes on; null where nobody said
  ViewInput input;
  Value mapping;                     // as mapping_of gives it
  std::vector<float> targets;        // parts of (5.3): targets_of(input) of each sample
  std::vector<std::uint8_t> inputs;  // numbers_of(input) bytes of each sample

  std::size_t size() const { return targets.size() / targets_of(input); }
  // Of each sample the sum of its targets: (5.3).
  std::vector<float> gains() const;
  // Appends one; numbers outside [0, 1] are a defect.
  void add(std::span<const float> numbers, std::span<const float> parts);
};

void write_samples(const SampleSet& samples, const std::filesystem::path& path);
// InputError naming the file: no such file, another format, truncated, contradicting itself.
SampleSet read_samples(const std::filesystem::path& path);
// Of files NAME.samples and folders of them, in the order given; those of a folder by name.
// InputError for what is neither, for a folder without any, and for a file named twice.
std::vector<std::filesystem::path> sample_files(const std::vector<std::filesystem::path>& given);

}  // namespace lapwing
