// SPDX-License-Identifier: Apache-2.0
#include "plugins/utilities/learned/fit.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>

#include "framework/core/checksum.h"
#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/number_text.h"
#include "framework/core/parallel.h"
#include "plugins/utilities/learned/kernels.h"
#include "plugins/utilities/learned/model_file.h"

namespace lapwing::learned {
namespace {

struct Samples {
  std::vector<SampleSet> sets;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> all;  // set, sample

  const std::uint8_t* grid(std::size_t k) const {
    const SampleSet& set = sets[all[k].first];
    return set.grids.data() + all[k].second * set.shape.size();
  }
  float target(std::size_t k) const { return sets[all[k].first].targets[all[k].second]; }
  std::size_t size() const { return all.size(); }
};

Samples read_all(const std::vector<std::filesystem::path>& files, const GridShape& shape,
                 Value& mapping) {
  Samples samples;
  for (const auto& file : files) {
    SampleSet set = read_samples(file);
    if (!(set.shape == shape))
      throw InputError("'" + file.string() + "' holds grids of another shape than the network's");
    if (const std::string fault = mapping_fault(set.mapping); !fault.empty())
      throw InputError("'" + file.string() +
                       "' was made with a mapping that is not whole: " + fault);
    if (mapping.is_null()) mapping = set.mapping;
    const std::string difference = mapping_difference(set.mapping, mapping);
    if (!difference.empty())
      throw InputError("'" + file.string() + "' was made with another mapping: " + difference);
    for (std::size_t k = 0; k < set.size(); ++k)
      samples.all.emplace_back(static_cast<std::uint32_t>(samples.sets.size()),
                               static_cast<std::uint32_t>(k));
    samples.sets.push_back(std::move(set));
  }
  return samples;
}

GridShape grid_of(const Parameters& grid) {
  return {static_cast<int>(grid.integer("across")), static_cast<int>(grid.integer("ahead")),
          static_cast<int>(grid.integer("up")), static_cast<int>(grid.integer("levels"))};
}

NetworkShape shape_of(const Parameters& p) {
  NetworkShape shape;
  shape.grid = grid_of(p.table("grid"));
  shape.blocks = static_cast<int>(p.integer("blocks"));
  shape.units = static_cast<int>(p.integer("units"));
  shape.growth = static_cast<int>(p.integer("growth"));
  shape.hidden1 = static_cast<int>(p.integer("hidden1"));
  shape.hidden2 = static_cast<int>(p.integer("hidden2"));
  require_sense(shape);
  return shape;
}

// What the network says of samples, normalised.
template <class GridOf>
std::vector<float> answers_to(const Model& model, std::size_t count, int threads, GridOf grid_of) {
  const FoldedNetwork network(NetworkLayout(model.shape), model.state);
  std::vector<float> answers(count);
  parallel_for(count, threads, [&](std::size_t k) { answers[k] = network.answer(grid_of(k)); });
  return answers;
}

double mean_squared_error(const Model& model, std::span<const float> answers,
                          std::span<const float> targets) {
  double sum = 0;
  for (std::size_t k = 0; k < answers.size(); ++k) {
    const double error =
        static_cast<double>(answers[k]) - model.answer_of(static_cast<double>(targets[k]));
    sum += error * error;
  }
  return sum / static_cast<double>(std::max<std::size_t>(answers.size(), 1));
}

// Says which samples these are without holding them.
std::string digest_of(const SampleSet& set) {
  std::string text = set.world + "\n" + std::to_string(set.episode) + "\n";
  text.append(reinterpret_cast<const char*>(set.targets.data()),
              set.targets.size() * sizeof(float));
  return sha256(text);
}

std::string digest_of(const Samples& samples) {
  std::string all;
  for (const SampleSet& set : samples.sets) all += digest_of(set);
  return sha256(all);
}

// Who is judged by what it was trained with is told nothing; what is there twice counts twice.
void require_apart(const FitRequest& request, const Samples& training, const Samples& validation) {
  std::map<std::string, std::size_t> trained;
  for (std::size_t k = 0; k < training.sets.size(); ++k) {
    const auto [there, fresh] = trained.emplace(digest_of(training.sets[k]), k);
    if (!fresh)
      throw InputError("'" + request.training[k].string() + "' holds the same samples as '" +
                       request.training[there->second].string() + "': leave one of them out");
  }
  for (std::size_t k = 0; k < validation.sets.size(); ++k)
    if (const auto found = trained.find(digest_of(validation.sets[k])); found != trained.end())
      throw InputError("'" + request.validation[k].string() + "' holds the same samples as '" +
                       request.training[found->second].string() +
                       "': training and validation must differ");
}

struct Judged {
  double loss = 0, rho = 0;
};

Judged judge(const Samples& samples, const Model& model, int threads) {
  const std::vector<float> answers =
      answers_to(model, samples.size(), threads, [&](std::size_t k) { return samples.grid(k); });
  std::vector<float> targets(samples.size());
  for (std::size_t k = 0; k < targets.size(); ++k) targets[k] = samples.target(k);
  return {mean_squared_error(model, answers, targets), rank_correlation(answers, targets)};
}

class Training {
 public:
  Training(const Parameters& p, const FitRequest& request);
  Value run();

