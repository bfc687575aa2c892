#include "framework/app/allocation_counter.h"
#include "framework/app/command_line.h"
#include "framework/app/plugin_check.h"

int main(int argc, char** argv) {
  // So that `plugins check` can say which calls allocate.
  lapwing::count_allocations_by(lapwing::allocation_counter());
  return lapwing::run_command_line(argc, argv);
}
