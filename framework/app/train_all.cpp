// SPDX-License-Identifier: Apache-2.0
// lapwing train all: a model from nothing, by a recipe (study/training_recipe.h). Every step is a
// command of this program, so that an interrupted run continues where it was.
#include <iostream>

#include "framework/app/child_command.h"
#include "framework/app/exploration_worlds.h"
#include "framework/app/input_checksums.h"
#include "framework/app/interruption.h"
#include "framework/app/item_command.h"
#include "framework/app/train_command.h"
#include "framework/config/shipped.h"
#include "framework/core/checksum.h"
#include "framework/core/file_set.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/number_text.h"
#include "framework/core/visible_text.h"
#include "framework/explore/trainable.h"
#include "framework/study/training_recipe.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

TrainingRecipe recipe_of(const TrainRequest& request) {
  const fs::path shipped = shipped_folder("configs") / "train" / (request.utility + ".yaml");
  if (request.recipe.empty() && !fs::exists(shipped))
    throw InputError("there is no recipe for utility '" + request.utility +
                     "': name one with --recipe FILE");
  const TrainingRecipe whole = read_recipe(request.recipe.empty() ? shipped : request.recipe);
  return whole.within(request.hours.value_or(whole.default_hours));
}

class RecipeRun {
 public:
  RecipeRun(const TrainRequest& request, const Invocation& invocation)
      : request_(request),
        invocation_(invocation),
        recipe_(recipe_of(request)),
        work_(request.target.string() + ".training") {}

  ExitStatus run() {
    if (fs::is_directory(request_.target))
      throw InputError("'" + request_.target.string() + "' is a folder: a model is a file");
    if (!request_.resume && fs::exists(request_.target))
      throw InputError("'" + request_.target.string() +
                       "' exists: choose another name, or delete it");
    if (!request_.resume && fs::exists(log_file()))
      throw InputError("'" + log_file().string() +
                       "' exists: choose another name for the model, or delete it");
    require_writable(request_.target);
    require_known();
    const FolderClaim claim(work_);
    claim_version();
    make_samples(recipe_.validation, "validation", "");
    std::string model;
    std::string log;
    for (std::size_t k = 0; k < recipe_.rounds.size(); ++k) {
      const std::string name = "round_" + std::to_string(k + 1);
      make_samples(recipe_.rounds[k].samples, name, model);
      model = fit(k, name, model, log);
    }
    write_file_atomically(log_file(), log);
    write_file_atomically(request_.target, read_file(model));
    if (invocation_.json) {
      Value object = Value::map();
      object.set("status", "ok");
      object.set("model", request_.target.string());
      object.set("rounds", rounds_);
      print_json(object);
    } else if (!invocation_.quiet) {
      std::cout << log << "model: " << visible_line(request_.target.string()) << std::endl;
    }
    return ExitStatus::done;
  }

 private:
  // What is named, before anything is flown.
  void require_known() const {
    const Registry registry = invocation_.registry();
    registry.find(ViewUtility::kKind, recipe_.utility);
    const auto* trainable = static_cast<const Trainable*>(
        registry.extension(ViewUtility::kKind, recipe_.utility, kTrainable));
    if (!trainable) throw InputError("utility '" + recipe_.utility + "' is not a trained utility");
    ExplorationSetup().set_mapping(request_.mapping);
    const auto require = [&](const RecipeSamples& line) {
      if (line.explorer != TrainingRecipe::kItself)
        registry.find(ViewUtility::kKind, line.explorer);
      for (const std::string& world : line.worlds()) require_world(world_names(world).front(), "");
    };
    for (const RecipeSamples& line : recipe_.validation) require(line);
    for (const RecipeRound& round : recipe_.rounds) {
      for (const RecipeSamples& line : round.samples) require(line);
      const Parameters fit = check(trainable->fit_parameters(), round.fit);
      if (trainable->require_fit) trainable->require_fit(fit);
      for (const char* input : {"rays", "grid"})
        if (round.fit.find(input))
          throw InputError(std::string("fit: a recipe uses the standard input of its network; '") +
                           input + "' cannot be set");
    }
  }

  fs::path log_file() const { return request_.target.string() + ".log"; }
  fs::path in_work(const std::string& name) const { return work_ / name; }

