// SPDX-License-Identifier: Apache-2.0
// Opening a plugin library. The one place that calls dlopen.
#pragma once

#include <filesystem>
#include <string>

#include "framework/plugin/plugin.h"

namespace lapwing {

// Opens the library, or returns it if it is open already; it stays open for good. Its ABI tag has
// been compared with this host's before anything else of it was read. Thread-safe. InputError names
// the file and says why: the loader's own reason, the missing symbol, or both tags and the cure.
const PluginLibrary& open_library(const std::filesystem::path& path);

// The plugin library that the calling thread's stack leads through, or null: for code that no call
// is marked of (active_call.h), as destructors are. May be called in a signal handler once it was
// called before: it loads what it needs then.
const char* library_in_stack();

// InputError, naming both tags and the cure, when `tag` is not this host's.
void require_abi_tag(const std::string& tag, const std::filesystem::path& library);

}  // namespace lapwing
