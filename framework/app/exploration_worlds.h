// SPDX-License-Identifier: Apache-2.0
// The worlds that explorations are trained on and judged in: made by a script, or a mesh file.
#pragma once

#include <memory>

#include "framework/app/command_line.h"
#include "framework/explore/episode.h"
#include "framework/geometry/mesh_file.h"
#include "framework/mission/scene_script.h"

namespace lapwing {

struct WorldName {
  std::string scene;                                     // of scripts/scene, or a mesh file
  std::uint64_t seed = 1;                                // of a script
  std::optional<Eigen::Vector3d> inside = std::nullopt;  // of a mesh file that gets no floor
  std::string inside_text = {};                          // with blanks between
  std::string text() const;  // "downtown 3", "my.lua 1", "delft_block.obj", "mine.dae@1 2 3"
  bool is_mesh() const;      // a mesh file; else a script makes it
  // The file that it is made of or by; of a shipped script that script.
  std::filesystem::path file() const;
};
// "downtown", "downtown:3", "downtown:3-6", "meshes/block.obj"; "meshes/mine.dae@1,2,3" is the
// space within a mesh that holds a place. InputError for a range or a place that is none.
std::vector<WorldName> world_names(const std::string& given);

// Of all that are given. InputError for none, and for two that files could not tell apart by their
// names: "a/block.obj" and "b/block.obj".
std::vector<WorldName> distinct_worlds(const std::vector<std::string>& given,
                                       const std::string& command);

struct World {
  std::string name;
  std::shared_ptr<const MeshScene> scene;
  Eigen::AlignedBox3d region;
  std::optional<Eigen::Vector3d> inside;  // the space to explore; else the one that holds most
};
// InputError where there is no such file or scene, or `up` does not fit it. Cheap.
void require_world(const WorldName& name, const std::string& up);
// What a script makes of its seed, and a checksum of its surface and region. InputError with the
// script's line.
GeneratedScene made_world(const WorldName& name, const Registry& registry,
                          const Invocation& invocation);
std::string checksum(const GeneratedScene& scene);
// A mesh file gets a floor (explore/ground_truth.h, with_floor) unless a place inside is given.
// `up` is the axis of a mesh file that points up, "x", "y" or "z"; empty: what the file says.
World load_world(const WorldName& name, const std::string& up, const Registry& registry,
                 const Invocation& invocation);

// How all of them are explored, if nothing else is said (readings 2.3, 5.2): camera, range, map.
struct ExplorationSetup {
  EpisodeSettings episode;
  double pitch = 0;
  std::string backend = "brick";
  Value map;                          // parameters of the backend
  Value stated_moves = Value::map();  // what set_moves was given

  ExplorationSetup();
  // "clear=2": how the camera moves, by the names of the mission's `moves`; all of them come
  // back as a map. InputError for others and for what makes no sense.
  Value set_moves(const std::vector<std::string>& given);
  // The moves that a scene recommends, where set_moves was not told otherwise; likewise.
  Value recommend_moves(const Value& moves);
  // "resolution=0.2": camera and map that a learned utility is good for, by the mission's names;
  // likewise.
  Value set_mapping(const std::vector<std::string>& given);
  // What an episode at its start cannot do in a world of this name, and the options that help.
  InputError with_options(const StartError& error, const std::string& world) const;
  GroundTruth truth_of(const World& world) const;
  ObservedSurface::NewMap new_map(const Registry& registry) const;
};

// What the episodes in one world share.
struct WorldInUse {
  World world;
  GroundTruth truth;
};
std::shared_ptr<const WorldInUse> load_for_episodes(const WorldName& name, const std::string& up,
                                                    const ExplorationSetup& setup,
                                                    const Registry& registry,
                                                    const Invocation& invocation);

}  // namespace lapwing
