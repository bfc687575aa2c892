// SPDX-License-Identifier: Apache-2.0
// The authoring layer: write the formula once, the kernel differentiates it.
//
//   class KeepLow final : public DifferentiableCost<KeepLow> {
//    public:
//     FunctionShape declare(const ProblemSetting& setting) {
//       FunctionShape shape{.rows = 1, .integral = true};
//       position_ = BlocksRead(setting.layout, shape.blocks).add<3>("position");
//       return shape;
//     }
//     template <class T>
//     void residual(const Stage<T>& stage, Rows<T>& rows) const {
//       using std::max;
//       rows[0] = max(stage(position_).z() - height_, T(0.0));
//     }
//    private:
//     VectorHandle position_;
//   };
//
// `declare` is called once, when the function is bound; it may note what it needs from the setting.
// T is double or a dual number. `stage` is the first stage of the window, stage[1] its neighbour;
// blocks are read through the handles of `declare` (blocks_read.h). Derivatives are taken `Width`
// inputs at a time in forward mode; second derivatives by duals of duals.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "framework/core/dual.h"
#include "framework/problem/blocks_read.h"
#include "framework/problem/constraint.h"
#include "framework/problem/cost_term.h"
#include "framework/problem/vehicle_model.h"

namespace lapwing {

// One stage of a window: a view of gathered inputs. Cheap to copy.
template <class T>
class Stage {
 public:
  Stage(const T* data, const int* offsets, int stride, int instance)
      : data_(data), offsets_(offsets), stride_(stride), instance_(instance) {}

  // The number or the vector of a block.
  const T& operator()(const NumberHandle& block) const { return data_[block.offset()]; }
  template <int Size>
  requires(Size != 1) Eigen::Map<const Eigen::Matrix<T, Size, 1>>
  operator()(const BlockHandle<Size>& block) const {
    return Eigen::Map<const Eigen::Matrix<T, Size, 1>>(data_ + block.offset(), block.size());
  }
  // Block by its place in the list of blocks read.
  const T& scalar(int block) const { return data_[offsets_[block]]; }
  template <int Size>
  Eigen::Map<const Eigen::Matrix<T, Size, 1>> vector(int block) const {
    return Eigen::Map<const Eigen::Matrix<T, Size, 1>>(data_ + offsets_[block]);
  }
  const T* data(int block) const { return data_ + offsets_[block]; }
  // The stage `k` places later in the window.
  Stage operator[](int k) const { return Stage(data_ + k * stride_, offsets_, stride_, instance_); }
  // Which instance this is, for terms with data of their own (keyframe number).
  int instance() const { return instance_; }

 private:
  const T* data_;
  const int* offsets_;
  int stride_;
  int instance_;
};

template <class T>
using Rows = Eigen::Map<Eigen::Matrix<T, Eigen::Dynamic, 1>>;

// Evaluates and differentiates Derived::residual over ranges of instances.
template <class Derived, class Base, int Width>
class DifferentiableFunction : public Base {
 public:
  FunctionShape bind(const ProblemSetting& setting) final {
    FunctionShape shape = static_cast<Derived&>(*this).declare(setting);
    offsets_.clear();
    stride_ = 0;
    for (const int block : shape.blocks) {
      offsets_.push_back(stride_);
      stride_ += setting.layout.block(block).size;
    }
    inputs_ = stride_ * shape.window;
    rows_ = shape.rows;
    return shape;
  }

  void evaluate(InstanceRange range, const double* inputs, double* values, double* jacobian,
                Workspace& workspace) const override {
    for (int k = 0; k < range.count; ++k) {
      const double* x = inputs + k * inputs_;
      if (!jacobian) {
        std::fill_n(values + k * rows_, rows_, 0.0);
        call(x, range.first + k, values + k * rows_);
        continue;
      }
      first_derivatives(x, range.first + k, values + k * rows_, jacobian + k * rows_ * inputs_,
                        workspace);
    }
  }

  void curvature(InstanceRange range, const double* inputs, const double* multipliers,
                 double* hessian, Workspace& workspace) const override {
    using Inner = Dual<double, Width>;
    using Outer = Dual<Inner, Width>;
    static_assert(sizeof(Outer) % sizeof(double) == 0);
    auto* x = reinterpret_cast<Outer*>(workspace.doubles(0, inputs_ * sizeof(Outer) / 8));
    auto* y = reinterpret_cast<Outer*>(workspace.doubles(1, rows_ * sizeof(Outer) / 8));
    for (int k = 0; k < range.count; ++k) {
      const double* at = inputs + k * inputs_;
      double* h = hessian + k * inputs_ * inputs_;
      for (int first = 0; first < inputs_; first += Width)
        for (int second = 0; second <= first; second += Width) {
          for (int i = 0; i < inputs_; ++i) {
            x[i] = Outer(at[i]);
            if (i >= second && i < second + Width) x[i].v.d[i - second] = 1.0;
            if (i >= first && i < first + Width) x[i].d[i - first] = Inner(1.0);
          }
          for (int r = 0; r < rows_; ++r) y[r] = Outer(0.0);
          call(x, range.first + k, y);
          scatter_second(y, multipliers + k * rows_, first, second, h);
        }
    }
  }

