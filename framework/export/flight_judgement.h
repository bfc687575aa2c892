// SPDX-License-Identifier: Apache-2.0
// Whether a file that vehicles fly may be written: the judgement that every export makes of it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/export/exporter.h"

namespace lapwing {

// Of `written`, what `exporter.write` gave for `plan`: how far its flight is from the plan, as
// sentences for the user; none of a format that no vehicle flies. `folder` holds the files that the
// plan's environment names. Throws InputError, which begins with `what` ("--format qgc_plan"), for
// a flight that breaks what the plan keeps; and what the exporter throws.
std::vector<std::string> judge_written_flight(const Exporter& exporter, const Plan& plan,
                                              const std::string& written,
                                              const std::filesystem::path& folder,
                                              const std::string& what);

}  // namespace lapwing
