// SPDX-License-Identifier: Apache-2.0
#include "framework/geometry/shape_hits.h"

#include <cmath>

namespace lapwing {
namespace {

using Eigen::Vector3d;
using Found = std::optional<SurfaceHit>;

Found facing(double distance, const Vector3d& normal, const Ray& ray) {
  if (!(distance > kNearestHit)) return std::nullopt;
  return SurfaceHit{distance, normal.dot(ray.direction) > 0 ? Vector3d(-normal) : normal};
}

Found hit(const BallShape& ball, const Ray& ray) {
  const Vector3d to_center = ball.center - ray.origin;
  const double along = to_center.dot(ray.direction);
  const Vector3d aside = to_center - along * ray.direction;
  const double half2 = ball.radius * ball.radius - aside.squaredNorm();
  if (half2 < 0) return std::nullopt;
  const double half = std::sqrt(half2);
  const double distance = along - half > kNearestHit ? along - half : along + half;
  const Vector3d normal = (ray.origin + distance * ray.direction - ball.center) / ball.radius;
  return facing(distance, normal, ray);
}

Found hit(const BlockShape& block, const Ray& ray) {
  double enter = -std::numeric_limits<double>::infinity(), leave = -enter;
  int enter_axis = 0, leave_axis = 0;
  for (int i = 0; i < 3; ++i) {
    const double o = ray.origin[i], d = ray.direction[i];
    if (d == 0) {
      if (o < block.lower[i] || o > block.upper[i]) return std::nullopt;
      continue;
    }
    const double a = (block.lower[i] - o) / d, b = (block.upper[i] - o) / d;
    if (std::min(a, b) > enter) enter = std::min(a, b), enter_axis = i;
    if (std::max(a, b) < leave) leave = std::max(a, b), leave_axis = i;
  }
  if (enter > leave) return std::nullopt;
  const bool outside = enter > kNearestHit;
  return facing(outside ? enter : leave, Vector3d::Unit(outside ? enter_axis : leave_axis), ray);
}

Found hit(const BoardShape& board, const Ray& ray) {
  const Vector3d normal = board.half_across.cross(board.half_up).normalized();
  const double towards = normal.dot(ray.direction);
  if (towards == 0) return std::nullopt;
  const double distance = normal.dot(board.center - ray.origin) / towards;
  const Vector3d p = ray.origin + distance * ray.direction - board.center;
  if (std::abs(p.dot(board.half_across)) > board.half_across.squaredNorm()) return std::nullopt;
  if (std::abs(p.dot(board.half_up)) > board.half_up.squaredNorm()) return std::nullopt;
  return facing(distance, normal, ray);
}

Found hit(const UprightCylinderShape& cylinder, const Ray& ray) {
  const Vector3d p = ray.origin - cylinder.middle;
  const Vector3d& d = ray.direction;
  // The span of the ray between the two caps, and that within the endless tube.
  constexpr double infinity = std::numeric_limits<double>::infinity();
  double enter = -infinity, leave = infinity;
  bool enter_cap = true, leave_cap = true;
  const double half = cylinder.height / 2, radius = cylinder.width / 2;
  if (d.z() == 0) {
    if (std::abs(p.z()) > half) return std::nullopt;
  } else {
    enter = (-std::copysign(half, d.z()) - p.z()) / d.z();
    leave = (std::copysign(half, d.z()) - p.z()) / d.z();
  }
  const double a = d.head<2>().squaredNorm(), b = p.head<2>().dot(d.head<2>());
  const double c = p.head<2>().squaredNorm() - radius * radius;
  if (a == 0) {
    if (c > 0) return std::nullopt;
  } else {
    const double root2 = b * b - a * c;
    if (root2 < 0) return std::nullopt;
    const double root = std::sqrt(root2);
    if ((-b - root) / a > enter) enter = (-b - root) / a, enter_cap = false;
    if ((-b + root) / a < leave) leave = (-b + root) / a, leave_cap = false;
  }
  if (enter > leave) return std::nullopt;
  const bool outside = enter > kNearestHit;
  const double distance = outside ? enter : leave;
  if (outside ? enter_cap : leave_cap) return facing(distance, Vector3d::UnitZ(), ray);
  Vector3d normal = p + distance * d;
  normal.z() = 0;
  return facing(distance, normal / radius, ray);
}

Found hit(const GroundShape& ground, const Ray& ray) {
  if (ray.direction.z() == 0) return std::nullopt;
  const double distance = (ground.height - ray.origin.z()) / ray.direction.z();
  return facing(distance, Vector3d::UnitZ(), ray);
}

Found hit(const TracedShape& traced, const Ray& ray) {
  return traced.body->hit(ray.origin, ray.direction);
}

BlockShape bounds(const BallShape& ball) {
  const Vector3d reach = Vector3d::Constant(ball.radius);
  return {ball.center - reach, ball.center + reach};
}
BlockShape bounds(const BlockShape& block) {
  return block;
}
BlockShape bounds(const BoardShape& board) {
  const Vector3d reach = board.half_across.cwiseAbs() + board.half_up.cwiseAbs();
  return {board.center - reach, board.center + reach};
}
BlockShape bounds(const UprightCylinderShape& cylinder) {
  const Vector3d reach = Vector3d(cylinder.width, cylinder.width, cylinder.height) / 2;
  return {cylinder.middle - reach, cylinder.middle + reach};
}
BlockShape bounds(const GroundShape& ground) {
  return {{-kLargestCoordinate, -kLargestCoordinate, ground.height},
          {kLargestCoordinate, kLargestCoordinate, ground.height}};
}

BlockShape bounds(const TracedShape& traced) {
  const Vector3d far = Vector3d::Constant(kLargestCoordinate);
  const Eigen::AlignedBox3d box =
      traced.body ? traced.body->bounds().intersection({-far, far}) : Eigen::AlignedBox3d();
  if (box.isEmpty()) return {Vector3d::Zero(), Vector3d::Zero()};
  return {box.min(), box.max()};
}

const char* extent_problem(const BallShape& ball) {
  return ball.radius > 0 ? "" : "a ball needs a radius above 0";
}
const char* extent_problem(const BlockShape& block) {
  return (block.lower.array() < block.upper.array()).all()
             ? ""
             : "a block needs its lower corner below its upper one";
}
const char* extent_problem(const BoardShape& board) {
  const double across = board.half_across.norm(), up = board.half_up.norm();
  return across > 0 && up > 0 &&
                 std::abs(board.half_across.dot(board.half_up)) <= 1e-9 * across * up
             ? ""
             : "a board needs two half edges at right angles";
}
const char* extent_problem(const UprightCylinderShape& cylinder) {
  return cylinder.height > 0 && cylinder.width > 0
             ? ""
             : "a cylinder needs a height and a width above 0";
}
const char* extent_problem(const GroundShape&) {
  return "";
}

const char* extent_problem(const TracedShape& traced) {
  const BlockShape box = bounds(traced);
  return traced.body && (box.lower.array() < box.upper.array()).any()
             ? ""
             : "a traced shape needs a body that is nearer than 1e5 m";
}

}  // namespace

std::optional<SurfaceHit> hit(const BodyShape& shape, const Ray& ray) {
  return std::visit([&](const auto& s) { return hit(s, ray); }, shape);
}

BlockShape bounds_of(const BodyShape& shape) {
  return std::visit([](const auto& s) { return bounds(s); }, shape);
}

const char* problem_of(const BodyShape& shape) {
  const BlockShape box = bounds_of(shape);
  // Written so that a NaN is a problem too.
  if (!((box.lower.array() >= -kLargestCoordinate).all() &&
        (box.upper.array() <= kLargestCoordinate).all())) {
    return "a coordinate is not finite or beyond 1e5 m";
  }
  return std::visit([](const auto& s) { return extent_problem(s); }, shape);
}

}  // namespace lapwing
