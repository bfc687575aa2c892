// SPDX-License-Identifier: Apache-2.0
#include "plugins/utilities/learned/torch_networks.h"

#include <torch/torch.h>

#include <new>

#include "framework/core/error.h"

namespace lapwing::learned {
namespace {

// One line for the user in place of a stack of calls.
template <class Compute>
auto in_torch(Compute compute) {
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

torch::Device device_here() {
  return torch::cuda::is_available() ? torch::kCUDA : torch::kCPU;
}

// A copy, on `device`. One of `sizes` may be -1: what is left.
torch::Tensor tensor_of(std::span<const float> numbers, std::vector<std::int64_t> sizes,
                        torch::Device device) {
  return torch::from_blob(const_cast<float*>(numbers.data()),
                          {static_cast<std::int64_t>(numbers.size())}, torch::kFloat32)
      .clone()
      .view(sizes)
      .to(device);
}

class TorchParameters {
 public:
  TorchParameters(std::span<const float> all, torch::Device device)
      : all_(tensor_of(all, {static_cast<std::int64_t>(all.size())}, device)) {}

  torch::Tensor all() const { return all_; }
  torch::Tensor take(std::size_t begin, std::vector<std::int64_t> sizes) const {
    std::int64_t count = 1;
    for (const std::int64_t size : sizes) count *= size;
    return all_.narrow(0, static_cast<std::int64_t>(begin), count).view(sizes);
  }
  // `begin`: of the weights [input][output]; biases follow them.
  torch::Tensor dense(const torch::Tensor& in, std::size_t begin, std::int64_t from,
                      std::int64_t to) const {
    return torch::matmul(in, take(begin, {from, to})) +
           take(begin + static_cast<std::size_t>(from * to), {to});
  }

 private:
  torch::Tensor all_;
};

// The network of the thesis (network.h).
class TorchGridNetwork {
 public:
  // What a batch does beside its answers.
  struct Batch {
    torch::Tensor mask1, mask2;                   // factors of hidden numbers (dropout)
    std::vector<torch::Tensor> means, variances;  // are set: of each unit, over the batch
  };

  TorchGridNetwork(const NetworkLayout& layout, const NetworkState& state, torch::Device device)
      : layout_(layout),
        parameters_(state.parameters, device),
        statistics_(state.statistics, device) {}

  torch::Tensor parameters() const { return parameters_.all(); }

  // Inputs [sample, map, z, y, x]. Normalised by running statistics, or by those of a batch.
  torch::Tensor answers(torch::Tensor now, Batch* batch = nullptr) const {
    for (const UnitPlace& unit : layout_.units) {
      const torch::Tensor in = now;
      now = torch::conv3d(
          now,
          parameters_.take(unit.weights, {3, 3, 3, unit.in, unit.out}).permute({4, 3, 0, 1, 2}), {},
          1, 1);
      torch::Tensor mean, variance;
      if (batch) {
        mean = now.mean({0, 2, 3, 4});
        variance = now.var({0, 2, 3, 4}, false);
        batch->means.push_back(mean.detach());
        batch->variances.push_back(variance.detach());
      } else {
        mean = statistics_.take(unit.mean, {unit.out});
        variance = statistics_.take(unit.variance, {unit.out});
      }
      const torch::Tensor factor =
          parameters_.take(unit.scale, {unit.out}) * (variance + 1e-5).rsqrt();
      const auto by_map = [](const torch::Tensor& t) { return t.view({1, -1, 1, 1, 1}); };
      now = torch::relu((now - by_map(mean)) * by_map(factor) +
                        by_map(parameters_.take(unit.shift, {unit.out})));
      if (layout_.shape.residual)
        now = now + torch::constant_pad_nd(in, {0, 0, 0, 0, 0, 0, 0, unit.out - unit.in});
      if (unit.last_of_block) now = torch::max_pool3d(now, 2);
    }
    // Maps fastest.
    now = now.permute({0, 2, 3, 4, 1}).reshape({now.size(0), layout_.flat});
    const NetworkShape& s = layout_.shape;
    now = torch::relu(parameters_.dense(now, layout_.weights1, layout_.flat, s.hidden1));
    if (batch) now = now * batch->mask1;
    now = torch::relu(parameters_.dense(now, layout_.weights2, s.hidden1, s.hidden2));
    if (batch) now = now * batch->mask2;
    return parameters_.dense(now, layout_.weights3, s.hidden2, 1).squeeze(1);
  }

  // (5.4)
  torch::Tensor loss(const torch::Tensor& inputs, const torch::Tensor& targets, double lambda,
                     Batch& batch) const {
    torch::Tensor sum = (answers(inputs, &batch) - targets).square().mean();
    for (const auto& [begin, end] : layout_.regularised)
      sum =
          sum +
          lambda * parameters_.take(begin, {static_cast<std::int64_t>(end - begin)}).square().sum();
    return sum;
  }

 private:
  NetworkLayout layout_;
  TorchParameters parameters_, statistics_;
};

// The network that reads rays (ray_network.h).
class TorchRayNetwork {
 public:
  TorchRayNetwork(const RayNetworkLayout& layout, std::span<const float> parameters,
                  torch::Device device)
      : layout_(layout), parameters_(parameters, device) {}

  torch::Tensor parameters() const { return parameters_.all(); }

  // Inputs [sample, row, column, number] of decode_rays; answers [sample, ray], in voxels.
  torch::Tensor answers(const torch::Tensor& inputs) const {
    const std::int64_t width = layout_.shape.width;
    torch::Tensor now =
        torch::relu(parameters_.dense(inputs, layout_.first, RayNetworkLayout::kInputs, width));
    now = now.permute({0, 3, 1, 2});
    for (std::size_t k = 0; k < layout_.convolutions.size(); ++k) {
      const std::size_t begin = layout_.convolutions[k];
      const std::int64_t dilation = std::int64_t{1} << k;
      now =
          now + torch::relu(torch::conv2d(
                    now, parameters_.take(begin, {3, 3, width, width}).permute({3, 2, 0, 1}),
                    parameters_.take(begin + static_cast<std::size_t>(9 * width * width), {width}),
                    1, dilation, dilation));
    }
    now = torch::relu(parameters_.dense(now.permute({0, 2, 3, 1}), layout_.last, width, width));
    return torch::softplus(parameters_.dense(now, layout_.output, width, 1)).flatten(1);
  }

  // The mean loss of a batch (RayBackpropagation); targets [sample, ray].
  torch::Tensor loss(const torch::Tensor& inputs, const torch::Tensor& targets) const {
    const torch::Tensor p = answers(inputs);
    const torch::Tensor likelihood = (p - targets * (p + kRayFloor).log()).mean(1);
    const torch::Tensor there = targets.sum(1);
    const torch::Tensor excess = (p.sum(1) - there).square() / (there + kRaySpread);
    return (likelihood + excess / static_cast<double>(layout_.rays())).mean();
  }

 private:
  RayNetworkLayout layout_;
  TorchParameters parameters_;
};

void copy_gradient(const torch::Tensor& parameters, std::span<float> gradient) {
  const torch::Tensor found = parameters.grad().to(torch::kCPU).contiguous();
  std::copy_n(found.data_ptr<float>(), gradient.size(), gradient.begin());
}

void follow(std::vector<float>& statistics, std::size_t begin, const torch::Tensor& found) {
  const torch::Tensor here = found.to(torch::kCPU).contiguous();
  for (std::int64_t c = 0; c < here.numel(); ++c) {
    float& kept = statistics[begin + static_cast<std::size_t>(c)];
    kept += static_cast<float>(kStatisticsMomentum) * (here.data_ptr<float>()[c] - kept);
  }
}

// [sample, map, z, y, x], without the borders.
torch::Tensor grids_of(const UnitPlace& first, std::span<const float> padded, std::int64_t count,
                       torch::Device device) {
  return tensor_of(padded,
                   {count, first.size[2] + 2, first.size[1] + 2, first.size[0] + 2, first.in},
                   device)
      .narrow(1, 1, first.size[2])
      .narrow(2, 1, first.size[1])
      .narrow(3, 1, first.size[0])
      .permute({0, 4, 1, 2, 3});
}

std::int64_t samples_in(const NetworkLayout& layout, std::span<const float> padded) {
  const UnitPlace& first = layout.units.front();
  return static_cast<std::int64_t>(padded.size() /
                                   (first.padded() * static_cast<std::size_t>(first.in)));
}

torch::Tensor mask_of(const BatchOptions& options, int layer, std::int64_t count,
                      std::int64_t width, torch::Device device) {
  std::vector<float> factors(static_cast<std::size_t>(count * width));
  for (std::size_t k = 0; k < factors.size(); ++k)
    factors[k] = static_cast<float>(dropout_factor(options, layer, k));
  return tensor_of(factors, {count, width}, device);
}

// [sample, row, column, number].
torch::Tensor images_of(const RayNetworkLayout& layout, std::span<const float> inputs,
                        torch::Device device) {
  const RayShape& rays = layout.shape.rays;
  return tensor_of(inputs, {-1, rays.rows, rays.columns, RayNetworkLayout::kInputs}, device);
}

std::vector<float> numbers_of(const torch::Tensor& tensor) {
  const torch::Tensor here = tensor.to(torch::kCPU).contiguous();
  return {here.data_ptr<float>(), here.data_ptr<float>() + here.numel()};
}

}  // namespace

void begin_torch(int threads) {
  in_torch([&] {
    torch::set_num_threads(threads);
    // A GPU would otherwise round to ten bits in the middle of its products.
    at::globalContext().setAllowTF32CuDNN(false);
    at::globalContext().setAllowTF32CuBLAS(false);
    return 0;
  });
}

std::string torch_here() {
  const torch::Device device = device_here();
  return std::string("libtorch ") + TORCH_VERSION + " on " + device.str() +
         (device.is_cpu() ? ", threads: " + std::to_string(torch::get_num_threads()) : "");
}

std::vector<float> torch_answers(const NetworkLayout& layout, const NetworkState& state,
                                 std::span<const float> inputs) {
  return in_torch([&] {
    const torch::NoGradGuard no_gradient;
    const torch::Device device = device_here();
    return numbers_of(
        TorchGridNetwork(layout, state, device)
            .answers(grids_of(layout.units.front(), inputs, samples_in(layout, inputs), device)));
  });
}

double torch_loss(const NetworkLayout& layout, NetworkState& state, std::span<const float> inputs,
                  std::span<const float> targets, const BatchOptions& options,
                  std::span<float> gradient) {
  return in_torch([&] {
    const torch::Device device = device_here();
    const std::int64_t count = samples_in(layout, inputs);
    const TorchGridNetwork network(layout, state, device);
    network.parameters().set_requires_grad(true);
    TorchGridNetwork::Batch drawn;
    drawn.mask1 = mask_of(options, 0, count, layout.shape.hidden1, device);
    drawn.mask2 = mask_of(options, 1, count, layout.shape.hidden2, device);
    const torch::Tensor loss =
        network.loss(grids_of(layout.units.front(), inputs, count, device),
                     tensor_of(targets, {count}, device), options.regularisation, drawn);
    loss.backward();
    copy_gradient(network.parameters(), gradient);
    for (std::size_t k = 0; options.keep_statistics && k < layout.units.size(); ++k) {
      follow(state.statistics, layout.units[k].mean, drawn.means[k]);
      follow(state.statistics, layout.units[k].variance, drawn.variances[k]);
    }
    return loss.item<double>();
  });
}

std::vector<float> torch_answers(const RayNetworkLayout& layout, std::span<const float> parameters,
                                 std::span<const float> inputs) {
  return in_torch([&] {
    const torch::NoGradGuard no_gradient;
    const torch::Device device = device_here();
    return numbers_of(
        TorchRayNetwork(layout, parameters, device).answers(images_of(layout, inputs, device)));
  });
}

double torch_loss(const RayNetworkLayout& layout, std::span<const float> parameters,
                  std::span<const float> inputs, std::span<const float> targets,
                  std::span<float> gradient) {
  return in_torch([&] {
    const torch::Device device = device_here();
    const TorchRayNetwork network(layout, parameters, device);
    network.parameters().set_requires_grad(true);
    const torch::Tensor loss = network.loss(images_of(layout, inputs, device),
                                            tensor_of(targets, {-1, layout.rays()}, device));
    loss.backward();
    copy_gradient(network.parameters(), gradient);
    return loss.item<double>();
  });
}

}  // namespace lapwing::learned
