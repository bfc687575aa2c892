// SPDX-License-Identifier: Apache-2.0
// A motion that the plan states as a table of derivatives: Runge-Kutta 4 over position, velocity,
// yaw and the columns that are states.
#include <cmath>
#include <map>

#include "framework/verify/motions/motion_integrator.h"
#include "framework/verify/operation_value.h"
#include "framework/verify/tolerances.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

// Position 0 to 2, velocity 3 to 5, yaw 6, then the columns in their order; inputs among them are
// constants of the state, written anew at every evaluation.
constexpr int kYawPlace = 6, kFirstColumn = 7;

class TableIntegrator final : public MotionIntegrator {
 public:
  explicit TableIntegrator(const Trajectory& trajectory)
      : held_(trajectory.inputs_held),
        name_(trajectory.motion.name),
        columns_(trajectory.motion.columns),
        table_(*trajectory.motion.table) {
    std::map<std::string, int> places{{"position", 0}, {"velocity", 3}, {"yaw", kYawPlace}};
    size_ = kFirstColumn;
    for (const MotionColumn& column : columns_) {
      places[column.name] = size_;
      for (int i = 0; i < column.size; ++i) is_input_.push_back(column.input);
      size_ += column.size;
    }
    for (const ConstraintStep& step : table_.operations)
      inputs_.push_back(step.op == ConstraintOp::input ? places[step.name] + step.component : -1);
    places["acceleration"] = 3;
    places["yaw_rate"] = kYawPlace;
    for (const MotionRate& rate : table_.rates)
      rates_.push_back({places[rate.name] + rate.component, rate.operation});
  }

  double steps(const Sample& a, const Sample& b) const override {
    return std::ceil(std::max(1.0, (b.time - a.time) / tolerances::kTableStep));
  }

  MotionPoint stated(const Sample& s) const override {
    MotionPoint p = point_of(state_of(s), s.time);
    p.gimbal_yaw = s.gimbal_yaw;
    p.gimbal_pitch = s.gimbal_pitch;
    p.gimbal_yaw_rate = s.gimbal_yaw_rate;
    p.gimbal_pitch_rate = s.gimbal_pitch_rate;
    return p;
  }

  void integrate(const Sample& a, const Sample& b, std::size_t count,
                 std::vector<MotionPoint>& points) const override {
    const VectorXd first = state_of(a), last = state_of(b);
    const double h = (b.time - a.time) / static_cast<double>(count);
    // A state with the inputs that hold after so many steps.
    const auto under = [&](VectorXd x, double steps_done) {
      const double share = held_ ? 0 : steps_done / static_cast<double>(count);
      for (int i = kFirstColumn; i < size_; ++i)
        if (is_input_[static_cast<std::size_t>(i - kFirstColumn)])
          x[i] = first[i] + share * (last[i] - first[i]);
      return x;
    };
    VectorXd x = first;
    points.push_back(point_of(x, a.time));
    for (std::size_t k = 0; k < count; ++k) {
      const double at = static_cast<double>(k);
      const VectorXd k1 = rate_of(under(x, at));
      const VectorXd k2 = rate_of(under(x + h / 2 * k1, at + 0.5));
      const VectorXd k3 = rate_of(under(x + h / 2 * k2, at + 0.5));
      const VectorXd k4 = rate_of(under(x + h * k3, at + 1));
      x = under(x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4), at + 1);
      points.push_back(point_of(x, k + 1 == count ? b.time : a.time + h * (at + 1)));
    }
    turn_gimbal(a, b, {held_}, points);
  }

  // Yaw rates that follow from inputs jump where these do; yaw itself is judged.
  std::array<double, 4> defects(const MotionPoint& reached,
                                const MotionPoint& stated) const override {
    std::array<double, 4> all = MotionIntegrator::defects(reached, stated);
    all[3] = 0;
    return all;
  }

  // Of numbers whose unit says little: a share of their size, and of 1 at least.
  double state_defect(const MotionPoint& reached, const MotionPoint& stated) const override {
    double worst = -1;
    for (std::size_t i = 0; i < is_input_.size(); ++i) {
      if (is_input_[i]) continue;
      const double size = std::max(1.0, std::abs(stated.columns[i]));
      const double defect = std::abs(reached.columns[i] - stated.columns[i]) / size;
      worst = std::isnan(defect) ? defect : std::max(worst, defect / tolerances::kTableDefect);
      if (std::isnan(worst)) return worst;
    }
    return worst;
  }

  std::string source() const override {
    return "the motion '" + name_ + "' is integrated from the derivatives that the plan states";
  }

 private:
  VectorXd state_of(const Sample& s) const {
    VectorXd x(size_);
    x.head<3>() = s.position;
    x.segment<3>(3) = s.velocity;
    x[kYawPlace] = s.yaw;
    int place = kFirstColumn;
    for (const MotionColumn& column : columns_)
      for (const double value : s.columns.find(column.name)) x[place++] = value;
    return x;
  }

  VectorXd rate_of(const VectorXd& x) const {
    values_.resize(table_.operations.size());
    for (std::size_t i = 0; i < values_.size(); ++i)
      values_[i] = inputs_[i] >= 0 ? x[inputs_[i]] : operation_value(table_.operations[i], values_);
    VectorXd rate = VectorXd::Zero(size_);
    rate.head<3>() = x.segment<3>(3);
    for (const auto& [place, operation] : rates_)
      rate[place] = values_[static_cast<std::size_t>(operation)];
    return rate;
  }

  MotionPoint point_of(const VectorXd& x, double time) const {
    const VectorXd rate = rate_of(x);
    return {.time = time,
            .position = x.head<3>(),
            .velocity = x.segment<3>(3),
            .acceleration = rate.segment<3>(3),
            .yaw = x[kYawPlace],
            .yaw_rate = rate[kYawPlace],
            .columns = {x.data() + kFirstColumn, x.data() + size_}};
  }

  struct Place {
    int place, operation;
  };
  bool held_;
  std::string name_;
  const std::vector<MotionColumn>& columns_;
  const MotionTable& table_;
  int size_ = 0;
  std::vector<bool> is_input_;  // of the numbers of the columns
  std::vector<int> inputs_;     // place in the state that an operation reads; -1: none
  std::vector<Place> rates_;
  mutable std::vector<double> values_;
};

}  // namespace

std::unique_ptr<MotionIntegrator> table_integrator(const Trajectory& trajectory) {
  return std::make_unique<TableIntegrator>(trajectory);
}

}  // namespace lapwing
