// SPDX-License-Identifier: Apache-2.0
// Shapes whose distance has a closed form: sphere, box, prism, capsule, cone, half space.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "framework/geometry/polygon.h"
#include "framework/verify/judged_shape.h"
#include "framework/verify/tolerances.h"

namespace lapwing {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kNoEnd = std::numeric_limits<double>::infinity();

Vector3d point_of(const Value& parameters, std::string_view key) {
  const auto numbers = recorded_numbers(parameters, key);
  return numbers.size() == 3 ? Vector3d(numbers.data()) : Vector3d::Constant(std::nan(""));
}

double number_of(const Value& parameters, std::string_view key, double absent = std::nan("")) {
  const Value* found = parameters.is_map() ? parameters.find(key) : nullptr;
  if (!found) return absent;
  return found->is_number() ? found->as_number() : std::nan("");
}

bool in_range(double number) {
  return std::abs(number) <= tolerances::kLargestNumber;
}
bool in_range(const Vector3d& v) {
  return in_range(v.x()) && in_range(v.y()) && in_range(v.z());
}

// A convex set of which the way to it says all: the way from a to b is hidden where its middle part
// comes inside.
class ConvexForm : public JudgedShape {
 public:
  bool convex() const final { return true; }
  bool hides(const Vector3d& camera, const Vector3d& middle, double) const override {
    if (distance(middle, 0) < 0) return false;
    // The distance along the way is convex: its least value by golden sections.
    constexpr double kGolden = 0.6180339887498949, kInside = 1e-9;
    const auto at = [&](double s) { return distance(camera + s * (middle - camera), 0); };
    double low = 0, high = 1, a = 1 - kGolden, b = kGolden, value_a = at(a), value_b = at(b);
    for (int i = 0; i < 60 && std::min(value_a, value_b) >= -kInside; ++i) {
      if (value_a < value_b) {
        high = b, b = a, value_b = value_a;
        a = high - kGolden * (high - low), value_a = at(a);
      } else {
        low = a, a = b, value_a = value_b;
        b = low + kGolden * (high - low), value_b = at(b);
      }
    }
    return std::min({value_a, value_b, at(0)}) < -kInside;
  }
};

class JudgedSphere final : public ConvexForm {
 public:
  explicit JudgedSphere(const Value& given)
      : center_(point_of(given, "center")), radius_(number_of(given, "radius")) {}
  static std::string problem(const Value& given) {
    const double radius = number_of(given, "radius");
    return in_range(point_of(given, "center")) && radius > 0 && in_range(radius)
               ? ""
               : " must have a centre and a radius above 0";
  }
  double distance(const Vector3d& p, double) const override {
    return (p - center_).norm() - radius_;
  }
  bool hides(const Vector3d& a, const Vector3d& b, double) const override {
    return !crossed(b, b) && crossed(a, b);
  }

 private:
  bool crossed(const Vector3d& a, const Vector3d& b) const {
    const Vector3d d = b - a;
    const double length2 = d.squaredNorm();
    const double s = length2 > 0 ? std::clamp((center_ - a).dot(d) / length2, 0.0, 1.0) : 0;
    return (a + s * d - center_).norm() < radius_;
  }
  Vector3d center_;
  double radius_;
};

class JudgedBox final : public ConvexForm {
 public:
  explicit JudgedBox(const Value& given)
      : lower_(point_of(given, "lower")), upper_(point_of(given, "upper")) {}
  static std::string problem(const Value& given) {
    const Vector3d lower = point_of(given, "lower"), upper = point_of(given, "upper");
    return in_range(lower) && in_range(upper) && (lower.array() < upper.array()).all()
               ? ""
               : " must have its lower corner below its upper one";
  }
  double distance(const Vector3d& p, double) const override {
    const Vector3d beyond = (lower_ - p).cwiseMax(p - upper_);
    const double deepest = beyond.maxCoeff();
    return deepest <= 0 ? deepest : beyond.cwiseMax(0.0).norm();
  }
  bool hides(const Vector3d& a, const Vector3d& b, double) const override {
    return !crossed(b, b) && crossed(a, b);
  }

