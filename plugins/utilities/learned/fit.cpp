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
#include "plugins/utilities/learned/trainee.h"

namespace lapwing::learned {
namespace {

Samples read_all(const std::vector<std::filesystem::path>& files, const ViewInput& input,
                 Value& mapping) {
  Samples samples;
  for (const auto& file : files) {
    SampleSet set = read_samples(file);
    if (!(set.input == input))
      throw InputError("'" + file.string() + "' holds samples of another input, " +
                       to_json(to_value(set.input), -1) + ", than the network reads, " +
                       to_json(to_value(input), -1));
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

// Training and validation must not share samples; what is there twice would count twice.
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

class Training {
 public:
  Training(NewTrainee make, const Parameters& p, const FitRequest& request);
  Value run();

 private:
  void begin();
  void resume();
  void require_same(const Value& checkpoints) const;
  double epoch(std::int64_t number);
  void note(std::int64_t number, double training, const Judged& judged, double seconds);

  const FitRequest& request_;
  std::unique_ptr<Trainee> network_;
  int batch_, epochs_, until_, patience_;
  double rate_;
  bool mirror_, cosine_;
  std::string from_;  // a model to begin with
  Samples training_, validation_;
  Model model_;
  Value asked_ = Value::map();  // all that the result depends on
  Judged best_;
  std::int64_t best_epoch_ = 0, first_ = 1;
  double seconds_ = 0;
};

Training::Training(NewTrainee make, const Parameters& p, const FitRequest& request)
    : request_(request),
      batch_(static_cast<int>(p.integer("batch"))),
      epochs_(static_cast<int>(p.integer("epochs"))),
      until_(static_cast<int>(p.integer("until") > 0 ? p.integer("until") : epochs_)),
      patience_(static_cast<int>(p.integer("patience"))),
      rate_(p.number("rate")),
      mirror_(p.boolean("mirror")),
      cosine_(p.text("schedule") == "cosine"),
      from_(p.text("begin")) {
  Value mapping;
  const ViewInput input = make(p, 1, 1)->input();  // refuses what is no architecture
  training_ = read_all(request.training, input, mapping);
  validation_ = read_all(request.validation, input, mapping);
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
  network_ = make(p, batch_, request.threads);
  // With libtorch, the result depends on the device and the number of threads as well.
  asked_.set("computed by", network_->backend());
  model_.mapping = mapping;
  model_.provenance = Value::map();
}

void Training::begin() {
  network_->begin(model_, training_, request_.seed);
  if (!from_.empty()) {
    Model other = read_model(from_);
    if (!network_->fits(other))
      throw InputError("begin: '" + from_ + "' has another architecture than asked for");
    const std::string difference = mapping_difference(model_.mapping, other.mapping);
    if (!difference.empty())
      throw InputError("begin: '" + from_ + "' has another mapping: " + difference);
    model_.state = std::move(other.state);
    Value& begun = model_.provenance.set("begin", other.provenance);
    begun.set("sha256", sha256(read_file(from_)));
  }
  model_.adam.emplace(network_->parameters());
  best_.loss = HUGE_VAL;
}

// At a constant rate, `epochs` may be raised on resume.
void Training::require_same(const Value& checkpoints) const {
  for (const auto& [key, value] : asked_.as_map()) {
    if (key == "epochs" && !cosine_) continue;
    const Value* other = checkpoints.find(key);
    if (other && *other == value) continue;
    // Of older versions.
    if (!other && (key == "backend" || key == "computed by") && network_->backend() == kOwnBackend)
      continue;
    throw InputError("--resume: '" + request_.checkpoint.string() + "' was made with another " +
                     key + ": " + (other ? to_json(*other, -1) : "none") + ", not " +
                     to_json(value, -1));
  }
}

void Training::resume() {
  Model saved = read_model(request_.checkpoint);
  if (!saved.adam) throw InputError("'" + request_.checkpoint.string() + "' is not a checkpoint");
  if (!network_->fits(saved))
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
  const std::size_t batches = order.size() / static_cast<std::size_t>(batch_);
  std::vector<float> gradient(network_->parameters());
  std::vector<std::uint8_t> mirrored(static_cast<std::size_t>(batch_));
  double sum = 0;
  for (std::size_t b = 0; b < batches; ++b) {
    if (request_.cancellation && request_.cancellation->cancelled()) throw Cancelled();
    for (auto& turned : mirrored) turned = mirror_ && (random.bits() >> 63) != 0;
    const BatchDraw draw{std::span(order).subspan(b * mirrored.size(), mirrored.size()), mirrored,
                         random.bits()};
    sum += network_->loss(model_, training_, draw, gradient);
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
  request_.log(std::to_string(training_.size()) + " training samples, " +
               std::to_string(validation_.size()) + " validation samples, " +
               std::to_string(network_->parameters()) + " parameters, " + network_->backend());
  for (std::int64_t number = first_; number <= std::min(epochs_, until_); ++number) {
    if (number - 1 - best_epoch_ >= patience_ && best_epoch_ > 0) {
      request_.log("stopped: no improvement for " + std::to_string(patience_) + " epochs");
      break;
    }
    const auto begin_time = std::chrono::steady_clock::now();
    const double loss = epoch(number);
    const Judged judged = network_->judge(model_, validation_, request_.threads);
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
      if (network_->backend() != kOwnBackend) from.set("computed by", network_->backend());
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

// What both networks are trained by.
void add_training(ParameterTable& table, std::int64_t batch, std::int64_t epochs,
                  std::int64_t patience, double rate) {
  table.integer("batch", batch, "samples per step", between(8, 4096))
      .integer("epochs", epochs, "passes over the samples", between(1, 100000))
      .integer("until", 0, "last epoch of this run; 0: all epochs", between(0, 100000))
      .integer("patience", patience, "epochs without improvement after which training stops",
               between(1, 100000))
      .number("rate", rate, "", "of Adam", above(0))
      .choice("schedule", "constant", {"constant", "cosine"},
              "constant rate, or falling to 0 at the last epoch")
      .boolean("mirror", true, "mirror half of the samples")
      .text("begin", "", "model with the initial weights; empty: none")
      .choice("backend", "own", {"own", "libtorch"},
              "what computes derivatives: kernels of Lapwing, or libtorch (preset `learn`)")
      .integer("validation_samples", 20000, "largest number of samples, evenly over all",
               between(2, 10000000));
}

ParameterTable grid_samples() {
  const Range points = between(GridShape::kLeastPoints, GridShape::kMostPoints);
  ParameterTable grid;
  grid.integer("across", 16, "points to the right and left", points)
      .integer("ahead", 16, "points ahead and behind", points)
      .integer("up", 8, "points up and down", points)
      .integer("levels", 3, "scales", between(1, MapMeans::kMostLevels));
  return ParameterTable().table("grid", grid, "levels of the map that the network reads");
}

ParameterTable grid_fit() {
  const Range widths = between(kLanes, NetworkShape::kMostWidth);
  ParameterTable table =
      grid_samples()
          .integer("blocks", 2, "N_c", between(1, NetworkShape::kMostBlocks))
          .integer("units", 4, "N_u, convolutions per block", between(1, NetworkShape::kMostUnits))
          .integer("growth", 8, "N_f, feature maps that every convolution adds", widths)
          .integer("hidden1", 128, "N_h1", widths)
          .integer("hidden2", 32, "N_h2", widths)
          .boolean("residual", false, "add the input of every convolution to its result")
          .choice("targets", "plain", {"plain", "root"},
                  "target: values of the oracle, or their square roots")
          .number("dropout", 0.5, "", "dropout: fraction of hidden units left out",
                  between(0, 0.95))
          .number("regularisation", 1e-4, "", "lambda of (5.4)", between(0, 1));
  add_training(table, 128, 30, 10, 1e-4);
  return table;
}

ParameterTable ray_samples() {
  const Range edge = between(RayShape::kLeastRays, RayShape::kMostRays);
  ParameterTable rays;
  rays.integer("columns", RayShape{}.columns, "rays across the image", edge)
      .integer("rows", RayShape{}.rows, "rays from its top to its bottom", edge);
  return ParameterTable().table("rays", rays, "rays of the view that the network reads");
}

ParameterTable ray_fit() {
  ParameterTable table = ray_samples()
                             .integer("width", RayNetworkShape{}.width, "feature maps",
                                      between(kLanes, RayNetworkShape::kMostWidth))
                             .integer("convolutions", RayNetworkShape{}.convolutions,
                                      "of 3 x 3 rays, each dilated twice as far as the one before",
                                      between(0, RayNetworkShape::kMostConvolutions));
  add_training(table, 64, 6, 3, 2e-3);
  return table;
}

void require_backend(const Parameters& p) {
  if (p.text("backend") == "libtorch") require_torch();
}

Value fit(const Parameters& p, const FitRequest& request, NewTrainee own, NewTrainee torch) {
  return Training(p.text("backend") == "libtorch" ? torch : own, p, request).run();
}

Value fit_grid(const Parameters& parameters, const FitRequest& request) {
  return fit(parameters, request, grid_trainee, torch_grid_trainee);
}

Value fit_rays(const Parameters& parameters, const FitRequest& request) {
  return fit(parameters, request, ray_trainee, torch_ray_trainee);
}

}  // namespace

void require_fit(const SampleSet& samples, const ViewInput& input, const Model& model,
                 const std::filesystem::path& path) {
  if (!(samples.input == input))
    throw InputError("the samples hold another input than the model '" + path.string() +
                     "' asks for: " + to_json(to_value(samples.input), -1) + ", not " +
                     to_json(to_value(input), -1));
  const std::string difference = mapping_difference(samples.mapping, model.mapping);
  if (!difference.empty())
    throw InputError("the samples do not fit the model '" + path.string() + "': " + difference);
}

const Trainable kGridTrainable{&grid_samples,    [](const Parameters& p) { return grid_input(p); },
                               &grid_fit,        &fit_grid,
                               &predict_by_grid, &require_backend};
const Trainable kRayTrainable{&ray_samples,     [](const Parameters& p) { return ray_input(p); },
                              &ray_fit,         &fit_rays,
                              &predict_by_rays, &require_backend};

}  // namespace lapwing::learned
