// SPDX-License-Identifier: Apache-2.0
// The studio: a mission in a browser, edited, certified and flown there.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "framework/core/progress.h"
#include "framework/studio/worker_link.h"

namespace lapwing {

struct StudioSettings {
  std::filesystem::path script;
  std::filesystem::path assets;        // folder of the page; empty: what was built in
  std::filesystem::path backdrop;      // a raster beneath the scene; empty: none
  std::uint16_t port = 0;              // 0: one is chosen
  WorkerProgram worker;                // the words of a working process
  std::vector<std::string> run_words;  // of `lapwing run` for reports
  Value laid = Value::map();           // options that the command line lays on the script
};

// Serves until the token is cancelled. `ready` is told the address once it can be opened.
// InputError where the script is no file, the port is taken, another studio has the script, or
// there is no page.
void run_studio(const StudioSettings& settings, const CancellationToken& token,
                const std::function<void(const std::string& address)>& ready);

// Whether this build has the page in it.
bool has_built_page();

}  // namespace lapwing
