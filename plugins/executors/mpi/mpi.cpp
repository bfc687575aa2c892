// SPDX-License-Identifier: Apache-2.0
// The items of a command in the processes that mpirun started.
//
// Process 0 answers requests for items in its main thread, and makes items in others. Messages are
// two-sided: a counter that others read one-sidedly makes progress only when its owner calls MPI,
// and processes waited for seconds while that computed. All waiting is by looks at intervals,
// because waiting inside of MPI occupies a core.
#include <mpi.h>

#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <cstring>
#include <deque>

#include "framework/core/error.h"
#include "framework/items/executor.h"
#include "framework/items/item_threads.h"
#include "framework/plugin/plugin.h"

namespace lapwing {
namespace {

constexpr std::uint64_t kNoItem = ~std::uint64_t{0};
constexpr std::size_t kLongestFailure = 2000;  // bytes; small messages need no waiting receiver

// Messages to process 0 are a kind and a body; its answers have the tag kAnswer.
enum Tag { kRequest = 1, kAnswer = 2 };
enum class Kind : std::uint64_t { ask, report, failure, end };
enum class FailureKind : std::uint64_t { input, cancelled, other };

// Once a process: MPI cannot be begun again after its end.
void begin_mpi() {
  int begun = 0;
  MPI_Initialized(&begun);
  if (begun) return;
  int level = 0;
  if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &level) != MPI_SUCCESS)
    throw InputError("executor 'mpi': MPI could not begin; start the program by mpirun");
  if (level < MPI_THREAD_FUNNELED)
    throw InputError("executor 'mpi': this MPI library was built without threads");
  std::atexit([] {
    int ended = 0;
    MPI_Finalized(&ended);
    if (!ended) MPI_Finalize();
  });
}

void put(std::string& message, std::uint64_t number) {
  message.append(reinterpret_cast<const char*>(&number), sizeof number);
}
void put(std::string& message, double number) {
  message.append(reinterpret_cast<const char*>(&number), sizeof number);
}

// Reads what `put` wrote, in its order.
class Reader {
 public:
  explicit Reader(const std::string& message) : message_(message) {}
  template <class Number>
  Number get() {
    Number number{};
    if (message_.size() - at_ < sizeof number) throw Error("executor 'mpi': a short message");
    std::memcpy(&number, message_.data() + at_, sizeof number);
    at_ += sizeof number;
    return number;
  }
  bool at_end() const { return at_ == message_.size(); }
  std::string rest() const { return message_.substr(at_); }

 private:
  const std::string& message_;
  std::size_t at_ = 0;
};

void send(const std::string& message, int to, Tag tag) {
  MPI_Send(message.data(), static_cast<int>(message.size()), MPI_BYTE, to, tag, MPI_COMM_WORLD);
}

// A failure of an item, as text, and back.
std::string text_of(const std::exception_ptr& failure) {
  FailureKind kind = FailureKind::other;
  std::string text = "an exception of unknown type";
  try {
    std::rethrow_exception(failure);
  } catch (const InputError& error) {
    kind = FailureKind::input;
    text = error.what();
  } catch (const Cancelled& error) {
    kind = FailureKind::cancelled;
    text = error.what();
  } catch (const std::exception& error) {
    text = error.what();
  } catch (...) {
  }
  std::string message;
  put(message, static_cast<std::uint64_t>(Kind::failure));
  put(message, static_cast<std::uint64_t>(kind));
  return message + text.substr(0, kLongestFailure);
}

std::exception_ptr failure_in(Reader& message, int rank) {
  const auto kind = static_cast<FailureKind>(message.get<std::uint64_t>());
  const std::string text = "process " + std::to_string(rank) + ": " + message.rest();
  if (kind == FailureKind::cancelled) return std::make_exception_ptr(Cancelled());
  if (kind == FailureKind::input) return std::make_exception_ptr(InputError(text));
  return std::make_exception_ptr(Error(text));
}

class Mpi final : public Executor {
 public:
  static constexpr PluginText kText{"mpi", "1.0.0", "the processes that mpirun started",
                                    "MPI: A Message-Passing Interface Standard, version 3.1"};
  static ParameterTable parameters() {
    ParameterTable table;
    table.number("interval", 5e-4, "s", "time between two looks for messages", between(1e-5, 0.1));
    return table;
  }

