// Which plugin's code a thread is in: so that a crash, or a call that does not return, has a name.
//
//   const ActiveCall call(name, "evaluate");   // until the end of the scope
//
// Costs a few stores. Names must outlive the scope. Calls nest; the innermost counts.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace lapwing {

// Of one thread.
struct ActiveCallSlot;

class ActiveCall {
 public:
  // `brief`: a call that is expected to return soon; others may take as long as a flight needs.
  ActiveCall(const char* name, const char* call, bool brief = true);
  ~ActiveCall();
  ActiveCall(const ActiveCall&) = delete;
  ActiveCall& operator=(const ActiveCall&) = delete;

 private:
  ActiveCallSlot* slot_;
  const char *outer_name_, *outer_call_;
  bool outer_brief_;
};

// "plugin 'keep_low' in evaluate", of the calling thread; "" outside of any. The pointers may be
// read in a signal handler: nothing is allocated.
struct ActiveCallName {
  const char* name = nullptr;  // null: none
  const char* call = nullptr;
};
ActiveCallName active_call();

// Every brief call that any thread is in: its name, and a number that differs from call to call.
struct RunningCall {
  std::string name, call;
  std::uint64_t serial = 0;
};
std::vector<RunningCall> running_brief_calls();

}  // namespace lapwing
