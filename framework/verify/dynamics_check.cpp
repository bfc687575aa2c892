// SPDX-License-Identifier: Apache-2.0
// Does the vehicle move as the samples say? Integrates every interval and compares.
#include <deque>

#include "framework/core/units.h"
#include "framework/verify/checks.h"
#include "framework/verify/motions/motion_integrator.h"

namespace lapwing {
namespace {

namespace tol = tolerances;

constexpr int kDefects = 5;
constexpr const char* kDefectNames[kDefects] = {"defect_position", "defect_velocity", "defect_yaw",
                                                "defect_yaw_rate", "defect_gimbal"};
constexpr double kLimits[kDefects] = {tol::kPositionDefect, tol::kVelocityDefect, tol::kYawDefect,
                                      tol::kYawRateDefect, tol::kGimbalDefect};
using Defects = Eigen::Matrix<double, kDefects, 1>;

Defects defects_of(const MotionIntegrator& integrator, const MotionPoint& reached,
                   const MotionPoint& stated, bool has_gimbal) {
  const std::array<double, 4> motion = integrator.defects(reached, stated);
  Defects d;
  d << motion[0], motion[1], motion[2], motion[3],
      std::max(std::abs(reached.gimbal_yaw - stated.gimbal_yaw),
               std::abs(reached.gimbal_pitch - stated.gimbal_pitch));
  if (!has_gimbal) d[4] = 0;
  return d;
}

// The sum of defects over a sliding window, as a share of what a window may hold.
class Drift {
 public:
  void add(double time, const Defects& defects) {
    window_.emplace_back(time, defects);
    sum_ += defects;
    while (window_.front().first <= time - tol::kDriftWindow) {
      sum_ -= window_.front().second;
      window_.pop_front();
    }
    for (int k = 0; k < kDefects; ++k) worst_.see(sum_[k] / (tol::kDriftFactor * kLimits[k]), time);
  }
  Check check() const { return worst_.check(); }

 private:
  std::deque<std::pair<double, Defects>> window_;
  Defects sum_ = Defects::Zero();
  Worst worst_{"drift", 1.0, 0.0};
};

void check_stated_acceleration(const Flight& flight, Certificate& certificate) {
  Worst worst("stated_acceleration", tol::kAcceleration, 0);
  const auto& samples = flight.plan.trajectory.samples;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Eigen::Vector3d difference =
        samples[i].acceleration - flight.motion.stated(i).acceleration;
    worst.see(difference.norm(), samples[i].time);
  }
  certificate.checks.push_back(worst.check());
}

}  // namespace

void check_dynamics(const Flight& flight, Certificate& certificate) {
  if (!flight.plan.trajectory.motion.moves) {
    for (const char* name : {"defect_position", "defect_velocity", "defect_yaw", "defect_yaw_rate",
                             "defect_gimbal", "drift", "stated_acceleration"}) {
      certificate.checks.push_back(
          skipped_check(name, "a path is its samples joined by straight lines"));
    }
    return;
  }
  Motion& motion = flight.motion;
  const bool has_gimbal = flight.plan.trajectory.has_gimbal;
  const MotionIntegrator& integrator = motion.integrator();
  std::vector<Worst> worst;
  for (int k = 0; k < kDefects; ++k) worst.emplace_back(kDefectNames[k], kLimits[k], 0.0);
  Drift drift;
  Worst state("defect_state", 1.0, 0.0);
  bool has_state = false;
  for (std::size_t i = 0; i < motion.intervals(); ++i) {
    const MotionPoint reached = motion.integrate(i).back();
    const MotionPoint stated = motion.stated(i + 1);
    const Defects defects = defects_of(integrator, reached, stated, has_gimbal);
    state.see(std::max(0.0, integrator.state_defect(reached, stated)), reached.time);
    has_state |= integrator.state_defect(reached, stated) >= 0;
    for (int k = 0; k < kDefects; ++k)
      worst[static_cast<std::size_t>(k)].see(defects[k], reached.time);
    drift.add(reached.time, defects);
  }
  for (int k = 0; k < kDefects; ++k) {
    const bool made = motion.intervals() > 0 && (k < 4 || has_gimbal);
    certificate.checks.push_back(
        made ? worst[static_cast<std::size_t>(k)].check()
             : skipped_check(kDefectNames[k], motion.intervals() == 0
                                                  ? "a single sample has no interval"
                                                  : "the plan moves no gimbal"));
  }
  certificate.checks.push_back(motion.intervals() > 0
                                   ? drift.check()
                                   : skipped_check("drift", "a single sample has no interval"));
  check_stated_acceleration(flight, certificate);
  if (has_state) certificate.checks.push_back(state.check());
  if (const std::string source = integrator.source(); !source.empty())
    for (Check& check : certificate.checks)
      if (check.name == "defect_position")
        check.detail += (check.detail.empty() ? "" : "; ") + source;
}

}  // namespace lapwing
