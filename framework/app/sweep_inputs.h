// SPDX-License-Identifier: Apache-2.0
// What a run of a sweep has read beside its script, so that --resume never mixes results of
// different inputs.
#pragma once

#include <filesystem>
#include <string>

namespace lapwing {

// Writes `inputs.json` into a run's folder: the checksum of every file and folder that the run's
// log says it read. Writes nothing where there is no log, or where one of them cannot be read: of
// such a run it is not known what it was made of.
void keep_inputs(const std::filesystem::path& run_folder);

bool has_inputs(const std::filesystem::path& run_folder);

// The first of them that is gone or has changed since; "" where there is none. InputError where
// `inputs.json` is malformed.
std::string changed_input(const std::filesystem::path& run_folder);

}  // namespace lapwing
