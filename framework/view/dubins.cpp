// SPDX-License-Identifier: Apache-2.0
#include "framework/view/dubins.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "framework/core/error.h"

namespace lapwing {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
// rad: an angle that rounding put just below a whole turn is none.
constexpr double kRounding = 1e-9;

double positive_angle(double angle) {
  double a = std::fmod(angle, kTurn);
  if (a < 0) a += kTurn;
  return kTurn - a < kRounding ? 0 : a;
}

CoursePoint moved(CoursePoint p, double curvature, double length) {
  if (curvature == 0) {
    p.x += length * std::cos(p.course);
    p.y += length * std::sin(p.course);
    return p;
  }
  const double after = p.course + curvature * length;
  p.x += (std::sin(after) - std::sin(p.course)) / curvature;
  p.y -= (std::cos(after) - std::cos(p.course)) / curvature;
  p.course = after;
  return p;
}

// A candidate in units of the radius: +1 left, -1 right, 0 straight, and how long each part is.
struct Word {
  std::array<double, 3> turns, lengths;
};

// The start is at the origin, the end at (d, 0), their courses are a and b (Shkel and Lumelsky,
// section 2). Nothing where the word does not exist.
std::optional<Word> word_of(int which, double d, double a, double b) {
  const double sa = std::sin(a), sb = std::sin(b), ca = std::cos(a), cb = std::cos(b);
  const double between = std::cos(a - b);
  const auto straight = [](double square) { return std::sqrt(std::max(0.0, square)); };
  switch (which) {
    case 0: {  // LSL
      const double square = 2 + d * d - 2 * between + 2 * d * (sa - sb);
      const double turned = std::atan2(cb - ca, d + sa - sb);
      return Word{{1, 0, 1},
                  {positive_angle(turned - a), straight(square), positive_angle(b - turned)}};
    }
    case 1: {  // RSR
      const double square = 2 + d * d - 2 * between + 2 * d * (sb - sa);
      const double turned = std::atan2(ca - cb, d - sa + sb);
      return Word{{-1, 0, -1},
                  {positive_angle(a - turned), straight(square), positive_angle(turned - b)}};
    }
    case 2: {  // LSR
      const double square = -2 + d * d + 2 * between + 2 * d * (sa + sb);
      if (square < 0) return std::nullopt;
      const double p = std::sqrt(square);
      const double turned = std::atan2(-ca - cb, d + sa + sb) - std::atan2(-2, p);
      return Word{{1, 0, -1}, {positive_angle(turned - a), p, positive_angle(turned - b)}};
    }
    case 3: {  // RSL
      const double square = -2 + d * d + 2 * between - 2 * d * (sa + sb);
      if (square < 0) return std::nullopt;
      const double p = std::sqrt(square);
      const double turned = std::atan2(ca + cb, d - sa - sb) - std::atan2(2, p);
      return Word{{-1, 0, 1}, {positive_angle(a - turned), p, positive_angle(b - turned)}};
    }
    case 4: {  // RLR
      const double c = (6 - d * d + 2 * between + 2 * d * (sa - sb)) / 8;
      if (std::abs(c) > 1) return std::nullopt;
      const double p = kTurn - std::acos(c);
      const double t = positive_angle(a - std::atan2(ca - cb, d - sa + sb) + p / 2);
      return Word{{-1, 1, -1}, {t, p, positive_angle(a - b - t + p)}};
    }
    default: {  // LRL
      const double c = (6 - d * d + 2 * between + 2 * d * (sb - sa)) / 8;
      if (std::abs(c) > 1) return std::nullopt;
      const double p = kTurn - std::acos(c);
      const double t = positive_angle(std::atan2(cb - ca, d + sa - sb) - a + p / 2);
      return Word{{1, -1, 1}, {t, p, positive_angle(b - a - t + p)}};
    }
  }
}

}  // namespace

CoursePoint DubinsWay::at(double along) const {
  CoursePoint p = from;
  if (along < 0) return moved(p, 0, along);
  for (const Part& part : parts) {
    const double gone = std::min(along, part.length);
    p = moved(p, part.curvature, gone);
    along -= gone;
  }
  return moved(p, 0, along);
}

DubinsWay shortest_dubins_way(const CoursePoint& from, const CoursePoint& to, double radius) {
  if (!(radius > 0)) throw InputError("the radius of turns must be above 0 m");
  const double dx = to.x - from.x, dy = to.y - from.y;
  const double bearing = std::atan2(dy, dx);
  const double a = from.course - bearing, b = to.course - bearing;
  std::optional<DubinsWay> best;
  for (int which = 0; which < 6; ++which) {
    const auto word = word_of(which, std::hypot(dx, dy) / radius, a, b);
    if (!word) continue;
    DubinsWay way{from, {}};
    for (std::size_t i = 0; i < 3; ++i)
      way.parts[i] = {word->turns[i] / radius, word->lengths[i] * radius};
    if (!best || way.length() < best->length()) best = way;
  }
  return *best;  // LSL always exists
}

}  // namespace lapwing
