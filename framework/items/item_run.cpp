// SPDX-License-Identifier: Apache-2.0
#include "framework/items/item_run.h"

#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>

#include "framework/core/checksum.h"
#include "framework/core/json.h"
#include "framework/core/parallel.h"
#include "framework/core/portable.h"
#include "framework/items/item_schedule.h"
#include "framework/items/item_times.h"
#include "framework/items/prepared_groups.h"

namespace lapwing {

namespace {

using Clock = std::chrono::steady_clock;

constexpr double kIdle = 0.7;  // share of busy threads below which the user is warned
constexpr int kSimulatedRanks[] = {1, 2, 5, 10, 20, 50, 100, 200, 500, 1000};
constexpr std::size_t kNamedFiles = 3;  // in messages

// What process 0 says after it has looked at the folder.
constexpr const char* kGo = "go";
constexpr const char* kNothing = "nothing";
constexpr const char* kRefused = "refused";

std::string host_name() {
  char name[256] = "";
  ::gethostname(name, sizeof name - 1);
  return name;
}

// A part of what processes tell each other: "NAME SIZE\n" and the text.
std::string record(const std::string& text) {
  return std::to_string(text.size()) + "\n" + text;
}

std::vector<std::string> records_in(const std::string& text) {
  std::vector<std::string> parts;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    const std::size_t size = std::stoull(text.substr(at, end - at));
    parts.push_back(text.substr(end + 1, size));
    at = end + 1 + size;
  }
  return parts;
}

std::string count_of(std::size_t count, const char* what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

}  // namespace

std::string ItemOptions::name() const {
  return gather     ? "--gather"
         : schedule ? "--schedule"
         : shard    ? "--shard"
         : resume   ? "--resume"
                    : "";
}

ItemRun::ItemRun(Executor& executor, const ItemOptions& options, int threads,
                 const CancellationToken& cancellation, std::function<void(const std::string&)> say)
    : executor_(executor),
      options_(options),
      threads_(threads > 0 ? threads : executor.default_threads()),
      cancellation_(cancellation),
      say_(std::move(say)) {
  if (threads_ <= 0) threads_ = options.usual_threads;
  if (threads_ <= 0) threads_ = available_threads();
}

// All processes tell each other whether they could begin, and what they would compute.
void ItemRun::meet(const std::string& error, const std::string& identity) {
  met_ = true;
  std::string own;
  for (const std::string& part : {error, host_name(), machine_of_numbers(), identity})
    own += record(part);
  const std::vector<std::string> all = executor_.exchange(own);
  const std::vector<std::string> first = records_in(all[0]);
  std::string refusal;
  for (std::size_t rank = 0; rank < all.size() && refusal.empty(); ++rank) {
    const std::vector<std::string> theirs = records_in(all[rank]);
    const std::string who = "process " + std::to_string(rank) + " on '" + theirs[1] + "'";
    if (!theirs[0].empty())
      refusal = rank == 0 ? theirs[0] : who + ": " + theirs[0];
    else if (theirs[2] != first[2])
      refusal = who + " is on another machine (" + theirs[2] + ") than process 0 on '" + first[1] +
                "' (" + first[2] +
                "), and results would differ in their last digits; use --portable";
    else if (theirs[3] != first[3])
      refusal = who + " has other inputs than process 0 on '" + first[1] +
                "'; files and programs must be the same everywhere";
  }
  if (refusal.empty()) return;
  if (leads()) throw InputError(refusal);
  throw ToldByAnother();
}

void ItemRun::fail(const std::string& message) {
  if (!met_) meet(message.empty() ? "failed" : message, "");
}

std::vector<std::size_t> ItemRun::missing(const ItemList& list) const {
  std::vector<std::size_t> todo;
  for (std::size_t item = 0; item < list.items.size(); ++item) {
    if (options_.shard && !options_.shard->has(item)) continue;
    if (!list.is_made(item)) todo.push_back(item);
  }
  return todo;
}

// What process 0 decides: one of the words above.
std::string ItemRun::decide(const ItemList& list, const std::function<void()>& open,
                            std::vector<std::size_t>& todo) {
  open();
  if (options_.schedule) {
    simulate(list);
    return kNothing;
  }
  todo = missing(list);
  if (options_.gather && !todo.empty()) {
    std::string names;
    for (std::size_t k = 0; k < std::min(todo.size(), kNamedFiles); ++k)
      names += (k == 0 ? "'" : ", '") + list.items[todo[k]].file + "'";
    throw InputError("--gather: " + std::to_string(todo.size()) + " of " +
                     count_of(list.items.size(), "item") + " in '" + list.folder.string() +
                     "' are missing: " + names + (todo.size() > kNamedFiles ? ", ..." : "") +
                     "; --shard or --resume makes them");
  }
  return todo.empty() ? kNothing : kGo;
}

bool ItemRun::make(const ItemList& list, const Value& statement,
                   const std::function<void()>& open) {
  meet("", sha256(to_json(statement, -1)) + " " + std::to_string(list.items.size()));
  std::vector<std::size_t> todo;
  std::string decision = kRefused;
  if (leads()) {
    try {
      decision = decide(list, open, todo);
    } catch (...) {
      executor_.exchange(decision);
      throw;
    }
  }
  decision = executor_.exchange(decision)[0];
  if (!leads() && decision == kRefused) throw ToldByAnother();
  if (decision == kGo) work(list, todo);
  if (!leads() || options_.schedule) return false;
  if (!options_.shard) return true;
  std::size_t own = 0;
  for (std::size_t item = 0; item < list.items.size(); ++item) own += options_.shard->has(item);
  answer_ = Value::map();
  answer_.set("status", "ok");
  answer_.set("shard", options_.shard->text());
  answer_.set("items", static_cast<std::int64_t>(own));
  answer_.set("items_of_all_shards", static_cast<std::int64_t>(list.items.size()));
  answer_text_ = "shard " + options_.shard->text() + " is complete: " + std::to_string(own) +
                 " of " + count_of(list.items.size(), "item") +
                 "; --gather reads the results of all shards";
  return false;
}

void ItemRun::warn_of_few(const ItemList& list, const std::vector<std::size_t>& todo,
                          const std::vector<double>& expected,
                          const std::vector<double>& preparations) const {
  if (executor_.ranks() == 1) return;
  const ScheduleInput input{list.items, todo, expected, preparations};
  const Schedule schedule = simulate_schedule(input, executor_.ranks(), threads_);
  if (schedule.busy >= kIdle) return;
  const int enough = enough_ranks(input, executor_.ranks(), threads_);
  char busy[16];
  std::snprintf(busy, sizeof busy, "%.0f %%", 100 * schedule.busy);
  say_("warning: " + count_of(todo.size(), "item") + (todo.size() == 1 ? " is" : " are") +
       " few for " + std::to_string(executor_.ranks()) + " processes by " +
       count_of(static_cast<std::size_t>(threads_), "thread") +
       ": in a simulated schedule the threads work for " + busy + " of the time" +
       (enough < executor_.ranks()
            ? ", and " + std::to_string(enough) + (enough == 1 ? " process" : " processes") +
                  " would take as long"
            : ""));
}

void ItemRun::work(const ItemList& list, const std::vector<std::size_t>& todo) {
  std::vector<double> expected(list.items.size(), 1);
  std::unique_ptr<ItemTimesLog> log;
  if (leads()) {
    const ItemTimes times = ItemTimes::read(list.folder);
    expected = times.expected(list.items);
    warn_of_few(list, todo, expected, times.preparations(list.items, list.groups));
    log = std::make_unique<ItemTimesLog>(
        list.folder, options_.shard ? std::to_string(options_.shard->number) + "_of_" +
                                          std::to_string(options_.shard->count)
                                    : "");
  }
  PreparedGroups prepared(list.prepare);
  ItemQueue queue(list.items, todo, expected);
  const ItemWork work{.queue = queue,
                      .threads = threads_,
                      .make =
                          [&](std::size_t item) {
                            ItemSeconds seconds;
                            std::shared_ptr<const void> group;
                            if (list.prepare)
                              group = prepared.use(list.items[item].group, seconds.preparation);
                            const auto begun = Clock::now();
                            list.make(item, group.get());
                            seconds.item =
                                std::chrono::duration<double>(Clock::now() - begun).count();
                            return seconds;
                          },
                      .prepared = [&] { return prepared.held(); },
                      .done =
                          [&](std::size_t item, const ItemSeconds& seconds) {
                            log->add(list.items[item].file, seconds);
                            if (list.done) list.done(item);
                          },
                      .cancellation = &cancellation_};
  executor_.run(work);
}

void ItemRun::simulate(const ItemList& list) {
  const ItemTimes times = ItemTimes::read(list.folder);
  const std::size_t measured = times.count(list.items);
  if (measured == 0)
    throw InputError("--schedule: no item in '" + list.folder.string() +
                     "' has a measured time; make some first, as with --shard 1/10");
  std::vector<std::size_t> all(list.items.size());
  for (std::size_t item = 0; item < all.size(); ++item) all[item] = item;
  const ScheduleInput input{list.items, all, times.expected(list.items),
                            times.preparations(list.items, list.groups)};
  answer_ = Value::map();
  answer_.set("status", "ok");
  answer_.set("simulated", true);
  answer_.set("items", static_cast<std::int64_t>(all.size()));
  answer_.set("measured_items", static_cast<std::int64_t>(measured));
  answer_.set("threads", threads_);
  Value& rows = answer_.set("schedules", Value::list());
  answer_text_ = "A simulation, not a measurement: " + count_of(all.size(), "item") + ", " +
                 std::to_string(measured) + " of them with measured times; processes by " +
                 count_of(static_cast<std::size_t>(threads_), "thread") + "\n" +
                 "processes        time  faster    busy\n";
  const double alone = simulate_schedule(input, 1, threads_).seconds;
  for (const int ranks : kSimulatedRanks) {
    const Schedule schedule = simulate_schedule(input, ranks, threads_);
    Value row = Value::map();
    row.set("processes", ranks);
    row.set("seconds", schedule.seconds);
    row.set("busy", schedule.busy);
    rows.push_back(std::move(row));
    char line[80];
    std::snprintf(line, sizeof line, "%9d  %8.1f s  %5.1fx  %4.0f %%\n", ranks, schedule.seconds,
                  alone / schedule.seconds, 100 * schedule.busy);
    answer_text_ += line;
  }
  answer_text_.pop_back();
}

}  // namespace lapwing
