// SPDX-License-Identifier: Apache-2.0
#include "framework/geometry/mesh_builder.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "framework/core/error.h"

namespace lapwing {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::size_t kMostTriangles = 20'000'000;
constexpr std::size_t kDeepest = 64;  // frames
constexpr double kLargest = 1e5;      // m

void require(bool holds, const char* why) {
  if (!holds) throw InputError(why);
}

bool sound(const Vector3d& p) {
  return p.cwiseAbs().maxCoeff() <= kLargest && p.allFinite();
}

double cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

double turn(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return cross(b - a, c - b);
}

bool inside(const Vector2d& p, const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
}

double signed_area(std::span<const Vector2d> corners) {
  double twice = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    twice += cross(corners[i], corners[(i + 1) % corners.size()]);
  }
  return twice / 2;
}

// Twice the area of a polygon in space, along its normal (Newell).
Vector3d newell(std::span<const Vector3d> corners) {
  Vector3d normal = Vector3d::Zero();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector3d& a = corners[i];
    const Vector3d& b = corners[(i + 1) % corners.size()];
    normal += (a - corners[0]).cross(b - corners[0]);
  }
  return normal;
}

// Two unit vectors that make a right-handed frame with `axis`.
std::pair<Vector3d, Vector3d> across(const Vector3d& axis) {
  const Vector3d other = std::abs(axis.z()) < 0.9 ? Vector3d::UnitZ() : Vector3d::UnitX();
  const Vector3d u = other.cross(axis).normalized();
  return {u, axis.cross(u)};
}

}  // namespace

std::vector<std::array<std::int32_t, 3>> triangulate(std::span<const Vector2d> corners) {
  require(corners.size() >= 3, "a polygon needs at least three corners");
  const double area = signed_area(corners);
  require(std::abs(area) > 1e-12, "a polygon needs an area");
  std::vector<std::int32_t> left(corners.size());
  std::iota(left.begin(), left.end(), 0);
  if (area < 0) std::reverse(left.begin(), left.end());
  const auto at = [&](std::int32_t i) -> const Vector2d& {
    return corners[static_cast<std::size_t>(i)];
  };
  const auto is_ear = [&](std::size_t i) {
    const std::size_t n = left.size();
    const std::int32_t a = left[(i + n - 1) % n], b = left[i], c = left[(i + 1) % n];
    if (!(turn(at(a), at(b), at(c)) > 0)) return false;
    return std::none_of(left.begin(), left.end(), [&](std::int32_t k) {
      const bool corner = at(k) == at(a) || at(k) == at(b) || at(k) == at(c);
      return !corner && inside(at(k), at(a), at(b), at(c));
    });
  };
  std::vector<std::array<std::int32_t, 3>> triangles;
  while (left.size() > 3) {
    const std::size_t n = left.size();
    std::size_t i = 0;
    while (i < n && !is_ear(i)) ++i;
    if (i == n) {
      // Corners on a straight line are no ears, and may go.
      for (i = 0; i < n; ++i) {
        if (turn(at(left[(i + n - 1) % n]), at(left[i]), at(left[(i + 1) % n])) == 0) break;
      }
      require(i < n, "the edges of a polygon cross each other");
    } else {
      triangles.push_back({left[(i + n - 1) % n], left[i], left[(i + 1) % n]});
    }
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(i));
  }
  if (turn(at(left[0]), at(left[1]), at(left[2])) > 0) {
    triangles.push_back({left[0], left[1], left[2]});
  }
  return triangles;
}

std::vector<std::array<std::int32_t, 3>> triangulate_face(std::span<const Vector3d> corners) {
  require(corners.size() >= 3, "a face needs at least three corners");
  const Vector3d normal = newell(corners);
  require(normal.norm() > 1e-12, "a face needs an area");
  const auto [u, v] = across(normal.normalized());
  std::vector<Vector2d> flat;
  for (const Vector3d& p : corners) {
    flat.emplace_back((p - corners[0]).dot(u), (p - corners[0]).dot(v));
  }
  return triangulate(flat);
}

void MeshBuilder::push(const Vector3d& origin, double yaw, double scale) {
  require(sound(origin) && std::isfinite(yaw) && scale > 0 && scale <= kLargest,
          "a frame needs a finite origin and yaw and a scale above 0");
  require(frames_.size() < kDeepest, "frames are nested deeper than 64: is a pop missing?");
  Frame next = frames_.back();
  const double c = std::cos(yaw), s = std::sin(yaw);
  next.origin = placed(origin);
  next.cosine = frames_.back().cosine * c - frames_.back().sine * s;
  next.sine = frames_.back().sine * c + frames_.back().cosine * s;
  next.scale *= scale;
  frames_.push_back(next);
}

