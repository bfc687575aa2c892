// SPDX-License-Identifier: Apache-2.0
// Training by libtorch (LAPWING_LEARN): its automatic derivatives in place of our own. Initial
// weights, order of samples, dropout, Adam, validation and files are the same.
#include <new>

#include "framework/core/error.h"
#include "framework/core/parallel.h"
#include "plugins/utilities/learned/backpropagation.h"
#include "plugins/utilities/learned/torch_networks.h"
#include "plugins/utilities/learned/trainee.h"

namespace lapwing::learned {
namespace {

torch::Device device_here() {
  return torch::cuda::is_available() ? torch::kCUDA : torch::kCPU;
}

// One line for the user in place of a stack of calls.
template <class Compute>
double in_torch(Compute compute) {
  try {
    return compute();
  } catch (const c10::Error& error) {
    const std::string what = error.what_without_backtrace();
    if (what.find("out of memory") != std::string::npos ||
        what.find("not enough memory") != std::string::npos ||
        what.find("alloc_cpu") != std::string::npos)
      throw std::bad_alloc();
    throw Error("libtorch: " + what.substr(0, what.find('\n')));
  }
}

void copy_gradient(const torch::Tensor& parameters, std::span<float> gradient) {
  const torch::Tensor found = parameters.grad().to(torch::kCPU).contiguous();
  std::copy_n(found.data_ptr<float>(), gradient.size(), gradient.begin());
}

// All but the loss is as our own trainee has it.
class TorchTrainee : public Trainee {
 public:
  TorchTrainee(std::unique_ptr<Trainee> own, int threads)
      : own_(std::move(own)), threads_(threads), device_(device_here()) {
    torch::set_num_threads(threads > 0 ? threads : available_threads());
    // A GPU would otherwise round to ten bits in the middle of its products.
    at::globalContext().setAllowTF32CuDNN(false);
    at::globalContext().setAllowTF32CuBLAS(false);
  }

  std::string backend() const override {
    return std::string("libtorch ") + TORCH_VERSION + " on " + device_.str() +
           (device_.is_cpu() ? ", threads: " + std::to_string(torch::get_num_threads()) : "");
  }
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
  torch::Device device_;
};

class TorchRayTrainee final : public TorchTrainee {
 public:
  TorchRayTrainee(const Parameters& p, int batch, int threads)
      : TorchTrainee(ray_trainee(p, batch, threads), threads) {}

  double loss(Model& model, const Samples& samples, const BatchDraw& batch,
              std::span<float> gradient) override {
    const RayNetworkLayout layout(std::get<RayNetworkShape>(model.shape));
    const RayShape& rays = layout.shape.rays;
    const auto count = static_cast<std::int64_t>(batch.samples.size());
    const auto targets = static_cast<std::size_t>(layout.rays());
    const std::size_t inputs = targets * RayNetworkLayout::kInputs;
    inputs_.resize(batch.samples.size() * inputs);
    targets_.resize(batch.samples.size() * targets);
    parallel_for(batch.samples.size(), threads_, [&](std::size_t i) {
      const std::size_t k = batch.samples[i];
      const bool mirrored = batch.mirrored[i] != 0;
      decode_rays(layout, samples.input(k), mirrored, inputs_.data() + i * inputs);
      decode_targets(rays, samples.targets(k), mirrored, targets_.data() + i * targets);
    });
    return in_torch([&] {
      const TorchRayNetwork network(layout, model.state.parameters, device_);
      network.parameters().set_requires_grad(true);
      const torch::Tensor loss = network.loss(
          tensor_of(inputs_, {count, rays.rows, rays.columns, RayNetworkLayout::kInputs}, device_),
          tensor_of(targets_, {count, layout.rays()}, device_));
      loss.backward();
      copy_gradient(network.parameters(), gradient);
      return loss.item<double>();
    });
  }

 private:
  std::vector<float> inputs_, targets_;
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
    const auto count = static_cast<std::int64_t>(batch.samples.size());
    const std::size_t inputs = first.padded() * static_cast<std::size_t>(first.in);
    inputs_.resize(batch.samples.size() * inputs);  // borders stay 0
    targets_.resize(batch.samples.size());
    parallel_for(batch.samples.size(), threads_, [&](std::size_t i) {
      const std::size_t k = batch.samples[i];
      decode_grid(layout, samples.input(k), batch.mirrored[i] != 0, inputs_.data() + i * inputs);
      targets_[i] = static_cast<float>(model.answer_of(static_cast<double>(*samples.targets(k))));
    });
    options_.seed = batch.seed;
    return in_torch([&] {
      const TorchGridNetwork network(layout, model.state, device_);
      network.parameters().set_requires_grad(true);
      TorchGridNetwork::Batch drawn;
      drawn.mask1 = mask(0, count, layout.shape.hidden1);
      drawn.mask2 = mask(1, count, layout.shape.hidden2);
      const torch::Tensor loss =
          network.loss(grids(first, count), tensor_of(targets_, {count}, device_),
                       options_.regularisation, drawn);
      loss.backward();
      copy_gradient(network.parameters(), gradient);
      for (std::size_t k = 0; k < layout.units.size(); ++k) {
        follow(model.state.statistics, layout.units[k].mean, drawn.means[k]);
        follow(model.state.statistics, layout.units[k].variance, drawn.variances[k]);
      }
      return loss.item<double>();
    });
  }

 private:
  // [sample, map, z, y, x], without the borders.
  torch::Tensor grids(const UnitPlace& first, std::int64_t count) const {
    const torch::Tensor padded = tensor_of(
        inputs_, {count, first.size[2] + 2, first.size[1] + 2, first.size[0] + 2, first.in},
        device_);
    return padded.narrow(1, 1, first.size[2])
        .narrow(2, 1, first.size[1])
        .narrow(3, 1, first.size[0])
        .permute({0, 4, 1, 2, 3});
  }

  torch::Tensor mask(int layer, std::int64_t count, std::int64_t width) const {
    std::vector<float> factors(static_cast<std::size_t>(count * width));
    for (std::size_t k = 0; k < factors.size(); ++k)
      factors[k] = static_cast<float>(dropout_factor(options_, layer, k));
    return tensor_of(factors, {count, width}, device_);
  }

  static void follow(std::vector<float>& statistics, std::size_t begin,
                     const torch::Tensor& found) {
    const torch::Tensor here = found.to(torch::kCPU).contiguous();
    for (std::int64_t c = 0; c < here.numel(); ++c) {
      float& kept = statistics[begin + static_cast<std::size_t>(c)];
      kept += static_cast<float>(kStatisticsMomentum) * (here.data_ptr<float>()[c] - kept);
    }
  }

  BatchOptions options_;
  std::vector<float> inputs_, targets_;
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
