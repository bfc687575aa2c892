// SPDX-License-Identifier: Apache-2.0
// Names of what is written beside its place, and what dead processes left of it.
#pragma once

#include <filesystem>
#include <string>

namespace lapwing {

// ".NAME.tmp-PLACE-PID-START-COUNT": a name that no other process takes, and that tells whose it
// is. PLACE stands for the machine since its last start and for the space of process numbers, PID
// and START (clock ticks) for the process there. Long names are cut.
std::string temporary_name(const std::string& name);

// Removes what `temporary_name` named in `folder` for processes that no longer run; of a process
// that runs, nothing. What another place wrote goes when it is a day old: whether its process runs
// cannot be told. A process looks into each folder once. Never throws: it is housekeeping.
void clear_dead_temporaries(const std::filesystem::path& folder);

}  // namespace lapwing
