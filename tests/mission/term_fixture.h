// SPDX-License-Identifier: Apache-2.0
// Problems stated by a script with terms of its own, compared with each other and with differences.
#pragma once

#include "framework/core/random.h"
#include "framework/mission/vehicle_source.h"
#include "framework/problem/path_clearance.h"
#include "tests/mission/mission_fixture.h"

namespace lapwing {

class TermTest : public MissionTest {
 protected:
  // In place of more of the problem: one obstacle, not two.
  static constexpr const char* kRockAlone = " ";

  // The script's text up to the terms, one line: they begin in line 2.
  static std::string before(const std::string& more) {
    return "return { kind = 'film', name = 'terms', options = {}, plan = function(run) "
           "local v = run:vehicle('vehicles/solo') "
           "local p_torque, p_acceleration, p_camera = " +
           constants() + " local p = run:problem { vehicle = v, duration = 1, step = 0.1, " + more +
           " environment = { margin = 0.25, "
           "spheres = { { name = 'rock', center = {4, 0.2, 3}, radius = 1.5 } }, " +
           std::string(
               more == kRockAlone
                   ? ""
                   : "boxes = { { name = 'hut', lower = {0, 1, 0}, upper = {2, 2, 3} } }, ") +
           "subjects = { { name = 'walker', height = 1.8, track = { "
           "{ time = 0, position = {6, 0, 1} }, { time = 2, position = {7, 1, 1} } } } } } } "
           "local after "
           "p:add_model { type = 'quadrotor' } p:add_model { type = 'gimbal' } "
           "p:add_block { name = 'target', size = 3, unit = 'm' } "
           "p:guess_path { times = {0, 1}, positions = { {0, 0, 3}, {5, 1, 4} }, yaws = {0, 1} } "
           "p:guess_block { block = 'target', times = {0}, values = { {9, 1.2, 1.5} } } "
           "p:guess_block { block = 'gimbal_pitch', times = {0}, values = { {-0.3} } }\n";
  }
  static std::string script(const std::string& terms, const std::string& more = "") {
    return before(more) + terms +
           "\np:finish() if after then after() end run:solve(p, 'iqp') end }";
  }

  // Of the vehicle, as the shipped terms read them.
  static std::string constants();

  std::shared_ptr<const TrajectoryProblem> stated(const std::string& terms) {
    std::shared_ptr<const TrajectoryProblem> problem;
    write_file_atomically(folder_ / "shot.lua", script(terms, more_));
    MissionSettings settings;
    settings.scripts = fs::path(LAPWING_SOURCE_DIR) / "scripts";
    settings.configs = fs::path(LAPWING_SOURCE_DIR) / "configs";
    settings.registry = &registry_;
    settings.observe_problem = [&](std::shared_ptr<const TrajectoryProblem> seen) {
      problem = std::move(seen);
      throw InputError("seen");
    };
    Mission mission(folder_ / "shot.lua", settings);
    mission.configure({}, {});
    try {
      mission.plan();
    } catch (const InputError& error) {
      if (!problem) ADD_FAILURE() << error.what() << "\n" << terms;
    }
    if (!problem) throw Error("no problem was stated");
    return problem;
  }

  void refuses(const std::string& terms, const std::string& fragment) {
    expect(script(terms, more_), fragment);
  }

  static Stages near_guess(const TrajectoryProblem& problem, std::uint64_t seed) {
    Random random(seed);
    Eigen::VectorXd step(problem.columns());
    for (double& number : step) number = random.uniform(-0.3, 0.3);
    if (problem.horizon().step_free)
      for (int c = 0; c < problem.columns(); ++c)
        if (problem.column_name(c).rfind("step", 0) == 0) step(c) *= 0.1;
    return problem.retract(problem.initial_guess(), step);
  }