 private:
  void begin();
  void resume();
  void require_same(const Value& checkpoints) const;
  double epoch(std::int64_t number);
  void note(std::int64_t number, double training, const Judged& judged, double seconds);

  const FitRequest& request_;
  NetworkShape shape_;
  NetworkLayout layout_;
  int batch_, epochs_, until_, patience_;
  double rate_, dropout_, regularisation_;
  bool mirror_, cosine_, root_;
  std::string from_;  // a model to begin with
  Samples training_, validation_;
  Model model_;
  Value asked_ = Value::map();  // all that the result depends on
  Judged best_;
  std::int64_t best_epoch_ = 0, first_ = 1;
  double seconds_ = 0;
};

Training::Training(const Parameters& p, const FitRequest& request)
    : request_(request),
      shape_(shape_of(p)),
      layout_(shape_),
      batch_(static_cast<int>(p.integer("batch"))),
      epochs_(static_cast<int>(p.integer("epochs"))),
      until_(static_cast<int>(p.integer("until") > 0 ? p.integer("until") : epochs_)),
      patience_(static_cast<int>(p.integer("patience"))),
      rate_(p.number("rate")),
      dropout_(p.number("dropout")),
      regularisation_(p.number("regularisation")),
      mirror_(p.boolean("mirror")),
      cosine_(p.text("schedule") == "cosine"),
      root_(p.text("targets") == "root"),
      from_(p.text("begin")) {
  Value mapping;
  training_ = read_all(request.training, shape_.grid, mapping);
  validation_ = read_all(request.validation, shape_.grid, mapping);
  require_apart(request, training_, validation_);
  asked_.set("seed", static_cast<std::int64_t>(request.seed));
  for (const auto& [key, value] : p.value().as_map())
    if (key != "until") asked_.set(key, value);
  asked_.set("training samples", digest_of(training_));
  asked_.set("validation samples", digest_of(validation_));
  // Evenly over all of them.
  const auto most = static_cast<std::size_t>(p.integer("validation_samples"));
  if (validation_.size() > most) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> fewer;
    for (std::size_t k = 0; k < most; ++k)
      fewer.push_back(validation_.all[k * validation_.size() / most]);
    validation_.all = std::move(fewer);
  }
  if (training_.size() < 2 * static_cast<std::size_t>(kShards) || validation_.size() < 2)
    throw InputError("too few samples to train with: " + std::to_string(training_.size()) +
                     " of training, " + std::to_string(validation_.size()) + " of validation");
  batch_ = static_cast<int>(std::min(static_cast<std::size_t>(batch_), training_.size()));
  model_.shape = shape_;
  model_.mapping = mapping;
  model_.provenance = Value::map();
}

void Training::begin() {
  model_.root = root_;
  double sum = 0, squares = 0;
  const double count = static_cast<double>(training_.size());
  for (std::size_t k = 0; k < training_.size(); ++k)
    sum += model_.answer_of(static_cast<double>(training_.target(k)));
  for (std::size_t k = 0; k < training_.size(); ++k) {
    const double d = model_.answer_of(static_cast<double>(training_.target(k))) - sum / count;
    squares += d * d;
  }
  model_.target_mean = sum / count;
  model_.target_deviation = std::sqrt(squares / count);
  if (!(model_.target_deviation > 0))
    throw InputError("all training samples have the same target: nothing can be learned");
  model_.state = initial_state(layout_, Random(request_.seed));
  if (!from_.empty()) {
    Model other = read_model(from_);
    if (!(other.shape == shape_))
      throw InputError("begin: '" + from_ + "' has another architecture than asked for");
    const std::string difference = mapping_difference(model_.mapping, other.mapping);
    if (!difference.empty())
      throw InputError("begin: '" + from_ + "' has another mapping: " + difference);
    model_.state = std::move(other.state);
    Value& begun = model_.provenance.set("begin", other.provenance);
    begun.set("sha256", sha256(read_file(from_)));
  }
  model_.adam.emplace(layout_.parameters);
  best_.loss = HUGE_VAL;
}

// A training that never learns more slowly towards its last epoch may be given more of them.
void Training::require_same(const Value& checkpoints) const {
  for (const auto& [key, value] : asked_.as_map()) {
    if (key == "epochs" && !cosine_) continue;
    const Value* other = checkpoints.find(key);
    if (other && *other == value) continue;
    throw InputError("--resume: '" + request_.checkpoint.string() + "' was made with another " +
                     key + ": " + (other ? to_json(*other, -1) : "none") + ", not " +
                     to_json(value, -1));
  }
}

void Training::resume() {
  Model saved = read_model(request_.checkpoint);
  if (!saved.adam) throw InputError("'" + request_.checkpoint.string() + "' is not a checkpoint");
  if (!(saved.shape == shape_))
    throw InputError("the checkpoint has another architecture than asked for");
  const std::string difference = mapping_difference(model_.mapping, saved.mapping);
  if (!difference.empty()) throw InputError("the checkpoint has another mapping: " + difference);
  require_same(saved.progress.at("asked"));
  model_ = std::move(saved);
  first_ = model_.progress.at("epoch").as_integer() + 1;
  best_epoch_ = model_.progress.at("best_epoch").as_integer();
  best_.loss = model_.progress.at("best_loss").as_number();
  const Value& rho = model_.progress.at("best_rho");
  best_.rho = rho.is_null() ? std::nan("") : rho.as_number();
  seconds_ = model_.progress.at("seconds").as_number();
  // The checkpoint has the last epoch's weights; the best one's are the model.
  if (!std::filesystem::exists(request_.model))
    throw InputError("--resume: the model '" + request_.model.string() + "' of epoch " +
                     std::to_string(best_epoch_) + " is not there: train anew without --resume");
  const Model best = read_model(request_.model);
  const Value* kept = best.provenance.find("epoch");
  if (!kept || !(*kept == Value(best_epoch_)))
    throw InputError("--resume: '" + request_.model.string() +
                     "' is not the model that its checkpoint goes with, of epoch " +
                     std::to_string(best_epoch_));
}

// One pass over the samples in an order of its own; the mean loss. Of the last, smaller batch the
// samples wait for another epoch.
double Training::epoch(std::int64_t number) {
  std::vector<std::uint32_t> order(training_.size());
  std::iota(order.begin(), order.end(), 0u);
  Random random = Random(request_.seed).split(static_cast<std::uint64_t>(number));
  for (std::size_t k = order.size(); k-- > 1;)
    std::swap(order[k],
              order[static_cast<std::size_t>(random.integer(0, static_cast<std::int64_t>(k)))]);
  Backpropagation network(layout_, batch_, request_.threads);
  const std::size_t batches = order.size() / static_cast<std::size_t>(batch_);
  std::vector<float> gradient(layout_.parameters), targets(static_cast<std::size_t>(batch_));
  std::vector<std::uint8_t> mirrored(static_cast<std::size_t>(batch_));
  double sum = 0;
  for (std::size_t b = 0; b < batches; ++b) {
    if (request_.cancellation && request_.cancellation->cancelled()) throw Cancelled();
    for (auto& turned : mirrored) turned = mirror_ && (random.bits() >> 63) != 0;
    parallel_for(targets.size(), request_.threads, [&](std::size_t i) {
      const std::size_t k = order[b * targets.size() + i];
      decode_grid(layout_, training_.grid(k), mirrored[i] != 0, network.input(static_cast<int>(i)));
      targets[i] = static_cast<float>(model_.answer_of(static_cast<double>(training_.target(k))));
    });
    BatchOptions options;
    options.dropout = dropout_;
    options.regularisation = regularisation_;
    options.seed = random.bits();
    sum += network.loss(model_.state, targets, options, gradient);
    const double through =
        (static_cast<double>(number - 1) * static_cast<double>(batches) + static_cast<double>(b)) /
        (static_cast<double>(epochs_) * static_cast<double>(batches));
    const double rate =
        cosine_ ? rate_ * 0.5 * (1 + std::cos(EIGEN_PI * std::min(through, 1.0))) : rate_;
    model_.adam->step(model_.state.parameters, gradient, rate);
  }
  return sum / static_cast<double>(batches);
}

void Training::note(std::int64_t number, double training, const Judged& judged, double seconds) {
  char line[200];
  std::snprintf(line, sizeof line,
                "epoch %lld: training loss %.4f, validation loss %.4f, rho %.4f, %.0f s",
                static_cast<long long>(number), training, judged.loss, judged.rho, seconds);
  request_.log(line);
}

Value Training::run() {
  if (request_.resume && std::filesystem::exists(request_.checkpoint))
    resume();
  else
    begin();
  char line[160];
  std::snprintf(line, sizeof line, "%zu training samples, %zu validation samples, %zu parameters",
                training_.size(), validation_.size(), layout_.parameters);
  request_.log(line);
  for (std::int64_t number = first_; number <= std::min(epochs_, until_); ++number) {
    if (number - 1 - best_epoch_ >= patience_ && best_epoch_ > 0) {
      request_.log("stopped: no improvement for " + std::to_string(patience_) + " epochs");
      break;
    }
    const auto begin_time = std::chrono::steady_clock::now();
    const double loss = epoch(number);
    const Judged judged = judge(validation_, model_, request_.threads);
    if (!std::isfinite(loss) || !std::isfinite(judged.loss))
      throw InputError("the training has no finite loss in epoch " + std::to_string(number) +
                       ": use a rate lower than " + plain_number(asked_.at("rate").as_number()) +
                       " may help");
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_time).count();
    seconds_ += seconds;
    note(number, loss, judged, seconds);
    if (judged.loss < best_.loss) {
      best_ = judged;
      best_epoch_ = number;
      Model kept = model_;
      kept.adam.reset();
      Value& from = kept.provenance = Value::map();
      if (const Value* begun = model_.provenance.find("begin")) from.set("begin", *begun);
      from.set("samples", static_cast<std::int64_t>(training_.size()));
      from.set("validation_samples", static_cast<std::int64_t>(validation_.size()));
      from.set("epoch", number);
      from.set("seed", static_cast<std::int64_t>(request_.seed));
      from.set("validation_loss", judged.loss);
      from.set("validation_rho", std::isfinite(judged.rho) ? Value(judged.rho) : Value());
      std::vector<std::string> worlds;
      for (const SampleSet& set : training_.sets)
        if (std::find(worlds.begin(), worlds.end(), set.world) == worlds.end())
          worlds.push_back(set.world);
      Value& list = from.set("worlds", Value::list());
      for (const std::string& world : worlds) list.push_back(world);
      write_model(kept, request_.model);
    }
    Value& progress = model_.progress = Value::map();
    progress.set("epoch", number);
    progress.set("best_epoch", best_epoch_);
    progress.set("best_loss", best_.loss);
    progress.set("best_rho", std::isfinite(best_.rho) ? Value(best_.rho) : Value());
    progress.set("seconds", seconds_);
    progress.set("asked", asked_);
    write_model(model_, request_.checkpoint);
  }
  Value figures = Value::map();
  figures.set("epoch", best_epoch_);
  figures.set("validation_loss", best_.loss);
  figures.set("validation_rho", std::isfinite(best_.rho) ? Value(best_.rho) : Value());
  figures.set("seconds", seconds_);
  return figures;
}

}  // namespace