 private:
  bool crossed(const Vector3d& a, const Vector3d& b) const {
    double enter = 0, leave = 1;
    for (int i = 0; i < 3; ++i) {
      const double d = b[i] - a[i];
      if (d == 0) {
        if (a[i] <= lower_[i] || a[i] >= upper_[i]) return false;
        continue;
      }
      const double s = (lower_[i] - a[i]) / d, t = (upper_[i] - a[i]) / d;
      enter = std::max(enter, std::min(s, t));
      leave = std::min(leave, std::max(s, t));
    }
    return enter < leave;
  }
  Vector3d lower_, upper_;
};

// Above a polygon on the ground, between two heights.
class JudgedPrism final : public JudgedShape {
 public:
  explicit JudgedPrism(const Value& given)
      : corners_(corners_of(given)),
        floor_(number_of(given, "floor", -kNoEnd)),
        ceiling_(number_of(given, "ceiling", kNoEnd)) {}

  static std::string problem(const Value& given) {
    const std::vector<Vector2d> corners = corners_of(given);
    if (corners.size() < 3) return " must have at least three corners";
    if (corners.size() > tolerances::kMostCorners)
      return " must have at most " + std::to_string(tolerances::kMostCorners) + " corners";
    for (const Vector2d& corner : corners)
      if (!in_range(corner.x()) || !in_range(corner.y()))
        return " has a corner that is not finite or beyond 1e7";
    if (!is_simple_polygon(corners))
      return " has edges that cross or touch, or corners that coincide";
    const double floor = number_of(given, "floor", -kNoEnd);
    const double ceiling = number_of(given, "ceiling", kNoEnd);
    if (!(in_range(floor) || floor == -kNoEnd) || !(in_range(ceiling) || ceiling == kNoEnd) ||
        !(floor < ceiling))
      return " must have its floor below its ceiling";
    return "";
  }

  double distance(const Vector3d& p, double) const override {
    const double across = to_polygon(p.head<2>());
    const double up = std::max(floor_ - p.z(), p.z() - ceiling_);
    if (across <= 0 && up <= 0) return std::max(across, up);
    return std::hypot(std::max(across, 0.0), std::max(up, 0.0));
  }

  bool hides(const Vector3d& a, const Vector3d& b, double) const override {
    return !holds(b) && crossed(a, b);
  }

 private:
  static std::vector<Vector2d> corners_of(const Value& given) {
    const auto numbers = recorded_numbers(given, "corners");
    std::vector<Vector2d> corners;
    for (std::size_t i = 0; i + 1 < numbers.size(); i += 2)
      corners.emplace_back(numbers[i], numbers[i + 1]);
    return corners;
  }

  // From the edges of a polygon that does not cross itself.
  double to_polygon(const Vector2d& p) const {
    double nearest2 = kNoEnd;
    bool inside = false;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const Vector2d& a = corners_[i];
      const Vector2d& b = corners_[i + 1 < corners_.size() ? i + 1 : 0];
      const Vector2d edge = b - a, to_p = p - a;
      const double share = std::clamp(to_p.dot(edge) / edge.squaredNorm(), 0.0, 1.0);
      nearest2 = std::min(nearest2, (to_p - share * edge).squaredNorm());
      // Each edge that a ray from p towards +x crosses turns outside into inside.
      if ((a.y() > p.y()) == (b.y() > p.y())) continue;
      const double side = edge.x() * to_p.y() - edge.y() * to_p.x();
      if ((side > 0) == (edge.y() > 0)) inside = !inside;
    }
    return inside ? -std::sqrt(nearest2) : std::sqrt(nearest2);
  }

