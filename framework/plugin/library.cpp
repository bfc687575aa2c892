// SPDX-License-Identifier: Apache-2.0
#include "framework/plugin/library.h"

#include <dlfcn.h>
#include <execinfo.h>

#include <array>
#include <atomic>
#include <cstring>
#include <map>
#include <mutex>

#include "framework/core/active_call.h"
#include "framework/core/error.h"

namespace lapwing {

namespace {

// Every library that was opened, for `library_in_stack`: never shortened.
constexpr int kMostOpened = 512;
std::array<std::atomic<const char*>, kMostOpened> opened_libraries;
std::atomic<int> opened_count{0};

void note_opened(const std::filesystem::path& path) {
  const int place = opened_count.load();  // under the lock of open_library
  if (place == kMostOpened) return;
  opened_libraries[place] = lasting_text(path.string());
  opened_count = place + 1;
}

const PluginLibrary* open_new(const std::filesystem::path& path) {
  const auto refuse = [&](const std::string& why) {
    throw InputError("cannot open plugin library '" + path.string() + "': " + why);
  };
  // Static objects are made in there; and of a file that was cut off even the loader crashes.
  const ActiveCall mark(lasting_text(path.string()), "dlopen");
  void* handle = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!handle) {
    const char* said = ::dlerror();
    const std::string why = said ? said : "unknown reason";
    // Words of the loader of glibc, where an address space is full.
    if (why.find("failed to map segment") != why.npos ||
        why.find("annot allocate memory") != why.npos)
      throw PluginError("cannot open plugin library '" + path.string() +
                        "': out of memory: it needs more than the system or a limit (ulimit -v) "
                        "gives (" +
                        why + ")");
    refuse(why);
  }
  note_opened(path);
  // Never closed, not even when it is refused: its static objects may be registered somewhere.
  void* symbol = ::dlsym(handle, kPluginLibrarySymbol);
  if (!symbol) {
    refuse(std::string("it has no symbol '") + kPluginLibrarySymbol +
           "'; a plugin library ends with LAPWING_PLUGINS(Class)");
  }
  const auto function = reinterpret_cast<PluginLibraryFunction>(symbol);
  const PluginLibrary* library =
      call_plugin(path.string(), kPluginLibrarySymbol, [&] { return function(); });
  if (!library || !library->abi_tag) refuse("it returns no description of itself");
  require_abi_tag(library->abi_tag, path);
  if (library->count == 0) refuse("it holds no plugin");
  return library;
}

}  // namespace

const char* library_in_stack() {
  constexpr int kDeepest = 64;
  void* frames[kDeepest];
  const int depth = ::backtrace(frames, kDeepest);
  for (int k = 0; k < depth; ++k) {
    Dl_info info{};
    if (::dladdr(frames[k], &info) == 0 || !info.dli_fname) continue;
    for (int i = 0; i < opened_count.load(); ++i)
      if (std::strcmp(opened_libraries[i].load(), info.dli_fname) == 0) return info.dli_fname;
  }
  return nullptr;
}

const PluginLibrary& open_library(const std::filesystem::path& path) {
  static std::mutex mutex;
  static std::map<std::filesystem::path, const PluginLibrary*> open;
  std::error_code code;
  const std::filesystem::path full = std::filesystem::canonical(path, code);
  if (code) {
    throw InputError("cannot open plugin library '" + path.string() + "': " + code.message());
  }
  const std::lock_guard<std::mutex> lock(mutex);
  const auto found = open.find(full);
  if (found != open.end()) return *found->second;
  return *open.emplace(full, open_new(full)).first->second;
}

void require_abi_tag(const std::string& tag, const std::filesystem::path& library) {
  if (tag == kAbiTag) return;
  throw InputError("plugin library '" + library.string() + "' was built as [" + tag +
                   "], this host as [" + kAbiTag +
                   "]; rebuild the plugin with this host's headers, compiler and build type");
}

}  // namespace lapwing
