// SPDX-License-Identifier: Apache-2.0
#include "framework/trajectory/environment.h"

#include <algorithm>

namespace lapwing {
namespace {

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

bool within(double x, double a, double b) {
  return std::min(a, b) <= x && x <= std::max(a, b);
}

// Whether p, which lies on the line through a and b, lies between them.
bool between(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return within(p.x(), a.x(), b.x()) && within(p.y(), a.y(), b.y());
}

// Whether two segments have a point in common.
bool meet(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
          const Eigen::Vector2d& d) {
  const double a_side = cross(d - c, a - c), b_side = cross(d - c, b - c);
  const double c_side = cross(b - a, c - a), d_side = cross(b - a, d - a);
  if (((a_side > 0) != (b_side > 0) && a_side != 0 && b_side != 0) &&
      ((c_side > 0) != (d_side > 0) && c_side != 0 && d_side != 0)) {
    return true;
  }
  return (a_side == 0 && between(a, c, d)) || (b_side == 0 && between(b, c, d)) ||
         (c_side == 0 && between(c, a, b)) || (d_side == 0 && between(d, a, b));
}

// Distance from the edges of a polygon, negative inside by the even-odd rule.
double polygon_distance(const std::vector<Eigen::Vector2d>& corners, const Eigen::Vector2d& p) {
  double nearest = std::numeric_limits<double>::infinity();
  bool inside = false;
  for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
    const Eigen::Vector2d &a = corners[j], &b = corners[i];
    const Eigen::Vector2d edge = b - a;
    const double length = edge.squaredNorm();
    const double share = length > 0 ? std::clamp((p - a).dot(edge) / length, 0.0, 1.0) : 0.0;
    nearest = std::min(nearest, (p - a - share * edge).norm());
    if ((a.y() > p.y()) != (b.y() > p.y()) &&
        p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
      inside = !inside;
  }
  return inside ? -nearest : nearest;
}

template <class Obstacle>
void see(const std::vector<Obstacle>& obstacles, const char* kind, const Eigen::Vector3d& p,
         NearestObstacle& nearest) {
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    const double distance = signed_distance(obstacles[i], p);
    if (!(distance < nearest.distance)) continue;
    nearest.distance = distance;
    nearest.name = obstacles[i].name.empty() ? std::string(kind) + " " + std::to_string(i + 1)
                                             : obstacles[i].name;
  }
}

// Those of meshes and maps, where somebody has read them.
template <class Source>
void see_fields(const std::vector<Source>& sources, const char* kind, const Eigen::Vector3d& p,
                NearestObstacle& nearest) {
  for (std::size_t i = 0; i < sources.size(); ++i) {
    if (!sources[i].distance) continue;
    const double distance = sources[i].distance->distance(p, nullptr);
    if (!(distance < nearest.distance)) continue;
    nearest.distance = distance;
    nearest.name =
        sources[i].name.empty() ? std::string(kind) + " " + std::to_string(i + 1) : sources[i].name;
  }
}

}  // namespace

Eigen::Vector3d Subject::position(double time) const {
  const auto next = std::upper_bound(times.begin(), times.end(), time);
  if (next == times.begin()) return positions.front();
  if (next == times.end()) return positions.back();
  const auto i = static_cast<std::size_t>(next - times.begin());
  const double share = (time - times[i - 1]) / (times[i] - times[i - 1]);
  return positions[i - 1] + share * (positions[i] - positions[i - 1]);
}

bool is_simple_polygon(const std::vector<Eigen::Vector2d>& corners) {
  const std::size_t n = corners.size();
  if (n < 3) return false;
  const auto corner = [&](std::size_t i) -> const Eigen::Vector2d& { return corners[i % n]; };
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d edge = corner(i + 1) - corner(i), next = corner(i + 2) - corner(i + 1);
    if (!(edge.squaredNorm() > 0)) return false;
    if (cross(edge, next) == 0 && edge.dot(next) < 0) return false;
    const std::size_t end = i == 0 ? n - 1 : n;  // the last edge is the first one's neighbour
    for (std::size_t k = i + 2; k < end; ++k) {
      if (meet(corner(i), corner(i + 1), corner(k), corner(k + 1))) return false;
    }
  }
  return true;
}

double signed_distance(const Sphere& sphere, const Eigen::Vector3d& p) {
  return (p - sphere.center).norm() - sphere.radius;
}

double signed_distance(const Box& box, const Eigen::Vector3d& p) {
  const Eigen::Vector3d beyond = (box.lower - p).cwiseMax(p - box.upper);
  const double deepest = beyond.maxCoeff();
  return deepest <= 0 ? deepest : beyond.cwiseMax(0.0).norm();
}

double signed_distance(const Zone& zone, const Eigen::Vector3d& p) {
  const double across = polygon_distance(zone.corners, p.head<2>());
  const double up = std::max(zone.floor - p.z(), p.z() - zone.ceiling);
  if (across <= 0 && up <= 0) return std::max(across, up);
  return std::hypot(std::max(across, 0.0), std::max(up, 0.0));
}

NearestObstacle nearest_obstacle(const Environment& environment, const Eigen::Vector3d& p) {
  NearestObstacle nearest;
  see(environment.spheres, "sphere", p, nearest);
  see(environment.boxes, "box", p, nearest);
  see(environment.zones, "zone", p, nearest);
  see_fields(environment.meshes, "mesh", p, nearest);
  see_fields(environment.maps, "map", p, nearest);
  return nearest;
}

}  // namespace lapwing
