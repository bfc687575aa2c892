// SPDX-License-Identifier: Apache-2.0
#include "framework/app/studio_command.h"

#include <fcntl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <iostream>

#include "framework/app/fleet_run.h"
#include "framework/app/interruption.h"
#include "framework/app/mission_loading.h"
#include "framework/app/provenance.h"
#include "framework/core/visible_text.h"
#include "framework/studio/patch.h"
#include "framework/studio/studio.h"
#include "framework/studio/worker.h"

namespace lapwing {
namespace {

// In the browser of the desktop, where there is one; nobody waits for it.
void open_in_browser(const std::string& address) {
  const pid_t child = ::fork();
  if (child != 0) return;
  ::setsid();
  const int nowhere = ::open("/dev/null", O_RDWR);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(nowhere, stream);
  ::execlp("xdg-open", "xdg-open", address.c_str(), static_cast<char*>(nullptr));
  ::_exit(1);
}

void add_folders(std::vector<std::string>& words, const char* option,
                 const std::vector<std::filesystem::path>& folders) {
  for (const std::filesystem::path& folder : folders)
    words.insert(words.end(), {option, folder.string()});
}

// What --config and --set change of the script's own options; checked, as for `lapwing run`.
Value laid_by_words(const StudioRequest& asked, const Invocation& invocation,
                    const Registry& registry) {
  if (invocation.configs.empty() && invocation.overrides.empty()) return Value::map();
  Invocation plain = invocation;
  plain.configs.clear();
  plain.overrides.clear();
  const auto script = load_mission(asked.script, plain, registry),
             mission = load_mission(asked.script, invocation, registry);
  for (const std::string& text : invocation.overrides)
    if (text.starts_with("sandbox."))
      throw InputError("--set " + text + ": the limits of a studio's script are the default ones");
  Value laid = layer_of(script->configuration(), mission->configuration());
  // An edit reads what the script may read: a file of elsewhere is refused here, not in every
  // solve.
  if (Value* input = laid.find("input")) {
    input->with_origin({asked.script.string(), 0});
    Mission reading(asked.script, mission_settings(invocation, registry));
    reading.configure(std::vector<Value>{laid}, {});
    reading.judge();
  }
  return laid;
}

ExitStatus open_studio(const StudioRequest& asked, const Invocation& invocation) {
  require_script(asked.script);
  const Interruption interruption;
  const Registry registry = invocation.registry();
  mission_settings(invocation, registry);  // folders that are none are told here
  StudioSettings settings;
  settings.laid = laid_by_words(asked, invocation, registry);
  settings.script = asked.script;
  settings.assets = asked.assets;
  settings.backdrop = asked.backdrop;
  settings.port = asked.port;
  settings.worker.words = {"lapwing", "studio-worker", asked.script.string()};
  settings.run_words = {"lapwing", "run",  asked.script.string(), "--json", "--quiet",
                        "--color", "never"};
  for (auto* words : {&settings.worker.words, &settings.run_words}) {
    add_folders(*words, "--data", invocation.data);
    add_folders(*words, "--plugin-path", invocation.plugin_path);
  }
  run_studio(settings, interruption.token(), [&](const std::string& address) {
    std::cout << visible_line(address) << std::endl;
    if (!asked.no_open) open_in_browser(address);
  });
  return ExitStatus::done;
}

ExitStatus work_for_studio(const StudioRequest& asked, const Invocation& invocation) {
  const Registry registry = invocation.registry();
  MissionSettings settings = mission_settings(invocation, registry);
  const auto judged = [&](const Plan& plan, const std::filesystem::path& folder,
                          const CancellationToken& token) {
    return judge(plan, folder, nullptr,
                 {.cancellation = &token, .controllers = controllers_of(invocation)})
        .certificate;
  };
  const auto fleet_judged = [&](MissionResult& result, const CancellationToken& token) {
    JudgedRun fleet = judge_run(
        result, false, {.cancellation = &token, .controllers = controllers_of(invocation)});
    return FleetVerdict{std::move(fleet.certificates), std::move(fleet.texts),
                        std::move(fleet.certificate)};
  };
  run_studio_worker(asked.script, settings, judged, fleet_judged,
                    std::string("lapwing ") + program_version());
  return ExitStatus::done;
}

void add_data(CLI::App& command, Invocation& invocation) {
  add_repeated(command, "--data", "DIR", invocation.data,
               "a folder that the script may read; repeatable; default: those of LAPWING_DATA");
}

}  // namespace

void add_studio_commands(CLI::App& app, Invocation& invocation, StudioRequest& asked,
                         Command& command) {
  CLI::App* studio =
      app.add_subcommand("studio", "edit, certify and fly a film in a browser of this machine");
  add_mission(*studio, asked.script);
  add_count(*studio, "--port", 1, 65535, "port on 127.0.0.1; default: one that is free",
            [&](std::uint64_t port) { asked.port = static_cast<std::uint16_t>(port); });
  studio->add_flag("--no-open", asked.no_open, "print the address and open no browser");
  add_text(*studio, "--assets", "DIR", "folder of the page's files; default: the page built in",
           [&](const std::string& path) { asked.assets = path; });
  add_text(
      *studio, "--backdrop", "FILE.tif",
      "GeoTIFF to be drawn beneath the scene, at its place on the earth: an orthophoto, a hill "
      "shading or heights; default: none",
      [&](const std::string& path) { asked.backdrop = path; });
  add_repeated(*studio, "--config", "FILE", invocation.configs,
               "a configuration file or its name in configs/, laid on the film as its first edit; "
               "repeatable, later ones win; default: none");
  add_repeated(*studio, "--set", "KEY=VALUE", invocation.overrides,
               "set one option likewise; repeatable, later ones win; default: none");
  add_data(*studio, invocation);
  studio->callback([&] { command = [&] { return open_studio(asked, invocation); }; });
  CLI::App* worker = app.add_subcommand("studio-worker", "a working process of a studio");
  worker->group("");
  add_mission(*worker, asked.script);
  add_data(*worker, invocation);
  worker->callback([&] { command = [&] { return work_for_studio(asked, invocation); }; });
}

}  // namespace lapwing
