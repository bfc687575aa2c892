// SPDX-License-Identifier: Apache-2.0
#include "framework/app/mission_loading.h"

#include <cstdlib>
#include <iostream>
#include <thread>

#include "framework/app/provenance.h"
#include "framework/config/lookup.h"
#include "framework/config/shipped.h"
#include "framework/core/log.h"
#include "framework/core/visible_text.h"

namespace lapwing {

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> data_folders(const Invocation& invocation) {
  std::vector<fs::path> folders;
  for (const fs::path& folder : invocation.data) {
    if (!fs::is_directory(folder)) {
      throw InputError("--data " + folder.string() + ": no such folder");
    }
    folders.push_back(folder);
  }
  const char* variable = std::getenv("LAPWING_DATA");
  std::string rest = variable ? variable : "";
  while (!rest.empty()) {
    const std::size_t end = rest.find(':');
    const std::string folder = rest.substr(0, end);
    rest = end == std::string::npos ? "" : rest.substr(end + 1);
    if (folder.empty()) continue;
    if (fs::is_directory(folder)) {
      folders.emplace_back(folder);
    } else {
      logging::warning("LAPWING_DATA names " + folder + ", which is not a folder");
    }
  }
  return folders;
}

// A file of another sort in a configuration's place would be a page of unknown keys.
Value mission_config(const std::string& name, const ConfigSearch& search) {
  Value config = read_config(name, search);
  if (config.find("mass") && config.find("rotors"))
    throw InputError("--config " + name +
                     ": this is a vehicle, not a configuration of a mission; " +
                     "expected --set vehicle=" + name);
  return config;
}

}  // namespace

void require_script(const fs::path& script) {
  const std::string file = script.string();
  if (script.extension() == ".svg")
    throw InputError("'" + file +
                     "' is not a mission script, NAME.lua; a light painting draws it: `lapwing run "
                     "PAINTING.lua --set input=" +
                     file + "` (mission.light_painting)");
  if (script.extension() == ".json")
    throw InputError("'" + file +
                     "' is not a mission script, NAME.lua; a plan is judged by `lapwing "
                     "verify " +
                     file +
                     "`; a designed shot is read by film.from_file, a course by race.course: "
                     "--set input=" +
                     file);
  if (script.extension() == ".yaml" || script.extension() == ".yml")
    throw InputError("'" + file +
                     "' is not a mission script, NAME.lua; a configuration is applied to "
                     "one by --config " +
                     file + "; a course is read by race.course: --set input=" + file);
  if (!fs::exists(script) && fs::exists(file + ".lua"))
    throw InputError("cannot read '" + file + "'; did you mean '" + file + ".lua'?");
}

MissionSettings mission_settings(const Invocation& invocation, const Registry& registry) {
  MissionSettings settings;
  settings.scripts = shipped_folder("scripts");
  settings.configs = shipped_folder("configs");
  settings.seed = invocation.seed;
  settings.threads = invocation.threads > 0
                         ? invocation.threads
                         : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  settings.data = data_folders(invocation);
  settings.registry = &registry;
  return settings;
}

std::unique_ptr<Mission> load_mission(const fs::path& script, const Invocation& invocation,
                                      const Registry& registry,
                                      const CancellationToken* cancellation, Progress* progress,
                                      std::function<void()> before_print,
                                      const MissionObservers& observers) {
  require_script(script);
  MissionSettings settings = mission_settings(invocation, registry);
  ConfigSearch search;
  search.folders = {settings.configs};
  std::vector<Value> layers;
  for (const std::string& name : invocation.configs) layers.push_back(mission_config(name, search));
  settings.limits = sandbox_limits(layers, invocation.overrides);
  if (!invocation.from.empty())
    settings.start = std::make_shared<const Plan>(read_plan_file(invocation.from));
  settings.cancellation = cancellation;
  settings.progress = progress;
  settings.observe_surface = observers.surface;
  settings.observe_tour = observers.tour;
  settings.record_steps = observers.steps;
  settings.print = [quiet = invocation.quiet, before_print](const std::string& line) {
    logging::info(line);
    if (quiet) return;
    if (before_print) before_print();
    std::cerr << visible_text(line) << "\n";
  };
  auto mission = std::make_unique<Mission>(script, std::move(settings));
  mission->configure(layers, invocation.overrides);
  return mission;
}

}  // namespace lapwing
