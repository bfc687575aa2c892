// SPDX-License-Identifier: Apache-2.0
// Answers about the map of an exploration after any of its images, as it is planned, as it was
// planned, or as a run's folder tells it. Internal to this room.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "framework/explore/episode_replay.h"
#include "framework/mission/run.h"
#include "framework/studio/frames.h"

namespace lapwing {

// Of `voxel` and `slice`, about the map after `image` images. A slice beyond the map is the nearest
// layer of it.
Frame episode_answer(const Frame& question, EpisodeReplay& replay);

// The episode of a run's folder. Its images are taken again in the world that the script makes with
// the options of the run; the map at the end must be that of the run, to the byte. InputError:
// whatever read_episode refuses, a run of another mission, and another map at the end.
std::shared_ptr<EpisodeReplay> replay_of_run(const std::filesystem::path& folder,
                                             const std::filesystem::path& script,
                                             const MissionSettings& settings,
                                             const std::string& program);

}  // namespace lapwing
