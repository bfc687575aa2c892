// SPDX-License-Identifier: Apache-2.0
// The whole quadrotor (thesis 3.8.1, (3.11) to (3.13)), thrusts of the rotors linear in time.
//
//   r' = v,  m v' = u_1 z_B + m g - d v,  q' = q (0, w) / 2,  I w' = u_234 - w x I w,  F' = rate
//
// One Runge-Kutta 4 step from stage to stage, the quaternion made a unit after it. The second
// derivatives are those of the gradient of lambda . f, which is written out backwards through the
// step and differentiated once by dual numbers: an eighth of the work of differentiating twice.
//
//   p:add_model { type = "quadrotor_full" }
#include "framework/core/dual.h"
#include "framework/core/units.h"
#include "framework/plugin/plugin.h"
#include "framework/problem/vehicle_model.h"
#include "framework/vehicle/rotor_body.h"

#include "plugins/vehicle_models/quadrotor_full/quadrotor_step.h"

namespace lapwing {
namespace {

class QuadrotorFull final : public VehicleModel {
 public:
  static constexpr PluginText kText{"quadrotor_full", "1.0.0",
                                    "rigid body with four rotors, thrust linear between stages",
                                    "thesis 3.8.1, (3.11) to (3.13)"};
  static ParameterTable parameters() {
    ParameterTable table;
    for (const auto& [name, value, summary] :
         {std::tuple{"thrust_share", 1.0, "used fraction of the largest rotor thrust"},
          std::tuple{"rate_share", 1.0, "used fraction of the body rate limits"}})
      table.number(name, value, "", summary,
                   {.minimum = 0, .maximum = 1, .minimum_excluded = true});
    return table;
  }
  explicit QuadrotorFull(const Parameters& parameters)
      : thrust_share_(parameters.number("thrust_share")),
        rate_share_(parameters.number("rate_share")) {}

  void bind(const Vehicle& vehicle) override {
    if (!vehicle.has_rotors)
      throw InputError("vehicle '" + vehicle.name +
                       "' states no rotors, which the model 'quadrotor_full' needs: its file needs "
                       "inertia and rotors, or use another model, such as 'velocity'");
    step_.mass_ = vehicle.mass;
    step_.drag_ = vehicle.drag / vehicle.mass;
    for (int i = 0; i < 3; ++i) step_.inertia_[i] = vehicle.inertia[i];
    const Eigen::Matrix4d mixer = mixer_of(vehicle.rotors);
    for (int r = 0; r < 3; ++r)
      for (int i = 0; i < 4; ++i) step_.moment_[r][i] = mixer(r + 1, i) / step_.inertia_[r];
    thrust_min_ = vehicle.rotors.thrust_min;
    thrust_max_ = std::max(thrust_min_, thrust_share_ * vehicle.rotors.thrust_max);
    tilt_rate_ = rate_share_ * vehicle.tilt_rate_max.value_or(kInfinity);
    yaw_rate_ = rate_share_ * vehicle.yaw_rate_max;
    climb_ = vehicle.climb_speed_max;
    descent_ = vehicle.descent_speed_max;
  }

  std::vector<BlockSpec> blocks() const override {
    return {{.name = "position", .size = 3, .unit = "m"},
            {.name = "velocity", .size = 3, .unit = "m/s"},
            {.name = "orientation", .size = 4, .topology = Topology::quaternion},
            {.name = "body_rates", .size = 3, .unit = "rad/s"},
            {.name = "rotor_thrusts", .size = 4, .unit = "N"},
            {.name = "thrust_rates", .size = 4, .unit = "N/s", .role = BlockRole::input}};
  }

  bool affine() const override { return false; }

  void flow(InstanceRange range, const double* inputs, double* next, double* jacobian,
            Workspace&) const override {
    using T = Dual<double, kActive>;
    for (int k = 0; k < range.count; ++k) {
      const double* at = inputs + k * kArguments;
      step_.step(at, next + k * kStates);
      if (!jacobian) continue;
      T x[kArguments], y[kStates];
      QuadrotorStep::seed(at, x);
      step_.step(x, y);
      double* j = jacobian + k * kStates * kArguments;
      for (int r = 0; r < kStates; ++r, j += kArguments) {
        for (int i = 0; i < kMoving; ++i) j[i] = r == i ? 1.0 : 0.0;
        std::copy(y[r].d.begin(), y[r].d.end(), j + kMoving);
      }
    }
  }

