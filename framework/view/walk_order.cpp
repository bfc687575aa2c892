// SPDX-License-Identifier: Apache-2.0
#include "framework/view/walk_order.h"

#include <algorithm>

namespace lapwing {
namespace {

constexpr double kShorter = 1e-9;  // s; less is rounding
constexpr int kLongestMoved = 3;

class Order {
 public:
  Order(const TourProblem& problem, const std::vector<int>& walk, const std::vector<int>& settled) {
    std::vector<std::pair<int, int>> beside(problem.views(), {-1, -1});
    for (std::size_t i = 1; i + 1 < settled.size(); ++i) {
      beside[settled[i]] = std::minmax(settled[i - 1], settled[i + 1]);
    }
    const std::size_t n = walk.size();
    stops_.reserve(n);
    for (std::size_t i = 0; i < n; ++i) {
      const bool inner = i > 0 && i + 1 < n;
      const bool same =
          inner && beside[walk[i]] == std::pair<int, int>(std::minmax(walk[i - 1], walk[i + 1]));
      stops_.push_back({walk[i], problem.legs_from(walk[i]).data(), !same});
    }
  }

  bool exchange_legs();
  bool move_views();
  bool drop_second_visits();
  std::vector<int> views() const {
    std::vector<int> views;
    for (const Stop& stop : stops_) views.push_back(stop.view);
    return views;
  }

 private:
  struct Stop {
    int view;
    const double* legs;
    bool moved;  // has other neighbours than when all was tried
  };
  int size() const { return static_cast<int>(stops_.size()); }
  double leg(int i, int j) const { return stops_[i].legs[stops_[j].view]; }
  bool exchange_with(int i);
  bool move_segment(int first, int last);

  std::vector<Stop> stops_;
};

// 2-opt: legs (i, i+1) and (j, j+1) become (i, j) and (i+1, j+1).
bool Order::exchange_with(int i) {
  bool changed = false;
  for (int j = 0; j + 1 < size(); ++j) {
    const int a = std::min(i, j), b = std::max(i, j);
    if (b - a < 2) continue;
    const double before = leg(a, a + 1) + leg(b, b + 1), crossing = leg(a, b);
    if (crossing >= before || crossing + leg(a + 1, b + 1) >= before - kShorter) continue;
    for (const int k : {a, a + 1, b, b + 1}) stops_[k].moved = true;
    std::reverse(stops_.begin() + a + 1, stops_.begin() + b + 1);
    changed = true;
  }
  return changed;
}

bool Order::exchange_legs() {
  bool changed = false;
  for (int i = 0; i + 1 < size(); ++i) {
    if (stops_[i].moved || stops_[i + 1].moved) changed = exchange_with(i) || changed;
  }
  return changed;
}

// Or-opt: the stops first..last to the place where they are cheapest, if that is another one.
bool Order::move_segment(int first, int last) {
  const double freed = leg(first - 1, first) + leg(last, last + 1) - leg(first - 1, last + 1);
  if (freed <= kShorter) return false;
  double best = freed - kShorter;
  int place = -1;
  bool turned = false;
  for (int j = 0; j + 1 < size(); ++j) {
    if (j >= first - 1 && j <= last) continue;
    const double open = leg(j, j + 1);
    const double straight = leg(j, first) + leg(last, j + 1) - open;
    const double reversed = leg(j, last) + leg(first, j + 1) - open;
    if (std::min(straight, reversed) >= best) continue;
    best = std::min(straight, reversed);
    turned = reversed < straight;
    place = j;
  }
  if (place < 0) return false;
  for (const int k : {first - 1, first, last, last + 1, place, place + 1}) stops_[k].moved = true;
  const auto begin = stops_.begin();
  if (turned) std::reverse(begin + first, begin + last + 1);
  if (place < first)
    std::rotate(begin + place + 1, begin + first, begin + last + 1);
  else
    std::rotate(begin + first, begin + last + 1, begin + place + 1);
  return true;
}

bool Order::move_views() {
  bool changed = false;
  for (int length = 1; length <= kLongestMoved; ++length) {
    for (int first = 1; first + length < size(); ++first) {
      if (!stops_[first].moved && !stops_[first + length - 1].moved) continue;
      changed = move_segment(first, first + length - 1) || changed;
    }
  }
  return changed;
}

bool Order::drop_second_visits() {
  std::vector<int> sorted = views();
  std::sort(sorted.begin(), sorted.end());
  bool changed = false;
  for (int i = 1; i + 1 < size();) {
    const auto [from, to] = std::equal_range(sorted.begin(), sorted.end(), stops_[i].view);
    const bool again = to - from > 1;
    if (!again || leg(i - 1, i) + leg(i, i + 1) - leg(i - 1, i + 1) <= kShorter) {
      ++i;
      continue;
    }
    sorted.erase(from);
    stops_[i - 1].moved = stops_[i + 1].moved = true;
    stops_.erase(stops_.begin() + i);
    changed = true;
  }
  return changed;
}

}  // namespace

std::vector<int> shorter_order(const TourProblem& problem, const std::vector<int>& walk,
                               const std::vector<int>& settled) {
  Order order(problem, walk, settled);
  bool changed = !problem.each_once() && order.drop_second_visits();
  for (;;) {
    const bool exchanged = order.exchange_legs();
    const bool moved = order.move_views();
    if (!exchanged && !moved) break;
    changed = true;
  }
  return changed ? order.views() : std::vector<int>{};
}

}  // namespace lapwing