  // Whether a point lies inside and not on the surface: within the polygon, by the even-odd rule,
  // and within the heights.
  bool holds(const Vector3d& p) const {
    if (!(floor_ < p.z() && p.z() < ceiling_)) return false;
    bool inside = false;
    for (std::size_t i = 0, j = corners_.size() - 1; i < corners_.size(); j = i++) {
      const Vector2d &a = corners_[j], &b = corners_[i];
      const double side = (b - a).x() * (p.y() - a.y()) - (b - a).y() * (p.x() - a.x());
      if (side == 0 && (p.head<2>() - a).dot(p.head<2>() - b) <= 0) return false;  // on the edge
      if ((a.y() > p.y()) == (b.y() > p.y())) continue;
      if ((side > 0) == (b.y() > a.y())) inside = !inside;
    }
    return inside;
  }

  // The way is cut where it crosses the floor, the ceiling or the line through an edge; the middle
  // of each part says whether it lies inside.
  bool crossed(const Vector3d& a, const Vector3d& b) const {
    const Vector3d way = b - a;
    std::vector<double> cuts{0, 1};
    const auto cut = [&](double share) {
      if (share > 0 && share < 1) cuts.push_back(share);
    };
    for (const double height : {floor_, ceiling_})
      if (way.z() != 0) cut((height - a.z()) / way.z());
    for (std::size_t i = 0, j = corners_.size() - 1; i < corners_.size(); j = i++) {
      const Vector2d edge = corners_[i] - corners_[j];
      const Vector2d to_edge = corners_[j] - a.head<2>();
      const double turn = way.x() * edge.y() - way.y() * edge.x();
      if (turn != 0) cut((to_edge.x() * edge.y() - to_edge.y() * edge.x()) / turn);
    }
    std::sort(cuts.begin(), cuts.end());
    for (std::size_t k = 1; k < cuts.size(); ++k)
      if (holds(a + 0.5 * (cuts[k - 1] + cuts[k]) * way)) return true;
    return false;
  }

  std::vector<Vector2d> corners_;
  double floor_, ceiling_;
};

// All points within a radius of a line between two points.
class JudgedCapsule final : public ConvexForm {
 public:
  explicit JudgedCapsule(const Value& given)
      : from_(point_of(given, "from")),
        to_(point_of(given, "to")),
        radius_(number_of(given, "radius")) {}
  static std::string problem(const Value& given) {
    const double radius = number_of(given, "radius");
    return in_range(point_of(given, "from")) && in_range(point_of(given, "to")) && radius > 0 &&
                   in_range(radius)
               ? ""
               : " must have two ends and a radius above 0";
  }
  double distance(const Vector3d& p, double) const override {
    const Vector3d axis = to_ - from_;
    const double length2 = axis.squaredNorm();
    const double s = length2 > 0 ? std::clamp((p - from_).dot(axis) / length2, 0.0, 1.0) : 0;
    return (p - from_ - s * axis).norm() - radius_;
  }

 private:
  Vector3d from_, to_;
  double radius_;
};

// Upright, from the middle of its base up to its tip: a triangle that is turned about its height.
class JudgedCone final : public ConvexForm {
 public:
  explicit JudgedCone(const Value& given)
      : base_(point_of(given, "base")),
        radius_(number_of(given, "radius")),
        height_(number_of(given, "height")) {}
  static std::string problem(const Value& given) {
    const double radius = number_of(given, "radius"), height = number_of(given, "height");
    return in_range(point_of(given, "base")) && radius > 0 && in_range(radius) && height > 0 &&
                   in_range(height)
               ? ""
               : " must have a base, a radius above 0 and a height above 0";
  }
  double distance(const Vector3d& p, double) const override {
    // In the half plane through the axis and p: across and up from the middle of the base.
    const Vector2d q(std::hypot(p.x() - base_.x(), p.y() - base_.y()), p.z() - base_.z());
    const Vector2d rim(radius_, 0), tip(0, height_), slope = tip - rim;
    const double along = std::clamp((q - rim).dot(slope) / slope.squaredNorm(), 0.0, 1.0);
    const double side = (q - rim - along * slope).norm();
    const double bottom = Vector2d(std::max(q.x() - radius_, 0.0), q.y()).norm();
    const double nearest = std::min(side, bottom);
    const bool inside = q.y() > 0 && (q - rim).dot(Vector2d(height_, radius_)) < 0;
    return inside ? -nearest : nearest;
  }

