// SPDX-License-Identifier: Apache-2.0
// Which plugin's code a thread is in: so that a crash, an exit, or a call that does not return, has
// a name.
//
//   const ActiveCall call(name, "evaluate");   // until the end of the scope
//
// Costs a few stores. Calls nest; the innermost counts. Mostly by way of plugin_object.h.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lapwing {

// Of one thread.
struct ActiveCallSlot;

// A brief call is expected to return soon. A long one, as a solver's, may take what a flight needs,
// but while it works it evaluates, or asks whether it was cancelled.
enum class CallLength { brief, lengthy };

class ActiveCall {
 public:
  // Both texts outlive the scope. A null name: within it no plugin's code runs.
  ActiveCall(const char* name, const char* call, CallLength length = CallLength::brief);
  ~ActiveCall();
  ActiveCall(const ActiveCall&) = delete;
  ActiveCall& operator=(const ActiveCall&) = delete;

 private:
  ActiveCallSlot* slot_;
  const char *outer_name_, *outer_call_;
  CallLength outer_length_;
};

// A copy that is never freed, the same for equal texts: for names of plugins, which are few.
const char* lasting_text(std::string_view text);

// "plugin 'keep_low' in evaluate", of the calling thread; null outside of any. The pointers may be
// read in a signal handler: nothing is allocated.
struct ActiveCallName {
  const char* name = nullptr;
  const char* call = nullptr;
  CallLength length = CallLength::brief;
};
ActiveCallName active_call();

// The calling thread shows that it works: whoever asks whether work was cancelled does so.
void show_activity();

// Every call that any thread is in: its name, and a number that differs from call to call.
struct RunningCall {
  std::string name, call;
  CallLength length = CallLength::brief;
  std::uint64_t serial = 0;
};
std::vector<RunningCall> running_calls();
// Grows with every call that any thread begins or ends, and with `show_activity`.
std::uint64_t activity_of_calls();

}  // namespace lapwing
