// SPDX-License-Identifier: Apache-2.0
// The shortest way of a vehicle that only moves ahead and turns no tighter than a radius, between
// two places in the plane with a course each: three arcs, or two arcs and a straight line (L. E.
// Dubins, "On curves of minimal length with a constraint on average curvature", Amer. J. Math. 79,
// 1957). The six candidates have the closed forms of A. M. Shkel and V. Lumelsky, "Classification
// of the Dubins set", Robotics and Autonomous Systems 34, 2001.
#pragma once

#include <array>

namespace lapwing {

struct CoursePoint {
  double x = 0, y = 0;  // m
  double course = 0;    // rad, counter-clockwise from x
};

struct DubinsWay {
  struct Part {
    double curvature = 0;  // 1/m, positive to the left
    double length = 0;     // m
  };
  CoursePoint from;
  std::array<Part, 3> parts;

  double length() const { return parts[0].length + parts[1].length + parts[2].length; }
  // The place `along` metres from the start, the course unwrapped. Beyond the ends it is straight.
  CoursePoint at(double along) const;
};

// `radius` > 0, m. The same arguments give the same way; of ways of one length the first in the
// order LSL, RSR, LSR, RSL, RLR, LRL. InputError for a radius that is not above 0.
DubinsWay shortest_dubins_way(const CoursePoint& from, const CoursePoint& to, double radius);

}  // namespace lapwing
