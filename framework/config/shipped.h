// SPDX-License-Identifier: Apache-2.0
// The files that come with Lapwing: configurations and scripts.
#pragma once

#include <filesystem>
#include <string>

namespace lapwing {

// The folder that holds configs/ and scripts/: LAPWING_HOME if set; else, of an installed library,
// <prefix>/share/lapwing; else the source tree that it was built from. InputError when there is
// none, or when LAPWING_HOME holds neither.
std::filesystem::path shipped_root();

// A folder below it, such as "configs" or "scripts". InputError when it is not there.
std::filesystem::path shipped_folder(const std::string& name);

}  // namespace lapwing
