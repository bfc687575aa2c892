// SPDX-License-Identifier: Apache-2.0
// A cost term or constraint bound to a camera drone with a gimbal, asked instance by instance, its
// derivatives compared with differences.
#pragma once

#include "tests/plugins/plugin_setting.h"

namespace lapwing {

inline Vehicle gimbal_drone() {
  Vehicle vehicle = camera_drone();
  vehicle.gimbal = GimbalLimits{-3.0, 3.0, -1.6, 0.5, 2.0, 1.5};
  vehicle.camera = {"action", 3840, 2160, 2300, 2300, 1919.5, 1079.5};
  return vehicle;
}

inline StageLayout film_layout(const Vehicle& vehicle) {
  StageLayout layout;
  for (const char* name : {"quadrotor", "gimbal"}) {
    const auto model = plugins().create<VehicleModel>(name);
    model->bind(vehicle);
    for (const BlockSpec& block : model->blocks()) layout.add(block);
  }
  layout.add({.name = "target", .size = 3, .role = BlockRole::free});
  layout.add({.name = "time", .role = BlockRole::clock});
  layout.add({.name = "step", .role = BlockRole::clock});
  return layout;
}

template <class Kind>
struct BoundTerm {
  std::unique_ptr<Kind> function;
  Environment environment;
  Vehicle vehicle;
  Horizon horizon;
  StageLayout layout;
  FunctionShape shape;
  int inputs = 0;

  BoundTerm(const char* name, const Value& parameters, Environment around = {},
            Horizon flown = {.stages = 11, .step = 0.1}, Vehicle of = gimbal_drone())
      : function(plugins().create<Kind>(name, parameters)),
        environment(std::move(around)),
        vehicle(std::move(of)),
        horizon(flown),
        layout(film_layout(vehicle)) {
    shape = function->bind({layout, horizon, vehicle, environment});
    for (const int block : shape.blocks) inputs += layout.block(block).size * shape.window;
  }

  Eigen::VectorXd values(const Eigen::VectorXd& x, int instance = 0) const {
    EXPECT_EQ(x.size(), inputs);
    Eigen::VectorXd result = Eigen::VectorXd::Constant(shape.rows, std::nan(""));
    Workspace workspace;
    function->evaluate({instance, 1}, x.data(), result.data(), nullptr, workspace);
    return result;
  }

  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  RowMajor jacobian(const Eigen::VectorXd& x, int instance = 0) const {
    RowMajor result = RowMajor::Constant(shape.rows, inputs, std::nan(""));
    Eigen::VectorXd ignored(shape.rows);
    Workspace workspace;
    function->evaluate({instance, 1}, x.data(), ignored.data(), result.data(), workspace);
    return result;
  }

  RowMajor curvature(const Eigen::VectorXd& x, const Eigen::VectorXd& multipliers,
                     int instance = 0) const {
    RowMajor result = RowMajor::Zero(inputs, inputs);
    Workspace workspace;
    function->curvature({instance, 1}, x.data(), multipliers.data(), result.data(), workspace);
    return result;
  }

  // First and second derivatives against central differences with steps of `step`.
  void expect_derivatives(const Eigen::VectorXd& x, const std::string& where, int instance = 0,
                          double step = 1e-5, double tolerance = 1e-7) const {
    const RowMajor stated = jacobian(x, instance);
    Eigen::VectorXd lambda(shape.rows);
    for (int r = 0; r < shape.rows; ++r) lambda(r) = std::sin(1.0 + r);
    const RowMajor bend = curvature(x, lambda, instance);
    RowMajor first(shape.rows, inputs), second(inputs, inputs);
    for (int c = 0; c < inputs; ++c) {
      const Eigen::VectorXd e = step * Eigen::VectorXd::Unit(inputs, c);
      first.col(c) = (values(x + e, instance) - values(x - e, instance)) / (2 * step);
      second.col(c) =
          (jacobian(x + e, instance) - jacobian(x - e, instance)).transpose() * lambda / (2 * step);
    }
    const auto near = [&](const RowMajor& a, const RowMajor& b, const char* what) {
      ASSERT_TRUE(a.allFinite()) << what << ", " << where;
      const double scale = std::max(1.0, b.cwiseAbs().maxCoeff());
      EXPECT_LE((a - b).cwiseAbs().maxCoeff(), tolerance * scale) << what << ", " << where << "\n"
                                                                  << a << "\ndifferences:\n"
                                                                  << b;
    };
    near(stated, first, "Jacobian");
    near(bend, second, "curvature");
  }

  void expect_finite(const Eigen::VectorXd& x, const std::string& where, int instance = 0) const {
    EXPECT_TRUE(values(x, instance).allFinite()) << where;
    EXPECT_TRUE(jacobian(x, instance).allFinite()) << where;
    EXPECT_TRUE(curvature(x, Eigen::VectorXd::Ones(shape.rows), instance).allFinite()) << where;
  }
};

using BoundCost = BoundTerm<CostTerm>;
using BoundRows = BoundTerm<Constraint>;

// A list of spans {start, finish} in s.
inline Value spans_of(const std::vector<std::pair<double, double>>& spans) {
  Value list = Value::list();
  for (const auto& [start, finish] : spans)
    list.push_back(map_of({{"start", start}, {"finish", finish}}));
  return list;
}

}  // namespace lapwing
