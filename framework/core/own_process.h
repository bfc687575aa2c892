// SPDX-License-Identifier: Apache-2.0
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

// How such work ended: with its answer; by an InputError or another exception; by a signal; or it
// was stopped after its time.
enum class ProcessEnd { answered, refused, failed, crashed, overtime };
struct ProcessResult {
  ProcessEnd end = ProcessEnd::answered;
  std::string text;  // the answer, the exception's text, or the signal's name
};

// Calls `work` in a copy of this process. Whatever it changes is lost. Throws Error when there can
// be no other process.
ProcessResult run_in_own_process(const ProcessLimits& limits,
                                 const std::function<std::string()>& work);

// Calls `work` in a copy of this process and returns the bytes that it returns. An InputError of
// `work` is thrown here with its text; so is one, naming `what` was to be done, when the copy
// crashes, exceeds a limit or throws anything else. Whatever `work` changes is lost. Throws Error
// when there can be no other process.
std::string in_own_process(const std::string& what, const ProcessLimits& limits,
                           const std::function<std::string()>& work);

}  // namespace lapwing
