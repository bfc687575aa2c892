// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/obstacle_files.h"

#include <stdlib.h>

#include <algorithm>
#include <cstdio>
#include <system_error>

#include "framework/core/checksum.h"
#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/geometry/mesh_file.h"
#include "framework/geometry/mesh_scene.h"
#include "framework/map/map_distance.h"
#include "framework/map/map_file.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

constexpr double kBeyond = 5;  // m, that distances reach beyond the margin

// A field less what it may say too much.
class Lowered final : public DistanceField {
 public:
  Lowered(std::unique_ptr<DistanceField> field, double by) : field_(std::move(field)), by_(by) {}
  double distance(const Eigen::Vector3d& p, Eigen::Vector3d* gradient) const override {
    return field_->distance(p, gradient) - by_;
  }
  double reach() const override { return field_->reach() - by_; }

 private:
  std::unique_ptr<DistanceField> field_;
  double by_;
};

struct Copy {
  std::string file, sha256;
};

}  // namespace

struct ObstacleFiles::State {
  fs::path folder;
  std::vector<std::string> files;
  struct Mesh {
    Copy copy;
    std::shared_ptr<const MeshScene> scene;
  };
  struct VoxelMap {
    Copy copy;
    std::shared_ptr<const Map> map;
  };
  std::map<fs::path, Mesh> meshes;
  std::map<fs::path, VoxelMap> maps;
  std::map<std::string, std::shared_ptr<const DistanceField>> fields;

  ~State() {
    std::error_code ignored;
    if (!folder.empty()) fs::remove_all(folder, ignored);
  }

  void make_folder() {
    if (folder.empty()) {
      std::string pattern = (fs::temp_directory_path() / "lapwing_obstacles_XXXXXX").string();
      if (!::mkdtemp(pattern.data()))
        throw InputError(pattern + ": cannot make a folder for copies of obstacles");
      folder = pattern;
    }
  }

  Copy keep(const std::string& bytes, const char* ending) {
    make_folder();
    const std::string name = "obstacle_" + std::to_string(files.size() + 1) + ending;
    write_file_atomically(folder / name, bytes);
    files.push_back(name);
    return {name, sha256(bytes)};
  }
};

ObstacleFiles::ObstacleFiles() : state_(std::make_unique<State>()) {}
ObstacleFiles::~ObstacleFiles() = default;
ObstacleFiles::ObstacleFiles(ObstacleFiles&&) noexcept = default;

std::string ObstacleFiles::keep(const std::string& name, const std::string& bytes) {
  state_->make_folder();
  write_file_atomically(state_->folder / name, bytes);
  if (std::find(state_->files.begin(), state_->files.end(), name) == state_->files.end())
    state_->files.push_back(name);
  return sha256(bytes);
}

const fs::path& ObstacleFiles::folder() const {
  return state_->folder;
}
const std::vector<std::string>& ObstacleFiles::files() const {
  return state_->files;
}

MeshObstacle ObstacleFiles::mesh(const fs::path& file, const std::string& name, double margin,
                                 const std::function<void(const std::string&)>& print) {
  auto found = state_->meshes.find(file);
  if (found == state_->meshes.end()) {
    const MeshFile given = read_mesh(file);
    const std::string name_there = file.filename().string();
    print(name_there + ": " + given.description());
    if (!given.doubt.empty()) print("warning: " + name_there + ": " + given.doubt);
    State::Mesh mesh;
    mesh.copy = state_->keep(ply_bytes(given.mesh), ".ply");
    // As the verifier will read it, rounded to single precision.
    mesh.scene = std::make_shared<MeshScene>(read_mesh(state_->folder / mesh.copy.file).mesh, name);
    found = state_->meshes.emplace(file, std::move(mesh)).first;
  }
  const State::Mesh& mesh = found->second;
  return {name, mesh.copy.file, mesh.copy.sha256,
          std::make_shared<MeshDistance>(mesh.scene, margin + kBeyond),
          mesh.scene->mesh().bounds()};
}

MapObstacle ObstacleFiles::map(const fs::path& file, const std::string& name, double margin,
                               const Eigen::AlignedBox3d& box, const std::string& plugin,
                               const Registry& registry) {
  auto found = state_->maps.find(file);
  if (found == state_->maps.end()) {
    const MapFile given = read_map_file(file);
    Value parameters = Value::map();
    parameters.set("resolution", given.resolution);
    std::shared_ptr<Map> map = registry.create<Map>(plugin, parameters, "map '" + name + "'");
    map->import(given.leaves);
    State::VoxelMap kept{state_->keep(map_file_bytes(".ot", *map), ".ot"), map};
    found = state_->maps.emplace(file, std::move(kept)).first;
  }
  const State::VoxelMap& kept = found->second;
  const auto known = kept.map->bounds();
  const VoxelGrid& grid = kept.map->grid();
  Eigen::AlignedBox3d wanted;
  if (known)
    wanted = Eigen::AlignedBox3d(
                 grid.corner(known->lower),
                 grid.corner(known->upper) + Eigen::Vector3d::Constant(grid.resolution()))
                 .intersection(box);
  if (wanted.isEmpty() || !(wanted.sizes().minCoeff() > 0))
    throw InputError("map '" + name + "' knows nothing of the place where the flight is to be");
  char key[300];
  std::snprintf(key, sizeof key, "%s %.9g %.9g %.9g %.9g %.9g %.9g %.9g", kept.copy.file.c_str(),
                margin, wanted.min().x(), wanted.min().y(), wanted.min().z(), wanted.max().x(),
                wanted.max().y(), wanted.max().z());
  auto& field = state_->fields[key];
  if (!field) {
    // Between the middles of voxels the true distance may be exceeded: its second derivatives at d
    // sum to 2 / d, so by r^2 / (4 d) at most, which is r / 4 from a voxel away on.
    const double reach = std::min(margin + kBeyond, std::max(margin + 1, 40 * grid.resolution()));
    field = std::make_shared<Lowered>(
        std::make_unique<MapDistance>(*kept.map, wanted.min(), wanted.max(), reach),
        grid.resolution() / 4);
  }
  return {name, kept.copy.file, kept.copy.sha256, field};
}

}  // namespace lapwing
