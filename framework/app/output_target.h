// SPDX-License-Identifier: Apache-2.0
// The file that a command writes beside its answer (-o).
#pragma once

#include <filesystem>
#include <vector>

namespace lapwing {

// InputError, before any work, where `target` cannot be written, is one of the files that the
// command reads, or would lose what cannot be made again from it: a script, a plan, a file of a
// run's folder. Any other file that is there will be replaced.
void require_output(const std::filesystem::path& target,
                    const std::vector<std::filesystem::path>& inputs = {});

}  // namespace lapwing
