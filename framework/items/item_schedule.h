// SPDX-License-Identifier: Apache-2.0
// How long items would take on other numbers of processes: a simulation, not a measurement.
#pragma once

#include "framework/items/item.h"

namespace lapwing {

struct ScheduleInput {
  const std::vector<Item>& items;
  std::vector<std::size_t> todo;
  std::vector<double> seconds;       // by item
  std::vector<double> preparations;  // by group
};

struct Schedule {
  int ranks = 1, threads = 1;
  double seconds = 0;  // until the last item is made
  double busy = 0;     // of the threads' time: the share in which they make items
};

// Simulates processes that take items from an ItemQueue. Process 0 answers one request at a time;
// every process prepares a group when it begins its first item of it, and keeps the last one.
// Processor, memory and disk are assumed to be as fast for many processes as for one.
Schedule simulate_schedule(const ScheduleInput& input, int ranks, int threads);

// The smallest number of processes that takes at most 5 % longer than `ranks` do.
int enough_ranks(const ScheduleInput& input, int ranks, int threads);

}  // namespace lapwing
