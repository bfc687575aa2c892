// SPDX-License-Identifier: Apache-2.0
// A linear quadratic regulator along the plan: gains that change with it, by a Riccati sweep from
// its end to its start (Anderson, Moore, Optimal Control, 1990, 2.4; in discrete time 2.3).
//
//   u(t) = u_d(t) - K(t) x(t)
//
//   controller = "tvlqr"
#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "framework/core/error.h"
#include "framework/plugin/plugin.h"
#include "framework/vehicle/controller.h"
#include "plugins/controllers/tvlqr/error_dynamics.h"

namespace lapwing {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::Vector4d;
using Eigen::VectorXd;

constexpr double kStep = 0.01;      // s, of the sweep
constexpr double kMostSteps = 2e5;  // of a long plan: then longer steps
constexpr double kSettling = 3.0;   // s, for which the last point is held before the sweep begins

using Gain = Eigen::Matrix<double, 4, Eigen::Dynamic>;

// exp(a h) and its integral times b, by a series to the fourth power: a h is small.
void discretise(const ErrorDynamics& d, double h, MatrixXd& a, MatrixXd& b) {
  const Eigen::Index n = d.a.rows();
  const MatrixXd ah = h * d.a;
  MatrixXd power = MatrixXd::Identity(n, n), sum = power, integral = power;
  double factor = 1;
  for (int k = 1; k <= 6; ++k) {
    power = power.lazyProduct(ah).eval();
    factor *= k;
    sum += power / factor;
    integral += power / (factor * (k + 1));
  }
  a = sum;
  b = h * integral.lazyProduct(d.b);
}

struct FollowedPlan {
  const BodyReference* reference = nullptr;
  double lag = 0, start = 0, step = 0;
  std::vector<Gain> gains;  // at start + k step
  double largest_position = 0, largest_velocity = 0;

  // Linear between the points of the sweep.
  Vector4d feedback(double time, const VectorXd& x) const {
    const double at = std::clamp((time - start) / step, 0.0, static_cast<double>(gains.size() - 1));
    const auto k = std::min(static_cast<std::size_t>(at), gains.size() - 2);
    const double share = at - static_cast<double>(k);
    return (1 - share) * (gains[k] * x) + share * (gains[k + 1] * x);
  }
};

class TvlqrFlight final : public ControlledFlight {
 public:
  TvlqrFlight(const FollowedPlan& plan, const RotorAllocation& allocation,
              const Eigen::Matrix4d& mixer)
      : plan_(plan), allocation_(allocation), mixer_(mixer) {}

  RotorCommand command(double time, const BodyState& state, double step) override {
    const BodyPoint wanted = plan_.reference->at(time);
    if (!saturated_) integral_ += step * (state.position - wanted.position);
    VectorXd x = deviation(state, wanted, integral_, plan_.lag > 0);
    limit(x, 3, plan_.largest_position);
    limit(x, 6, plan_.largest_velocity);
    const RotorCommand command =
        allocation_(mixer_ * (fed_forward(time, step) - plan_.feedback(time, x)));
    saturated_ = command.saturated;
    return command;
  }

 private:
  // Thrusts in the middle of the step for which the command is held; of rotors that lag, those
  // whose answer they are.
  Vector4d fed_forward(double time, double step) const {
    const double middle = time + step / 2;
    const Vector4d now = plan_.reference->at(middle).rotor_thrusts;
    if (plan_.lag == 0) return now;
    const double around = std::max(step, 0.005);
    const Vector4d rate = (plan_.reference->at(middle + around).rotor_thrusts -
                           plan_.reference->at(middle - around).rotor_thrusts) /
                          (2 * around);
    return now + plan_.lag * rate;
  }

  static void limit(VectorXd& x, Eigen::Index first, double most) {
    const double norm = x.segment<3>(first).norm();
    if (norm > most) x.segment<3>(first) *= most / norm;
  }

