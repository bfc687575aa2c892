// SPDX-License-Identifier: Apache-2.0
// A command as a list of items, with the processes of an executor played by threads.
#include "framework/items/item_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <barrier>
#include <thread>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/items/item_threads.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// What the processes of one command have in common.
struct Meeting {
  explicit Meeting(int count) : texts(count), gate(count) {}
  std::vector<std::string> texts;
  std::barrier<> gate;
  ItemQueue* queue = nullptr;
  std::function<void(std::size_t, const ItemSeconds&)> done;
  std::mutex reporting;
  std::exception_ptr failure;
};

// One process of several: a thread of the test.
class PlayedExecutor final : public Executor {
 public:
  PlayedExecutor(Meeting& meeting, int rank) : meeting_(meeting), rank_(rank) {}
  int rank() const override { return rank_; }
  int ranks() const override { return static_cast<int>(meeting_.texts.size()); }
  int default_threads() const override { return 1; }
  std::vector<std::string> exchange(const std::string& text) override {
    meeting_.texts[static_cast<std::size_t>(rank_)] = text;
    meeting_.gate.arrive_and_wait();
    std::vector<std::string> all = meeting_.texts;
    meeting_.gate.arrive_and_wait();
    return all;
  }
  void run(const ItemWork& work) override {
    if (rank_ == 0) {
      meeting_.queue = &work.queue;
      meeting_.done = work.done;
    }
    meeting_.gate.arrive_and_wait();
    const ItemThreads threads(work,
                              {[&] { return meeting_.queue->take(rank_, work.prepared()); },
                               [&](std::size_t item, const ItemSeconds& seconds) {
                                 const std::lock_guard lock(meeting_.reporting);
                                 meeting_.done(item, seconds);
                               },
                               [&] { meeting_.queue->close(); }},
                              false);
    if (threads.failure()) meeting_.failure = threads.failure();
    meeting_.gate.arrive_and_wait();
    if (rank_ == 0 && meeting_.failure) std::rethrow_exception(meeting_.failure);
  }

 private:
  Meeting& meeting_;
  int rank_;
};

class ItemRuns : public testing::Test {
 protected:
  ItemRuns() : base_(fs::temp_directory_path() / ("lapwing_run_" + std::to_string(::getpid()))) {
    fs::remove_all(base_);
  }
  ~ItemRuns() override { fs::remove_all(base_); }

  ItemList list(std::size_t count) {
    ItemList list;
    list.folder = base_;
    for (std::size_t i = 0; i < count; ++i) list.items.push_back({std::to_string(i), 0, {}});
    list.is_made = [this](std::size_t item) { return fs::exists(base_ / std::to_string(item)); };
    list.make = [this](std::size_t item, const void*) {
      if (item == broken_) throw InputError("the disk is full");
      write_file_atomically(base_ / std::to_string(item), "item");
      ++made_;
    };
    return list;
  }

  // What each process came to: "results", "nothing", "told by another", or its refusal.
  std::vector<std::string> run(int ranks, const ItemOptions& options, std::size_t count,
                               int broken_rank = -1, int other_rank = -1) {
    Meeting meeting(ranks);
    std::vector<std::string> ends(static_cast<std::size_t>(ranks));
    std::vector<std::thread> processes;
    said_.clear();
    for (int rank = 0; rank < ranks; ++rank)
      processes.emplace_back([&, rank] {
        PlayedExecutor executor(meeting, rank);
        const CancellationToken token;
        ItemRun items(executor, options, 1, token, [&](const std::string& line) { said_ = line; });
        std::string& end = ends[static_cast<std::size_t>(rank)];
        try {
          if (rank == broken_rank) {
            items.fail("no such file");
            end = "went on";
            return;
          }
          Value statement = Value::map();
          statement.set("seed", rank == other_rank ? 2 : 1);
          end = items.make(list(count), statement, [&] { ++opened_; }) ? "results" : "nothing";
          if (rank == 0) answer_ = items.answer_text();
        } catch (const ToldByAnother&) {
          end = "told by another";
        } catch (const InputError& error) {
          end = error.what();
        }
      });
    for (std::thread& process : processes) process.join();
    return ends;
  }

