// SPDX-License-Identifier: Apache-2.0
#include "framework/study/training_recipe.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "framework/config/yaml.h"
#include "framework/core/checksum.h"
#include "framework/core/error.h"
#include "framework/core/fields.h"
#include "framework/core/files.h"
#include "framework/core/number_text.h"

namespace lapwing {
namespace {

constexpr int kMostSteps = 100'000;
constexpr double kLargestSeed = 1e9, kMostSeeds = 10'000;  // of one line

RecipeSamples samples_from(Fields& fields, bool has_model) {
  RecipeSamples samples;
  const Value scenes = fields.opaque("scenes");
  if (!scenes.is_list() || scenes.as_list().empty()) {
    fields.add_error("scenes", "expected a list of names of scenes");
  } else {
    for (const Value& scene : scenes.as_list()) {
      if (scene.is_text())
        samples.scenes.push_back(scene.as_text());
      else
        fields.add_error("scenes", "expected a list of names of scenes");
    }
  }
  const std::vector<double> seeds = fields.numbers("seeds", 2);
  if (seeds.size() == 2) {
    const bool whole = seeds[0] == std::floor(seeds[0]) && seeds[1] == std::floor(seeds[1]);
    if (!whole || seeds[0] < 0 || seeds[1] < seeds[0] || seeds[1] > kLargestSeed ||
        seeds[1] - seeds[0] >= kMostSeeds) {
      fields.add_error("seeds", "expected the first and the last seed, whole numbers up to " +
                                    plain_number(kLargestSeed) + ", at most " +
                                    plain_number(kMostSeeds) + " of them");
    } else {
      samples.first = static_cast<std::int64_t>(seeds[0]);
      samples.last = static_cast<std::int64_t>(seeds[1]);
    }
  }
  samples.explorer = fields.text("explorer");
  if (samples.explorer == TrainingRecipe::kItself && !has_model)
    fields.add_error("explorer", "there is no model yet: 'itself' explores from the second round");
  samples.steps = fields.integer("steps", 1, kMostSteps);
  samples.sigma = fields.optional_number("sigma").value_or(0);
  samples.dropped = fields.optional_number("dropped").value_or(0);
  if (samples.sigma < 0) fields.add_error("sigma", "expected at least 0 m");
  if (samples.dropped < 0 || samples.dropped > 1)
    fields.add_error("dropped", "expected a share from 0 to 1");
  fields.finish();
  return samples;
}

std::vector<RecipeSamples> all_samples(Fields& fields, const char* name, bool has_model) {
  std::vector<RecipeSamples> all;
  for (Fields& entry : fields.tables(name)) all.push_back(samples_from(entry, has_model));
  return all;
}

// Training and validation must not share worlds.
void require_apart(const TrainingRecipe& recipe, const std::string& file) {
  std::set<std::pair<std::string, std::int64_t>> judged;
  for (const RecipeSamples& samples : recipe.validation)
    for (const std::string& scene : samples.scenes)
      for (std::int64_t seed = samples.first; seed <= samples.last; ++seed)
        judged.emplace(scene, seed);
  std::set<std::pair<std::string, std::int64_t>> trained;
  for (const RecipeRound& round : recipe.rounds)
    for (const RecipeSamples& samples : round.samples)
      for (const std::string& scene : samples.scenes)
        for (std::int64_t seed = samples.first; seed <= samples.last; ++seed) {
          const std::string world = "'" + scene + "' " + std::to_string(seed);
          if (judged.contains({scene, seed}))
            throw InputError(file + ": world " + world +
                             " is used for training and for validation: they must differ");
          if (!trained.emplace(scene, seed).second)
            throw InputError(file + ": world " + world +
                             " is used for training twice: use other seeds");
        }
}

}  // namespace

std::vector<std::string> RecipeSamples::worlds() const {
  std::vector<std::string> names;
  for (const std::string& scene : scenes)
    names.push_back(scene + ":" + std::to_string(first) + "-" + std::to_string(last));
  return names;
}

TrainingRecipe TrainingRecipe::within(double given) const {
  if (!(given > 0 && given <= hours))
    throw InputError("--hours: expected above 0 and at most " + plain_number(hours) +
                     ", for which the recipe has seeds, not " + plain_number(given));
  TrainingRecipe shorter = *this;
  const auto cut = [&](RecipeSamples& samples) {
    const double seeds = static_cast<double>(samples.last - samples.first + 1);
    samples.last = samples.first +
                   std::max<std::int64_t>(
                       1, static_cast<std::int64_t>(std::ceil(seeds * given / hours - 1e-9))) -
                   1;
  };
  for (RecipeSamples& samples : shorter.validation) cut(samples);
  for (RecipeRound& round : shorter.rounds)
    for (RecipeSamples& samples : round.samples) cut(samples);
  return shorter;
}

TrainingRecipe read_recipe(const std::filesystem::path& file) {
  const Value value = read_yaml(file);
  Diagnostics errors;
  Fields fields(value, file.string(), errors);
  TrainingRecipe recipe;
  recipe.utility = fields.text("utility");
  recipe.hours = fields.number("hours");
  if (!(recipe.hours > 0) || !std::isfinite(recipe.hours))
    fields.add_error("hours", "expected above 0 h");
  recipe.default_hours =
      fields.has("default_hours") ? fields.number("default_hours") : recipe.hours;
  if (!(recipe.default_hours > 0 && recipe.default_hours <= recipe.hours))
    fields.add_error("default_hours", "expected above 0 h and at most `hours`");
  recipe.validation = all_samples(fields, "validation", false);
  for (Fields& entry : fields.tables("rounds")) {
    RecipeRound& round = recipe.rounds.emplace_back();
    round.samples = all_samples(entry, "samples", recipe.rounds.size() > 1);
    if (entry.has("fit")) round.fit = entry.opaque("fit");
    if (!round.fit.is_map()) entry.add_error("fit", "expected parameters of `train fit`");
    if (round.samples.empty()) entry.add_error("samples", "expected at least one line");
    entry.finish();
  }
  if (recipe.validation.empty()) fields.add_error("validation", "expected at least one line");
  if (recipe.rounds.empty()) fields.add_error("rounds", "expected at least one round");
  fields.finish();
  errors.throw_if_any();
  require_apart(recipe, file.string());
  recipe.checksum = sha256(read_file(file));
  return recipe;
}

}  // namespace lapwing
