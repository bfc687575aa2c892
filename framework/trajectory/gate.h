// SPDX-License-Identifier: Apache-2.0
// Gates: openings of a race course that are flown through in order.
//
// A flat gate stands at its position, is flown through along its direction, and may be the middle
// of a tunnel of its own cross section, half before and half behind. Its frame: the first axis to
// the left of who flies through, the second up. A ball has neither direction nor corners.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace lapwing {

struct GateTask {
  std::string name;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();   // m, world: middle
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  // unit; zero for a ball
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();        // unit, across the direction
  std::vector<Eigen::Vector2d> corners;                 // m, left and up; counter-clockwise, convex
  double radius = 0;                                    // m, of a ball
  double tunnel_length = 0;                             // m
  bool ball() const { return corners.empty(); }
  Eigen::Vector3d left() const { return up.cross(direction); }
};

// What a file or a script says of a shape. Rectangles and triangles have a width and a height, the
// position in the middle of both; pentagons and hexagons are regular, with a radius to the corners,
// or a side. They stand on a flat side, a corner up for triangle and pentagon.
struct GateShape {
  std::string shape;  // ball, rectangle, triangle, pentagon, hexagon
  double width = 0, height = 0, radius = 0, side = 0;  // m; 0: not given
};

// InputError when a figure that the shape needs is missing, not positive, or not its own.
std::vector<Eigen::Vector2d> gate_corners(const GateShape& shape);

// The direction made a unit and `up` made to stand across it. InputError when either has no
// length or they are parallel.
void set_direction(GateTask& gate, const Eigen::Vector3d& direction, const Eigen::Vector3d& up);

}  // namespace lapwing
