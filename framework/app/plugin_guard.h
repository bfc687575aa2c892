// SPDX-License-Identifier: Apache-2.0
// What the program does when a plugin's code crashes, or does not return.
#pragma once

namespace lapwing {

// From now on a crash inside a plugin's call names the plugin, and so does a plugin that ends the
// program by `exit`, a brief call (one evaluation of a term) that does not return for `seconds`,
// and a lengthy one (a solve) that for five times as long neither evaluates nor asks whether it was
// cancelled: each ends the program with exit status 3 and a line on standard error. Counted is what
// the process worked in that time, at least a third of what passed: a machine that is busy with
// other things, or a stop of the process, is no plugin's fault. Only the first call counts. Keeps a
// thread for as long as the process lives.
void guard_plugin_calls(double seconds);

// What LAPWING_CALL_LIMIT says, in s; else 60. InputError where that is no number above 0.
double call_limit_from_environment();

}  // namespace lapwing