ParameterTable sample_parameters() {
  const Range points = between(GridShape::kLeastPoints, GridShape::kMostPoints);
  ParameterTable grid;
  grid.integer("across", 16, "points to the right and left", points)
      .integer("ahead", 16, "points ahead and behind", points)
      .integer("up", 8, "points up and down", points)
      .integer("levels", 3, "scales", between(1, MapMeans::kMostLevels));
  return ParameterTable().table("grid", grid, "levels of the map that the network reads");
}

ParameterTable fit_parameters() {
  const Range widths = between(kLanes, NetworkShape::kMostWidth);
  return sample_parameters()
      .integer("blocks", 2, "N_c", between(1, NetworkShape::kMostBlocks))
      .integer("units", 4, "N_u, convolutions per block", between(1, NetworkShape::kMostUnits))
      .integer("growth", 8, "N_f, feature maps that every convolution adds", widths)
      .integer("hidden1", 128, "N_h1", widths)
      .integer("hidden2", 32, "N_h2", widths)
      .integer("batch", 128, "samples per step", between(8, 4096))
      .integer("epochs", 30, "passes over the samples", between(1, 100000))
      .integer("until", 0, "last epoch of this run; 0: all epochs", between(0, 100000))
      .integer("patience", 10, "epochs without improvement after which training stops",
               between(1, 100000))
      .number("rate", 1e-4, "", "of Adam", above(0))
      .choice("schedule", "constant", {"constant", "cosine"},
              "constant rate, or falling to 0 at the last epoch")
      .choice("targets", "plain", {"plain", "root"},
              "target: values of the oracle, or their square roots")
      .number("dropout", 0.5, "", "dropout: fraction of hidden units left out", between(0, 0.95))
      .number("regularisation", 1e-4, "", "lambda of (5.4)", between(0, 1))
      .boolean("mirror", true, "mirror half of the samples")
      .text("begin", "", "model with the initial weights; empty: none")
      .integer("validation_samples", 20000, "largest number of samples, evenly over all",
               between(2, 10000000));
}

GridShape sample_shape(const Parameters& parameters) {
  NetworkShape smallest;
  smallest.grid = grid_of(parameters.table("grid"));
  smallest.blocks = 1;
  require_sense(smallest);
  return smallest.grid;
}

Value fit(const Parameters& parameters, const FitRequest& request) {
  return Training(parameters, request).run();
}

Prediction predict(const std::filesystem::path& path, const SampleSet& samples, int threads) {
  const Model model = read_model(path);
  if (!(samples.shape == model.shape.grid))
    throw InputError("the samples hold grids of another shape than the model '" + path.string() +
                     "' asks for");
  const std::string difference = mapping_difference(samples.mapping, model.mapping);
  if (!difference.empty())
    throw InputError("the samples do not fit the model '" + path.string() + "': " + difference);
  const std::vector<float> answers = answers_to(model, samples.size(), threads, [&](std::size_t k) {
    return samples.grids.data() + k * samples.shape.size();
  });
  Prediction predicted{{}, mean_squared_error(model, answers, samples.targets)};
  for (const float answer : answers)
    predicted.values.push_back(static_cast<float>(model.target_of(static_cast<double>(answer))));
  return predicted;
}

}  // namespace lapwing::learned
