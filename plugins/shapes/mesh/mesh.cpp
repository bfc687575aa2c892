// SPDX-License-Identifier: Apache-2.0
// A mesh in a file, in metres with z up. It has no inside: flights keep away from its triangles.
//
//   { type = "mesh", file = "castle.obj" }
#include "framework/geometry/mesh_file.h"
#include "framework/geometry/mesh_scene.h"
#include "framework/plugin/plugin.h"
#include "framework/shape/shape.h"

namespace lapwing {
namespace {

class MeshForm final : public Shape {
 public:
  static constexpr PluginText kText{"mesh", "1.0.0", "the triangles of a mesh file",
                                    "thesis 2.1, Collision"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .required_text("file", "mesh file, in metres with z up")
        .optional_text("sha256", "checksum of the copy in the folder of a plan; stated by plans");
  }
  explicit MeshForm(const Parameters& parameters) : name_(parameters.text("file")) {
    if (parameters.has("sha256")) stated_ = parameters.text("sha256");
  }

  void open(ShapeSetting& setting) override {
    const std::filesystem::path path = setting.find(name_, "meshes");
    const MeshFile given = read_mesh(path);
    const std::string file = path.filename().string();
    setting.tell(file + ": " + given.description());
    if (!given.doubt.empty()) setting.tell("warning: " + file + ": " + given.doubt);
    kept_ = setting.keep(ply_bytes(given.mesh), ".ply");
    if (!stated_.empty() && kept_.sha256 != stated_)
      throw InputError("'" + name_ + "' has changed since planning");
    // As the verifier will read it, rounded to single precision.
    scene_ = std::make_shared<MeshScene>(read_mesh(setting.kept(kept_.file)).mesh, name_);
    field_ = std::make_unique<MeshDistance>(scene_, setting.margin + kBeyond);
  }

  double core_distance(const Eigen::Vector3d& p_W, Eigen::Vector3d* gradient) const override {
    return field_->distance(p_W, gradient);
  }
  double reach() const override { return field_->reach(); }
  bool solid() const override { return false; }
  Eigen::AlignedBox3d bounds() const override { return scene_->mesh().bounds(); }

  std::optional<SurfaceHit> hit(const Eigen::Vector3d& origin,
                                const Eigen::Vector3d& direction) const override {
    const MeshHit found = scene_->cast({origin, direction});
    if (found.triangle < 0) return std::nullopt;
    return SurfaceHit{found.distance, found.normal};
  }

  TriangleMesh triangles(double, const Eigen::AlignedBox3d&) const override {
    return scene_->mesh();
  }

  Value record() const override {
    Value value = Value::map();
    value.set("file", kept_.file);
    value.set("sha256", kept_.sha256);
    return value;
  }

 private:
  std::string name_, stated_;
  KeptFile kept_;
  std::shared_ptr<const MeshScene> scene_;
  std::unique_ptr<MeshDistance> field_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::MeshForm)
