// The one statement of what surrounds a flight: obstacle constraints read it, the plan carries it,
// the verifier checks all of it. World frame, metres.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace lapwing {

struct Sphere {
  std::string name;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double radius = 0;
};

// Axis-aligned.
struct Box {
  std::string name;
  Eigen::Vector3d lower = Eigen::Vector3d::Zero();
  Eigen::Vector3d upper = Eigen::Vector3d::Zero();
};

struct Environment {
  std::vector<Sphere> spheres;
  std::vector<Box> boxes;
  double margin = 0;  // m kept from every surface, vehicle radius included
};

}  // namespace lapwing
