// SPDX-License-Identifier: Apache-2.0
#include "framework/explore/sample_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <set>

#include "framework/core/checksum.h"
#include "framework/core/error.h"
#include "framework/core/fields.h"
#include "framework/core/files.h"
#include "framework/core/json.h"

namespace lapwing {
namespace {

constexpr std::string_view kMagic = "lapwing samples 4\n";
constexpr std::size_t kMostBytes = std::size_t{4} << 30;

}  // namespace

void SampleSet::add(std::span<const float> numbers, std::span<const float> parts) {
  if (numbers.size() != numbers_of(input) || parts.size() != targets_of(input))
    throw Error("a sample of another shape");
  for (const float value : numbers) {
    if (!(value >= -1e-4f && value <= 1 + 1e-4f)) throw Error("an input outside 0 to 1");
    inputs.push_back(static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0f, 1.0f) * 255)));
  }
  targets.insert(targets.end(), parts.begin(), parts.end());
}

std::vector<float> SampleSet::gains() const {
  const std::size_t each = targets_of(input);
  std::vector<float> sums;
  for (std::size_t k = 0; k < targets.size(); k += each)
    sums.push_back(std::accumulate(targets.begin() + static_cast<std::ptrdiff_t>(k),
                                   targets.begin() + static_cast<std::ptrdiff_t>(k + each), 0.0f));
  return sums;
}

void write_samples(const SampleSet& samples, const std::filesystem::path& path) {
  Value header = Value::map();
  header.set("world", samples.world);
  header.set("episode", samples.episode);
  header.set("made_by", samples.made_by);
  header.set("samples", static_cast<std::int64_t>(samples.size()));
  header.set("input", to_value(samples.input));
  header.set("mapping", samples.mapping);
  const std::size_t numbers = samples.targets.size() * sizeof(float);
  std::string data(numbers + samples.inputs.size(), '\0');
  std::memcpy(data.data(), samples.targets.data(), numbers);
  std::memcpy(data.data() + numbers, samples.inputs.data(), samples.inputs.size());
  header.set("sha256", sha256(data));
  write_file_atomically(path, std::string(kMagic) + to_json(header, -1) + '\n' + data);
}

SampleSet read_samples(const std::filesystem::path& path) {
  const std::string bytes = read_file(path, kMostBytes);
  const auto refuse = [&](const std::string& why) {
    return InputError("'" + path.string() + "' is not a sample file: " + why +
                      "; delete it or leave it out");
  };
  if (bytes.starts_with("lapwing samples ") && !bytes.starts_with(kMagic))
    throw InputError("'" + path.string() + "' is of another format than 4, which this program " +
                     "reads: make its samples again, in another folder");
  if (!std::string_view(bytes).starts_with(kMagic)) throw refuse("another first line");
  const std::size_t line = bytes.find('\n', kMagic.size());
  if (line == bytes.npos) throw refuse("it ends in its first lines");
  const Value header =
      from_json(std::string_view(bytes).substr(kMagic.size(), line - kMagic.size()), path.string());
  Diagnostics errors;
  Fields fields(header, path.string(), errors);
  SampleSet samples;
  samples.world = fields.text("world");
  samples.episode = fields.integer("episode");
  samples.made_by = fields.opaque("made_by");
  const std::int64_t count = fields.integer("samples");
  const Value input = fields.opaque("input");
  samples.mapping = fields.opaque("mapping");
  const std::string sum = fields.text("sha256");
  fields.finish();
  errors.throw_if_any();
  samples.input = view_input_from(input);
  const std::size_t begin = line + 1, rest = bytes.size() - begin;
  const std::size_t parts = targets_of(samples.input);
  const std::size_t each = parts * sizeof(float) + numbers_of(samples.input);
  if (count < 0 || rest / each != static_cast<std::size_t>(count) || rest % each != 0)
    throw refuse("it says " + std::to_string(count) + " samples, its " + std::to_string(rest) +
                 " bytes hold another number");
  if (sha256(std::string_view(bytes).substr(begin)) != sum)
    throw refuse("its data does not match its checksum");
  samples.targets.resize(static_cast<std::size_t>(count) * parts);
  const std::size_t numbers = samples.targets.size() * sizeof(float);
  std::memcpy(samples.targets.data(), bytes.data() + begin, numbers);
  for (const float target : samples.targets)
    if (!std::isfinite(target) || target < 0)
      throw refuse("a target is not a finite number of at least 0");
  samples.inputs.assign(bytes.begin() + static_cast<std::ptrdiff_t>(begin + numbers), bytes.end());
  return samples;
}

std::vector<std::filesystem::path> sample_files(const std::vector<std::filesystem::path>& given) {
  const auto holds_samples = [](const std::filesystem::path& path) {
    return path.extension() == ".samples";
  };
  std::vector<std::filesystem::path> files;
  std::set<std::filesystem::path> met;
  const auto add = [&](const std::filesystem::path& file) {
    if (!met.insert(std::filesystem::canonical(file)).second)
      throw InputError("'" + file.string() + "' is named twice");
    files.push_back(file);
  };
  for (const std::filesystem::path& path : given) {
    if (std::filesystem::is_regular_file(path) && holds_samples(path)) {
      add(path);
      continue;
    }
    std::error_code code;
    std::vector<std::filesystem::path> within;
    for (const auto& entry : std::filesystem::directory_iterator(path, code))
      if (holds_samples(entry.path())) within.push_back(entry.path());
    if (code) throw InputError("'" + path.string() + "': " + code.message());
    if (within.empty()) throw InputError("'" + path.string() + "' holds no file NAME.samples");
    std::sort(within.begin(), within.end());
    for (const auto& file : within) add(file);
  }
  return files;
}

}  // namespace lapwing
