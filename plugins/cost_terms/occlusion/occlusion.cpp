// SPDX-License-Identifier: Apache-2.0
// Nothing stands between the camera and its target.
//
//   E^o = sum_i h sum_k (haze of obstacle k on the line of sight)^2
//
// Every sphere and box of the environment, grown by the margin, is filled with a haze that is thick
// in the middle and thins out to nothing at its surface: (1 - |q|^2)^2 for a sphere, the product of
// (1 - q_j^2)^2 for a box, q in units of the half sizes. Its integral along the line of sight, in
// units of the smallest half size, is about 1 for a line through the middle and zero for one that
// keeps the margin. Along a line the haze is a polynomial, so that Gauss's rule is exact, and the
// integral is twice differentiable. A little more haze below the middle than above shows a line
// through the very middle the way out.
//
//   p:add_cost { type = "occlusion", margin = 0.5, weight = 10 }
#include "framework/plugin/plugin.h"
#include "framework/problem/camera_error.h"
#include "framework/problem/filmed_point.h"
#include "framework/problem/time_spans.h"

namespace lapwing {
namespace {

template <class T>
using Vector = Eigen::Matrix<T, 3, 1>;

// Sphere or box around `center`.
struct Obstacle {
  Eigen::Vector3d center, half;  // m; of a sphere, the radius three times
  bool round = false;
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
    const auto add = [&](const std::string& name, const char* kind, const Obstacle& obstacle) {
      obstacles_.push_back(obstacle);
      shape.row_names.push_back(name.empty() ? kind + std::to_string(obstacles_.size()) : name);
    };
    for (const Sphere& sphere : setting.environment.spheres)
      add(sphere.name, "sphere ", {sphere.center, Eigen::Vector3d::Constant(sphere.radius), true});
    for (const Box& box : setting.environment.boxes)
      add(box.name, "box ", {0.5 * (box.lower + box.upper), 0.5 * (box.upper - box.lower)});
    shape.rows = static_cast<int>(obstacles_.size());
    ask_within(shape, setting.horizon, {}, except_);
    return shape;
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    const Vector<T> from = stage.template vector<3>(0), to = point_.at(stage);
    for (std::size_t k = 0; k < obstacles_.size(); ++k)
      rows[static_cast<int>(k)] = hidden(obstacles_[k], from, to);
  }

 private:
  template <class T>
  T hidden(const Obstacle& obstacle, const Vector<T>& from, const Vector<T>& to) const {
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
  T clear_of(const Obstacle& obstacle, const Vector<T>& target) const {
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
    if (value_of(share) >= 1) return T(1.0);
    return share * share * share * (10.0 + share * (-15.0 + 6.0 * share));
  }

  FilmedPoint point_;
  double margin_;
  std::vector<TimeSpan> except_;
  std::vector<Obstacle> obstacles_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Occlusion)
