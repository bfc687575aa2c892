// SPDX-License-Identifier: Apache-2.0
// Nothing stands between the camera and its target.
//
//   E^o = sum_i h sum_k (haze of obstacle k on the line of sight)^2
//
// Every opaque obstacle of the environment, grown by the margin m, is filled with a haze that thins
// out to nothing at its surface. Its integral along the line of sight is about 1 for a line through
// the middle and zero for one that keeps the margin.
//
// Balls and blocks (Shape::simple_form): (1 - |q|^2)^2 and the product of (1 - q_j^2)^2, q in units
// of the half sizes. Along a line the haze is a polynomial, so that Gauss's rule is exact, and the
// integral is twice differentiable. A little more haze below the middle than above shows a line
// through the very middle the way out.
//
// Other shapes: x^3 with x = (m - d) / unit of the signed distance d, summed at points a fixed way
// apart from the target on. The last ones fade out at the camera, so that the sum is smooth. Where
// d > m + e there is no haze within e, so that most points are passed over.
//
//   p:add_cost { type = "occlusion", margin = 0.5, weight = 10 }
#include "framework/plugin/plugin.h"
#include "framework/problem/camera_error.h"
#include "framework/problem/filmed_point.h"
#include "framework/problem/obstacle_position.h"
#include "framework/problem/time_spans.h"
#include "framework/shape/lifted_distance.h"

namespace lapwing {
namespace {

template <class T>
using Vector = Eigen::Matrix<T, 3, 1>;

// A ball or a block, or any other shape where there is no form.
struct Hiding {
  Obstacle obstacle;
  std::optional<SimpleForm> form;
  double unit = 0;  // m, of other shapes: depth at which the haze is 1
};

template <class T>
T squared_norm(const Vector<T>& v) {
  return v.x() * v.x() + v.y() * v.y() + v.z() * v.z();
}

// From `first` to `last` of the way, 0 to 1, a line runs through an obstacle.
template <class T>
struct Passage {
  T first = T(0.0), last = T(1.0);
  bool empty() const { return value_of(first) >= value_of(last); }
};

// `from` and `along` in units of the half sizes, from the middle.
template <class T>
Passage<T> through_ball(const Vector<T>& from, const Vector<T>& along) {
  using std::max, std::min, std::sqrt;
  Passage<T> passage;
  const T a = squared_norm(along);
  const T b = from.x() * along.x() + from.y() * along.y() + from.z() * along.z();
  const T rest = b * b - a * (squared_norm(from) - 1.0);
  if (value_of(rest) <= 0) return {T(1.0), T(0.0)};
  const T root = sqrt(rest);
  passage.first = max(passage.first, (-b - root) / a);
  passage.last = min(passage.last, (root - b) / a);
  return passage;
}

template <class T>
Passage<T> through_cube(const Vector<T>& from, const Vector<T>& along) {
  using std::abs, std::max, std::min;
  constexpr double kParallel = 1e-12;
  Passage<T> passage;
  for (int i = 0; i < 3; ++i) {
    if (std::abs(value_of(along(i))) < kParallel) {
      if (std::abs(value_of(from(i))) >= 1) return {T(1.0), T(0.0)};
      continue;
    }
    const T one = (1.0 - from(i)) / along(i), other = (-1.0 - from(i)) / along(i);
    passage.first = max(passage.first, min(one, other));
    passage.last = min(passage.last, max(one, other));
  }
  return passage;
}

// Haze at a point in units of the half sizes from the middle; never negative inside.
template <class T>
T haze(const Vector<T>& q, bool round) {
  constexpr double kTilt[] = {0.08, 0.06, -0.17};
  T thickness = T(1.0);
  if (round) {
    thickness = 1.0 - squared_norm(q);
  } else {
    for (int i = 0; i < 3; ++i) thickness = thickness * (1.0 - q(i) * q(i));
  }
  const T tilt = 1.0 + kTilt[0] * q.x() + kTilt[1] * q.y() + kTilt[2] * q.z();
  return thickness * thickness * tilt;
}

class Occlusion final : public DifferentiableCost<Occlusion> {
 public:
  static constexpr PluginText kText{"occlusion", "1.0.0",
                                    "penalises obstacles between the camera and its target", ""};
  static ParameterTable parameters() {
    return FilmedPoint::table(FilmedPoint::Has::place)
        .number("margin", 0.5, "m", "wanted distance of the line of sight from obstacles", above(0))
        .tables("except", time_span_table(), "spans without this cost: cuts");
  }
  explicit Occlusion(const Parameters& parameters)
      : point_(parameters, FilmedPoint::Has::place),
        margin_(parameters.number("margin")),
        except_(time_spans(parameters, "except")) {}

