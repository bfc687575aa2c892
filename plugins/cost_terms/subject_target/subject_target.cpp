// SPDX-License-Identifier: Apache-2.0
// The target follows a subject on its track (thesis 3.5.3, E^t), at the time that each stage has.
//
//   E^t = sum_i h || target_i - s(t_i) ||^2,   s: where the subject is
//
// A keyframe of the block `target` stands at a time that is known beforehand. This term reads the
// time as a variable, so that it also holds where steps are free.
//
//   p:add_cost { type = "subject_target", subject = "walker", weight = 10,
//                spans = { { start = 0, finish = 8 } } }
#include "framework/plugin/plugin.h"
#include "framework/problem/differentiable.h"
#include "framework/problem/filmed_point.h"
#include "framework/problem/time_spans.h"

namespace lapwing {
namespace {

class SubjectTarget final : public DifferentiableCost<SubjectTarget, 4> {
 public:
  static constexpr PluginText kText{"subject_target", "1.0.0",
                                    "penalises the distance of the target from a moving subject",
                                    "thesis 3.5.3, E^t"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .required_text("subject", "name of the subject")
        .tables("spans", time_span_table(), "spans with this cost; none: always")
        .tables("except", time_span_table(), "spans without this cost: cuts");
  }

  explicit SubjectTarget(const Parameters& parameters)
      : name_(parameters.text("subject")),
        spans_(time_spans(parameters, "spans")),
        except_(time_spans(parameters, "except")) {}

  FunctionShape declare(const ProblemSetting& setting) {
    subject_ = subject_named(setting.environment, name_);
    FunctionShape shape{.rows = 3, .integral = true, .row_names = {"x", "y", "z"}};
    BlocksRead reads(setting.layout, shape.blocks);
    target_ = reads.add<3>("target");
    time_ = reads.add("time");
    ask_within(shape, setting.horizon, spans_, except_);
    return shape;
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    const Eigen::Matrix<T, 3, 1> off = stage(target_) - subject_position<T>(subject_, stage(time_));
    for (int i = 0; i < 3; ++i) rows[i] = off(i);
  }

 private:
  std::string name_;
  Subject subject_;
  VectorHandle target_;
  NumberHandle time_;
  std::vector<TimeSpan> spans_, except_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::SubjectTarget)
