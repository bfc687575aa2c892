// SPDX-License-Identifier: Apache-2.0
// The camera looks at its target (thesis 3.5.3, (3.7), (3.8); reading 3.4).
//
//   E^c = sum_i h alpha_i^2,   alpha: the angle between the camera's direction and the target's
//
// As two residuals, the error to the right and downwards in the image, both in rad: their squares
// sum to alpha^2 and they are smooth where it is zero.
//
//   p:add_cost { type = "camera_angle", weight = 10, except = { { start = 4, finish = 5 } } }
#include "framework/geometry/camera_axes.h"
#include "framework/plugin/plugin.h"
#include "framework/problem/camera_error.h"
#include "framework/problem/differentiable.h"
#include "framework/problem/invariance.h"
#include "framework/problem/time_spans.h"

namespace lapwing {
namespace {

class CameraAngle final : public DifferentiableCost<CameraAngle, 9> {
 public:
  static constexpr PluginText kText{"camera_angle", "1.0.0",
                                    "penalises the angle between camera and target",
                                    "thesis 3.5.3, (3.7), (3.8)"};
  static ParameterTable parameters() {
    return ParameterTable{}.tables("except", time_span_table(), "spans without this cost: cuts");
  }
  static std::span<const Extension> extensions() {
    static const Extension all[] = {{kInvariantToTranslation, nullptr},
                                    {kInvariantToRotationAboutZ, nullptr},
                                    {kInvariantToTime, nullptr}};
    return all;
  }
  explicit CameraAngle(const Parameters& parameters) : except_(time_spans(parameters, "except")) {}

  FunctionShape declare(const ProblemSetting& setting) {
    FunctionShape shape{.rows = 2, .integral = true, .row_names = {"right", "down"}};
    BlocksRead reads(setting.layout, shape.blocks);
    in_ = {reads.add<3>("position"), reads.add("yaw"), reads.add("gimbal_yaw"),
           reads.add("gimbal_pitch"), reads.add<3>("target")};
    ask_within(shape, setting.horizon, {}, except_);
    return shape;
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    const CameraAxes<T> axes =
        camera_axes<T>(stage(in_.yaw) + stage(in_.gimbal_yaw), stage(in_.gimbal_pitch));
    const Eigen::Matrix<T, 3, 1> to_target = stage(in_.target) - stage(in_.position);
    const auto angles = angle_residual<T>(axes.in_camera(to_target));
    rows[0] = angles[0];
    rows[1] = angles[1];
  }

 private:
  struct {
    VectorHandle position;
    NumberHandle yaw, gimbal_yaw, gimbal_pitch;
    VectorHandle target;
  } in_;
  std::vector<TimeSpan> except_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::CameraAngle)
