// SPDX-License-Identifier: Apache-2.0
// The flight stays on a path, whenever it is where on it.
//
//   E^p = sum_i h || p_i - q(p_i) ||^2,   q: the nearest point of the path
//
// Keyframes along the path would also say when it is where. This term leaves the speed open, so
// that times can be variables.
//
//   p:add_cost { type = "path_distance", points = { 0, 0, 3,  5, 0, 3,  5, 5, 3 }, weight = 100 }
#include "framework/plugin/plugin.h"
#include "framework/problem/differentiable.h"
#include "framework/problem/time_spans.h"

namespace lapwing {
namespace {

class PathDistance final : public DifferentiableCost<PathDistance, 3> {
 public:
  static constexpr PluginText kText{"path_distance", "1.0.0",
                                    "penalises the distance of the position from a path",
                                    "thesis 3.7.1"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .required_numbers("points", 0, "m", "x, y, z of the first point, of the second, ...; world")
        .tables("spans", time_span_table(), "spans with this cost; none: always")
        .tables("except", time_span_table(), "spans without this cost: cuts");
  }

  explicit PathDistance(const Parameters& parameters)
      : spans_(time_spans(parameters, "spans")), except_(time_spans(parameters, "except")) {
    const auto numbers = parameters.numbers("points");
    if (numbers.size() < 6 || numbers.size() % 3 != 0)
      throw InputError(parameters.origin("points"),
                       "points: expected x, y, z of two points or more, got " +
                           std::to_string(numbers.size()) + " numbers");
    for (std::size_t k = 0; k < numbers.size(); k += 3)
      points_.emplace_back(numbers[k], numbers[k + 1], numbers[k + 2]);
  }

  FunctionShape declare(const ProblemSetting& setting) {
    FunctionShape shape{.rows = 3, .integral = true, .row_names = {"x", "y", "z"}};
    BlocksRead reads(setting.layout, shape.blocks);
    position_ = reads.add<3>("position");
    ask_within(shape, setting.horizon, spans_, except_);
    return shape;
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    const Eigen::Matrix<T, 3, 1> p = stage(position_);
    const Nearest nearest = nearest_to({value_of(p.x()), value_of(p.y()), value_of(p.z())});
    const Eigen::Vector3d& from = points_[nearest.segment];
    const Eigen::Vector3d way = points_[nearest.segment + 1] - from;
    T share = T(nearest.share);
    if (nearest.share > 0 && nearest.share < 1) {  // off the ends it is a corner that stays
      share = T(0.0);
      for (int i = 0; i < 3; ++i) share += (p(i) - from(i)) * (way(i) / way.squaredNorm());
    }
    for (int i = 0; i < 3; ++i) rows[i] = p(i) - from(i) - share * way(i);
  }

 private:
  struct Nearest {
    std::size_t segment = 0;
    double share = 0;  // of the way along it
  };

  Nearest nearest_to(const Eigen::Vector3d& p) const {
    Nearest best;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k + 1 < points_.size(); ++k) {
      const Eigen::Vector3d way = points_[k + 1] - points_[k], off = p - points_[k];
      const double length = way.squaredNorm();
      const double share = length > 0 ? std::clamp(off.dot(way) / length, 0.0, 1.0) : 0.0;
      const double distance = (off - share * way).squaredNorm();
      if (distance < least) {
        least = distance;
        best = {k, share};
      }
    }
    return best;
  }

  std::vector<Eigen::Vector3d> points_;  // m, world
  VectorHandle position_;
  std::vector<TimeSpan> spans_, except_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::PathDistance)