 private:
  template <class T>
  void call(const T* x, int instance, T* y) const {
    Rows<T> rows(y, rows_);
    static_cast<const Derived&>(*this).residual(Stage<T>(x, offsets_.data(), stride_, instance),
                                                rows);
  }

  void first_derivatives(const double* at, int instance, double* values, double* jacobian,
                         Workspace& workspace) const {
    using T = Dual<double, Width>;
    static_assert(sizeof(T) == (Width + 1) * sizeof(double));
    auto* x = reinterpret_cast<T*>(workspace.doubles(0, inputs_ * (Width + 1)));
    auto* y = reinterpret_cast<T*>(workspace.doubles(1, rows_ * (Width + 1)));
    for (int i = 0; i < inputs_; ++i) x[i] = T(at[i]);
    for (int first = 0; first < inputs_; first += Width) {
      const int width = std::min(Width, inputs_ - first);
      for (int k = 0; k < width; ++k) x[first + k].d[k] = 1.0;
      for (int r = 0; r < rows_; ++r) y[r] = T(0.0);
      call(x, instance, y);
      for (int r = 0; r < rows_; ++r)
        for (int k = 0; k < width; ++k) jacobian[r * inputs_ + first + k] = y[r].d[k];
      for (int k = 0; k < width; ++k) x[first + k].d[k] = 0.0;
    }
    for (int r = 0; r < rows_; ++r) values[r] = y[r].v;
  }

  template <class Outer>
  void scatter_second(const Outer* y, const double* multipliers, int first, int second,
                      double* h) const {
    for (int a = first; a < std::min(first + Width, inputs_); ++a)
      for (int b = second; b < std::min(second + Width, inputs_); ++b) {
        double sum = 0;
        for (int r = 0; r < rows_; ++r) sum += multipliers[r] * y[r].d[a - first].d[b - second];
        h[a * inputs_ + b] += sum;
        if (second < first) h[b * inputs_ + a] += sum;
      }
  }

  std::vector<int> offsets_;
  int stride_ = 0, inputs_ = 0, rows_ = 0;
};

// A vehicle model from one formula. Derived writes
//   template <class T> void next_state(const T* state, const T* input, const T& step, T* next)
//   const
// and lists its blocks; the number of state and input numbers are template arguments.
template <class Derived, int States, int Inputs, int Width = 6>
class DifferentiableModel : public VehicleModel {
  static constexpr int kArguments = States + Inputs + 1;

 public:
  void flow(InstanceRange range, const double* inputs, double* next, double* jacobian,
            Workspace&) const override {
    for (int k = 0; k < range.count; ++k) {
      const double* at = inputs + k * kArguments;
      call(at, next + k * States);
      if (jacobian) first_derivatives(at, jacobian + k * States * kArguments);
    }
  }

  void curvature(InstanceRange range, const double* inputs, const double* multipliers,
                 double* hessian, Workspace&) const override {
    using T = Dual<Dual<double, kArguments>, 1>;
    for (int k = 0; k < range.count; ++k)
      for (int first = 0; first < kArguments; ++first) {
        std::array<T, kArguments> x;
        std::array<T, States> y;
        for (int i = 0; i < kArguments; ++i) {
          x[i] = T(inputs[k * kArguments + i]);
          x[i].v.d[i] = 1.0;
        }
        x[first].d[0] = Dual<double, kArguments>(1.0);
        call(x.data(), y.data());
        double* row = hessian + (k * kArguments + first) * kArguments;
        for (int r = 0; r < States; ++r)
          for (int i = 0; i < kArguments; ++i)
            row[i] += multipliers[k * States + r] * y[r].d[0].d[i];
      }
  }

 private:
  template <class T>
  void call(const T* arguments, T* next) const {
    static_cast<const Derived&>(*this).next_state(arguments, arguments + States,
                                                  arguments[States + Inputs], next);
  }

  void first_derivatives(const double* at, double* jacobian) const {
    using T = Dual<double, Width>;
    std::array<T, kArguments> x;
    std::array<T, States> y;
    for (int i = 0; i < kArguments; ++i) x[i] = T(at[i]);
    for (int first = 0; first < kArguments; first += Width) {
      const int width = std::min(Width, kArguments - first);
      for (int i = 0; i < width; ++i) x[first + i].d[i] = 1.0;
      call(x.data(), y.data());
      for (int r = 0; r < States; ++r)
        for (int i = 0; i < width; ++i) jacobian[r * kArguments + first + i] = y[r].d[i];
      for (int i = 0; i < width; ++i) x[first + i].d[i] = 0.0;
    }
  }
};

template <class Derived, int Width = 6>
using DifferentiableCost = DifferentiableFunction<Derived, CostTerm, Width>;
template <class Derived, int Width = 6>
using DifferentiableConstraint = DifferentiableFunction<Derived, Constraint, Width>;

}  // namespace lapwing
