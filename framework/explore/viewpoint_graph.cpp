// SPDX-License-Identifier: Apache-2.0
#include "framework/explore/viewpoint_graph.h"

#include <algorithm>
#include <limits>
#include <queue>

namespace lapwing {

namespace {

double turned(const Viewpoint& a, const Viewpoint& b) {
  return std::abs(std::remainder(a.yaw - b.yaw, 2 * EIGEN_PI));
}

}  // namespace

double MoveTimes::of(const Viewpoint& a, const Viewpoint& b) const {
  if (acceleration > 0) return std::max(way(a, b).seconds(), turn(a, b).seconds());
  return (a.position - b.position).norm() / speed + turned(a, b) / turn_rate;
}

RestProfile MoveTimes::way(const Viewpoint& a, const Viewpoint& b) const {
  return {(a.position - b.position).norm(), {speed, acceleration, kStep}};
}

RestProfile MoveTimes::turn(const Viewpoint& a, const Viewpoint& b) const {
  return {turned(a, b), {turn_rate, turn_acceleration, kStep}};
}

int ViewpointGraph::add(const Viewpoint& view) {
  const int place = index_.add(view);
  if (static_cast<std::size_t>(place) == edges_.size()) edges_.emplace_back();
  return place;
}

bool ViewpointGraph::joined(int a, int b) const {
  const auto& edges = edges_[static_cast<std::size_t>(a)];
  return std::any_of(edges.begin(), edges.end(), [&](const Edge& edge) { return edge.to == b; });
}

void ViewpointGraph::join(int a, int b) {
  if (a == b || joined(a, b)) return;
  const double seconds = times_.of(index_[a], index_[b]);
  edges_[static_cast<std::size_t>(a)].push_back({b, seconds});
  edges_[static_cast<std::size_t>(b)].push_back({a, seconds});
}

void ViewpointGraph::set_blocked(int a, int b, bool blocked) {
  for (Edge& edge : edges_[static_cast<std::size_t>(a)])
    if (edge.to == b) edge.blocked = blocked;
  for (Edge& edge : edges_[static_cast<std::size_t>(b)])
    if (edge.to == a) edge.blocked = blocked;
}

void ViewpointGraph::look_again() {
  std::erase_if(blocked_, [&](const std::pair<int, int>& move) {
    if (!free(index_[move.first], index_[move.second])) return false;
    set_blocked(move.first, move.second, false);
    return true;
  });
}

bool ViewpointGraph::free(const Viewpoint& a, const Viewpoint& b) const {
  return map_->swept_box_free(a.position, b.position, half_);
}

// Dijkstra; of equally quick ways the one found first, in the order of viewpoints.
std::vector<double> ViewpointGraph::search(int from, int to, std::vector<int>& before) const {
  const auto count = static_cast<std::size_t>(size());
  std::vector<double> seconds(count, std::numeric_limits<double>::infinity());
  before.assign(count, -1);
  using Open = std::pair<double, int>;
  std::priority_queue<Open, std::vector<Open>, std::greater<>> open;
  seconds[static_cast<std::size_t>(from)] = 0;
  open.push({0, from});
  while (!open.empty()) {
    const auto [reached, at] = open.top();
    open.pop();
    if (reached > seconds[static_cast<std::size_t>(at)]) continue;
    if (at == to) break;
    for (const Edge& edge : edges_[static_cast<std::size_t>(at)]) {
      if (edge.blocked) continue;
      const double there = reached + edge.seconds;
      if (there >= seconds[static_cast<std::size_t>(edge.to)]) continue;
      seconds[static_cast<std::size_t>(edge.to)] = there;
      before[static_cast<std::size_t>(edge.to)] = at;
      open.push({there, edge.to});
    }
  }
  return seconds;
}

std::vector<double> ViewpointGraph::seconds_from(int from) const {
  std::vector<int> before;
  return search(from, -1, before);
}

std::vector<int> ViewpointGraph::believed_way(int from, int to) const {
  std::vector<int> before;
  search(from, to, before);
  std::vector<int> way;
  if (before[static_cast<std::size_t>(to)] < 0) return way;
  for (int at = to; at != from; at = before[static_cast<std::size_t>(at)]) way.push_back(at);
  std::reverse(way.begin(), way.end());
  return way;
}

std::vector<bool> ViewpointGraph::reached_from(int from) const {
  std::vector<bool> reached(static_cast<std::size_t>(size()));
  std::vector<int> open{from};
  reached[static_cast<std::size_t>(from)] = true;
  while (!open.empty()) {
    const int at = open.back();
    open.pop_back();
    for (const Edge& edge : edges_[static_cast<std::size_t>(at)]) {
      const auto to = static_cast<std::size_t>(edge.to);
      if (reached[to] || !free(index_[at], index_[edge.to])) continue;
      reached[to] = true;
      open.push_back(edge.to);
    }
  }
  return reached;
}

std::vector<int> ViewpointGraph::way(int from, int to) {
  if (from == to) return {};
  for (;;) {
    std::vector<int> way = believed_way(from, to);
    int at = from;
    bool good = true;
    for (const int next : way) {
      if (!free(index_[at], index_[next])) {
        set_blocked(at, next, true);
        blocked_.emplace_back(at, next);
        good = false;
        break;
      }
      at = next;
    }
    if (good) return way;
  }
}

}  // namespace lapwing