  FunctionShape declare(const ProblemSetting& setting) {
    FunctionShape shape{.blocks = setting.layout.indices({"position"}), .integral = true};
    point_.bind(setting, shape);
    obstacles_.clear();
    bool moving = false;
    for (const Obstacle& obstacle : setting.environment.obstacles) {
      if (!obstacle.opaque || obstacle.side == Side::keep_inside) continue;
      if (!obstacle.shape)
        throw InputError("obstacle '" + obstacle.name + "' has no shape that was opened");
      obstacles_.push_back({obstacle, obstacle.shape->simple_form(), unit_of(*obstacle.shape)});
      shape.row_names.push_back(obstacle.name.empty()
                                    ? obstacle.type + " " + std::to_string(obstacles_.size())
                                    : obstacle.name);
      moving |= !obstacle.still();
    }
    if (moving) {
      time_ = static_cast<int>(shape.blocks.size());
      shape.blocks.push_back(setting.layout.index("time"));
    }
    shape.rows = static_cast<int>(obstacles_.size());
    ask_within(shape, setting.horizon, {}, except_);
    return shape;
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    const Vector<T> from = stage.template vector<3>(0), to = point_.at(stage);
    for (std::size_t k = 0; k < obstacles_.size(); ++k) {
      const Hiding& hiding = obstacles_[k];
      Vector<T> moved(T(0.0), T(0.0), T(0.0));
      if (!hiding.obstacle.still()) moved = obstacle_moved<T>(hiding.obstacle, stage.scalar(time_));
      const Vector<T> camera = from - moved, target = to - moved;
      rows[static_cast<int>(k)] =
          hiding.form ? hidden(*hiding.form, camera, target) : hidden_by(hiding, camera, target);
    }
  }

 private:
  // The least half size of a solid, grown by the margin: there the haze is 1 at most.
  double unit_of(const Shape& shape) const {
    if (!shape.solid()) return margin_;
    const double least = shape.bounds().sizes().minCoeff() / 2;
    return margin_ + (std::isfinite(least) ? least : 0.0);
  }

  // x^3 from 0 on, and beyond 1 as its Taylor polynomial of second degree.
  template <class T>
  static T haze_at(const T& x) {
    if (value_of(x) <= 0) return T(0.0);
    if (value_of(x) <= 1) return x * x * x;
    const T more = x - 1.0;
    return 1.0 + 3.0 * more + 3.0 * more * more;
  }

  // 0 at 0, 1 from 1 on, twice differentiable.
  template <class T>
  static T rising(const T& share) {
    if (value_of(share) <= 0) return T(0.0);
    if (value_of(share) >= 1) return T(1.0);
    return share * share * share * (10.0 + share * (-15.0 + 6.0 * share));
  }

