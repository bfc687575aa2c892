// SPDX-License-Identifier: Apache-2.0
#include "plugins/utilities/learned/model_file.h"

#include <cmath>
#include <cstring>

#include "framework/core/checksum.h"
#include "framework/core/error.h"
#include "framework/core/fields.h"
#include "framework/core/files.h"
#include "framework/core/json.h"

namespace lapwing::learned {
namespace {

constexpr std::string_view kMagic = "lapwing model 2\n";
constexpr std::size_t kChecksum = 64;  // hexadecimal digits, on the second line
constexpr std::size_t kMostBytes = std::size_t{1} << 28;

void append(std::string& bytes, const std::vector<float>& numbers) {
  bytes.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(float));
}

}  // namespace

double Model::answer_of(double target) const {
  // The oracle's values are not below 0.
  return ((root ? std::sqrt(std::max(target, 0.0)) : target) - target_mean) / target_deviation;
}

double Model::target_of(double answer) const {
  const double told = target_mean + target_deviation * answer;
  return root ? told * std::abs(told) : told;
}

const NetworkShape& Model::grid_network(const std::filesystem::path& path) const {
  if (const auto* grid = std::get_if<NetworkShape>(&shape)) return *grid;
  throw InputError("'" + path.string() +
                   "' is a model that reads rays: it belongs to the utility 'learned', not to "
                   "'learned_grid'");
}

const RayNetworkShape& Model::ray_network(const std::filesystem::path& path) const {
  if (const auto* rays = std::get_if<RayNetworkShape>(&shape)) return *rays;
  throw InputError("'" + path.string() +
                   "' is a model that reads a grid: it belongs to the utility 'learned_grid', not "
                   "to 'learned'");
}

void write_model(const Model& model, const std::filesystem::path& path) {
  std::string numbers;
  append(numbers, model.state.parameters);
  append(numbers, model.state.statistics);
  if (model.adam) {
    append(numbers, model.adam->first);
    append(numbers, model.adam->second);
  }
  Value header = Value::map();
  header.set("network", std::visit([](const auto& shape) { return to_value(shape); }, model.shape));
  header.set("mapping", model.mapping);
  Value& targets = header.set("targets", Value::map());
  targets.set("root", model.root);
  targets.set("mean", model.target_mean);
  targets.set("deviation", model.target_deviation);
  header.set("provenance", model.provenance);
  if (model.adam) {
    header.set("adam_steps", model.adam->steps);
    header.set("progress", model.progress);
  }
  const std::string body = to_json(header, -1) + "\n" + numbers;
  write_file_atomically(path, std::string(kMagic) + sha256(body) + "\n" + body);
}

Model read_model(const std::filesystem::path& path) {
  const std::string bytes = read_file(path, kMostBytes);
  const auto refuse = [&](const std::string& why) {
    return InputError("'" + path.string() + "' is not a model of a learned utility: " + why);
  };
  const std::string_view all(bytes);
  if (!all.starts_with(kMagic)) throw refuse("another first line");
  const std::size_t begin = kMagic.size() + kChecksum + 1;
  const std::size_t line = bytes.find('\n', begin);
  if (bytes.size() < begin || line == bytes.npos) throw refuse("it ends in its first lines");
  // Before anything is made of it: the header says what a network's answers mean.
  if (all.substr(kMagic.size(), kChecksum) != sha256(all.substr(begin)) || all[begin - 1] != '\n')
    throw refuse("it is damaged: its checksum does not hold");
  const Value header = from_json(all.substr(begin, line - begin), path.string());
  Diagnostics errors;
  Fields fields(header, "", errors);
  Model model;
  const Value shape = fields.opaque("network");
  model.mapping = fields.opaque("mapping");
  Fields targets = fields.table("targets");
  if (targets.has("root")) model.root = targets.boolean("root");
  model.target_mean = targets.number("mean");
  model.target_deviation = targets.number("deviation");
  targets.finish();
  model.provenance = fields.opaque("provenance");
  const bool checkpoint = fields.has("adam_steps");
  const std::int64_t steps = checkpoint ? fields.integer("adam_steps") : 0;
  if (checkpoint) model.progress = fields.opaque("progress");
  fields.finish();
  errors.throw_if_any();
  if (const std::string fault = mapping_fault(model.mapping); !fault.empty())
    throw refuse("its mapping is not whole: " + fault);
  if (!(model.target_deviation > 0)) throw refuse("its deviation of targets is not above 0");
  std::size_t parameters = 0, statistics = 0;
  if (shape.is_map() && shape.find("rays")) {
    const RayNetworkShape rays = ray_network_shape_from(shape);
    parameters = RayNetworkLayout(rays).parameters;
    model.shape = rays;
  } else {
    const NetworkShape grid = network_shape_from(shape);
    const NetworkLayout layout(grid);
    parameters = layout.parameters;
    statistics = layout.statistics;
    model.shape = grid;
  }
  const std::string_view numbers = all.substr(line + 1);
  const std::size_t expected = sizeof(float) * (parameters * (checkpoint ? 3 : 1) + statistics);
  if (numbers.size() != expected)
    throw refuse("its network has " + std::to_string(expected) + " bytes of numbers, the file " +
                 std::to_string(numbers.size()));
  std::size_t at = 0;
  const auto take = [&](std::size_t count) {
    std::vector<float> values(count);
    std::memcpy(values.data(), numbers.data() + at, count * sizeof(float));
    at += count * sizeof(float);
    return values;
  };
  model.state.parameters = take(parameters);
  model.state.statistics = take(statistics);
  for (const std::vector<float>* values : {&model.state.parameters, &model.state.statistics})
    for (const float value : *values)
      if (!std::isfinite(value)) throw refuse("its network has a number that is not finite");
  if (checkpoint) {
    model.adam.emplace(0);
    model.adam->first = take(parameters);
    model.adam->second = take(parameters);
    model.adam->steps = steps;
  }
  return model;
}

}  // namespace lapwing::learned
