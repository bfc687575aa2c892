// SPDX-License-Identifier: Apache-2.0
// Keeps the path out of every obstacle of the environment, and inside of every one that it is not
// to leave, the margin away, along the whole path and not at the stages alone
// (problem/path_clearance.h).
//
//   out of:     c(p_i) - sqrt((r + margin + a h^2/8)^2 + L_i^2/4) >= 0,   L_i = |v_i| h + a h^2/2
//   inside of: -d(p_i) - sqrt((margin + a h^2/8)^2 + L_i^2/4) >= 0
//              -d(p_i) - margin - a h^2/8 >= 0            convex shapes: chords stay inside
//
// c: the distance from the core of the shape, of which the shape is all within r; d = c - r.
//
//   p:add_constraint { type = "obstacle" }
#include "framework/plugin/plugin.h"
#include "framework/problem/differentiable.h"
#include "framework/problem/obstacle_position.h"
#include "framework/problem/path_clearance.h"
#include "framework/shape/lifted_distance.h"

namespace lapwing {
namespace {

class ObstacleConstraint final : public DifferentiableConstraint<ObstacleConstraint, 7> {
 public:
  static constexpr PluginText kText{"obstacle", "1.0.0",
                                    "the path stays outside obstacles and inside flight zones",
                                    "thesis 3.6, obstacle avoidance"};
  static ParameterTable parameters() { return {}; }
  explicit ObstacleConstraint(const Parameters&) {}

  FunctionShape declare(const ProblemSetting& setting) {
    margin_ = setting.environment.margin;
    clearance_ = PathClearance(setting.vehicle);
    bodies_.clear();
    FunctionShape shape{.blocks = setting.layout.indices({"position", "velocity", "step"})};
    bool moving = false;
    for (const Obstacle& obstacle : setting.environment.obstacles) {
      const std::string number = std::to_string(bodies_.size() + 1);
      if (!obstacle.shape)
        throw InputError("obstacle '" + (obstacle.name.empty() ? number : obstacle.name) +
                         "' has no distances: its shape was not opened");
      bodies_.push_back({obstacle, obstacle.shape->convex(), obstacle.speed()});
      shape.row_names.push_back(obstacle.name.empty() ? number : obstacle.name);
      moving |= !obstacle.still();
    }
    if (moving) shape.blocks.push_back(setting.layout.index("time"));
    shape.rows = static_cast<int>(bodies_.size());
    return shape;
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    const Eigen::Matrix<T, 3, 1> position = stage.template vector<3>(0);
    const Eigen::Matrix<T, 3, 1> velocity = stage.template vector<3>(1);
    const PathReach<T> still = clearance_.around<T>(velocity, stage.scalar(2));
    const T plain = still.asked(margin_);  // what most rows ask for
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      const Body& body = bodies_[k];
      T& row = rows[static_cast<int>(k)];
      if (body.obstacle.still()) {
        row = free_way(body, position, still, plain);
        continue;
      }
      const Eigen::Matrix<T, 3, 1> seen =
          position - obstacle_moved<T>(body.obstacle, stage.scalar(3));
      const PathReach<T> reach = clearance_.around<T>(velocity, stage.scalar(2), body.speed);
      row = free_way(body, seen, reach, reach.asked(margin_));
    }
  }

  void bounds(InstanceRange range, double* lower, double* upper) const override {
    std::fill_n(lower, range.count * bodies_.size(), 0.0);
    std::fill_n(upper, range.count * bodies_.size(), std::numeric_limits<double>::infinity());
  }

 private:
  struct Body {
    Obstacle obstacle;
    bool convex;
    double speed;  // m/s, at most
  };

  // What there is beyond what is asked for; `plain` for a shape that is its own core.
  template <class T>
  T free_way(const Body& body, const Eigen::Matrix<T, 3, 1>& p, const PathReach<T>& reach,
             const T& plain) const {
    const Shape& shape = *body.obstacle.shape;
    const double tolerance = body.obstacle.tolerance;
    if (body.obstacle.side == Side::keep_out) {
      const double grown = shape.rounding() + tolerance;
      return lifted_core_distance(shape, p.data()) -
             (grown > 0 ? reach.asked(grown + margin_) : plain);
    }
    const T inside = -lifted_distance(shape, p.data());
    if (body.convex) return inside - reach.bulge - (margin_ + tolerance);
    return inside - (tolerance > 0 ? reach.asked(margin_ + tolerance) : plain);
  }

  std::vector<Body> bodies_;
  double margin_ = 0;
  PathClearance clearance_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::ObstacleConstraint)
