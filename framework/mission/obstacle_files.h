// SPDX-License-Identifier: Apache-2.0
// Meshes and maps that flights keep away from: read once a mission, with their distances, and
// copied to a folder of the mission's own as the plan will name them.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "framework/plugin/registry.h"
#include "framework/trajectory/environment.h"

namespace lapwing {

class ObstacleFiles {
 public:
  ObstacleFiles();
  ~ObstacleFiles();  // the folder goes with it
  ObstacleFiles(ObstacleFiles&&) noexcept;

  // Both: distances up to 5 m beyond `margin` metres; the same file twice is the same copy.
  // InputError for a file that cannot be read.
  MeshObstacle mesh(const std::filesystem::path& file, const std::string& name, double margin,
                    const std::function<void(const std::string&)>& print);
  // Distances within `box` and what of it the map knows; `plugin` holds the voxels. InputError also
  // for a box that the map knows nothing of, and for one with more voxels than a field can hold.
  MapObstacle map(const std::filesystem::path& file, const std::string& name, double margin,
                  const Eigen::AlignedBox3d& box, const std::string& plugin,
                  const Registry& registry);

  // Keeps the bytes under a name of the caller's own, in place of what had it: their SHA-256.
  std::string keep(const std::string& name, const std::string& bytes);

  // Holds obstacle_1.ply, obstacle_2.ot and so on. Empty while there is none.
  const std::filesystem::path& folder() const;
  const std::vector<std::string>& files() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lapwing
