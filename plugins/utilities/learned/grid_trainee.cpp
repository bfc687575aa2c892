// SPDX-License-Identifier: Apache-2.0
// The network of the thesis as it is trained: one number a view, the mean squared error (5.4).
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/parallel.h"
#include "plugins/utilities/learned/trainee.h"

namespace lapwing::learned {
namespace {

GridShape grid_of(const Parameters& grid) {
  return {static_cast<int>(grid.integer("across")), static_cast<int>(grid.integer("ahead")),
          static_cast<int>(grid.integer("up")), static_cast<int>(grid.integer("levels"))};
}

NetworkShape network_of(const Parameters& p) {
  NetworkShape shape;
  shape.grid = grid_of(p.table("grid"));
  shape.blocks = static_cast<int>(p.integer("blocks"));
  shape.units = static_cast<int>(p.integer("units"));
  shape.growth = static_cast<int>(p.integer("growth"));
  shape.hidden1 = static_cast<int>(p.integer("hidden1"));
  shape.hidden2 = static_cast<int>(p.integer("hidden2"));
  shape.residual = p.boolean("residual");
  require_sense(shape);
  return shape;
}

// What the network says of samples, normalised.
template <class GridOf>
std::vector<float> answers_to(const NetworkShape& shape, const Model& model, std::size_t count,
                              int threads, GridOf grid_of) {
  const FoldedNetwork network(NetworkLayout(shape), model.state);
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

class GridTrainee final : public Trainee {
 public:
  GridTrainee(const Parameters& p, int batch, int threads)
      : shape_(network_of(p)),
        layout_(shape_),
        batch_(batch),
        threads_(threads),
        root_(p.text("targets") == "root") {
    options_.dropout = p.number("dropout");
    options_.regularisation = p.number("regularisation");
  }

  std::size_t parameters() const override { return layout_.parameters; }
  ViewInput input() const override { return shape_.grid; }
  bool fits(const Model& model) const override {
    const auto* other = std::get_if<NetworkShape>(&model.shape);
    return other && *other == shape_;
  }

  void begin(Model& model, const Samples& training, std::uint64_t seed) const override {
    model.shape = shape_;
    model.root = root_;
    double sum = 0, squares = 0;
    const double count = static_cast<double>(training.size());
    for (std::size_t k = 0; k < training.size(); ++k)
      sum += model.answer_of(static_cast<double>(*training.targets(k)));
    for (std::size_t k = 0; k < training.size(); ++k) {
      const double d = model.answer_of(static_cast<double>(*training.targets(k))) - sum / count;
      squares += d * d;
    }
    model.target_mean = sum / count;
    model.target_deviation = std::sqrt(squares / count);
    if (!(model.target_deviation > 0))
      throw InputError("all training samples have the same target: nothing can be learned");
    model.state = initial_state(layout_, Random(seed));
  }

  double loss(Model& model, const Samples& samples, const BatchDraw& batch,
              std::span<float> gradient) override {
    if (!network_) network_.emplace(layout_, batch_, threads_);
    targets_.resize(batch.samples.size());
    parallel_for(targets_.size(), threads_, [&](std::size_t i) {
      const std::size_t k = batch.samples[i];
      decode_grid(layout_, samples.input(k), batch.mirrored[i] != 0,
                  network_->input(static_cast<int>(i)));
      targets_[i] = static_cast<float>(model.answer_of(static_cast<double>(*samples.targets(k))));
    });
    options_.seed = batch.seed;
    return network_->loss(model.state, targets_, options_, gradient);
  }

  Judged judge(const Model& model, const Samples& samples, int threads) const override {
    const std::vector<float> answers = answers_to(shape_, model, samples.size(), threads,
                                                  [&](std::size_t k) { return samples.input(k); });
    std::vector<float> targets(samples.size());
    for (std::size_t k = 0; k < targets.size(); ++k) targets[k] = *samples.targets(k);
    return {mean_squared_error(model, answers, targets), rank_correlation(answers, targets)};
  }

 private:
  NetworkShape shape_;
  NetworkLayout layout_;
  int batch_, threads_;
  bool root_;
  BatchOptions options_;
  std::optional<Backpropagation> network_;  // once a batch is asked for
  std::vector<float> targets_;
};

}  // namespace

std::unique_ptr<Trainee> grid_trainee(const Parameters& parameters, int batch, int threads) {
  return std::make_unique<GridTrainee>(parameters, batch, threads);
}

ViewInput grid_input(const Parameters& parameters) {
  NetworkShape smallest;
  smallest.grid = grid_of(parameters.table("grid"));
  smallest.blocks = 1;
  require_sense(smallest);
  return smallest.grid;
}

Prediction predict_by_grid(const std::filesystem::path& path, const SampleSet& samples,
                           int threads) {
  const Model model = read_model(path);
  const NetworkShape& shape = model.grid_network(path);
  require_fit(samples, shape.grid, model, path);
  const std::vector<float> answers =
      answers_to(shape, model, samples.size(), threads,
                 [&](std::size_t k) { return samples.inputs.data() + k * shape.grid.size(); });
  Prediction predicted{{}, mean_squared_error(model, answers, samples.targets)};
  for (const float answer : answers)
    predicted.values.push_back(static_cast<float>(model.target_of(static_cast<double>(answer))));
  return predicted;
}

}  // namespace lapwing::learned
