// SPDX-License-Identifier: Apache-2.0
// A map in a file: what is occupied or unknown is closed to flight (thesis 2.1).
//
//   { type = "map", file = "hall.ot" }
//
// Distances are known within the box `lower` to `upper`, or where the mission says that it flies,
// and what of it the map knows.
#include "framework/map/map_distance.h"
#include "framework/map/map_file.h"
#include "framework/plugin/plugin.h"
#include "framework/shape/shape.h"
#include "framework/shape/surfaces.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

class MapForm final : public Shape {
 public:
  static constexpr PluginText kText{"map", "1.0.0", "the occupied and unknown voxels of a map",
                                    "thesis 2.1"};
  static ParameterTable parameters() {
    const Range far = between(-1e6, 1e6);
    return ParameterTable{}
        .required_text("file", "map file, .ot or .bt")
        .optional_numbers("lower", 3, "m", "lowest corner of the used part, world", far)
        .optional_numbers("upper", 3, "m", "highest corner", far)
        .text("voxels", "brick", "plugin of kind map that holds the voxels")
        .optional_text("sha256", "checksum of the copy in the folder of a plan; stated by plans");
  }
  explicit MapForm(const Parameters& parameters)
      : name_(parameters.text("file")), plugin_(parameters.text("voxels")) {
    if (parameters.has("sha256")) stated_ = parameters.text("sha256");
    if (parameters.has("lower") != parameters.has("upper"))
      throw InputError(parameters.origin(), "expected lower and upper");
    if (!parameters.has("lower")) return;
    asked_ = Eigen::AlignedBox3d(Vector3d(parameters.numbers("lower").data()),
                                 Vector3d(parameters.numbers("upper").data()));
    if (!(asked_.sizes().minCoeff() > 0))
      throw InputError(parameters.origin("lower"), "lower must be below upper in x, y and z");
  }

  void open(ShapeSetting& setting) override {
    const MapFile given = read_map_file(setting.find(name_, "maps"));
    const std::shared_ptr<Map> map = setting.make_map(plugin_, given.resolution);
    map->import(given.leaves);
    kept_ = setting.keep(map_file_bytes(".ot", *map), ".ot");
    if (!stated_.empty() && kept_.sha256 != stated_)
      throw InputError("'" + name_ + "' has changed since planning");
    const VoxelGrid& grid = map->grid();
    resolution_ = grid.resolution();
    if (const auto known = map->bounds())
      bounds_ = {grid.corner(known->lower),
                 grid.corner(known->upper) + Vector3d::Constant(resolution_)};
    if (!asked_.isEmpty())
      bounds_ = bounds_.intersection(asked_);
    else if (!setting.region.isEmpty())
      bounds_ = bounds_.intersection(setting.region);
    if (bounds_.isEmpty() || !(bounds_.sizes().minCoeff() > 0))
      throw InputError("'" + name_ + "' has no known voxel near the flight");
    // Between the middles of voxels the true distance may be exceeded: its second derivatives at d
    // sum to 2 / d, so by r^2 / (4 d) at most, which is r / 4 from a voxel away on.
    const double reach =
        std::min(setting.margin + kBeyond, std::max(setting.margin + 1, 40 * resolution_));
    field_ = std::make_unique<MapDistance>(*map, bounds_.min(), bounds_.max(), reach);
  }

  double core_distance(const Vector3d& p_W, Vector3d* gradient) const override {
    return field_->distance(p_W, gradient) - resolution_ / 4;
  }
  double reach() const override { return field_->reach() - resolution_ / 4; }
  bool solid() const override { return false; }
  bool surrounds() const override { return true; }
  Eigen::AlignedBox3d bounds() const override { return bounds_; }

  // The faces between voxels that are free and voxels that are not.
  TriangleMesh triangles(double, const Eigen::AlignedBox3d&) const override {
    TriangleMesh mesh;
    const Vector3d half = Vector3d::Constant(resolution_ / 2);
    const Eigen::Array3i count =
        ((bounds_.max() - bounds_.min()) / resolution_).array().round().cast<int>();
    const auto middle = [&](const Eigen::Array3i& at) -> Vector3d {
      return bounds_.min() + half + resolution_ * at.cast<double>().matrix();
    };
    const auto free = [&](const Eigen::Array3i& at) {
      return (at >= 0).all() && (at < count).all() && field_->distance(middle(at), nullptr) > 0;
    };
    Eigen::Array3i at;
    for (at.z() = 0; at.z() < count.z(); ++at.z())
      for (at.y() = 0; at.y() < count.y(); ++at.y())
        for (at.x() = 0; at.x() < count.x(); ++at.x())
          if (free(at)) add_faces(at, middle(at), free, mesh);
    if (!mesh.triangles.empty()) weld(mesh, resolution_ * 1e-3);
    return mesh;
  }

  Value record() const override {
    Value value = Value::map();
    value.set("file", kept_.file);
    value.set("sha256", kept_.sha256);
    return value;
  }

 private:
  // Of a free voxel, towards its neighbours that are not: seen from it counter-clockwise.
  template <class Free>
  void add_faces(const Eigen::Array3i& at, const Vector3d& middle, const Free& free,
                 TriangleMesh& mesh) const {
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {-1, 1}) {
        Eigen::Array3i next = at;
        next(axis) += side;
        if (free(next)) continue;
        const Vector3d out = side * resolution_ / 2 * Vector3d::Unit(axis);
        const Vector3d a = resolution_ / 2 * Vector3d::Unit((axis + 1) % 3);
        const Vector3d b = side * resolution_ / 2 * Vector3d::Unit((axis + 2) % 3);
        const auto start = static_cast<std::int32_t>(mesh.vertices.size());
        for (const Vector3d& corner :
             {Vector3d(-a - b), Vector3d(b - a), Vector3d(a + b), Vector3d(a - b)})
          mesh.vertices.push_back(middle + out + corner);
        mesh.triangles.push_back({start, start + 1, start + 2});
        mesh.triangles.push_back({start, start + 2, start + 3});
      }
  }

  std::string name_, plugin_, stated_;
  Eigen::AlignedBox3d asked_, bounds_;
  double resolution_ = 0;
  KeptFile kept_;
  std::unique_ptr<MapDistance> field_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::MapForm)
