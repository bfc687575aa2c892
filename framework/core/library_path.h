// SPDX-License-Identifier: Apache-2.0
// Where this library was loaded from, for what lies beside it: plugins, configurations, scripts.
#pragma once

#include <filesystem>

namespace lapwing {

// liblapwing, links resolved; empty when the system cannot tell.
std::filesystem::path library_file();

// The folder that holds it.
std::filesystem::path library_folder();

}  // namespace lapwing
