// SPDX-License-Identifier: Apache-2.0
#include "framework/items/prepared_groups.h"

#include <chrono>

namespace lapwing {

std::shared_ptr<const void> PreparedGroups::use(std::size_t group, double& seconds) {
  const auto found = [&]() -> std::shared_ptr<const void> {
    const std::lock_guard lock(mutex_);
    const auto there = in_use_.find(group);
    std::shared_ptr<const void> held = there == in_use_.end() ? nullptr : there->second.lock();
    if (held) last_ = held;
    return held;
  };
  if (std::shared_ptr<const void> held = found()) return held;
  const std::lock_guard one(preparing_);
  std::shared_ptr<const void> held = found();  // by another thread in the meantime
  if (!held) {
    {
      const std::lock_guard lock(mutex_);
      last_.reset();  // its memory is needed now
    }
    const auto begun = std::chrono::steady_clock::now();
    held = prepare_(group);
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    const std::lock_guard lock(mutex_);
    std::erase_if(in_use_, [](const auto& entry) { return entry.second.expired(); });
    in_use_[group] = held;
    last_ = held;
  }
  return held;
}

std::vector<std::size_t> PreparedGroups::held() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::size_t> groups;
  for (const auto& [group, entry] : in_use_)
    if (!entry.expired()) groups.push_back(group);
  return groups;
}

}  // namespace lapwing