  // All in the folder is of one recipe, program, seed and share.
  void claim_version() const {
    Value stated = Value::map();
    stated.set("format", 1);
    stated.set("program", std::string("lapwing ") + program_version());
    stated.set("executable", program_checksum());
    stated.set("plugins", sha256(to_json(plugin_checksums(invocation_.registry()))));
    stated.set("scripts", checksum_of_folder(shipped_folder("scripts")));
    stated.set("recipe", recipe_.checksum);
    stated.set("hours", request_.hours.value_or(recipe_.default_hours));
    Value& mapping = stated.set("mapping", Value::list());
    for (const std::string& entry : request_.mapping) mapping.push_back(entry);
    stated.set("seed", static_cast<std::int64_t>(invocation_.seed));
    const fs::path file = in_work("training.json");
    if (!fs::exists(file)) {
      if (!fs::is_empty(work_))
        throw InputError("'" + work_.string() + "' is not empty, and not of a training: delete it");
      write_file_atomically(file, to_json(stated) + "\n");
      return;
    }
    if (!request_.resume)
      throw InputError("'" + work_.string() +
                       "' contains a training: continue it with --resume, or delete it");
    const Value there = from_json(read_file(file), file.string());
    for (const auto& [key, value] : stated.as_map()) {
      const Value* before = there.find(key);
      if (before && *before == value) continue;
      throw InputError("--resume: '" + file.string() + "' is of another training: its " + key +
                       " is " + (before ? to_json(*before, -1) : "not said") + ", not " +
                       to_json(value, -1));
    }
  }

  std::vector<std::string> command(const char* name) const {
    std::vector<std::string> words{"lapwing"};
    for (const fs::path& path : invocation_.plugin_path)
      words.insert(words.end(), {"--plugin-path", path.string()});
    words.insert(words.end(), {"train", name, "--utility", recipe_.utility, "--seed",
                               std::to_string(invocation_.seed), "--resume"});
    if (invocation_.threads > 0)
      words.insert(words.end(), {"--threads", std::to_string(invocation_.threads)});
    if (invocation_.quiet) words.push_back("--quiet");
    return words;
  }

  Value ask(const std::vector<std::string>& words, const std::string& step) const {
    if (!invocation_.quiet) std::cerr << visible_line(step) << std::endl;
    const ChildAnswer said = run_child(words, interruption_.token());
    if (said.status != 0)
      throw InputError(step + ": ended with exit status " + std::to_string(said.status));
    return said.output.empty() ? Value::map() : from_json(said.output, step);
  }

  void make_samples(const std::vector<RecipeSamples>& lines, const std::string& name,
                    const std::string& model) const {
    for (std::size_t k = 0; k < lines.size(); ++k) {
      const RecipeSamples& line = lines[k];
      std::vector<std::string> words = command("dataset");
      for (const std::string& world : line.worlds()) words.insert(words.end(), {"--world", world});
      const bool itself = line.explorer == TrainingRecipe::kItself;
      words.insert(words.end(), {"--explorer", itself ? recipe_.utility : line.explorer});
      if (itself) words.insert(words.end(), {"--explorer-set", "model=" + model});
      for (const std::string& entry : request_.mapping)
        words.insert(words.end(), {"--mapping", entry});
      words.insert(words.end(), {"--episodes", "1", "--steps", std::to_string(line.steps)});
      if (line.sigma > 0) words.insert(words.end(), {"--sigma", plain_number(line.sigma)});
      if (line.dropped > 0) words.insert(words.end(), {"--dropped", plain_number(line.dropped)});
      words.insert(words.end(), {"--output", (in_work(name) / std::to_string(k + 1)).string()});
      ask(words, name + ", samples " + std::to_string(k + 1) + " of " +
                     std::to_string(lines.size()) + ": " + line.explorer + " explores");
    }
  }

  // Of all samples so far; the path of the model.
  std::string fit(std::size_t round, const std::string& name, const std::string& before,
                  std::string& log) {
    std::vector<std::string> words = command("fit");
    const auto add_folders = [&](const std::string& of, std::size_t count, bool validation) {
      for (std::size_t k = 0; k < count; ++k) {
        if (validation) words.push_back("--validation");
        words.push_back((in_work(of) / std::to_string(k + 1)).string());
      }
    };
    for (std::size_t k = 0; k <= round; ++k)
      add_folders("round_" + std::to_string(k + 1), recipe_.rounds[k].samples.size(), false);
    add_folders("validation", recipe_.validation.size(), true);
    for (const auto& [key, value] : recipe_.rounds[round].fit.as_map())
      words.insert(words.end(),
                   {"--set", key + "=" + (value.is_text() ? value.as_text() : to_json(value, -1))});
    if (!before.empty()) words.insert(words.end(), {"--set", "begin=" + before});
    const std::string model = in_work(name + ".model").string();
    words.insert(words.end(), {"--output", model, "--json"});
    Value figures = ask(words, name + ", training");
    log += name + ": " + to_json(figures, -1) + "\n";
    figures.set("round", static_cast<std::int64_t>(round + 1));
    rounds_.push_back(std::move(figures));
    return model;
  }

  const TrainRequest& request_;
  const Invocation& invocation_;
  const TrainingRecipe recipe_;
  const fs::path work_;
  Value rounds_ = Value::list();
  const Interruption interruption_;
};

}  // namespace

ExitStatus train_all(const TrainRequest& request, const Invocation& invocation) {
  return RecipeRun(request, invocation).run();
}

}  // namespace lapwing
