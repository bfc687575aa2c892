// SPDX-License-Identifier: Apache-2.0
#include "framework/core/active_call.h"

#include <array>
#include <atomic>
#include <mutex>
#include <set>

namespace lapwing {

struct ActiveCallSlot {
  std::atomic<bool> taken{false};
  std::atomic<const char*> name{nullptr}, call{nullptr};
  std::atomic<CallLength> length{CallLength::brief};
  std::atomic<std::uint64_t> serial{0};
  std::atomic<std::uint64_t> shown{0};  // of show_activity
};

namespace {

// More threads than these have calls without a name.
std::array<ActiveCallSlot, 256> active_slots;

// Still there when the thread's objects are gone, as they are when code that runs at the end of the
// program asks.
thread_local ActiveCallSlot* current_slot = nullptr;

class ThreadSlot {
 public:
  ThreadSlot() {
    for (ActiveCallSlot& slot : active_slots) {
      bool free = false;
      if (!slot.taken.compare_exchange_strong(free, true)) continue;
      current_slot = &slot;
      return;
    }
  }
  // Inside a call (`exit` was called there) the slot stays as it is.
  ~ThreadSlot() {
    if (current_slot && !current_slot->name.load()) current_slot->taken = false;
  }
  ThreadSlot(const ThreadSlot&) = delete;
  ThreadSlot& operator=(const ThreadSlot&) = delete;
};

ActiveCallSlot* own_slot() {
  if (current_slot) return current_slot;
  thread_local ThreadSlot taken;
  return current_slot;
}

constexpr auto kRelaxed = std::memory_order_relaxed;

// Only its own thread writes a slot's numbers.
void count_up(std::atomic<std::uint64_t>& number) {
  number.store(number.load(kRelaxed) + 1, kRelaxed);
}

}  // namespace

ActiveCall::ActiveCall(const char* name, const char* call, CallLength length)
    : slot_(own_slot()),
      outer_name_(nullptr),
      outer_call_(nullptr),
      outer_length_(CallLength::brief) {
  if (!slot_) return;
  outer_name_ = slot_->name.load(kRelaxed);
  outer_call_ = slot_->call.load(kRelaxed);
  outer_length_ = slot_->length.load(kRelaxed);
  count_up(slot_->serial);
  slot_->call.store(call, kRelaxed);
  slot_->length.store(length, kRelaxed);
  slot_->name.store(name, std::memory_order_release);
}

ActiveCall::~ActiveCall() {
  if (!slot_) return;
  count_up(slot_->serial);
  slot_->call.store(outer_call_, kRelaxed);
  slot_->length.store(outer_length_, kRelaxed);
  slot_->name.store(outer_name_, std::memory_order_release);
}

const char* lasting_text(std::string_view text) {
  static std::mutex mutex;
  static auto* const kept = new std::set<std::string, std::less<>>;  // other threads outlive main
  const std::lock_guard<std::mutex> lock(mutex);
  return kept->emplace(text).first->c_str();
}

ActiveCallName active_call() {
  const ActiveCallSlot* slot = current_slot;
  if (!slot) return {};
  return {slot->name.load(), slot->call.load(), slot->length.load()};
}

void show_activity() {
  if (ActiveCallSlot* slot = own_slot()) count_up(slot->shown);
}

std::vector<RunningCall> running_calls() {
  std::vector<RunningCall> running;
  for (const ActiveCallSlot& slot : active_slots) {
    const std::uint64_t serial = slot.serial.load();
    const char* const name = slot.name.load(std::memory_order_acquire);
    const char* const call = slot.call.load();
    const CallLength length = slot.length.load();
    if (!name || !call) continue;
    // A name that is being left is not read: the number has changed then.
    if (slot.serial.load() == serial) running.push_back({name, call, length, serial});
  }
  return running;
}

std::uint64_t activity_of_calls() {
  std::uint64_t all = 0;
  for (const ActiveCallSlot& slot : active_slots) all += slot.serial.load() + slot.shown.load();
  return all;
}

}  // namespace lapwing
