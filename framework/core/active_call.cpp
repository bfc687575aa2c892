#include "framework/core/active_call.h"

#include <array>
#include <atomic>

namespace lapwing {

struct ActiveCallSlot {
  std::atomic<bool> taken{false};
  std::atomic<const char*> name{nullptr}, call{nullptr};
  std::atomic<bool> brief{false};
  std::atomic<std::uint64_t> serial{0};
};

namespace {

// More threads than these have calls without a name.
std::array<ActiveCallSlot, 256> active_slots;

class ThreadSlot {
 public:
  ThreadSlot() {
    for (ActiveCallSlot& slot : active_slots) {
      bool free = false;
      if (!slot.taken.compare_exchange_strong(free, true)) continue;
      slot_ = &slot;
      return;
    }
  }
  ~ThreadSlot() {
    if (slot_) slot_->taken = false;
  }
  ThreadSlot(const ThreadSlot&) = delete;
  ThreadSlot& operator=(const ThreadSlot&) = delete;
  ActiveCallSlot* slot() const { return slot_; }

 private:
  ActiveCallSlot* slot_ = nullptr;
};

thread_local ThreadSlot thread_slot;

constexpr auto kRelaxed = std::memory_order_relaxed;

}  // namespace

ActiveCall::ActiveCall(const char* name, const char* call, bool brief)
    : slot_(thread_slot.slot()), outer_name_(nullptr), outer_call_(nullptr), outer_brief_(false) {
  if (!slot_) return;
  outer_name_ = slot_->name.load(kRelaxed);
  outer_call_ = slot_->call.load(kRelaxed);
  outer_brief_ = slot_->brief.load(kRelaxed);
  slot_->serial.store(slot_->serial.load(kRelaxed) + 1, kRelaxed);
  slot_->call.store(call, kRelaxed);
  slot_->brief.store(brief, kRelaxed);
  slot_->name.store(name, std::memory_order_release);
}

ActiveCall::~ActiveCall() {
  if (!slot_) return;
  slot_->serial.store(slot_->serial.load(kRelaxed) + 1, kRelaxed);
  slot_->call.store(outer_call_, kRelaxed);
  slot_->brief.store(outer_brief_, kRelaxed);
  slot_->name.store(outer_name_, std::memory_order_release);
}

ActiveCallName active_call() {
  const ActiveCallSlot* slot = thread_slot.slot();
  if (!slot) return {};
  return {slot->name.load(), slot->call.load()};
}

std::vector<RunningCall> running_brief_calls() {
  std::vector<RunningCall> running;
  for (const ActiveCallSlot& slot : active_slots) {
    const std::uint64_t serial = slot.serial.load();
    const char* const name = slot.name.load(std::memory_order_acquire);
    const char* const call = slot.call.load();
    if (!name || !call || !slot.brief.load()) continue;
    // A name that is being left is not read: the number has changed then.
    if (slot.serial.load() == serial) running.push_back({name, call, serial});
  }
  return running;
}

}  // namespace lapwing