void MeshBuilder::pop() {
  require(frames_.size() > 1, "pop without a push");
  frames_.pop_back();
}

Vector3d MeshBuilder::placed(const Vector3d& p) const {
  const Frame& f = frames_.back();
  return f.origin + f.scale * Vector3d(f.cosine * p.x() - f.sine * p.y(),
                                       f.sine * p.x() + f.cosine * p.y(), p.z());
}

std::int32_t MeshBuilder::add_vertex(const Vector3d& p) {
  mesh_.vertices.push_back(placed(p));
  return static_cast<std::int32_t>(mesh_.vertices.size() - 1);
}

void MeshBuilder::add_triangle(std::int32_t a, std::int32_t b, std::int32_t c) {
  mesh_.triangles.push_back({a, b, c});
  mesh_.colors.push_back(color_);
}

void MeshBuilder::check_room(std::size_t triangles) const {
  require(mesh_.triangles.size() + triangles <= kMostTriangles,
          "a scene of more than 20 million triangles is too large");
}

void MeshBuilder::face(std::span<const Vector3d> corners) {
  require(corners.size() >= 3, "a face needs at least three corners");
  require(std::all_of(corners.begin(), corners.end(), sound),
          "a corner of a face is not finite or beyond 1e5 m");
  const auto triangles = triangulate_face(corners);
  const Vector3d normal = newell(corners).normalized();
  double size = 0, off = 0;
  for (const Vector3d& p : corners) {
    size = std::max(size, (p - corners[0]).norm());
    off = std::max(off, std::abs((p - corners[0]).dot(normal)));
  }
  require(off <= 1e-3 * size, "the corners of a face do not lie in one plane");
  check_room(triangles.size());
  const auto first = static_cast<std::int32_t>(mesh_.vertices.size());
  for (const Vector3d& p : corners) add_vertex(p);
  for (const auto& t : triangles) add_triangle(first + t[0], first + t[1], first + t[2]);
}

void MeshBuilder::quad(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
  require(sound(a) && sound(b) && sound(c) && sound(d),
          "a corner of a quad is not finite or beyond 1e5 m");
  check_room(2);
  const std::int32_t i = add_vertex(a);
  add_vertex(b), add_vertex(c), add_vertex(d);
  add_triangle(i, i + 1, i + 2);
  add_triangle(i, i + 2, i + 3);
}

void MeshBuilder::box(const Vector3d& lower, const Vector3d& upper) {
  require(sound(lower) && sound(upper), "a corner of a box is not finite or beyond 1e5 m");
  require((lower.array() < upper.array()).all(), "lower must be below upper on every axis");
  const Vector2d corners[] = {{lower.x(), lower.y()},
                              {upper.x(), lower.y()},
                              {upper.x(), upper.y()},
                              {lower.x(), upper.y()}};
  prism(corners, lower.z(), upper.z());
}

void MeshBuilder::prism(std::span<const Vector2d> corners, double floor, double ceiling) {
  require(floor < ceiling && std::abs(floor) <= kLargest && std::abs(ceiling) <= kLargest,
          "the floor of a prism must be below its ceiling");
  for (const Vector2d& p : corners) {
    require(p.cwiseAbs().maxCoeff() <= kLargest && p.allFinite(),
            "a corner of a prism is not finite or beyond 1e5 m");
  }
  const auto caps = triangulate(corners);
  check_room(2 * caps.size() + 2 * corners.size());
  const bool reversed = signed_area(corners) < 0;
  const auto n = static_cast<std::int32_t>(corners.size());
  const auto first = static_cast<std::int32_t>(mesh_.vertices.size());
  for (const Vector2d& p : corners) add_vertex({p.x(), p.y(), floor});
  for (const Vector2d& p : corners) add_vertex({p.x(), p.y(), ceiling});
  for (std::int32_t i = 0; i < n; ++i) {
    std::int32_t a = first + i, b = first + (i + 1) % n;
    if (reversed) std::swap(a, b);
    add_triangle(a, b, b + n);
    add_triangle(a, b + n, a + n);
  }
  for (const auto& t : caps) {
    add_triangle(first + t[0], first + t[2], first + t[1]);
    add_triangle(first + n + t[0], first + n + t[1], first + n + t[2]);
  }
}

