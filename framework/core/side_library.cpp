// SPDX-License-Identifier: Apache-2.0
#include "framework/core/side_library.h"

#include <dlfcn.h>

#include <string>

#include "framework/core/error.h"
#include "framework/core/library_path.h"

namespace lapwing {

void* side_function(const char* library, const char* function) {
  const std::filesystem::path file = library_folder() / "lapwing" / library;
  std::error_code code;
  if (!std::filesystem::exists(file, code)) return nullptr;
  void* const handle = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* const found = handle ? ::dlsym(handle, function) : nullptr;
  if (found) return found;
  const char* const why = ::dlerror();
  throw Error("cannot open '" + file.string() + "': " + (why ? why : "no reason is known"));
}

}  // namespace lapwing