  const FollowedPlan& plan_;
  const RotorAllocation& allocation_;
  const Eigen::Matrix4d& mixer_;
  Vector3d integral_ = Vector3d::Zero();  // m s
  bool saturated_ = false;
};

class Tvlqr final : public Controller {
 public:
  static constexpr PluginText kText{
      "tvlqr", "1.0.0", "linear quadratic regulator with gains that change along the plan",
      "Anderson, Moore, Optimal Control, 1990, 2.3"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .number("thrust", 0.15, "",
                "thrust difference of cost 1, as a fraction of the largest thrust of a rotor",
                between(0.001, 10))
        .number("integral", 0.3, "m s", "integral of the position error of cost 1",
                between(0.001, 1000))
        .number("position", 0.1, "m", "position error of cost 1", between(0.001, 100))
        .number("velocity", 0.5, "m/s", "velocity error of cost 1", between(0.001, 100))
        .number("attitude", 0.2, "rad", "attitude error of cost 1", between(0.001, 10))
        .number("rates", 4, "rad/s", "body rate error of cost 1", between(0.01, 1000))
        .number("largest_position", 1, "m", "largest error that is corrected in full",
                between(0.01, 1000))
        .number("largest_velocity", 4, "m/s", "largest error that is corrected in full",
                between(0.01, 1000));
  }
  explicit Tvlqr(const Parameters& parameters)
      : thrust_(parameters.number("thrust")),
        worth_{parameters.number("integral"), parameters.number("position"),
               parameters.number("velocity"), parameters.number("attitude"),
               parameters.number("rates")} {
    plan_.largest_position = parameters.number("largest_position");
    plan_.largest_velocity = parameters.number("largest_velocity");
  }

  void follow(const Vehicle& vehicle, const BodyReference& reference) override {
    plan_.reference = &reference;
    plan_.lag = vehicle.rotors.lag;
    allocation_ = std::make_unique<RotorAllocation>(vehicle);
    mixer_ = mixer_of(vehicle.rotors);
    sweep(vehicle);
  }
  std::unique_ptr<ControlledFlight> begin() const override {
    return std::make_unique<TvlqrFlight>(plan_, *allocation_, mixer_);
  }

 private:
  void sweep(const Vehicle& vehicle) {
    const BodyReference& reference = *plan_.reference;
    const double duration = reference.finish() - reference.start();
    const double steps = std::clamp(std::ceil(duration / kStep), 1.0, kMostSteps);
    plan_.start = reference.start();
    plan_.step = duration / steps;
    const auto count = static_cast<std::size_t>(steps) + 1;
    plan_.gains.resize(count);

    const bool rotors = plan_.lag > 0;
    const int n = kBodyErrors + (rotors ? kRotorErrors : 0);
    VectorXd q = VectorXd::Zero(n);
    for (int block = 0; block < 5; ++block)
      q.segment<3>(3 * block).setConstant(1 / (worth_[block] * worth_[block]));
    const double worth = thrust_ * vehicle.rotors.thrust_max;
    const double r = 1 / (worth * worth);
    MatrixXd p = plan_.step * MatrixXd(q.asDiagonal());
    // One step of the difference equation of Riccati, in the symmetric form that stays definite.
    const auto step_back = [&](std::size_t k) {
      const double time = plan_.start + static_cast<double>(k) * plan_.step;
      MatrixXd a, b;
      discretise(error_dynamics(reference.at(time), vehicle), plan_.step, a, b);
      const MatrixXd pa = p.lazyProduct(a), pb = p.lazyProduct(b);
      const MatrixXd weight =
          plan_.step * r * MatrixXd::Identity(4, 4) + b.transpose().lazyProduct(pb);
      const MatrixXd gain = weight.llt().solve(MatrixXd(b.transpose().lazyProduct(pa)));
      const MatrixXd closed = a - b.lazyProduct(gain);
      const MatrixXd next = MatrixXd(plan_.step * q.asDiagonal()) +
                            closed.transpose().lazyProduct(MatrixXd(p.lazyProduct(closed))) +
                            plan_.step * r * MatrixXd(gain.transpose().lazyProduct(gain));
      p = (next + next.transpose()) / 2;
      if (!p.allFinite() || !gain.allFinite())
        throw InputError("the controller tvlqr finds no gains for this plan at " +
                         std::to_string(time) + " s: its motion or the weights are too extreme");
      plan_.gains[k] = gain;
    };
    // As if the plan went on as it ends, so that gains do not fade towards the end.
    const auto settling = static_cast<int>(std::ceil(kSettling / plan_.step));
    for (int k = 0; k < settling; ++k) step_back(count - 1);
    for (std::size_t k = count; k-- > 0;) step_back(k);
  }

  double thrust_;
  std::array<double, 5> worth_;
  FollowedPlan plan_;
  std::unique_ptr<RotorAllocation> allocation_;
  Eigen::Matrix4d mixer_ = Eigen::Matrix4d::Zero();
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Tvlqr)
