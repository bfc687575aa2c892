// SPDX-License-Identifier: Apache-2.0
#include "framework/export/camera_track.h"

#include <cmath>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/core/units.h"
#include "framework/geometry/depth_camera.h"
#include "framework/trajectory/interpolate.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {

bool states_certified(const Plan& plan) {
  const Value* feasible = plan.certificate.find("feasible");
  return feasible && feasible->type() == Value::Type::boolean && feasible->as_boolean();
}

std::vector<double> frame_times(const Trajectory& trajectory, double rate,
                                const std::string& format) {
  constexpr double kMost = 2e6;
  if (trajectory.samples.empty()) throw InputError(format + ": the plan has no samples");
  // A flight that ends on a frame up to the rounding has that frame.
  const double intervals = std::floor(trajectory.duration() * rate + 1e-6);
  if (!(intervals < kMost))
    throw InputError(format + ": " + plain_number(trajectory.duration()) + " s at " +
                     plain_number(rate) + " frames/s are more than two million frames; a lower " +
                     "rate is needed");
  const double start = trajectory.samples.front().time;
  std::vector<double> times;
  for (int i = 0; i <= static_cast<int>(intervals); ++i)
    times.push_back(std::min(start + i / rate, trajectory.samples.back().time));
  return times;
}

Pinhole filming_camera(const Plan& plan, const std::string& format) {
  if (!plan.trajectory.has_gimbal)
    throw InputError(format + ": '" + plan.mission + "' is a plan of kind " + plan.kind +
                     " without a camera: no gimbal turns one");
  return plan.task.scan ? plan.task.scan->camera
                        : vehicle_from_value(plan.vehicle).camera.pinhole();
}

Pose filming_pose(const Plan& plan, double time) {
  const Sample sample = sample_at(plan.trajectory, time);
  return camera_pose(sample.position, sample.yaw + sample.gimbal_yaw, sample.gimbal_pitch);
}

Pose from_y_up(const Eigen::Vector3d& place, const Eigen::Quaterniond& turn) {
  const Eigen::Quaterniond upright(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX()));
  const Eigen::Quaterniond optical(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()));
  return {upright * place, upright * turn * optical};
}

TrackDeviation deviation_of(const Plan& plan, double start, double finish, int steps,
                            const std::function<Pose(double)>& played) {
  TrackDeviation worst;
  for (int i = 0; i <= steps; ++i) {
    const double time = i == steps ? finish : start + (finish - start) * i / steps;
    const Pose wanted = filming_pose(plan, time);
    const Pose shown = played(time);
    const double distance = (shown.position - wanted.position).norm();
    const double angle = shown.orientation.angularDistance(wanted.orientation);
    if (distance > worst.distance) worst.distance = distance, worst.distance_time = time;
    if (angle > worst.angle) worst.angle = angle, worst.angle_time = time;
  }
  return worst;
}

std::string sentence_of(const TrackDeviation& deviation) {
  return "played back, the camera is at most " + plain_number(1000 * deviation.distance, 3) +
         " mm (at " + plain_number(deviation.distance_time, 4) + " s) and " +
         plain_number(degrees(deviation.angle), 3) + " deg (at " +
         plain_number(deviation.angle_time, 4) + " s) from the plan";
}

}  // namespace lapwing
