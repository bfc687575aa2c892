// Work in a process of its own: what ends that process, or keeps it for ever, harms nobody else.
// For libraries that do not survive hostile files.
#pragma once

#include <functional>
#include <string>

namespace lapwing {

struct ProcessLimits {
  double seconds = 60;         // of wall clock
  double memory = 8ull << 30;  // bytes of address space beyond what this process has
};

// Calls `work` in a copy of this process and returns the bytes that it returns. An InputError of
// `work` is thrown here with its text; so is one, naming `what` was to be done, when the copy
// crashes, exceeds a limit or throws anything else. Whatever `work` changes is lost. Throws Error
// when there can be no other process.
std::string in_own_process(const std::string& what, const ProcessLimits& limits,
                           const std::function<std::string()>& work);

}  // namespace lapwing
