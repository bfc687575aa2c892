// SPDX-License-Identifier: Apache-2.0
// The one statement of what surrounds a flight: obstacle constraints read it, the plan carries it,
// the verifier checks all of it. World frame, metres.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "framework/core/value.h"
#include "framework/geometry/pilot_place.h"
#include "framework/geometry/triangle_mesh.h"
#include "framework/shape/shape.h"

namespace lapwing {

// Where a flight may be: outside of a shape, or inside of it.
enum class Side { keep_out, keep_inside };

// A shape that the flight keeps out of, or inside of.
struct Obstacle {
  std::string name;
  std::string type;                 // the plugin that it is of: "sphere"
  Value parameters = Value::map();  // as Shape::record gives them
  Side side = Side::keep_out;
  bool opaque = true;  // whether it hides subjects; what flights stay inside of never does

  // How it moves: what is added to its place, straight and even in between, at rest before and
  // after. No times: it stands still.
  std::vector<double> times = {};           // s, strictly increasing
  std::vector<Eigen::Vector3d> moves = {};  // m, one per time

  // Its surface, of a type that the verifier has no distance of: the true surface lies within
  // `tolerance` metres of these triangles. Null otherwise.
  std::shared_ptr<const TriangleMesh> triangles = nullptr;
  double tolerance = 0;  // m

  // What plans are made with. A document has none, and it is null.
  std::shared_ptr<const Shape> shape = nullptr;

  bool still() const { return times.empty(); }
  Eigen::Vector3d moved(double time) const;
  // The largest speed of its moves, m/s.
  double speed() const;
  // Of messages: "sphere 'tree'", "zone 'field'", "flight zone 'park'"; or, without a name, with
  // its number in the list.
  std::string label(std::size_t number) const;
};

// The numbers of `parameters` under `key`; empty where there are none.
std::vector<double> recorded_numbers(const Value& parameters, std::string_view key);

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
  std::vector<Obstacle> obstacles;
  std::vector<Subject> subjects;  // filmed, or bystanders
  double margin = 0;              // m kept from every surface, vehicle radius included
  double accuracy = 0;            // m of the margin that is the accuracy of the position in flight
  std::optional<PilotPlace> pilot = {};  // who must see the vehicle during the whole flight
};

// The one of that type and name; null where there is none.
const Obstacle* find_obstacle(const Environment& environment, std::string_view type,
                              std::string_view name);

// The nearest of all obstacles to keep out of whose shape is there, at a time: its distance
// (infinite where there is none, negative inside) and its name, or its type and number where it has
// none ("sphere 2"). Distances are told apart up to the reach of a shape only.
struct NearestObstacle {
  double distance = std::numeric_limits<double>::infinity();
  std::string name;
};
NearestObstacle nearest_obstacle(const Environment& environment, const Eigen::Vector3d& p,
                                 double time = 0);
// The same of what the flight is to stay inside of: how far inside it is, negative outside.
NearestObstacle least_inside(const Environment& environment, const Eigen::Vector3d& p,
                             double time = 0);

}  // namespace lapwing
