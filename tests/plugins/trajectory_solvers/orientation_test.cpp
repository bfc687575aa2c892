// SPDX-License-Identifier: Apache-2.0
// Solvers on orientations: steps in the tangent space of a rotation.
#include "tests/plugins/trajectory_solvers/solver_expectations.h"
#include "tests/problem/laboratory.h"

namespace lapwing {
namespace {

// The height and attitude of a tumbler at its last stage; the attitude is a turn about x.
class Pose final : public DifferentiableCost<Pose> {
 public:
  Pose(double height, double turn) : height_(height), turn_(turn) {}
  FunctionShape declare(const ProblemSetting& setting) {
    return {.blocks = setting.layout.indices({"height", "attitude"}),
            .rows = 4,
            .stages = {setting.horizon.stages - 1}};
  }
  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    const T* q = stage.data(1);
    const double c = std::cos(0.5 * turn_), s = std::sin(0.5 * turn_);
    rows[0] = stage.scalar(0) - height_;
    rows[1] = c * q[1] - s * q[0];  // the vector part of the rotation between both
    rows[2] = c * q[2] + s * q[3];
    rows[3] = c * q[3] - s * q[2];
  }

 private:
  double height_, turn_;
};

class LittleSpin final : public DifferentiableCost<LittleSpin> {
 public:
  FunctionShape declare(const ProblemSetting& setting) {
    return {.blocks = setting.layout.indices({"spin", "push"}), .rows = 4, .affine = true};
  }
  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    for (int i = 0; i < 3; ++i) rows[i] = stage.data(0)[i];
    rows[3] = stage.scalar(1);
  }
};

// Turned by more than half a circle from the guess, at an even spin.
TEST(Orientation, IsTurned) {
  for (const auto& [solver, parameters] : {std::pair{"ipopt", table({{"hessian", "exact"}})},
                                           {"ipopt", table({{"hessian", "gauss_newton"}})},
                                           {"iqp", Value::map()}}) {
    SCOPED_TRACE(solver);
    const int stages = 21;
    const double step = 0.1, turn = 2.5;
    TrajectoryProblem problem(solo(), {.stages = stages, .step = step});
    problem.add_model("tumbler", std::make_unique<laboratory::Tumbler>());
    problem.add_cost("pose", 1e4, std::make_unique<Pose>(0.0, turn));
    problem.add_cost("spin", 1e-3, std::make_unique<LittleSpin>());
    problem.finish();
    const SolveResult result = solve(solver, problem, {}, parameters);
    EXPECT_EQ(result.report.status, SolveStatus::optimal) << result.report.message;
    EXPECT_LE(result.report.violations.front().amount, 1e-6);
    const int attitude = problem.layout().offset(problem.layout().index("attitude"));
    const int spin = problem.layout().offset(problem.layout().index("spin"));
    const Eigen::Vector4d first = result.point.stages.col(0).segment<4>(attitude);
    const Eigen::Vector4d last = result.point.stages.col(stages - 1).segment<4>(attitude);
    EXPECT_NEAR(first.norm(), 1.0, 1e-9);
    EXPECT_NEAR(last.norm(), 1.0, 1e-9);
    EXPECT_NEAR(std::abs(last(1)), std::sin(0.5 * turn), 1e-3);
    const Eigen::VectorXd rates = result.point.stages.row(spin);
    EXPECT_LT(rates.maxCoeff() - rates.minCoeff(), 1e-4) << "an uneven spin costs more";
  }
}

}  // namespace
}  // namespace lapwing
