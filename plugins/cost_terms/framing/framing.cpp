// SPDX-License-Identifier: Apache-2.0
// A subject's place and size in the image: centred, on a third, as large as this.
//
//   E^f = sum_i h (beta_i^2 + w log^2(D_i / D)),   beta: the angle between where the subject is
//   seen and where it ought to be; D_i: its distance, D: the one at which it has the size asked for
//
// Angles between directions instead of distances between pixels: finite behind the camera too, and
// the same for every lens. Where the subject ought to be is a fixed direction in the camera's
// frame.
//
//   p:add_cost { type = "framing", subject = "actor", horizontal = 1/3, size = 0.5, weight = 10 }
#include "framework/geometry/camera_axes.h"
#include "framework/plugin/plugin.h"
#include "framework/problem/camera_error.h"
#include "framework/problem/filmed_point.h"
#include "framework/problem/time_spans.h"

namespace lapwing {
namespace {

class Framing final : public DifferentiableCost<Framing, 9> {
 public:
  static constexpr PluginText kText{"framing", "1.0.0",
                                    "penalises wrong place and size of a subject in the image",
                                    "thesis 3.5.3, (3.7), for any place in the image"};
  static ParameterTable parameters() {
    return FilmedPoint::table(FilmedPoint::Has::place_and_height)
        .number("horizontal", 0.5, "",
                "wanted place in the image: 0 is the left edge, 1 the right edge", between(0, 1))
        .number("vertical", 0.5, "",
                "wanted place in the image: 0 is the upper edge, 1 the lower edge", between(0, 1))
        .optional_number("size", "", "wanted height as a fraction of the image height", above(0))
        .number("size_weight", 1.0, "", "weight of the squared log size error, per rad^2",
                at_least(0))
        .tables("spans", time_span_table(), "spans with this cost; none: always")
        .tables("except", time_span_table(), "spans without this cost: cuts");
  }

  explicit Framing(const Parameters& parameters)
      : point_(parameters, FilmedPoint::Has::place_and_height),
        horizontal_(parameters.number("horizontal")),
        vertical_(parameters.number("vertical")),
        root_(std::sqrt(parameters.number("size_weight"))),
        spans_(time_spans(parameters, "spans")),
        except_(time_spans(parameters, "except")) {
    if (parameters.has("size")) size_ = parameters.number("size");
  }

  FunctionShape declare(const ProblemSetting& setting) {
    FunctionShape shape{.rows = size_ ? 3 : 2, .integral = true, .row_names = {"right", "down"}};
    BlocksRead reads(setting.layout, shape.blocks);
    in_ = {reads.add<3>("position"), reads.add("yaw"), reads.add("gimbal_yaw"),
           reads.add("gimbal_pitch")};
    if (size_) shape.row_names.push_back("size");
    point_.bind(setting, shape);
    const Camera& camera = setting.vehicle.camera;
    turn_to(Eigen::Vector3d(
        (horizontal_ * camera.width - 0.5 - camera.principal_x) / camera.focal_x,
        (vertical_ * camera.height - 0.5 - camera.principal_y) / camera.focal_y, 1.0));
    if (size_) distance_ = point_.height("size") * camera.focal_y / (*size_ * camera.height);
    ask_within(shape, setting.horizon, spans_, except_);
    return shape;
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    const CameraAxes<T> axes =
        camera_axes<T>(stage(in_.yaw) + stage(in_.gimbal_yaw), stage(in_.gimbal_pitch));
    const Eigen::Matrix<T, 3, 1> away = point_.at(stage) - stage(in_.position);
    const Eigen::Matrix<T, 3, 1> seen = axes.in_camera(away);
    Eigen::Matrix<T, 3, 1> turned;
    for (int i = 0; i < 3; ++i)
      turned(i) = turn_(i, 0) * seen.x() + turn_(i, 1) * seen.y() + turn_(i, 2) * seen.z();
    const auto angles = angle_residual<T>(turned);
    rows[0] = angles[0];
    rows[1] = angles[1];
    if (!size_) return;
    const T squared = away.x() * away.x() + away.y() * away.y() + away.z() * away.z();
    using std::log;
    rows[2] = root_ * (0.5 * log(near_squared(squared)) - std::log(distance_));
  }

 private:
  // Rows: the axes, in the camera's frame, of one that looks where the subject ought to be.
  void turn_to(const Eigen::Vector3d& direction) {
    const Eigen::Vector3d forward = direction.normalized();
    const Eigen::Vector3d right = Eigen::Vector3d::UnitY().cross(forward).normalized();
    turn_ << right.transpose(), forward.cross(right).transpose(), forward.transpose();
  }

  struct {
    VectorHandle position;
    NumberHandle yaw, gimbal_yaw, gimbal_pitch;
  } in_;
  FilmedPoint point_;
  double horizontal_, vertical_, root_;
  std::optional<double> size_;
  std::vector<TimeSpan> spans_, except_;
  Eigen::Matrix3d turn_ = Eigen::Matrix3d::Identity();
  double distance_ = 1;  // m, at which the subject has its size
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Framing)
