// SPDX-License-Identifier: Apache-2.0
// What obstacles and zones are made of. The plugin kind `shape`.
//
// A shape is a set of points with a signed distance. Constraints keep flights out of it or inside
// of it, the occlusion cost looks round it, pictures draw it, the plan document records it. World
// frame, metres. Immutable once it is open: every const call is thread-safe.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "framework/core/plugin_object.h"
#include "framework/core/value.h"
#include "framework/geometry/distance_field.h"
#include "framework/geometry/surface_hit.h"
#include "framework/geometry/triangle_mesh.h"

namespace lapwing {

class Map;

// A file that goes with the plan.
struct KeptFile {
  std::string file;    // its name, beside the plan
  std::string sha256;  // of its bytes, 64 hexadecimal digits
};

// What a shape may use while it is opened.
class ShapeSetting {
 public:
  virtual ~ShapeSetting() = default;

  double margin = 0;           // m, that flights keep from it
  Eigen::AlignedBox3d region;  // where its distances are wanted; empty: everywhere

  // A file that the user named: where it is; `folder` is looked in as well ("meshes"). InputError
  // where there is none that may be read.
  virtual std::filesystem::path find(const std::string& file, const std::string& folder) = 0;
  // Keeps bytes beside the plan under a name with this ending (".ply"); equal bytes are kept once.
  virtual KeptFile keep(const std::string& bytes, const std::string& ending) = 0;
  // Where a kept file lies.
  virtual std::filesystem::path kept(const std::string& file) const = 0;
  // An empty map, held by the plugin of that name.
  virtual std::shared_ptr<Map> make_map(const std::string& plugin, double resolution) = 0;
  // A line for the user.
  virtual void tell(const std::string& line) = 0;
};

// A ball or a block that a shape is, for integrals along lines of sight in closed form.
struct SimpleForm {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Vector3d half =
      Eigen::Vector3d::Zero();  // m, half sizes; of a ball the radius three times
  bool round = false;
};

class Shape : public PluginObject, public DistanceField, public RayBody {
 public:
  using Interface = Shape;
  static constexpr const char* kKind = "shape";
  // How far beyond the margin distances must be told apart, m.
  static constexpr double kBeyond = 5;
  ~Shape() override = default;

  // Called once, before everything else: shapes of files read them here. InputError for what they
  // cannot be read from.
  virtual void open(ShapeSetting&) {}

  // The set is all that lies within `rounding` of a smaller set, its core (the centre of a sphere,
  // the axis of a capsule). A path keeps clear of a core by less than of any set of that size
  // (problem/path_clearance.h). 0: the core is the set itself.
  virtual double rounding() const { return 0; }
  // The signed distance from the core. `gradient`, unless null, takes its derivative.
  virtual double core_distance(const Eigen::Vector3d& p_W, Eigen::Vector3d* gradient) const = 0;

  // From the surface: positive outside, negative inside; never more than the true distance, and
  // changing by no more than p_W moves.
  double distance(const Eigen::Vector3d& p_W, Eigen::Vector3d* gradient) const final {
    return core_distance(p_W, gradient) - rounding();
  }
  double reach() const override;  // infinite, unless a shape says otherwise

  // Found by steps as long as the distance; to 1e-7 m. Shapes may know better.
  std::optional<SurfaceHit> hit(const Eigen::Vector3d& origin,
                                const Eigen::Vector3d& direction) const override;

  // Whether straight lines between two of its points stay inside.
  virtual bool convex() const { return false; }
  // Whether it has an inside; a flight can be kept inside of those alone.
  virtual bool solid() const { return true; }
  // Whether all that is not known to be free belongs to it, so that there is no way round it.
  virtual bool surrounds() const { return false; }
  virtual std::optional<SimpleForm> simple_form() const { return std::nullopt; }

  // Its surface, to within `tolerance` metres, counter-clockwise as seen from outside; of a shape
  // without end what lies in `within`, closed along the faces of that box. A solid gives a closed
  // surface. Empty where none of it lies there.
  virtual TriangleMesh triangles(double tolerance, const Eigen::AlignedBox3d& within) const = 0;

  // Its parameters as the plan document states them, a map: what it can be made from again, and a
  // judge can know it by.
  virtual Value record() const = 0;
};

}  // namespace lapwing
