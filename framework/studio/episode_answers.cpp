// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/episode_answers.h"

#include <algorithm>

#include "framework/core/checksum.h"
#include "framework/core/error.h"
#include "framework/export/episode_file.h"
#include "framework/map/map_file.h"
#include "framework/studio/map_answers.h"
#include "framework/studio/worker_errands.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

int asked_image(const Frame& question) {
  return static_cast<int>(std::min<std::int64_t>(question.header.at("image").as_integer(),
                                                 std::numeric_limits<int>::max()));
}

Frame voxel_after(const Frame& question, EpisodeReplay& replay) {
  const int images = asked_image(question);
  const Map& map = replay.after(images);
  const VoxelKey voxel = asked_voxel(question, map);
  Value value = voxel_members(map, voxel);
  const std::optional<int> known = replay.known_from(voxel, images);  // the map goes on
  value.set("image", std::int64_t{images});
  value.set("known_from", known ? Value(std::int64_t{*known}) : Value());
  return answer_with(value);
}

Frame slice_after(Frame question, EpisodeReplay& replay) {
  const int images = asked_image(question);
  const Map& map = replay.after(images);
  const auto axis = static_cast<int>(question.header.at("axis").as_integer());
  if (const auto bounds = map.bounds()) {
    const double at = question.header.at("at").as_number();
    question.header.set("at", std::clamp(at, map.grid().center(bounds->lower[axis]),
                                         map.grid().center(bounds->upper[axis])));
  }
  return slice_answer(question, map, images);
}

const std::string& checksum_of_map(const Plan& plan) {
  for (const Obstacle& obstacle : plan.environment.obstacles)
    if (obstacle.type == "map") return obstacle.parameters.at("sha256").as_text();
  throw InputError("the plan of the run names no map");
}

std::shared_ptr<EpisodeReplay> made_by_script(const fs::path& script, MissionSettings settings,
                                              const Plan& plan, const std::string& named) {
  std::shared_ptr<EpisodeReplay> replay;
  settings.observe_episode = [&](std::shared_ptr<EpisodeReplay> one) { replay = std::move(one); };
  settings.episode_alone = true;
  try {
    const auto mission = configured_mission(script, settings, plan.configuration);
    if (mission->kind() == plan.kind && mission->name() == plan.mission) mission->plan();
  } catch (const Cancelled&) {  // as it was told to
  } catch (const InputError& error) {
    throw InputError(named +
                     " cannot be looked into: its images are taken again with this script, " +
                     "which does not take the options of the run: " + error.what());
  }
  if (!replay)
    throw InputError(named + " is a run of the mission '" + plan.mission +
                     "': its images are taken again with its script, and this studio has another "
                     "one; open a studio of that script");
  return replay;
}

}  // namespace

Frame episode_answer(const Frame& question, EpisodeReplay& replay) {
  return question.header.at("do") == Value("voxel") ? voxel_after(question, replay)
                                                    : slice_after(question, replay);
}

std::shared_ptr<EpisodeReplay> replay_of_run(const fs::path& folder, const fs::path& script,
                                             const MissionSettings& settings,
                                             const std::string& program) {
  const ShownEpisode shown = read_episode(folder, program);
  const std::string named = "'" + folder.string() + "'";
  const auto replay = made_by_script(script, settings, shown.plan, named);
  for (const Value& image : shown.exploration.at("images").as_list()) {
    const Value::List& p = image.at("position").as_list();
    replay->took({{p.at(0).as_number(), p.at(1).as_number(), p.at(2).as_number()},
                  image.at("yaw").as_number(),
                  image.at("pitch").as_number()});
  }
  if (sha256(map_file_bytes(".ot", replay->after(replay->images()))) != checksum_of_map(shown.plan))
    throw InputError(named +
                     " cannot be looked into: its images, taken again, do not give the map of the "
                     "run. The script, a file that it reads, or the seed is another one than then; "
                     "run the mission again");
  return replay;
}

}  // namespace lapwing