  void curvature(InstanceRange range, const double* inputs, const double* multipliers,
                 double* hessian, Workspace&) const override {
    for (int k = 0; k < range.count; ++k)
      add_curvature(step_, inputs + k * kArguments, multipliers + k * kStates,
                    hessian + k * kArguments * kArguments);
  }

  void to_sample(const double* x, Sample& sample) const override {
    sample.position = Eigen::Vector3d(x);
    sample.velocity = Eigen::Vector3d(x + 3);
    const Eigen::Quaterniond orientation(x[6], x[7], x[8], x[9]);
    const Eigen::Vector3d body_rates(x + 10);
    const Eigen::Vector4d thrusts(x + 13);
    sample.columns.set("orientation", orientation);
    sample.columns.set("body_rates", body_rates);
    sample.columns.set("rotor_thrusts", thrusts);
    sample.columns.set("rotor_thrust_rates", Eigen::Vector4d(x + 17));  // not in plans
    const Eigen::Vector3d axis = orientation * Eigen::Vector3d::UnitZ();
    sample.acceleration = thrusts.sum() / step_.mass_ * axis - step_.drag_ * sample.velocity -
                          kGravity * Eigen::Vector3d::UnitZ();
    set_yaw(orientation, body_rates, sample);
  }

  // A sample without thrusts of its own, such as that of a point mass, stands along its force and
  // shares it out among the rotors.
  void from_sample(const Sample& sample, double* x) const override {
    Eigen::Map<Eigen::Vector3d>(x + 0) = sample.position;
    Eigen::Map<Eigen::Vector3d>(x + 3) = sample.velocity;
    Eigen::Quaterniond q = sample.columns.quaternion("orientation");
    Eigen::Vector4d thrusts = sample.columns.vector<4>("rotor_thrusts");
    const Eigen::Vector3d pull = sample.columns.vector3("force");
    if (const double force = pull.norm(); thrusts.isZero(0)) {
      const bool pushed = force > 0;
      thrusts.setConstant(pushed ? force / 4 : step_.mass_ * kGravity / 4);
      if (pushed) q = upright_to(pull / force);
    }
    Eigen::Map<Eigen::Vector4d>(x + 6) = Eigen::Vector4d(q.w(), q.x(), q.y(), q.z());
    Eigen::Map<Eigen::Vector3d>(x + 10) = sample.columns.vector3("body_rates");
    Eigen::Map<Eigen::Vector4d>(x + 13) = thrusts;
    Eigen::Map<Eigen::Vector4d>(x + 17) = sample.columns.vector<4>("rotor_thrust_rates");
  }

  void bounds(double* lower, double* upper) const override {
    std::fill_n(lower, kStates + kInputs, -kInfinity);
    std::fill_n(upper, kStates + kInputs, kInfinity);
    lower[5] = -descent_;
    upper[5] = climb_;
    const double rates[] = {tilt_rate_, tilt_rate_, yaw_rate_};
    for (int i = 0; i < 3; ++i) lower[10 + i] = -rates[i], upper[10 + i] = rates[i];
    std::fill_n(lower + 13, 4, thrust_min_);
    std::fill_n(upper + 13, 4, thrust_max_);
  }

  void describe(Trajectory& trajectory) const override {
    trajectory.motion = rotors_motion();
    trajectory.inputs_held = false;
  }

 private:
  // The shortest turn from up to a direction. (Eigen's own decomposes a matrix, which takes g++
  // longer than the rest of this file.)
  static Eigen::Quaterniond upright_to(const Eigen::Vector3d& direction) {
    const Eigen::Quaterniond q(1 + direction.z(), -direction.y(), direction.x(), 0);
    return q.norm() > 1e-9 ? q.normalized() : Eigen::Quaterniond(0, 1, 0, 0);
  }

  // Where the nose points, and how fast that turns; the trajectory makes turns of it.
  static void set_yaw(const Eigen::Quaterniond& orientation, const Eigen::Vector3d& body_rates,
                      Sample& sample) {
    const Eigen::Vector3d nose = orientation * Eigen::Vector3d::UnitX();
    const Eigen::Vector3d spin = (orientation * body_rates).cross(nose);
    const double squared = nose.head<2>().squaredNorm();
    sample.yaw = squared > 0 ? std::atan2(nose.y(), nose.x()) : 0.0;
    sample.yaw_rate = squared > 1e-12 ? (nose.x() * spin.y() - nose.y() * spin.x()) / squared : 0.0;
  }

  double thrust_share_, rate_share_;
  QuadrotorStep step_;
  double thrust_min_ = 0, thrust_max_ = 1, tilt_rate_ = 1, yaw_rate_ = 1, climb_ = 1, descent_ = 1;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::QuadrotorFull)
