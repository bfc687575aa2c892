// SPDX-License-Identifier: Apache-2.0
#include "framework/core/library_path.h"

#include <dlfcn.h>

namespace lapwing {

std::filesystem::path library_file() {
  Dl_info info{};
  if (::dladdr(reinterpret_cast<const void*>(&library_file), &info) == 0) return {};
  std::error_code code;
  const std::filesystem::path library = std::filesystem::canonical(info.dli_fname, code);
  return code ? std::filesystem::path() : library;
}

std::filesystem::path library_folder() {
  return library_file().parent_path();
}

}  // namespace lapwing
