// SPDX-License-Identifier: Apache-2.0
// Training by libtorch (LAPWING_LEARN): its automatic derivatives in place of our own. Initial
// weights, order of samples, dropout, Adam, validation and files are the same.
#include "framework/core/parallel.h"
#include "plugins/utilities/learned/torch_networks.h"
#include "plugins/utilities/learned/trainee.h"

namespace lapwing::learned {
namespace {

// All but the loss is as our own trainee has it.
class TorchTrainee : public Trainee {
 public:
  TorchTrainee(std::unique_ptr<Trainee> own, int threads)
      : own_(std::move(own)), threads_(threads > 0 ? threads : available_threads()) {
    begin_torch(threads_);
  }

  std::string backend() const override { return torch_here(); }
  std::size_t parameters() const override { return own_->parameters(); }
  ViewInput input() const override { return own_->input(); }
  void begin(Model& model, const Samples& training, std::uint64_t seed) const override {
    own_->begin(model, training, seed);
  }
  bool fits(const Model& model) const override { return own_->fits(model); }
  Judged judge(const Model& model, const Samples& samples, int threads) const override {
    return own_->judge(model, samples, threads);
  }

 protected:
  std::unique_ptr<Trainee> own_;
  int threads_;
  std::vector<float> inputs_, targets_;  // of a batch
};

class TorchRayTrainee final : public TorchTrainee {
 public:
  TorchRayTrainee(const Parameters& p, int batch, int threads)
      : TorchTrainee(ray_trainee(p, batch, threads), threads) {}

  double loss(Model& model, const Samples& samples, const BatchDraw& batch,
              std::span<float> gradient) override {
    const RayNetworkLayout layout(std::get<RayNetworkShape>(model.shape));
    const auto targets = static_cast<std::size_t>(layout.rays());
    const std::size_t inputs = targets * RayNetworkLayout::kInputs;
    inputs_.resize(batch.samples.size() * inputs);
    targets_.resize(batch.samples.size() * targets);
    parallel_for(batch.samples.size(), threads_, [&](std::size_t i) {
      const std::size_t k = batch.samples[i];
      const bool mirrored = batch.mirrored[i] != 0;
      decode_rays(layout, samples.input(k), mirrored, inputs_.data() + i * inputs);
      decode_targets(layout.shape.rays, samples.targets(k), mirrored,
                     targets_.data() + i * targets);
    });
    return torch_loss(layout, model.state.parameters, inputs_, targets_, gradient);
  }
};

class TorchGridTrainee final : public TorchTrainee {
 public:
  TorchGridTrainee(const Parameters& p, int batch, int threads)
      : TorchTrainee(grid_trainee(p, batch, threads), threads) {
    options_.dropout = p.number("dropout");
    options_.regularisation = p.number("regularisation");
  }

  double loss(Model& model, const Samples& samples, const BatchDraw& batch,
              std::span<float> gradient) override {
    const NetworkLayout layout(std::get<NetworkShape>(model.shape));
    const UnitPlace& first = layout.units.front();
    const std::size_t inputs = first.padded() * static_cast<std::size_t>(first.in);
    inputs_.resize(batch.samples.size() * inputs);  // borders stay 0
    targets_.resize(batch.samples.size());
    parallel_for(batch.samples.size(), threads_, [&](std::size_t i) {
      const std::size_t k = batch.samples[i];
      decode_grid(layout, samples.input(k), batch.mirrored[i] != 0, inputs_.data() + i * inputs);
      targets_[i] = static_cast<float>(model.answer_of(static_cast<double>(*samples.targets(k))));
    });
    options_.seed = batch.seed;
    return torch_loss(layout, model.state, inputs_, targets_, options_, gradient);
  }

 private:
  BatchOptions options_;
};

}  // namespace

void require_torch() {}

std::unique_ptr<Trainee> torch_grid_trainee(const Parameters& parameters, int batch, int threads) {
  return std::make_unique<TorchGridTrainee>(parameters, batch, threads);
}

std::unique_ptr<Trainee> torch_ray_trainee(const Parameters& parameters, int batch, int threads) {
  return std::make_unique<TorchRayTrainee>(parameters, batch, threads);
}

}  // namespace lapwing::learned
