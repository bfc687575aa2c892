// What the program does when a plugin's code crashes, or does not return.
#pragma once

namespace lapwing {

// From now on a crash inside a plugin's call names the plugin, and a brief call (one evaluation of
// a term) that does not return for `seconds` ends the program with its name: both with exit
// status 3. Once per process; keeps a thread for as long as it lives.
void guard_plugin_calls(double seconds);

// What LAPWING_CALL_LIMIT says, in s; else 60. InputError where that is no number above 0.
double call_limit_from_environment();

}  // namespace lapwing