  // Two ways to state one term, alone in their problems: cost, gradient, rows, and both Hessians,
  // to 1e-9. With `as_bounds` the shipped constraint may make bounds of what are rows here.
  void expect_same(const std::string& shipped, const std::string& own, bool as_bounds = false) {
    const auto one = stated(shipped), other = stated(own);
    ASSERT_EQ(one->columns(), other->columns()) << own;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const Stages at = near_guess(*one, seed);
      if (as_bounds) {
        EXPECT_NEAR(worst(*one, at), worst(*other, at), 1e-9) << own;
        continue;
      }
      ASSERT_EQ(one->rows(), other->rows()) << own;
      Eigen::VectorXd multipliers(one->rows());
      Random random(seed);
      for (double& number : multipliers) number = random.uniform(-1, 1);
      LocalModel a, b;
      for (const Curvature curvature : {Curvature::gauss_newton, Curvature::exact}) {
        one->linearise(at, a, curvature, &multipliers);
        other->linearise(at, b, curvature, &multipliers);
        expect_near(Eigen::MatrixXd(a.hessian), Eigen::MatrixXd(b.hessian), "Hessian\n" + own);
      }
      EXPECT_NEAR(a.cost, b.cost, 1e-9 * (1 + std::abs(a.cost))) << own;
      expect_near(a.gradient, b.gradient, "gradient\n" + own);
      expect_near(a.values, b.values, "rows\n" + own);
      expect_near(Eigen::MatrixXd(a.jacobian), Eigen::MatrixXd(b.jacobian), "Jacobian\n" + own);
      EXPECT_EQ(a.row_lower, b.row_lower) << own;
      EXPECT_EQ(a.row_upper, b.row_upper) << own;
    }
  }

  // Gradient against differences of the cost, exact Hessian against differences of the gradient.
  static void expect_term_derivatives(const TrajectoryProblem& problem) {
    constexpr double kStep = 1e-5, kTolerance = 2e-6;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const Stages at = near_guess(problem, seed);
      const int n = problem.columns();
      const Eigen::VectorXd none = Eigen::VectorXd::Zero(problem.rows());
      LocalModel model, ahead, behind;
      problem.linearise(at, model, Curvature::exact, &none);
      Eigen::MatrixXd bend = Eigen::MatrixXd(model.hessian).selfadjointView<Eigen::Lower>();
      Eigen::VectorXd slope(n);
      Eigen::MatrixXd differences(n, n);
      for (int c = 0; c < n; ++c) {
        const Eigen::VectorXd e = kStep * Eigen::VectorXd::Unit(n, c);
        problem.linearise(problem.retract(at, e), ahead);
        problem.linearise(problem.retract(at, -e), behind);
        slope(c) = (ahead.cost - behind.cost) / (2 * kStep);
        differences.col(c) = (ahead.gradient - behind.gradient) / (2 * kStep);
      }
      const auto near = [](const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, const char* what) {
        const double scale = std::max(1.0, b.cwiseAbs().maxCoeff());
        EXPECT_LE((a - b).cwiseAbs().maxCoeff(), kTolerance * scale) << what;
      };
      near(model.gradient, slope, "gradient");
      near(bend, differences, "Hessian");
    }
  }

 private:
  static double worst(const TrajectoryProblem& problem, const Stages& at) {
    for (const Violation& violation : problem.violations(at))
      if (violation.name == "t") return violation.amount;
    return 0;
  }
  static void expect_near(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b,
                          const std::string& what) {
    ASSERT_EQ(a.size(), b.size()) << what;
    if (a.size() == 0) return;
    const double scale = std::max(1.0, a.cwiseAbs().maxCoeff());
    EXPECT_LE((a - b).cwiseAbs().maxCoeff(), 1e-9 * scale) << what;
  }

 protected:
  std::string more_;  // of the problem
};

inline std::string TermTest::constants() {
  const Vehicle solo =
      load_vehicle(Value("vehicles/solo"), {fs::path(LAPWING_SOURCE_DIR) / "configs"});
  const Camera& c = solo.camera;
  const auto text = [](double number) {
    char digits[40];
    std::snprintf(digits, sizeof digits, "%.17g", number);
    return std::string(digits);
  };
  return text(solo.yaw_torque_max()) + ", " + text(largest_acceleration(solo)) +
         ", { width = " + text(c.width) + ", height = " + text(c.height) +
         ", focal_x = " + text(c.focal_x) + ", focal_y = " + text(c.focal_y) +
         ", principal_x = " + text(c.principal_x) + ", principal_y = " + text(c.principal_y) + " }";
}

}  // namespace lapwing
