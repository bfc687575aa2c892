// SPDX-License-Identifier: Apache-2.0
#include "framework/trajectory/gate.h"

#include <cmath>
#include <numbers>

#include "framework/core/error.h"

namespace lapwing {
namespace {

void expect_sizes(const GateShape& s, std::initializer_list<const char*> needed) {
  const std::pair<const char*, double> sizes[] = {
      {"width", s.width}, {"height", s.height}, {"radius", s.radius}, {"side", s.side}};
  std::string list;
  for (const char* name : needed) list += (list.empty() ? "" : " and ") + std::string(name);
  for (const auto& [name, size] : sizes) {
    bool own = false;
    for (const char* other : needed) own |= std::string(name) == other;
    if (own && !(size > 0 && std::isfinite(size)))
      throw InputError("a " + s.shape + " needs a " + list + " above 0");
    if (!own && size != 0) throw InputError("a " + s.shape + " has a " + list + ", no " + name);
  }
}

// Regular, a flat side below: one corner lies up where their number is odd.
std::vector<Eigen::Vector2d> regular(int count, const GateShape& s) {
  expect_sizes(s, {s.side != 0 ? "side" : "radius"});
  const double pi = std::numbers::pi;
  const double radius = s.side != 0 ? 0.5 * s.side / std::sin(pi / count) : s.radius;
  std::vector<Eigen::Vector2d> corners;
  for (int k = 0; k < count; ++k) {
    const double angle = -pi / 2 + pi / count + 2 * pi * k / count;
    corners.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return corners;
}

}  // namespace

std::vector<Eigen::Vector2d> gate_corners(const GateShape& s) {
  if (s.shape == "ball") {
    expect_sizes(s, {"radius"});
    return {};
  }
  if (s.shape == "pentagon") return regular(5, s);
  if (s.shape == "hexagon") return regular(6, s);
  const double w = 0.5 * s.width, h = 0.5 * s.height;
  if (s.shape != "rectangle" && s.shape != "triangle")
    throw InputError("no gate has the shape '" + s.shape +
                     "'; there are ball, rectangle, triangle, pentagon and hexagon");
  expect_sizes(s, {"width", "height"});
  if (s.shape == "rectangle") return {{-w, -h}, {w, -h}, {w, h}, {-w, h}};
  return {{-w, -h}, {w, -h}, {0, h}};
}

void set_direction(GateTask& gate, const Eigen::Vector3d& direction, const Eigen::Vector3d& up) {
  const double length = direction.norm();
  if (!(length > 0) || !direction.allFinite())
    throw InputError("the direction through a gate needs a length");
  gate.direction = direction / length;
  const Eigen::Vector3d across = up - up.dot(gate.direction) * gate.direction;
  if (!(across.norm() > 1e-6) || !across.allFinite())
    throw InputError("the direction through a gate and its `up` must not be parallel");
  gate.up = across.normalized();
}

}  // namespace lapwing
