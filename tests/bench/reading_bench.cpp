// SPDX-License-Identifier: Apache-2.0
// What it costs that terms read blocks through named handles (problem/blocks_read.h): the shipped
// terms, which do, beside the same formulas that read blocks by their numbers.
#include <time.h>

#include <algorithm>

#include <benchmark/benchmark.h>

#include "framework/conformance/standard_setting.h"
#include "framework/core/units.h"
#include "framework/geometry/camera_axes.h"
#include "framework/problem/camera_error.h"
#include "framework/problem/differentiable.h"
#include "tests/bench/bench_registry.h"

namespace lapwing {
namespace {

constexpr int kInstances = 500;  // evaluated at once

class NumberedCameraAngle final : public DifferentiableCost<NumberedCameraAngle, 9> {
 public:
  static constexpr const char* kShipped = "camera_angle";
  FunctionShape declare(const ProblemSetting& setting) {
    return {.blocks =
                setting.layout.indices({"position", "yaw", "gimbal_yaw", "gimbal_pitch", "target"}),
            .rows = 2,
            .integral = true};
  }
  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    const CameraAxes<T> axes = camera_axes<T>(stage.scalar(1) + stage.scalar(2), stage.scalar(3));
    const Eigen::Matrix<T, 3, 1> to_target =
        stage.template vector<3>(4) - stage.template vector<3>(0);
    const auto angles = angle_residual<T>(axes.in_camera(to_target));
    rows[0] = angles[0];
    rows[1] = angles[1];
  }
};

class NumberedSkewness final : public DifferentiableCost<NumberedSkewness> {
 public:
  static constexpr const char* kShipped = "skewness";
  FunctionShape declare(const ProblemSetting& setting) {
    return {.blocks = setting.layout.indices({"position", "target"}), .rows = 1, .integral = true};
  }
  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    using std::abs;
    const Eigen::Matrix<T, 3, 1> d = stage.template vector<3>(1) - stage.template vector<3>(0);
    const T squared = d.x() * d.x() + d.y() * d.y() + d.z() * d.z();
    if (value_of(squared) < 1e-12) return;
    rows[0] = near_fade(squared) * height_ * d.z() / (squared + 0.5 * height_ * abs(d.z()));
  }

 private:
  double height_ = 4;
};

class NumberedEffort final : public DifferentiableCost<NumberedEffort, 4> {
 public:
  static constexpr const char* kShipped = "input_effort";
  FunctionShape declare(const ProblemSetting& setting) {
    weight_ = setting.vehicle.mass * kGravity;
    torque_max_ = setting.vehicle.yaw_torque_max();
    return {.blocks = setting.layout.indices({"force", "yaw_torque"}),
            .rows = 4,
            .integral = true,
            .affine = true};
  }
  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    const auto force = stage.template vector<3>(0);
    rows[0] = force.x() / weight_;
    rows[1] = force.y() / weight_;
    rows[2] = force.z() / weight_ - 1.0;
    if (torque_max_ > 0) rows[3] = stage.scalar(1) / torque_max_;
  }

 private:
  double weight_ = 1, torque_max_ = 0;
};

// Where a term reads its seeded numbers and writes what it answers. Both forms use the same one:
// where arrays lie in memory can change the time of a call by a third.
struct Buffers {
  int rows = 0;
  std::vector<double> inputs, values, jacobian;
  Workspace workspace;

  Buffers(const StandardSetting& standard, const FunctionShape& shape) : rows(shape.rows) {
    Random random(1);
    inputs = make_inputs(standard, shape, std::vector<double>(kInstances, 0.5), InputKind::random,
                         random);
    const int width = static_cast<int>(inputs.size()) / kInstances;
    values.resize(kInstances * rows);
    jacobian.resize(kInstances * rows * width);
  }
  void evaluate(CostTerm& term) {
    term.evaluate({0, kInstances}, inputs.data(), values.data(), jacobian.data(), workspace);
  }
};

std::unique_ptr<CostTerm> shipped(const std::string& name) {
  Value parameters = Value::map();
  if (name == "skewness") parameters.set("height", 4.0);
  return bench_registry().create<CostTerm>(name, parameters);
}

// Of this thread, s.
double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Both forms in turn, many times, and the shortest time of each: what else the machine
// does only ever adds to a time.
template <class Numbered>
void reading(benchmark::State& state) {
  constexpr int kTurns = 60, kCalls = 20;
  const StandardSetting standard(false);
  const std::unique_ptr<CostTerm> by_name = shipped(Numbered::kShipped),
                                  by_number = std::make_unique<Numbered>();
  const FunctionShape shape = by_name->bind(standard.setting());
  by_number->bind(standard.setting());
  Buffers buffers(standard, shape);
  const auto seconds_of = [&](CostTerm& term) {
    const double begin = thread_seconds();
    for (int k = 0; k < kCalls; ++k) {
      buffers.evaluate(term);
      benchmark::ClobberMemory();
    }
    return thread_seconds() - begin;
  };
  double named = seconds_of(*by_name);
  const std::vector<double> values = buffers.values, jacobian = buffers.jacobian;
  double numbered = seconds_of(*by_number);
  if (values != buffers.values || jacobian != buffers.jacobian)
    state.SkipWithError("the two forms differ");
  for (auto _ : state) {
    for (int turn = 0; turn < kTurns; ++turn) {
      named = std::min(named, seconds_of(*by_name));
      numbered = std::min(numbered, seconds_of(*by_number));
    }
  }
  state.counters["ratio"] = named / numbered;
  state.counters["named_us"] = 1e6 * named / kCalls;
  state.counters["numbered_us"] = 1e6 * numbered / kCalls;
}

BENCHMARK(reading<NumberedCameraAngle>)
    ->Name("reading/camera_angle")
    ->Unit(benchmark::kMillisecond);
BENCHMARK(reading<NumberedSkewness>)->Name("reading/skewness")->Unit(benchmark::kMillisecond);
BENCHMARK(reading<NumberedEffort>)->Name("reading/input_effort")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lapwing