  template <class T>
  T hidden_by(const Hiding& hiding, const Vector<T>& from, const Vector<T>& to) const {
    using std::sqrt;
    constexpr double kCoincident = 1e-12;  // m^2
    const Shape& shape = *hiding.obstacle.shape;
    const Vector<T> way = from - to;
    const T squared = squared_norm(way);
    if (value_of(squared) < kCoincident) return T(0.0);
    const T at_target = lifted_distance(shape, to.data());
    if (value_of(at_target) <= 0) return T(0.0);
    const T clear = at_target * (1.0 / margin_);
    const T seen = rising(T(clear * clear));
    const T length = sqrt(squared);
    // Where the haze is wide it needs no more points than it has to be told by.
    const double spacing = std::max(margin_ / 2, hiding.unit / 8), whole = value_of(length);
    T sum = T(0.0);
    for (double at = spacing; at < whole;) {
      Vector<T> p;
      for (int i = 0; i < 3; ++i) p(i) = to(i) + way(i) * (at / length);
      const Eigen::Vector3d place(value_of(p(0)), value_of(p(1)), value_of(p(2)));
      const double away = shape.distance(place, nullptr);
      if (away < margin_) {
        const T depth = (margin_ - lifted_distance(shape, p.data())) * (1.0 / hiding.unit);
        sum += haze_at(depth) * rising(T((length - at) * (1.0 / (4 * spacing))));
      }
      at += spacing * (away > margin_ ? std::floor((away - margin_) / spacing) + 1 : 1);
    }
    return near_fade(squared) * seen * sum * (spacing / hiding.unit);
  }

  template <class T>
  T hidden(const SimpleForm& obstacle, const Vector<T>& from, const Vector<T>& to) const {
    using std::sqrt;
    constexpr double kCoincident = 1e-12;  // m^2
    // Gauss's rule of seven points on -1 to 1: exact up to degree 13, that of a box's haze.
    static constexpr double kNodes[] = {
        -0.9491079123427585, -0.7415311855993945, -0.4058451513773972, 0.0,
        0.4058451513773972,  0.7415311855993945,  0.9491079123427585};
    static constexpr double kWeights[] = {
        0.1294849661688697, 0.2797053914892766, 0.3818300505051189, 0.4179591836734694,
        0.3818300505051189, 0.2797053914892766, 0.1294849661688697};
    const Vector<T> way = to - from;
    const T length = squared_norm(way);
    if (value_of(length) < kCoincident) return T(0.0);
    Vector<T> start, along;
    for (int i = 0; i < 3; ++i) {
      const double half = obstacle.half(i) + margin_;
      start(i) = (from(i) - obstacle.center(i)) * (1.0 / half);
      along(i) = way(i) * (1.0 / half);
    }
    const Passage<T> passage =
        obstacle.round ? through_ball(start, along) : through_cube(start, along);
    if (passage.empty()) return T(0.0);
    const T seen = clear_of(obstacle, to);
    if (value_of(seen) == 0) return T(0.0);
    const T middle = 0.5 * (passage.first + passage.last);
    const T half_way = 0.5 * (passage.last - passage.first);
    T sum = T(0.0);
    for (int g = 0; g < 7; ++g) {
      const T share = middle + kNodes[g] * half_way;
      const Vector<T> q(start.x() + share * along.x(), start.y() + share * along.y(),
                        start.z() + share * along.z());
      sum += kWeights[g] * haze(q, obstacle.round);
    }
    const double unit = obstacle.half.minCoeff() + margin_;
    return near_fade(length) * seen * sum * half_way * sqrt(length) * (1.0 / unit);
  }

  // What the target stands in or touches is not in its way: 0 there, 1 a margin outside.
  template <class T>
  T clear_of(const SimpleForm& obstacle, const Vector<T>& target) const {
    using std::abs, std::sqrt;
    T squared = T(0.0);
    if (obstacle.round) {
      const Vector<T> away = target - obstacle.center.template cast<T>();
      const T distance = squared_norm(away);
      if (value_of(distance) <= obstacle.half.x() * obstacle.half.x()) return T(0.0);
      const T outside = sqrt(distance) - obstacle.half.x();
      squared = outside * outside;
    } else {
      for (int i = 0; i < 3; ++i) {
        const T outside = abs(target(i) - obstacle.center(i)) - obstacle.half(i);
        if (value_of(outside) > 0) squared += outside * outside;
      }
    }
    const T share = squared * (1.0 / (margin_ * margin_));
    return rising(share);
  }

  FilmedPoint point_;
  double margin_;
  std::vector<TimeSpan> except_;
  std::vector<Hiding> obstacles_;
  int time_ = 0;  // of its block in the shape
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Occlusion)
