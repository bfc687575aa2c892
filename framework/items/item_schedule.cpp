// SPDX-License-Identifier: Apache-2.0
#include "framework/items/item_schedule.h"

#include <algorithm>
#include <queue>

#include "framework/items/item_queue.h"

namespace lapwing {

namespace {

// Of the executor `mpi`: until a request is answered, and work of process 0 for one request
// (plugins/executors/mpi/README.md, "Dispatch").
constexpr double kLatency = 1e-3, kService = 1e-4;  // s

constexpr double kLonger = 1.05;  // what counts as not taking longer

struct FreeThread {
  double at;
  int rank;
  std::size_t order;  // of equal times: the one that waits longest

  bool operator>(const FreeThread& other) const {
    return at != other.at ? at > other.at : order > other.order;
  }
};

struct HeldGroup {
  std::size_t group;
  double ready, last_use_ends;
};

// The groups of one process at a time: those in use then, and the last one.
std::vector<std::size_t> groups_at(std::vector<HeldGroup>& held, double time) {
  if (held.size() > 1)
    held.erase(std::remove_if(held.begin(), held.end() - 1,
                              [&](const HeldGroup& one) { return one.last_use_ends <= time; }),
               held.end() - 1);
  std::vector<std::size_t> groups;
  for (const HeldGroup& one : held) groups.push_back(one.group);
  return groups;
}

}  // namespace

Schedule simulate_schedule(const ScheduleInput& input, int ranks, int threads) {
  ItemQueue queue(input.items, input.todo, input.seconds);
  std::priority_queue<FreeThread, std::vector<FreeThread>, std::greater<>> waiting;
  std::size_t order = 0;
  for (int thread = 0; thread < threads; ++thread)
    for (int rank = 0; rank < ranks; ++rank) waiting.push({0, rank, order++});
  std::vector<std::vector<HeldGroup>> held(static_cast<std::size_t>(ranks));
  Schedule schedule{ranks, threads, 0, 0};
  double server_free = 0, working = 0;
  while (!waiting.empty()) {
    const FreeThread free = waiting.top();
    waiting.pop();
    double begin = free.at;
    if (free.rank > 0) {  // process 0 takes its own without a message
      server_free = std::max(server_free, free.at) + kService;
      begin = server_free + kLatency;
    }
    auto& own = held[static_cast<std::size_t>(free.rank)];
    const auto item = queue.take(free.rank, groups_at(own, free.at));
    if (!item) continue;
    const std::size_t group = input.items[*item].group;
    auto place = std::find_if(own.begin(), own.end(),
                              [&](const HeldGroup& one) { return one.group == group; });
    if (place == own.end()) {
      const double seconds = group < input.preparations.size() ? input.preparations[group] : 0;
      own.push_back({group, begin + seconds, 0});
      place = own.end() - 1;
    } else {
      std::rotate(place, place + 1, own.end());
      place = own.end() - 1;
    }
    const double end = std::max(begin, place->ready) + input.seconds[*item];
    place->last_use_ends = std::max(place->last_use_ends, end);
    working += input.seconds[*item];
    schedule.seconds = std::max(schedule.seconds, end);
    waiting.push({end, free.rank, order++});
  }
  if (schedule.seconds > 0)
    schedule.busy = working / (schedule.seconds * static_cast<double>(ranks) * threads);
  return schedule;
}

int enough_ranks(const ScheduleInput& input, int ranks, int threads) {
  const double most = kLonger * simulate_schedule(input, ranks, threads).seconds;
  int enough = ranks;
  while (enough > 1 && simulate_schedule(input, enough - 1, threads).seconds <= most) --enough;
  return enough;
}

}  // namespace lapwing