 private:
  Vector3d base_;
  double radius_, height_;
};

// All points behind a plane.
class JudgedHalfSpace final : public ConvexForm {
 public:
  explicit JudgedHalfSpace(const Value& given)
      : point_(point_of(given, "point")), normal_(point_of(given, "normal").normalized()) {}
  static std::string problem(const Value& given) {
    const Vector3d normal = point_of(given, "normal");
    return in_range(point_of(given, "point")) && in_range(normal) && normal.norm() > 1e-9
               ? ""
               : " must have a point and a normal that is not zero";
  }
  double distance(const Vector3d& p, double) const override { return normal_.dot(p - point_); }

 private:
  Vector3d point_, normal_;
};

struct Form {
  std::string (*problem)(const Value&);
  std::unique_ptr<JudgedShape> (*make)(const Value&);
};

template <class Judged>
Form form() {
  return {&Judged::problem, [](const Value& given) -> std::unique_ptr<JudgedShape> {
            return std::make_unique<Judged>(given);
          }};
}

const Form* form_of(std::string_view type) {
  static const std::map<std::string, Form, std::less<>> all{
      {"sphere", form<JudgedSphere>()}, {"box", form<JudgedBox>()},
      {"prism", form<JudgedPrism>()},   {"capsule", form<JudgedCapsule>()},
      {"cone", form<JudgedCone>()},     {"half_space", form<JudgedHalfSpace>()}};
  const auto found = all.find(type);
  return found == all.end() ? nullptr : &found->second;
}

std::string problem_of_track(const Obstacle& obstacle) {
  if (obstacle.times.size() != obstacle.moves.size())
    return " has " + std::to_string(obstacle.times.size()) + " times and " +
           std::to_string(obstacle.moves.size()) + " moves";
  for (std::size_t i = 0; i < obstacle.times.size(); ++i) {
    if (!in_range(obstacle.times[i]) || !in_range(obstacle.moves[i]))
      return " moves by a number that is not finite or beyond 1e7";
    if (i > 0 && !(obstacle.times[i] > obstacle.times[i - 1]))
      return " has times that do not increase";
  }
  return "";
}

std::string problem_of_file(const Obstacle& obstacle) {
  const Value* stated = obstacle.parameters.find("file");
  const std::filesystem::path file = stated && stated->is_text() ? stated->as_text() : "";
  const bool up = std::find(file.begin(), file.end(), "..") != file.end();
  if (file.empty() || file.is_absolute() || up) return " must name a file below the plan's folder";
  return "";
}

std::string problem_of_triangles(const Obstacle& obstacle) {
  if (!obstacle.triangles)
    return " has a type whose distance this verifier cannot compute, and the plan records no "
           "triangles of it";
  if (!(obstacle.tolerance >= 0) || !in_range(obstacle.tolerance))
    return " must have triangles with a tolerance of at least 0";
  try {
    check_mesh(*obstacle.triangles, "triangles");
  } catch (const std::exception& error) {
    return std::string(": ") + error.what();
  }
  return open_edges(*obstacle.triangles);
}

}  // namespace

bool judged_by_itself(std::string_view type) {
  return form_of(type) || type == "mesh" || type == "map";
}

std::string problem_of(const Obstacle& obstacle) {
  std::string problem = problem_of_track(obstacle);
  if (!problem.empty()) return problem;
  if (const Form* form = form_of(obstacle.type)) return form->problem(obstacle.parameters);
  if (obstacle.type != "mesh" && obstacle.type != "map") return problem_of_triangles(obstacle);
  if (obstacle.side == Side::keep_inside) return " has no inside that a flight could stay in";
  return problem_of_file(obstacle);
}

std::unique_ptr<JudgedShape> judged_form(const Obstacle& obstacle) {
  const Form* form = form_of(obstacle.type);
  return form ? form->make(obstacle.parameters) : nullptr;
}

}  // namespace lapwing