void MeshBuilder::tube(const Vector3d& from, const Vector3d& to, double radius_from,
                       double radius_to, int sides) {
  require(sound(from) && sound(to) && (to - from).norm() > 1e-9, "a tube needs a length");
  require(radius_from >= 0 && radius_to >= 0 && radius_from + radius_to > 0 &&
              radius_from <= kLargest && radius_to <= kLargest,
          "a tube needs radii of at least 0, one of them above 0");
  require(sides >= 3 && sides <= 1000, "a tube has between 3 and 1000 sides");
  check_room(4 * static_cast<std::size_t>(sides));
  const auto [u, v] = across((to - from).normalized());
  const std::int32_t low = add_vertex(from), high = add_vertex(to);
  for (int i = 0; i < sides; ++i) {
    const double angle = 2 * std::numbers::pi * i / sides;
    const Vector3d out = std::cos(angle) * u + std::sin(angle) * v;
    add_vertex(from + radius_from * out);
    add_vertex(to + radius_to * out);
  }
  for (int i = 0; i < sides; ++i) {
    const std::int32_t a = high + 1 + 2 * i, b = high + 1 + 2 * ((i + 1) % sides);
    if (radius_from > 0) add_triangle(low, b, a), add_triangle(a, b, b + 1);
    if (radius_to > 0) add_triangle(high, a + 1, b + 1), add_triangle(a, b + 1, a + 1);
  }
}

void MeshBuilder::ball(const Vector3d& center, const Vector3d& radii, int detail,
                       double roughness) {
  require(sound(center) && sound(radii) && radii.minCoeff() > 0, "a ball needs radii above 0 m");
  require(detail >= 0 && detail <= 6, "the detail of a ball is between 0 and 6");
  require(roughness >= 0 && roughness < 1, "the roughness of a ball is at least 0 and below 1");
  check_room(std::size_t{20} << (2 * detail));
  constexpr double g = std::numbers::phi;
  std::vector<Vector3d> corners = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                   {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                   {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  std::vector<std::array<std::int32_t, 3>> faces = {
      {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level < detail; ++level) {
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
    const auto middle = [&](std::int32_t a, std::int32_t b) {
      const auto [it, fresh] = middles.emplace(std::minmax(a, b), corners.size());
      if (fresh) {
        corners.push_back(corners[static_cast<std::size_t>(a)].normalized() +
                          corners[static_cast<std::size_t>(b)].normalized());
      }
      return it->second;
    };
    std::vector<std::array<std::int32_t, 3>> finer;
    for (const auto& [a, b, c] : faces) {
      const std::int32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    faces = std::move(finer);
  }
  const auto first = static_cast<std::int32_t>(mesh_.vertices.size());
  for (const Vector3d& c : corners) {
    const double bump = 1 + roughness * (2 * random_.uniform() - 1);
    add_vertex(center + bump * radii.cwiseProduct(c.normalized()));
  }
  for (const auto& [a, b, c] : faces) add_triangle(first + a, first + b, first + c);
}

void MeshBuilder::terrain(const Vector2d& corner, double step, int columns,
                          std::span<const double> heights) {
  require(step > 0 && step <= kLargest, "the step of a terrain must be above 0 m");
  require(columns >= 2 && heights.size() % static_cast<std::size_t>(columns) == 0 &&
              heights.size() >= 2 * static_cast<std::size_t>(columns),
          "a terrain needs at least two full rows and two columns of heights");
  const int rows = static_cast<int>(heights.size()) / columns;
  check_room(2 * heights.size());
  const auto point = [&](int column, int row) -> Vector3d {
    return {corner.x() + step * column, corner.y() + step * row,
            heights[static_cast<std::size_t>(row * columns + column)]};
  };
  for (int k = 0; k < columns * rows; ++k) {
    require(sound(point(k % columns, k / columns)),
            "a terrain has a height that is not finite or beyond 1e5 m");
  }
  const auto first = static_cast<std::int32_t>(mesh_.vertices.size());
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) add_vertex(point(column, row));
  }
  for (int row = 0; row + 1 < rows; ++row) {
    for (int column = 0; column + 1 < columns; ++column) {
      const std::int32_t a = first + row * columns + column, b = a + columns;
      add_triangle(a, a + 1, b + 1);
      add_triangle(a, b + 1, b);
    }
  }
}

}  // namespace lapwing
