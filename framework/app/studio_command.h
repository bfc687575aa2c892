// SPDX-License-Identifier: Apache-2.0
// lapwing studio, and the working processes that it starts.
#pragma once

#include <cstdint>
#include <filesystem>

#include "framework/app/command_line.h"
#include "framework/app/command_options.h"

namespace lapwing {

struct StudioRequest {
  std::filesystem::path script, assets, backdrop;
  std::uint16_t port = 0;
  bool no_open = false;
};

void add_studio_commands(CLI::App& app, Invocation& invocation, StudioRequest& asked,
                         Command& command);

}  // namespace lapwing
