// SPDX-License-Identifier: Apache-2.0
// The network that reads rays as it is trained: one number a ray, the loss of ray_network.h.
#include <numeric>

#include "framework/core/error.h"
#include "framework/core/parallel.h"
#include "plugins/utilities/learned/trainee.h"

namespace lapwing::learned {
namespace {

RayShape rays_of(const Parameters& rays) {
  return {static_cast<int>(rays.integer("columns")), static_cast<int>(rays.integer("rows"))};
}

RayNetworkShape network_of_rays(const Parameters& p) {
  RayNetworkShape shape;
  shape.rays = rays_of(p.table("rays"));
  shape.width = static_cast<int>(p.integer("width"));
  shape.convolutions = static_cast<int>(p.integer("convolutions"));
  require_sense(shape);
  return shape;
}

// Values of views and the mean loss.
template <class Input, class Targets>
Prediction told_of(const RayNetworkShape& shape, const Model& model, std::size_t count, int threads,
                   Input input, Targets targets) {
  const RayNetwork network(RayNetworkLayout(shape), model.state.parameters);
  const auto rays = static_cast<std::size_t>(shape.rays.rays());
  Prediction told{std::vector<float>(count), 0};
  std::vector<double> losses(count);
  parallel_for(count, threads, [&](std::size_t k) {
    thread_local std::vector<float> cells;
    cells.resize(rays);
    network.answer(input(k), cells);
    told.values[k] = std::accumulate(cells.begin(), cells.end(), 0.0f);
    losses[k] = ray_loss(cells, {targets(k), rays});
  });
  for (const double loss : losses) told.loss += loss;
  told.loss /= static_cast<double>(std::max<std::size_t>(count, 1));
  return told;
}

class RayTrainee final : public Trainee {
 public:
  RayTrainee(const Parameters& p, int batch, int threads)
      : shape_(network_of_rays(p)), layout_(shape_), batch_(batch), threads_(threads) {}

  std::size_t parameters() const override { return layout_.parameters; }
  ViewInput input() const override { return shape_.rays; }
  bool fits(const Model& model) const override {
    const auto* other = std::get_if<RayNetworkShape>(&model.shape);
    return other && *other == shape_;
  }

  void begin(Model& model, const Samples&, std::uint64_t seed) const override {
    model.shape = shape_;
    model.state.parameters = initial_parameters(layout_, Random(seed));
  }

  double loss(Model& model, const Samples& samples, const BatchDraw& batch,
              std::span<float> gradient) override {
    if (!network_) network_.emplace(layout_, batch_, threads_);
    parallel_for(batch.samples.size(), threads_, [&](std::size_t i) {
      const std::size_t k = batch.samples[i];
      const bool mirrored = batch.mirrored[i] != 0;
      decode_rays(layout_, samples.input(k), mirrored, network_->input(static_cast<int>(i)));
      decode_targets(shape_.rays, samples.targets(k), mirrored,
                     network_->target(static_cast<int>(i)));
    });
    return network_->loss(model.state.parameters, gradient);
  }

  Judged judge(const Model& model, const Samples& samples, int threads) const override {
    const Prediction told = told_of(
        shape_, model, samples.size(), threads, [&](std::size_t k) { return samples.input(k); },
        [&](std::size_t k) { return samples.targets(k); });
    const auto rays = static_cast<std::ptrdiff_t>(shape_.rays.rays());
    std::vector<float> gains(samples.size());
    for (std::size_t k = 0; k < gains.size(); ++k)
      gains[k] = std::accumulate(samples.targets(k), samples.targets(k) + rays, 0.0f);
    return {told.loss, rank_correlation(told.values, gains)};
  }

 private:
  RayNetworkShape shape_;
  RayNetworkLayout layout_;
  int batch_, threads_;
  std::optional<RayBackpropagation> network_;  // once a batch is asked for
};

}  // namespace

std::unique_ptr<Trainee> ray_trainee(const Parameters& parameters, int batch, int threads) {
  return std::make_unique<RayTrainee>(parameters, batch, threads);
}

ViewInput ray_input(const Parameters& parameters) {
  const RayShape shape = rays_of(parameters.table("rays"));
  require_sense(shape);
  return shape;
}

Prediction predict_by_rays(const std::filesystem::path& path, const SampleSet& samples,
                           int threads) {
  const Model model = read_model(path);
  const RayNetworkShape& shape = model.ray_network(path);
  require_fit(samples, shape.rays, model, path);
  return told_of(
      shape, model, samples.size(), threads,
      [&](std::size_t k) { return samples.inputs.data() + k * shape.rays.size(); },
      [&](std::size_t k) {
        return samples.targets.data() + k * static_cast<std::size_t>(shape.rays.rays());
      });
}

}  // namespace lapwing::learned
