// SPDX-License-Identifier: Apache-2.0
// What a working process does beside solving. Internal to this room.
#pragma once

#include <filesystem>
#include <memory>
#include <set>
#include <string>

#include "framework/mission/mission.h"
#include "framework/studio/backdrop.h"
#include "framework/studio/frames.h"
#include "framework/studio/worker_games.h"
#include "framework/vehicle/closed_loop.h"

namespace lapwing {

// "shot.lua:12: ..." is line 12 of the script; 0 where it is of no line of it.
int line_in(const std::string& message, const std::filesystem::path& script);

// Whether a module of scripts is the user's own, not one that is shipped in `scripts`.
bool is_own_module(const std::filesystem::path& file, const std::filesystem::path& scripts);

// A layer that a page made of the document, as if the script said it: whoever types a file behind
// `--set input=` may read it, a page only what the script may.
Value layer_of_page(Value layer, const std::filesystem::path& script);

// A mission of the script with this configuration on it.
std::unique_ptr<Mission> configured_mission(const std::filesystem::path& script,
                                            MissionSettings settings, const Value& layer);

// Its options, with keyframes and subjects of the file that a film reads written out where it has
// none of its own, so that they can be edited: film.from_file takes them in place of the file's.
Value options_with_file(Mission& mission);

class EpisodeReplay;

class WorkerErrands {
 public:
  // `program`: its name and version, as run folders state it.
  WorkerErrands(std::filesystem::path script, const MissionSettings& settings, std::string program)
      : script_(std::move(script)), settings_(settings), program_(std::move(program)) {}

  // Does what the frame asks for. InputError and what plugins throw come out.
  Frame answer(const Frame& asked);
  // The modules that the script required in the last check, also in one that failed; those that are
  // shipped left out.
  Value script_files() const;

 private:
  Frame check(const Frame& asked);
  Frame describe() const;
  Frame fly(const Frame& asked) const;
  Frame picture(const Frame& asked);
  std::string exposure(const Plan& plan, double time, int width, int height);
  Frame export_plan(const Frame& asked);
  Frame export_lua(const Frame& asked) const;
  Frame save_report(const Frame& asked) const;
  Frame list_runs() const;
  Frame open_run(const Frame& asked) const;
  Frame backdrop(const Frame& asked);
  Frame look_into_run(const Frame& asked);
  // With the shapes of its obstacles open.
  Plan with_shapes(const Frame& asked);
  void state_environment(const Plan& plan, const Value& layer,
                         const std::filesystem::path& planned);

  std::filesystem::path script_;
  const MissionSettings& settings_;
  std::string program_;
  std::set<std::string> files_;
  std::string stated_layer_;  // whose environment is kept
  std::unique_ptr<Mission> stated_mission_;
  Environment stated_environment_;
  std::filesystem::path stated_folder_;  // of the files that it names
  std::string drawn_trajectory_;         // whose simulated flight is kept, of light paintings
  FlownPath drawn_;
  WorkerGames games_;
  Backdrop backdrop_;
  std::shared_ptr<EpisodeReplay> looked_into_;  // of the folder:
  std::string looked_into_looks_;               // its name, and what its files looked like
  std::string looked_into_error_;               // why it could not be taken again
  std::set<std::filesystem::path> stated_reads_;
  std::string stated_looks_;  // of those files, when they were read
};

// What a page shows in forms: declared options, parameters of plugins, names to choose from.
void describe_mission(const Mission& mission, const MissionSettings& settings, Value& described);

// A script that makes this document without a layer: `film.shot`, or `film.from_file`. Written to
// `target` once it was loaded and found to come to the same options. InputError where it cannot.
void write_flat_script(const std::filesystem::path& script, const MissionSettings& settings,
                       const Mission& mission, const std::filesystem::path& target);

}  // namespace lapwing
