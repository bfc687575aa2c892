#include "framework/view/walk_order.h"

#include <algorithm>

namespace lapwing {
namespace {

constexpr double kShorter = 1e-9;  // s; less is rounding
constexpr int kLongestMoved = 3;

class Order {
 public:
  Order(const TourProblem& problem, const std::vector<int>& walk) {
    stops_.reserve(walk.size());
    for (const int view : walk) stops_.push_back({view, problem.legs_from(view).data()});
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
  };
  int size() const { return static_cast<int>(stops_.size()); }
  double leg(int i, int j) const { return stops_[i].legs[stops_[j].view]; }
  bool move_segment(int first, int last);

  std::vector<Stop> stops_;
};

// 2-opt: legs (i, i+1) and (j, j+1) become (i, j) and (i+1, j+1).
bool Order::exchange_legs() {
  bool changed = false;
  for (int i = 0; i + 3 < size(); ++i) {
    double here = leg(i, i + 1);
    for (int j = i + 2; j + 1 < size(); ++j) {
      const double before = here + leg(j, j + 1);
      const double crossing = leg(i, j);
      if (crossing >= before || crossing + leg(i + 1, j + 1) >= before - kShorter) continue;
      std::reverse(stops_.begin() + i + 1, stops_.begin() + j + 1);
      here = leg(i, i + 1);
      changed = true;
    }
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
    stops_.erase(stops_.begin() + i);
    changed = true;
  }
  return changed;
}

}  // namespace

std::vector<int> shorter_order(const TourProblem& problem, const std::vector<int>& walk) {
  Order order(problem, walk);
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
