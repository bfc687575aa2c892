// SPDX-License-Identifier: Apache-2.0
// A long command as a list of items: which are missing, who makes them, and what follows.
//
// Every process of the command calls the same functions. Process 0 looks at the folder, and writes
// everything but items.
#pragma once

#include <filesystem>
#include <memory>

#include "framework/core/value.h"
#include "framework/items/executor.h"
#include "framework/items/shard.h"

namespace lapwing {

// How the items of a command are to be made.
struct ItemOptions {
  bool resume = false;         // keep the items that are there
  std::optional<Shard> shard;  // make items of this part only, beside those that are there
  bool gather = false;         // make none: all must be there
  bool schedule = false;       // make none: simulate a schedule from measured times
  std::string executor;        // NAME[:KEY=VALUE,...]; "": as the program was started
  int usual_threads = 0;       // of an executor that leaves it open; 0: one per core
  bool portable = false;       // the same numbers on every processor (core/portable.h)

  // Whether items that are there are kept.
  bool continues() const { return resume || shard || gather || schedule; }
  // The option that asks for it, for messages; "" for none.
  std::string name() const;
};

struct ItemList {
  std::filesystem::path folder;
  std::vector<Item> items;  // no two of one file
  std::size_t groups = 1;   // Item::group is below it
  // Whether the item's file is there; InputError if what is there is another item.
  std::function<bool(std::size_t item)> is_made;
  // What the items of a group share; null: nothing.
  std::function<std::shared_ptr<const void>(std::size_t group)> prepare = nullptr;
  // Makes an item and writes its file, whole; called by several threads. InputError, Cancelled.
  std::function<void(std::size_t item, const void* prepared)> make;
  // Told in process 0 of every item that was made; null: nobody.
  std::function<void(std::size_t item)> done = nullptr;
};

// Thrown in a process that has nothing to say, because process 0 tells what happened.
class ToldByAnother : public Error {
 public:
  ToldByAnother() : Error("process 0 says what happened") {}
};

class ItemRun {
 public:
  // `threads`: of this process; 0: as the executor says. `say`: of messages to the user.
  ItemRun(Executor& executor, const ItemOptions& options, int threads,
          const CancellationToken& cancellation, std::function<void(const std::string&)> say);

  const ItemOptions& options() const { return options_; }
  int threads() const { return threads_; }
  bool leads() const { return executor_.rank() == 0; }

  // Makes what is missing. `statement`: all that the items depend on. `open`: called by process 0
  // alone before anything is read or written; it claims the folder, and refuses one that does not
  // fit. True in process 0 if all items are there, so that their results can be read; false in
  // others, after a shard, and after a simulated schedule (see `answer`).
  //
  // Throws InputError, Cancelled and what items throw; ToldByAnother in other processes.
  bool make(const ItemList& list, const Value& statement, const std::function<void()>& open);

  // This process failed before it called `make`: the others are told, and process 0 throws
  // InputError if it did not fail itself. Does nothing afterwards.
  void fail(const std::string& message);

  // What `make` came to where it returned false in process 0: an object and a text for the user.
  const Value& answer() const { return answer_; }
  const std::string& answer_text() const { return answer_text_; }

 private:
  void meet(const std::string& error, const std::string& identity);
  std::vector<std::size_t> missing(const ItemList& list) const;
  std::string decide(const ItemList& list, const std::function<void()>& open,
                     std::vector<std::size_t>& todo);
  void warn_of_few(const ItemList& list, const std::vector<std::size_t>& todo,
                   const std::vector<double>& expected,
                   const std::vector<double>& preparations) const;
  void simulate(const ItemList& list);
  void work(const ItemList& list, const std::vector<std::size_t>& todo);

  Executor& executor_;
  ItemOptions options_;
  int threads_;
  const CancellationToken& cancellation_;
  std::function<void(const std::string&)> say_;
  bool met_ = false;
  Value answer_;
  std::string answer_text_;
};

}  // namespace lapwing
