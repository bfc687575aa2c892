// SPDX-License-Identifier: Apache-2.0
// A flight log from a file, by the plugin that knows its format.
#pragma once

#include <filesystem>
#include <string>

#include "framework/flight_log/flight_log.h"
#include "framework/plugin/registry.h"

namespace lapwing {

// `format`: NAME[:KEY=VALUE,...] of a reader, as --format takes it; empty: the reader that
// recognizes the content. InputError, which names the file, for one that no reader or that several
// recognize, with the formats that can be read; and for what the reader refuses. Files of at most
// 2 GiB.
FlightLog read_flight_log(const std::filesystem::path& file, const std::string& format,
                          const Registry& registry);

}  // namespace lapwing
