// SPDX-License-Identifier: Apache-2.0
// The one statement of what surrounds a flight: obstacle constraints read it, the plan carries it,
// the verifier checks all of it. World frame, metres.
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "framework/geometry/distance_field.h"

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

// All points above a polygon on the ground between two heights: closed to flight, or the only ones
// open to it.
struct Zone {
  std::string name;
  std::vector<Eigen::Vector2d> corners;  // at least 3, in either turn; edges do not cross
  double floor = -std::numeric_limits<double>::infinity();
  double ceiling = std::numeric_limits<double>::infinity();
};

// A mesh in a file beside the plan (PLY and the like, in metres with z up). It has no inside: the
// flight keeps away from its triangles.
struct MeshObstacle {
  std::string name;
  std::string file;    // relative to the plan's folder, and below it
  std::string sha256;  // of the file, 64 hexadecimal digits
  // To what the file holds. Planners read it; a document has none, and it is null.
  std::shared_ptr<const DistanceField> distance = nullptr;
  Eigen::AlignedBox3d bounds = {};  // m, of the triangles; empty where nobody has read them
};

// A map in a file beside the plan (.ot): what is occupied or unknown is closed to flight.
struct MapObstacle {
  std::string name;
  std::string file;                                         // as of a mesh
  std::string sha256;                                       // likewise
  std::shared_ptr<const DistanceField> distance = nullptr;  // likewise
};

// What is filmed, or only kept away from: an upright cylinder around a middle that may move.
// Straight and even motion between the times of its track, at rest before and after.
struct Subject {
  std::string name;
  std::vector<double> times;               // s, strictly increasing, one at least
  std::vector<Eigen::Vector3d> positions;  // of its middle, one per time
  double height = 0;                       // m, from foot to top; 0 is a point
  double width = 0;                        // m, diameter
  double distance = 0;                     // m, kept from its middle; 0 asks for none
  bool filmed = true;                      // else a bystander, whom no camera looks for

  Eigen::Vector3d position(double time) const;
};

struct Environment {
  std::vector<Sphere> spheres;
  std::vector<Box> boxes;
  std::vector<Zone> zones;         // closed to flight
  std::vector<Zone> flight_zones;  // the flight stays inside every one of them
  std::vector<MeshObstacle> meshes;
  std::vector<MapObstacle> maps;
  std::vector<Subject> subjects;  // filmed, or bystanders
  double margin = 0;              // m kept from every surface, vehicle radius included
};

// Whether corners bound one area: at least three, no edge of no length, none that turns back on the
// one before it or meets one that is not its neighbour.
bool is_simple_polygon(const std::vector<Eigen::Vector2d>& corners);

// Signed distances from a surface, negative inside; to a zone's prism with its floor and ceiling.
double signed_distance(const Sphere& sphere, const Eigen::Vector3d& p);
double signed_distance(const Box& box, const Eigen::Vector3d& p);
double signed_distance(const Zone& zone, const Eigen::Vector3d& p);

// The nearest of all spheres, boxes and closed zones, and of the meshes and maps whose distance is
// given: its distance (infinite where there is none) and its name, or its kind and number where it
// has none ("sphere 2"). Distances of meshes and maps are told apart up to their reach only.
struct NearestObstacle {
  double distance = std::numeric_limits<double>::infinity();
  std::string name;
};
NearestObstacle nearest_obstacle(const Environment& environment, const Eigen::Vector3d& p);

}  // namespace lapwing
