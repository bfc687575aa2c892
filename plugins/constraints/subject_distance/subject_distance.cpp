// SPDX-License-Identifier: Apache-2.0
// Keeps a distance from the middle of one subject, or of every one, wherever it moves, along the
// whole path and not at the stages alone (problem/path_clearance.h).
//
//   |p_i - s(t_i)| - sqrt((distance + a h^2/8 + w h/2)^2 + L_i^2/4) >= 0
//
// L_i = (|v_i| + w) h + a h^2/2 bounds the chords in the frame of the subject, whose speed is at
// most w; where its track has a corner between two stages it leaves its own chord by w h/2 at most.
//
//   p:add_constraint { type = "subject_distance", subject = "walker", distance = 3 }
#include "framework/plugin/plugin.h"
#include "framework/problem/filmed_point.h"
#include "framework/problem/path_clearance.h"

namespace lapwing {
namespace {

// The largest speed on a track, m/s.
double largest_speed(const Subject& subject) {
  double speed = 0;
  for (std::size_t k = 1; k < subject.times.size(); ++k)
    speed = std::max(speed, (subject.positions[k] - subject.positions[k - 1]).norm() /
                                (subject.times[k] - subject.times[k - 1]));
  return speed;
}

class SubjectDistance final : public DifferentiableConstraint<SubjectDistance, 8> {
 public:
  static constexpr PluginText kText{"subject_distance", "1.0.0",
                                    "the path keeps a distance from subjects",
                                    "thesis 3.5.3, minimum distance from the target"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .optional_text("subject", "name of a subject; absent: all subjects")
        .required_number("distance", "m", "distance from its centre", above(0));
  }
  explicit SubjectDistance(const Parameters& parameters)
      : distance_(parameters.number("distance")) {
    if (parameters.has("subject")) name_ = parameters.text("subject");
  }

  FunctionShape declare(const ProblemSetting& setting) {
    subjects_ = setting.environment.subjects;
    if (name_) subjects_ = {subject_named(setting.environment, *name_)};
    speeds_.clear();
    clearance_ = PathClearance(setting.vehicle);
    FunctionShape shape{.rows = static_cast<int>(subjects_.size())};
    BlocksRead reads(setting.layout, shape.blocks);
    in_ = {reads.add<3>("position"), reads.add<3>("velocity"), reads.add("time"),
           reads.add("step")};
    for (const Subject& subject : subjects_) {
      speeds_.push_back(largest_speed(subject));
      shape.row_names.push_back(subject.name.empty() ? std::to_string(speeds_.size())
                                                     : subject.name);
    }
    return shape;
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    const auto position = stage(in_.position);
    const Eigen::Matrix<T, 3, 1> velocity = stage(in_.velocity);
    for (std::size_t k = 0; k < subjects_.size(); ++k) {
      const auto subject = subject_position<T>(subjects_[k], stage(in_.time));
      rows[static_cast<int>(k)] =
          distance<T>(position - subject) -
          clearance_.around(velocity, stage(in_.step), speeds_[k]).asked(distance_);
    }
  }

  void bounds(InstanceRange range, double* lower, double* upper) const override {
    std::fill_n(lower, range.count * subjects_.size(), 0.0);
    std::fill_n(upper, range.count * subjects_.size(), std::numeric_limits<double>::infinity());
  }

 private:
  // From the subject's very middle the way out is up.
  template <class T>
  static T distance(const Eigen::Matrix<T, 3, 1>& d) {
    using std::sqrt;
    constexpr double kMiddle = 1e-4;  // m
    const T squared = d.x() * d.x() + d.y() * d.y() + d.z() * d.z();
    if (value_of(squared) < kMiddle * kMiddle) return d.z() - value_of(d.z()) + kMiddle;
    return sqrt(squared);
  }

  struct {
    VectorHandle position, velocity;
    NumberHandle time, step;
  } in_;
  std::optional<std::string> name_;
  double distance_;
  std::vector<Subject> subjects_;
  std::vector<double> speeds_;  // m/s, of each
  PathClearance clearance_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::SubjectDistance)
