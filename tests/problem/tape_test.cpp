// SPDX-License-Identifier: Apache-2.0
// Expressions and the tapes made of them.
#include <cmath>
#include <functional>

#include "framework/core/random.h"
#include "framework/problem/environment_distance.h"
#include "framework/problem/tape.h"
#include "tests/obstacles.h"

namespace lapwing {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr double kWidth = 0.1;

struct Recorded {
  ExpressionGraph graph;
  std::vector<int> x;  // inputs
  std::vector<int> outputs;

  explicit Recorded(int inputs) {
    for (int i = 0; i < inputs; ++i) x.push_back(graph.input(i));
  }
  int op(TapeOp op, int a, int b = -1, int c = -1, double number = 0) {
    return graph.apply(op, a, b, c, number);
  }
  Tape tape() const {
    std::vector<int> place(x.size());
    for (std::size_t i = 0; i < place.size(); ++i) place[i] = static_cast<int>(i);
    return Tape(graph, outputs, place, static_cast<int>(x.size()));
  }
};

Eigen::VectorXd values_of(const Tape& tape, const Eigen::VectorXd& x,
                          const std::vector<double>& parameters) {
  Eigen::VectorXd values(tape.rows());
  Workspace workspace;
  tape.evaluate(1, x.data(), parameters.data(), values.data(), nullptr, workspace);
  return values;
}

RowMajor jacobian_of(const Tape& tape, const Eigen::VectorXd& x,
                     const std::vector<double>& parameters) {
  RowMajor jacobian(tape.rows(), tape.width());
  Eigen::VectorXd values(tape.rows());
  Workspace workspace;
  tape.evaluate(1, x.data(), parameters.data(), values.data(), jacobian.data(), workspace);
  return jacobian;
}

// First and second derivatives against differences at one point.
void expect_tape_derivatives(const Tape& tape, const Eigen::VectorXd& x,
                             const std::vector<double>& parameters, const std::string& where) {
  constexpr double kStep = 1e-5, kTolerance = 1e-7;
  const int n = tape.width();
  const RowMajor jacobian = jacobian_of(tape, x, parameters);
  Eigen::VectorXd lambda(tape.rows());
  for (int r = 0; r < tape.rows(); ++r) lambda(r) = std::sin(1.0 + r);
  RowMajor hessian = RowMajor::Zero(n, n);
  Workspace workspace;
  tape.curvature(1, x.data(), parameters.data(), lambda.data(), hessian.data(), workspace);
  EXPECT_EQ((hessian - hessian.transpose()).norm(), 0.0) << where;
  RowMajor first(tape.rows(), n), second(n, n);
  for (int c = 0; c < n; ++c) {
    const Eigen::VectorXd e = kStep * Eigen::VectorXd::Unit(n, c);
    first.col(c) =
        (values_of(tape, x + e, parameters) - values_of(tape, x - e, parameters)) / (2 * kStep);
    second.col(c) =
        (jacobian_of(tape, x + e, parameters) - jacobian_of(tape, x - e, parameters)).transpose() *
        lambda / (2 * kStep);
  }
  const auto near = [&](const RowMajor& a, const RowMajor& b, const char* what) {
    ASSERT_TRUE(a.allFinite()) << what << ", " << where;
    const double scale = std::max(1.0, b.cwiseAbs().maxCoeff());
    EXPECT_LE((a - b).cwiseAbs().maxCoeff(), kTolerance * scale) << what << ", " << where << "\n"
                                                                 << a << "\ndifferences:\n"
                                                                 << b;
  };
  near(jacobian, first, "Jacobian");
  near(hessian, second, "curvature");
}

TEST(Tape, EveryOperationHasItsDerivatives) {
  struct Case {
    TapeOp op;
    double low, high;  // of the operands
    double number = 0;
  };
  const Case cases[] = {
      {TapeOp::add, -2, 2},
      {TapeOp::subtract, -2, 2},
      {TapeOp::multiply, -2, 2},
      {TapeOp::divide, 0.5, 3},
      {TapeOp::negate, -2, 2},
      {TapeOp::sin, -4, 4},
      {TapeOp::cos, -4, 4},
      {TapeOp::tan, -1.2, 1.2},
      {TapeOp::exp, -2, 2},
      {TapeOp::log, 0.3, 3},
      {TapeOp::sqrt, 0.3, 3},
      {TapeOp::power, 0.3, 3, 2.7},
      {TapeOp::power, 0.3, 3, -1.5},
      {TapeOp::atan2, 0.3, 2},
      {TapeOp::absolute, -2, 2, kWidth},
      {TapeOp::absolute, -0.09, 0.09, kWidth},  // within the rounding
      {TapeOp::norm, 0.1, 2, kWidth},
      {TapeOp::norm, 0.0005, 0.009, kWidth},
      {TapeOp::maximum, -2, 2, kWidth},
      {TapeOp::maximum, 0, 0.05, kWidth},
      {TapeOp::select, 0.2, 2},
      {TapeOp::select, -2, -0.2},
  };
  Random random(3);
  for (const Case& a_case : cases)
    for (int trial = 0; trial < 8; ++trial) {
      Recorded made(3);
      const int result = made.op(a_case.op, made.x[0], made.x[1], made.x[2], a_case.number);
      // Bent once more, so that the chain rule has something to do.
      made.outputs = {made.op(TapeOp::sin, result), made.op(TapeOp::multiply, result, made.x[1])};
      Eigen::VectorXd x(3);
      for (double& number : x) number = random.uniform(a_case.low, a_case.high);
      expect_tape_derivatives(made.tape(), x, {},
                              "operation " + std::to_string(static_cast<int>(a_case.op)) +
                                  " trial " + std::to_string(trial));
    }
}

TEST(Tape, ManyInputsAndRowsInAnyNumberOfInstances) {
  constexpr int kInputs = 13, kRows = 5;  // more than there are lanes
  Recorded made(kInputs);
  const int factor = made.graph.parameter(0);
  for (int r = 0; r < kRows; ++r) {
    int sum = made.graph.constant(0.3 * r);
    for (int i = r; i < kInputs; i += 1 + r)
      sum = made.op(TapeOp::add, sum,
                    made.op(TapeOp::multiply, made.x[i], made.x[(i * 7 + r) % kInputs]));
    made.outputs.push_back(made.op(TapeOp::multiply, factor, made.op(TapeOp::cos, sum)));
  }
  const Tape tape = made.tape();
  const std::vector<double> parameters{1.7};
  Random random(11);
  for (const int count : {1, 7, 8, 9, 20}) {
    Eigen::MatrixXd x(kInputs, count);  // a column an instance
    for (double& number : x.reshaped()) number = random.uniform(-1, 1);
    std::vector<double> values(count * kRows), jacobian(values.size() * kInputs, NAN);
    std::vector<double> alone(values.size());
    Workspace workspace;
    tape.evaluate(count, x.data(), parameters.data(), values.data(), jacobian.data(), workspace);
    tape.evaluate(count, x.data(), parameters.data(), alone.data(), nullptr, workspace);
    EXPECT_EQ(values, alone) << "the values depend on whether derivatives were asked";
    for (int k = 0; k < count; ++k) {
      const RowMajor one = jacobian_of(tape, x.col(k), parameters);
      const Eigen::Map<RowMajor> block(jacobian.data() + k * kRows * kInputs, kRows, kInputs);
      EXPECT_EQ((one - block).norm(), 0.0) << "instance " << k << " of " << count;
    }
    expect_tape_derivatives(tape, x.col(count - 1), parameters, "the last instance");
  }
}

TEST(Tape, WhatIsWrittenTwiceIsComputedOnce) {
  Recorded made(2);
  const int a = made.x[0], b = made.x[1];
  const int one = made.op(TapeOp::sin, made.op(TapeOp::add, a, b));
  const int other = made.op(TapeOp::sin, made.op(TapeOp::add, b, a));
  EXPECT_EQ(one, other);
  const int zero = made.graph.constant(0), unit = made.graph.constant(1);
  EXPECT_EQ(made.op(TapeOp::add, a, zero), a);
  EXPECT_EQ(made.op(TapeOp::multiply, unit, a), a);
  EXPECT_EQ(made.op(TapeOp::multiply, a, zero), zero);
  EXPECT_EQ(made.op(TapeOp::divide, a, unit), a);
  EXPECT_EQ(made.op(TapeOp::negate, made.op(TapeOp::negate, a)), a);
  EXPECT_EQ(made.op(TapeOp::select, unit, a, b), a);
  const int folded = made.op(TapeOp::exp, made.op(TapeOp::add, unit, unit));
  ASSERT_TRUE(made.graph.is_constant(folded));
  EXPECT_EQ(made.graph.number(folded), std::exp(2.0));
  made.op(TapeOp::cos, b);  // asked for by nobody
  made.outputs = {made.op(TapeOp::multiply, one, other)};
  EXPECT_EQ(made.tape().instructions(), 3);
}

TEST(Tape, KinksAreRoundedWithinTheirWidthAndExactOutside) {
  const auto absolute = [](double x) {
    return local_value({TapeOp::absolute, 0, kWidth}, &x, {}, 2);
  };
  EXPECT_EQ(absolute(0.3).value, 0.3);
  EXPECT_EQ(absolute(-kWidth).value, kWidth);
  EXPECT_DOUBLE_EQ(absolute(0).value, 0.375 * kWidth);
  EXPECT_NEAR(absolute(kWidth - 1e-12).slope[0], 1, 1e-9);
  EXPECT_NEAR(absolute(kWidth - 1e-12).bend[0], 0, 1e-7);
  const auto maximum = [](double a, double b, double width) {
    const double x[] = {a, b};
    return local_value({TapeOp::maximum, 0, width}, x, {}, 2);
  };
  EXPECT_EQ(maximum(0.1 + 0.2, 0, kWidth).value, 0.1 + 0.2);
  EXPECT_EQ(maximum(-7, 0, kWidth).value, 0);
  EXPECT_DOUBLE_EQ(maximum(2, 2, kWidth).value, 2 + 0.1875 * kWidth);
  EXPECT_EQ(maximum(2, 2, 0).value, 2);
  EXPECT_EQ(maximum(2, 2, 0).slope[0], 1);  // the first on ties, as in dual.h
  const double zero = 0;
  for (const TapeOp op : {TapeOp::sqrt, TapeOp::norm})
    EXPECT_EQ(local_value({op, 0, 0.0}, &zero, {}, 2).slope[0], 0);
}

// What select does not take may be infinite and must not spoil the rest.
TEST(Tape, ABranchNotTakenSpoilsNothing) {
  Recorded made(2);
  const int bad = made.op(TapeOp::multiply, made.op(TapeOp::log, made.x[0]),
                          made.op(TapeOp::divide, made.x[1], made.x[0]));
  made.outputs = {made.op(TapeOp::select, made.x[0], bad, made.op(TapeOp::sin, made.x[1]))};
  const Tape tape = made.tape();
  const Eigen::Vector2d at(0, 0.5);
  const RowMajor jacobian = jacobian_of(tape, at, {});
  EXPECT_EQ(jacobian(0, 0), 0);
  EXPECT_EQ(jacobian(0, 1), std::cos(0.5));
  RowMajor hessian = RowMajor::Zero(2, 2);
  const double one = 1;
  Workspace workspace;
  tape.curvature(1, at.data(), nullptr, &one, hessian.data(), workspace);
  EXPECT_EQ(hessian(0, 0), 0);
  EXPECT_EQ(hessian(0, 1), 0);
  EXPECT_EQ(hessian(1, 1), -std::sin(0.5));
}

TEST(Tape, StraightFunctionsAreKnownToBe) {
  Recorded made(2);
  const int a = made.x[0], time = made.x[1], free = made.graph.parameter(0);
  const auto affine = [&](int node) {
    return made.graph.affine({node}, [](int input) { return input == 1; });
  };
  EXPECT_TRUE(affine(made.op(TapeOp::add, a, made.op(TapeOp::sin, time))));
  EXPECT_TRUE(affine(made.op(TapeOp::multiply, a, made.op(TapeOp::exp, time))));
  EXPECT_TRUE(affine(made.op(TapeOp::subtract, a, free)));
  EXPECT_FALSE(affine(made.op(TapeOp::multiply, a, free)));  // its slope changes between solves
  EXPECT_FALSE(affine(made.op(TapeOp::multiply, a, a)));
  EXPECT_FALSE(affine(made.op(TapeOp::divide, time, a)));
  EXPECT_FALSE(affine(made.op(TapeOp::absolute, a)));
}

TEST(Tape, TheNearestObstacleIsAsFarAsTheEnvironmentSays) {
  Environment environment;
  environment.obstacles = {sphere_at("ball", {3, 0, 1}, 1),
                           box_at("house", {-4, -2, 0}, {-1, 2, 3}),
                           zone_at("field", {{0, 4}, {3, 4}, {3, 7}, {0, 8}}, 0, 5)};
  environment = with_shapes(environment);
  Recorded made(3);
  const int point[] = {made.x[0], made.x[1], made.x[2]};
  const auto distance = [&](const std::string& name, double width) {
    return nearest_distance(made.graph, environment, name, {point[0], point[1], point[2]}, width);
  };
  made.outputs = {distance("", 0), distance("house", 1e-3)};
  const Tape tape = made.tape();
  Random random(5);
  int inside = 0;
  for (int trial = 0; trial < 200; ++trial) {
    Eigen::Vector3d p(random.uniform(-6, 6), random.uniform(-4, 9), random.uniform(-1, 6));
    const Eigen::VectorXd values = values_of(tape, p, {});
    EXPECT_NEAR(values(0), nearest_obstacle(environment, p).distance, 1e-12) << p.transpose();
    EXPECT_NEAR(values(1), signed_distance(environment.obstacles[1], p), 1e-3) << p.transpose();
    inside += values(0) < 0;
    const RowMajor jacobian = jacobian_of(tape, p, {});
    EXPECT_NEAR(jacobian.row(0).norm(), 1, 1e-9) << p.transpose();
  }
  EXPECT_GT(inside, 10);
  EXPECT_THROW(distance("huose", 0), InputError);
  try {
    distance("huose", 0);
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean 'house'?"), std::string::npos);
  }
}

TEST(Tape, ASubjectIsWhereItsTrackSays) {
  Recorded made(1);
  const int subject = made.graph.add_subject({"walker", {1, 3}, {{0, 0, 1}, {4, 2, 1}}});
  made.outputs = {made.graph.apply(TapeOp::track, made.x[0], -1, -1, 0, 3 * subject),
                  made.graph.apply(TapeOp::track, made.x[0], -1, -1, 0, 3 * subject + 1)};
  const Tape tape = made.tape();
  for (const auto& [time, x, speed] :
       {std::tuple{0.5, 0.0, 0.0}, {2.0, 2.0, 2.0}, {9.0, 4.0, 0.0}}) {
    const Eigen::VectorXd at = Eigen::VectorXd::Constant(1, time);
    EXPECT_DOUBLE_EQ(values_of(tape, at, {})(0), x);
    EXPECT_DOUBLE_EQ(jacobian_of(tape, at, {})(0, 0), speed);
  }
}

}  // namespace
}  // namespace lapwing
