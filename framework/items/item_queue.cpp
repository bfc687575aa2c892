// SPDX-License-Identifier: Apache-2.0
#include "framework/items/item_queue.h"

#include <algorithm>

namespace lapwing {

namespace {

// How much shorter than the longest an item may be that is handed out before it.
constexpr double kShorter = 0.5;

}  // namespace

ItemQueue::ItemQueue(const std::vector<Item>& items, const std::vector<std::size_t>& todo,
                     const std::vector<double>& expected)
    : left_(todo.size()) {
  for (const std::size_t item : todo) {
    const std::size_t group = items[item].group;
    if (group >= groups_.size()) groups_.resize(group + 1);
    groups_[group].push_back({expected[item], item});
  }
  for (std::vector<Entry>& group : groups_)
    std::sort(group.begin(), group.end(), [](const Entry& a, const Entry& b) {
      return a.seconds != b.seconds ? a.seconds < b.seconds : a.item > b.item;
    });
}

bool ItemQueue::of_another(int asker, std::size_t group) const {
  for (std::size_t process = 0; process < prepared_.size(); ++process)
    if (process != static_cast<std::size_t>(asker) && prepared_[process].count(group)) return true;
  return false;
}

std::optional<std::size_t> ItemQueue::take(int asker, const std::vector<std::size_t>& prepared) {
  const std::lock_guard lock(mutex_);
  if (left_ == 0) return std::nullopt;
  if (static_cast<std::size_t>(asker) >= prepared_.size())
    prepared_.resize(static_cast<std::size_t>(asker) + 1);
  std::set<std::size_t>& own = prepared_[static_cast<std::size_t>(asker)];
  own = {prepared.begin(), prepared.end()};
  double longest = 0;
  for (const std::vector<Entry>& group : groups_)
    if (!group.empty()) longest = std::max(longest, group.back().seconds);
  // The better rank wins, then the longer item, then the earlier group.
  std::size_t best = groups_.size();
  int best_rank = -1;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (groups_[g].empty()) continue;
    const double seconds = groups_[g].back().seconds;
    if (seconds < kShorter * longest) continue;
    const int rank = own.count(g) ? 2 : of_another(asker, g) ? 0 : 1;
    const bool better =
        rank != best_rank ? rank > best_rank : seconds > groups_[best].back().seconds;
    if (!better) continue;
    best = g;
    best_rank = rank;
  }
  const std::size_t item = groups_[best].back().item;
  groups_[best].pop_back();
  own.insert(best);
  --left_;
  return item;
}

void ItemQueue::close() {
  const std::lock_guard lock(mutex_);
  for (std::vector<Entry>& group : groups_) group.clear();
  left_ = 0;
}

std::size_t ItemQueue::left() const {
  const std::lock_guard lock(mutex_);
  return left_;
}

}  // namespace lapwing
