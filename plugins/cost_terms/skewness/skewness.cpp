// SPDX-License-Identifier: Apache-2.0
// Upright lines stay upright: no views from far above or below (thesis 3.5.3, (3.9); reading 3.5).
//
//   E^s = sum_i h s_i^2,   s = (p_d + h/2) . p_d / ((p_d - h/2) . p_d) - 1
//
// With h the full height, upwards where the camera is above the target and downwards below, the
// denominator is |p_d|^2 + height |z| / 2 and cannot vanish, z the target's height over the camera:
// s = -height |z| / (|p_d|^2 + height |z| / 2). The residual is s with the sign of -z, so that it
// is smooth where both have the same height.
//
//   p:add_cost { type = "skewness", height = 4, weight = 1 }
#include "framework/plugin/plugin.h"
#include "framework/problem/camera_error.h"
#include "framework/problem/differentiable.h"
#include "framework/problem/invariance.h"
#include "framework/problem/time_spans.h"

namespace lapwing {
namespace {

class Skewness final : public DifferentiableCost<Skewness> {
 public:
  static constexpr PluginText kText{"skewness", "1.0.0",
                                    "penalises views from far above or far below",
                                    "thesis 3.5.3, (3.9), (3.10)"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .required_number("height", "m", "height of the subject", above(0))
        .tables("spans", time_span_table(), "spans with this cost; none: always")
        .tables("except", time_span_table(), "spans without this cost: cuts");
  }
  static std::span<const Extension> extensions() {
    static const Extension all[] = {{kInvariantToTranslation, nullptr},
                                    {kInvariantToRotationAboutZ, nullptr},
                                    {kInvariantToTime, nullptr}};
    return all;
  }
  explicit Skewness(const Parameters& parameters)
      : height_(parameters.number("height")),
        spans_(time_spans(parameters, "spans")),
        except_(time_spans(parameters, "except")) {}

  FunctionShape declare(const ProblemSetting& setting) {
    FunctionShape shape{.rows = 1, .integral = true};
    BlocksRead reads(setting.layout, shape.blocks);
    in_ = {reads.add<3>("position"), reads.add<3>("target")};
    ask_within(shape, setting.horizon, spans_, except_);
    return shape;
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    using std::abs;
    constexpr double kCoincident = 1e-12;  // m^2
    const Eigen::Matrix<T, 3, 1> d = stage(in_.target) - stage(in_.position);
    const T squared = d.x() * d.x() + d.y() * d.y() + d.z() * d.z();
    if (value_of(squared) < kCoincident) return;
    rows[0] = near_fade(squared) * height_ * d.z() / (squared + 0.5 * height_ * abs(d.z()));
  }

 private:
  struct {
    VectorHandle position, target;
  } in_;
  double height_;
  std::vector<TimeSpan> spans_, except_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Skewness)