  explicit Mpi(const Parameters& parameters) : interval_(parameters.number("interval")) {
    begin_mpi();
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks_);
  }

  int rank() const override { return rank_; }
  int ranks() const override { return ranks_; }
  int default_threads() const override { return 1; }

  std::vector<std::string> exchange(const std::string& text) override {
    const int size = static_cast<int>(text.size());
    std::vector<int> sizes(ranks_), places(ranks_, 0);
    MPI_Request request = MPI_REQUEST_NULL;
    MPI_Iallgather(&size, 1, MPI_INT, sizes.data(), 1, MPI_INT, MPI_COMM_WORLD, &request);
    wait(request);
    for (int r = 1; r < ranks_; ++r) places[r] = places[r - 1] + sizes[r - 1];
    std::string all(static_cast<std::size_t>(places.back() + sizes.back()), '\0');
    MPI_Iallgatherv(text.data(), size, MPI_BYTE, all.data(), sizes.data(), places.data(), MPI_BYTE,
                    MPI_COMM_WORLD, &request);
    wait(request);
    std::vector<std::string> texts;
    for (int r = 0; r < ranks_; ++r)
      texts.push_back(
          all.substr(static_cast<std::size_t>(places[r]), static_cast<std::size_t>(sizes[r])));
    return texts;
  }

  void run(const ItemWork& work) override {
    if (rank_ == 0)
      serve(work);
    else
      ask(work);
  }

 private:
  void sleep(double share = 1) const {
    std::this_thread::sleep_for(std::chrono::duration<double>(share * interval_));
  }

  void wait(MPI_Request& request) const {
    for (int done = 0;;) {
      MPI_Test(&request, &done, MPI_STATUS_IGNORE);
      if (done) return;
      sleep();
    }
  }

  // The next message to process 0, and its sender; none if there is none now.
  static std::optional<std::string> next_message(int& sender) {
    int there = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, kRequest, MPI_COMM_WORLD, &there, &status);
    if (!there) return std::nullopt;
    int size = 0;
    MPI_Get_count(&status, MPI_BYTE, &size);
    sender = status.MPI_SOURCE;
    std::string message(static_cast<std::size_t>(size), '\0');
    MPI_Recv(message.data(), size, MPI_BYTE, sender, kRequest, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    return message;
  }

  void serve(const ItemWork& work) const {
    std::mutex reporting;
    const auto done = [&](std::size_t item, const ItemSeconds& seconds) {
      const std::lock_guard lock(reporting);
      work.done(item, seconds);
    };
    ItemThreads own(
        work,
        {[&] { return work.queue.take(0, work.prepared()); }, done, [&] { work.queue.close(); }},
        true);
    std::exception_ptr failure;
    bool cancelled = false;
    const auto look_for_cancellation = [&] {
      if (!work.cancellation || !work.cancellation->cancelled() || work.queue.left() == 0) return;
      cancelled = true;
      work.queue.close();
    };
    for (int others = ranks_ - 1; others > 0 || !own.ended();) {
      look_for_cancellation();
      int sender = 0;
      const std::optional<std::string> message = next_message(sender);
      if (!message) {
        sleep();
        continue;
      }
      Reader reader(*message);
      switch (static_cast<Kind>(reader.get<std::uint64_t>())) {
        case Kind::ask: {
          std::vector<std::size_t> prepared;
          while (!reader.at_end()) prepared.push_back(reader.get<std::uint64_t>());
          std::string answer;
          put(answer, std::uint64_t{work.queue.take(sender, prepared).value_or(kNoItem)});
          send(answer, sender, kAnswer);
          break;
        }
        case Kind::report: {
          const std::size_t item = reader.get<std::uint64_t>();
          ItemSeconds seconds;
          seconds.item = reader.get<double>();
          seconds.preparation = reader.get<double>();
          done(item, seconds);
          break;
        }
        case Kind::failure:
          if (!failure) failure = failure_in(reader, sender);
          work.queue.close();
          break;
        case Kind::end:
          --others;
          break;
      }
    }
    own.join();
    look_for_cancellation();
    if (own.failure()) failure = own.failure();
    if (failure) std::rethrow_exception(failure);
    if (cancelled) throw Cancelled();
  }

  // What the threads of a process and its main thread, which alone sends messages, tell each other.
  struct Desk {
    std::mutex mutex;
    std::condition_variable changed;
    int waiting = 0;                   // threads without an item
    bool closed = false;               // no item comes any more
    std::deque<std::size_t> items;     // for waiting threads
    std::deque<std::string> messages;  // for process 0
  };

  void ask(const ItemWork& work) const {
    Desk desk;
    const auto take = [&]() -> std::optional<std::size_t> {
      std::unique_lock lock(desk.mutex);
      ++desk.waiting;
      desk.changed.notify_all();
      desk.changed.wait(lock, [&] { return desk.closed || !desk.items.empty(); });
      --desk.waiting;
      if (desk.items.empty()) return std::nullopt;
      const std::size_t item = desk.items.front();
      desk.items.pop_front();
      return item;
    };
    const auto tell = [&](std::string message) {
      const std::lock_guard lock(desk.mutex);
      desk.messages.push_back(std::move(message));
      desk.changed.notify_all();
    };
    const auto done = [&](std::size_t item, const ItemSeconds& seconds) {
      std::string message;
      put(message, static_cast<std::uint64_t>(Kind::report));
      put(message, std::uint64_t{item});
      put(message, seconds.item);
      put(message, seconds.preparation);
      tell(std::move(message));
    };
    ItemThreads own(work,
                    {take, done,
                     [&] {
                       const std::lock_guard lock(desk.mutex);
                       desk.closed = true;
                       desk.changed.notify_all();
                     }},
                    true);
    exchange_items(desk, work, own);
    own.join();
    std::exception_ptr failure = own.failure();
    // An item that came too late was not made.
    if (!failure && work.cancellation && work.cancellation->cancelled())
      failure = std::make_exception_ptr(Cancelled());
    if (failure) send(text_of(failure), 0, kRequest);
    std::string end;
    put(end, static_cast<std::uint64_t>(Kind::end));
    send(end, 0, kRequest);
  }

  // Sends reports, and asks for an item while a thread waits for one, until all threads ended.
  void exchange_items(Desk& desk, const ItemWork& work, const ItemThreads& threads) const {
    MPI_Request answer_request = MPI_REQUEST_NULL;
    std::uint64_t answer = kNoItem;
    bool asked = false;
    while (asked || !threads.ended() || has_messages(desk)) {
      std::unique_lock lock(desk.mutex);
      while (!desk.messages.empty()) {
        const std::string message = std::move(desk.messages.front());
        desk.messages.pop_front();
        lock.unlock();
        send(message, 0, kRequest);
        lock.lock();
      }
      if (!asked) {
        if (desk.waiting > static_cast<int>(desk.items.size()) && !desk.closed) {
          lock.unlock();
          MPI_Irecv(&answer, sizeof answer, MPI_BYTE, 0, kAnswer, MPI_COMM_WORLD, &answer_request);
          std::string message;
          put(message, static_cast<std::uint64_t>(Kind::ask));
          for (const std::size_t group : work.prepared()) put(message, std::uint64_t{group});
          send(message, 0, kRequest);
          asked = true;
        } else {
          // Threads tell of everything but their end.
          desk.changed.wait_for(lock, std::chrono::duration<double>(40 * interval_));
        }
        continue;
      }
      lock.unlock();
      int arrived = 0;
      MPI_Test(&answer_request, &arrived, MPI_STATUS_IGNORE);
      if (!arrived) {
        sleep(0.2);
        continue;
      }
      asked = false;
      lock.lock();
      if (answer == kNoItem)
        desk.closed = true;
      else
        desk.items.push_back(answer);
      desk.changed.notify_all();
    }
  }

  static bool has_messages(Desk& desk) {
    const std::lock_guard lock(desk.mutex);
    return !desk.messages.empty();
  }

  double interval_;
  int rank_ = 0, ranks_ = 1;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Mpi)