  fs::path base_;
  std::size_t broken_ = ~std::size_t{0};
  std::atomic<int> made_{0}, opened_{0};
  std::string said_, answer_;
};

TEST_F(ItemRuns, OneProcessReadsTheResultsOfAll) {
  EXPECT_THAT(run(3, {}, 20), testing::ElementsAre("results", "nothing", "nothing"));
  EXPECT_EQ(made_, 20);
  EXPECT_EQ(opened_, 1);
  EXPECT_EQ(said_, "");
  // Nothing is missing any more.
  EXPECT_THAT(run(2, {}, 20), testing::ElementsAre("results", "nothing"));
  EXPECT_EQ(made_, 20);
}

TEST_F(ItemRuns, ShardsMakeTheirPartsAndGatheringNamesWhatIsMissing) {
  ItemOptions gather, shard;
  gather.gather = true;
  for (std::size_t number = 1; number <= 3; ++number) {
    shard.shard = Shard{number, 3};
    const std::string incomplete = run(1, gather, 10)[0];
    EXPECT_THAT(incomplete, HasSubstr("--gather: "));
    EXPECT_THAT(incomplete, HasSubstr("of 10 items in '"));
    EXPECT_THAT(incomplete, HasSubstr(number < 3 ? "missing: '0', " : "missing: '0', '3', '6'"));
    EXPECT_THAT(run(number == 2 ? 2 : 1, shard, 10)[0], "nothing");
    EXPECT_THAT(answer_, HasSubstr("shard " + shard.shard->text() + " is complete: "));
  }
  EXPECT_EQ(made_, 10);
  EXPECT_THAT(run(2, gather, 10), testing::ElementsAre("results", "nothing"));
}

TEST_F(ItemRuns, AFailureAnywhereIsSaidOnceByProcess0) {
  EXPECT_THAT(run(3, {}, 5, 2), testing::ElementsAre(testing::AllOf(HasSubstr("process 2 on '"),
                                                                    HasSubstr("': no such file")),
                                                     "told by another", "told by another"));
  EXPECT_THAT(run(2, {}, 5, 0), testing::ElementsAre("no such file", "told by another"));
  EXPECT_THAT(
      run(2, {}, 5, -1, 1),
      testing::ElementsAre(HasSubstr("has other inputs than process 0"), "told by another"));
  EXPECT_EQ(opened_, 0);
  broken_ = 2;
  EXPECT_THAT(run(2, {}, 5), testing::ElementsAre("the disk is full", "nothing"));
  EXPECT_FALSE(fs::exists(base_ / "2"));
}

TEST_F(ItemRuns, TooFewItemsAreWarnedOf) {
  run(4, {}, 2);
  EXPECT_THAT(said_, HasSubstr("2 items are few for 4 processes by 1 thread"));
  EXPECT_THAT(said_, HasSubstr("in a simulated schedule the threads work for 50 % of the time"));
  EXPECT_THAT(said_, HasSubstr("2 processes would take as long"));
}

TEST_F(ItemRuns, AScheduleIsSimulatedFromMeasuredTimes) {
  ItemOptions schedule;
  schedule.schedule = true;
  EXPECT_THAT(run(1, schedule, 40)[0], HasSubstr("has a measured time"));
  ItemOptions shard;
  shard.shard = Shard{1, 10};
  run(1, shard, 40);
  EXPECT_EQ(made_, 4);
  EXPECT_EQ(run(1, schedule, 40)[0], "nothing");
  EXPECT_EQ(made_, 4);
  EXPECT_THAT(answer_, HasSubstr("A simulation, not a measurement: 40 items, 4 of them"));
  EXPECT_THAT(answer_, HasSubstr("\n     1000  "));
}

}  // namespace
}  // namespace lapwing
