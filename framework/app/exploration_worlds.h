// The worlds that explorations are trained on and judged in: made by a script, or a mesh file.
#pragma once

#include "framework/app/command_line.h"
#include "framework/explore/episode.h"

namespace lapwing {

struct WorldName {
  std::string scene;         // of scripts/scene, or a mesh file
  std::uint64_t seed = 1;    // of a script
  std::string text() const;  // "downtown 3", "delft_block.obj"
};
// "downtown", "downtown:3", "downtown:3-6", "meshes/block.obj". InputError for a range that is
// none.
std::vector<WorldName> world_names(const std::string& given);

struct World {
  std::string name;
  std::shared_ptr<const MeshScene> scene;
  Eigen::AlignedBox3d region;
};
// A mesh file gets a floor (explore/ground_truth.h, with_floor).
World load_world(const WorldName& name, const Registry& registry, const Invocation& invocation);

// How all of them are explored, if nothing else is said (readings 2.3, 5.2): camera, range, map.
struct ExplorationSetup {
  EpisodeSettings episode;
  double pitch = 0;
  std::string backend = "brick";
  Value map;  // parameters of the backend

  ExplorationSetup();
  // "clear=2": how the camera moves, by the names of the mission's `moves`; what is given comes
  // back as a map. InputError for others and for what makes no sense.
  Value set_moves(const std::vector<std::string>& given);
  ObservedSurface::NewMap new_map(const Registry& registry) const;
};

}  // namespace lapwing
