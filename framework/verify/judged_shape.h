// SPDX-License-Identifier: Apache-2.0
// Obstacles as the verifier sees them: distances by code of its own, from what the plan records.
// A type that it does not know is judged by the triangles that the plan records of it.
//
// Internal to this room. World frame, metres.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "framework/trajectory/environment.h"
#include "framework/verify/blocked_voxels.h"

namespace lapwing {

class JudgedShape {
 public:
  virtual ~JudgedShape() = default;

  // Signed distance, negative inside; told apart up to `farthest` at least. It changes by no more
  // than the point moves, and is the true one to within `error`.
  virtual double distance(const Eigen::Vector3d& p, double farthest) const = 0;
  virtual double error() const { return 0; }
  // Whether that is a convex function of the point.
  virtual bool convex() const { return false; }
  // How far beyond the margin it must be told apart; infinite where that costs nothing.
  virtual double reach() const { return std::numeric_limits<double>::infinity(); }

  // The smallest distance on a straight way, at most `farthest`, and its share of the way; nothing
  // where the shape has no exact answer of its own.
  struct Nearest {
    double distance = 0, share = 0;
  };
  virtual std::optional<Nearest> nearest(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                         double farthest) const;

  // Whether it hides `middle`, around which `own` metres belong to the subject, from the camera. A
  // shape that contains the middle is part of the subject.
  virtual bool hides(const Eigen::Vector3d& camera, const Eigen::Vector3d& middle,
                     double own) const = 0;

  // Of a map; null otherwise.
  virtual const BlockedVoxels* voxels() const { return nullptr; }
  virtual bool by_triangles() const { return false; }
};

// Whether the verifier has distance code of its own for obstacles of that type.
bool judged_by_itself(std::string_view type);

// What is wrong with the numbers of an obstacle, to be read after its label; empty where nothing
// is.
std::string problem_of(const Obstacle& obstacle);

// The obstacle of a plan. `file`: where its file is, if it has one. `around`: where distances of a
// map are asked for. InputError for files that are not what the plan says. Of an obstacle without
// problems.
std::unique_ptr<JudgedShape> judged_shape(const Obstacle& obstacle,
                                          const std::filesystem::path& file,
                                          const Eigen::AlignedBox3d& around);

// Of every kind, for `judged_shape`.
std::unique_ptr<JudgedShape> judged_form(const Obstacle& obstacle);  // null: no closed form
std::unique_ptr<JudgedShape> judged_surface(TriangleMesh mesh, const std::string& name);
std::unique_ptr<JudgedShape> judged_solid(const TriangleMesh& mesh, double tolerance,
                                          const std::string& name);
// What keeps triangles from bounding a solid; empty where they do.
std::string open_edges(const TriangleMesh& mesh);

}  // namespace lapwing
