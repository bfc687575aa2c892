// SPDX-License-Identifier: Apache-2.0
// How: the seconds of views move into the legs, half to each side, so that the cost of a walk is a
// sum of legs. Views and motions form a graph. The shortest ways from a view are a tree (Dijkstra),
// computed at the first request and kept;
// problems that differ in their limits alone share them. If two threads compute the same tree, one
// is dropped. A problem of `legs` has no ways: its matrix of legs is used as it is.
#include "framework/view/tour_problem.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <queue>
#include <set>

#include "framework/core/error.h"

namespace lapwing {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
// Legs there and back may differ by rounding alone.
constexpr double kSymmetric = 1e-9;

bool sound(double seconds) {
  return std::isfinite(seconds) && seconds >= 0;
}

std::string text_of(double seconds) {
  char text[40];
  std::snprintf(text, sizeof text, "%.6g s", seconds);
  return text;
}

std::string name_of(int view) {
  return "view " + std::to_string(view);
}

void check_view(int view, int views, const std::string& what, Diagnostics& errors) {
  if (view >= 0 && view < views) return;
  errors.add({}, what, name_of(view) + " does not exist, there are " + std::to_string(views));
}

void check_legs(const TourDefinition& d, std::size_t n, Diagnostics& errors) {
  if (!d.motions.empty()) errors.add({}, "legs", "give legs or motions, not both");
  if (d.legs.size() != n * n) {
    errors.add({}, "legs",
               std::to_string(n) + " views need " + std::to_string(n * n) + " legs, not " +
                   std::to_string(d.legs.size()));
    return;
  }
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = a; b < n; ++b) {
      const double there = d.legs[a * n + b], back = d.legs[b * n + a];
      const bool symmetric = std::abs(there - back) <= kSymmetric * (1 + std::abs(there));
      if (sound(there) && sound(back) && symmetric) continue;
      errors.add({}, "legs",
                 "from " + std::to_string(a) + " to " + std::to_string(b) +
                     " must be finite, at least 0 s and the same in both directions");
      return;
    }
  }
}

void check_motions(const TourDefinition& d, int n, Diagnostics& errors) {
  for (std::size_t i = 0; i < d.motions.size(); ++i) {
    const TourMotion& motion = d.motions[i];
    const std::string which = "motions[" + std::to_string(i) + "]";
    check_view(motion.a, n, which, errors);
    check_view(motion.b, n, which, errors);
    if (!sound(motion.seconds)) {
      errors.add({}, which, "takes " + text_of(motion.seconds) + "; a finite time of at least 0 s");
    }
    if (errors.lines().size() > 20) return;
  }
}

void check_limits(double budget, const std::optional<int>& image_limit, Diagnostics& errors) {
  if (!sound(budget)) errors.add({}, "budget", "must be finite and at least 0 s");
  if (image_limit && *image_limit < 1) errors.add({}, "image_limit", "must be at least 1");
}

void check_definition(const TourDefinition& d) {
  Diagnostics errors;
  if (!d.score || d.score->views() == 0) {
    errors.add({}, "score", "there are no views: a tour needs at least one");
    errors.throw_if_any();
  }
  const int n = d.score->views();
  if (d.view_seconds.size() != 1 && static_cast<int>(d.view_seconds.size()) != n) {
    errors.add({}, "view_seconds",
               "must be one number or " + std::to_string(n) + ", not " +
                   std::to_string(d.view_seconds.size()));
  }
  for (std::size_t v = 0; v < d.view_seconds.size(); ++v) {
    if (sound(d.view_seconds[v])) continue;
    errors.add({}, "view_seconds",
               name_of(static_cast<int>(v)) + " takes " + text_of(d.view_seconds[v]) +
                   "; a finite time of at least 0 s");
    break;
  }
  check_view(d.start, n, "start", errors);
  check_view(d.end, n, "end", errors);
  check_limits(d.budget, d.image_limit, errors);
  if (!d.legs.empty()) check_legs(d, static_cast<std::size_t>(n), errors);
  check_motions(d, n, errors);
  errors.throw_if_any();
}

}  // namespace

// The tree of shortest ways from one view, made when first asked for.
struct TourProblem::Ways {
  struct Tree {
    std::vector<double> seconds;
    std::vector<int> before;  // the view before, on the way from the root
  };
  explicit Ways(int views) : trees(views) {}
  ~Ways() {
    for (auto& tree : trees) delete tree.load();
  }
  std::vector<std::atomic<const Tree*>> trees;
  std::mutex writing;

  const Tree& from(const TourProblem& problem, int view);
  static Tree search(const TourProblem& problem, int root);
};

TourProblem::Ways::Tree TourProblem::Ways::search(const TourProblem& problem, int root) {
  Tree tree{std::vector<double>(problem.views(), kNever), std::vector<int>(problem.views(), -1)};
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  tree.seconds[root] = 0;
  open.push({0, root});
  while (!open.empty()) {
    const auto [seconds, a] = open.top();
    open.pop();
    if (seconds > tree.seconds[a]) continue;
    for (int i = problem.first_neighbour_[a]; i < problem.first_neighbour_[a + 1]; ++i) {
      const int b = problem.neighbours_[i];
      const double reached = seconds + problem.neighbour_legs_[i];
      if (reached >= tree.seconds[b]) continue;
      tree.seconds[b] = reached;
      tree.before[b] = a;
      open.push({reached, b});
    }
  }
  return tree;
}

const TourProblem::Ways::Tree& TourProblem::Ways::from(const TourProblem& problem, int view) {
  const Tree* tree = trees[view].load(std::memory_order_acquire);
  if (tree) return *tree;
  auto found = std::make_unique<const Tree>(search(problem, view));
  const std::lock_guard lock(writing);
  tree = trees[view].load(std::memory_order_acquire);
  if (tree) return *tree;  // another thread was quicker
  tree = found.release();
  trees[view].store(tree, std::memory_order_release);
  return *tree;
}

TourProblem::~TourProblem() = default;
TourProblem::TourProblem(const TourProblem&) = default;
TourProblem::TourProblem(TourProblem&&) noexcept = default;
TourProblem& TourProblem::operator=(TourProblem&&) noexcept = default;

TourProblem::TourProblem(TourDefinition d) {
  check_definition(d);
  score_ = std::move(d.score);
  start_ = d.start;
  end_ = d.end;
  budget_ = d.budget;
  image_limit_ = d.image_limit;
  const int n = views();
  std::vector<double>& stops = stops_;
  stops.assign(n, d.view_seconds.front());
  if (d.view_seconds.size() > 1) stops = std::move(d.view_seconds);
  fixed_seconds_ = stops[start_] + (loop() ? 0 : stops[end_]);
  stops[start_] = stops[end_] = 0;
  std::vector<double> legs = std::move(d.legs);
  for (int a = 0; a < n && !legs.empty(); ++a) {
    for (int b = 0; b < a; ++b) {
      const std::size_t there = static_cast<std::size_t>(b) * n + a;
      legs[there] += (stops[a] + stops[b]) / 2;
      legs[static_cast<std::size_t>(a) * n + b] = legs[there];
    }
    legs[static_cast<std::size_t>(a) * (n + 1)] = 0;
  }
  legs_ = std::make_shared<const std::vector<double>>(std::move(legs));
  if (each_once()) return;
  ways_ = std::make_shared<Ways>(n);
  std::vector<std::vector<std::pair<int, double>>> of(n);
  for (const TourMotion& motion : d.motions) {
    if (motion.a == motion.b) continue;
    const double leg = motion.seconds + (stops[motion.a] + stops[motion.b]) / 2;
    of[motion.a].push_back({motion.b, leg});
    of[motion.b].push_back({motion.a, leg});
  }
  for (auto& list : of) {
    std::sort(list.begin(), list.end());  // of equal neighbours the quickest comes first
    int last = -1;
    for (const auto& [neighbour, leg] : list) {
      if (neighbour == last) continue;
      last = neighbour;
      neighbours_.push_back(neighbour);
      neighbour_legs_.push_back(leg);
    }
    first_neighbour_.push_back(static_cast<int>(neighbours_.size()));
  }
}

TourProblem TourProblem::with_limits(double budget, std::optional<int> image_limit) const {
  Diagnostics errors;
  check_limits(budget, image_limit, errors);
  errors.throw_if_any();
  TourProblem other(*this);
  other.budget_ = budget;
  other.image_limit_ = image_limit;
  return other;
}

std::span<const double> TourProblem::legs_from(int view) const {
  const std::size_t n = views();
  if (each_once()) return {legs_->data() + view * n, n};
  return ways_->from(*this, view).seconds;
}

void TourProblem::append_way(int a, int b, std::vector<int>& walk) const {
  if (a == b) return;
  if (each_once()) {
    walk.push_back(b);
    return;
  }
  const int root = std::min(a, b), far = std::max(a, b);
  const std::vector<int>& before = ways_->from(*this, root).before;
  const std::size_t begin = walk.size();
  for (int v = far; v != root; v = before[v]) walk.push_back(v);  // from the far end, root left out
  if (root != a) {
    walk.erase(walk.begin() + static_cast<std::ptrdiff_t>(begin));  // that was `a` itself
    walk.push_back(b);
    return;
  }
  std::reverse(walk.begin() + static_cast<std::ptrdiff_t>(begin), walk.end());
}

std::pair<double, double> TourProblem::cheapest_legs(int view) const {
  double first = kNever, second = kNever;
  const auto take = [&](double leg) {
    if (leg < first) std::swap(first, leg);
    second = std::min(second, leg);
  };
  if (each_once()) {
    const auto legs = legs_from(view);
    for (int v = 0; v < views(); ++v) {
      if (v != view) take(legs[v]);
    }
  } else {
    for (int i = first_neighbour_[view]; i < first_neighbour_[view + 1]; ++i) {
      take(neighbour_legs_[i]);
    }
  }
  return {first, second};
}

double TourProblem::direct_leg(int a, int b) const {
  if (each_once()) return (*legs_)[static_cast<std::size_t>(a) * views() + b];
  const auto begin = neighbours_.begin() + first_neighbour_[a];
  const auto end = neighbours_.begin() + first_neighbour_[a + 1];
  const auto found = std::lower_bound(begin, end, b);
  if (found == end || *found != b) return kNever;
  return neighbour_legs_[static_cast<std::size_t>(found - neighbours_.begin())];
}

double TourProblem::seconds_of(std::span<const int> walk) const {
  double seconds = fixed_seconds_;
  for (std::size_t i = 1; i < walk.size(); ++i) seconds += direct_leg(walk[i - 1], walk[i]);
  return seconds;
}

double TourProblem::score_of(std::span<const int> walk) const {
  ScoreState state(*score_);
  for (const int view : walk) state.add(view);
  return state.score();
}

int TourProblem::images_of(std::span<const int> walk) {
  return static_cast<int>(std::set<int>(walk.begin(), walk.end()).size());
}

std::string TourProblem::problem_of(std::span<const int> walk) const {
  if (walk.empty()) return "the tour is empty";
  for (const int view : walk) {
    if (view < 0 || view >= views()) return name_of(view) + " does not exist";
  }
  if (walk.front() != start_) return "it begins at " + name_of(walk.front()) + ", not at the start";
  if (walk.back() != end_) return "it ends at " + name_of(walk.back()) + ", not at the end";
  for (std::size_t i = 1; i < walk.size(); ++i) {
    const bool moves = walk[i - 1] != walk[i] && direct_leg(walk[i - 1], walk[i]) < kNever;
    if (moves) continue;
    return "from " + name_of(walk[i - 1]) + " to " + name_of(walk[i]) + " there is no motion";
  }
  const int images = images_of(walk);
  const std::size_t closing = loop() && walk.size() > 1;
  if (each_once() && walk.size() != images + closing) return "it visits a view twice";
  if (image_limit_ && images > *image_limit_) {
    return "it takes " + std::to_string(images) + " images of " + std::to_string(*image_limit_);
  }
  const double seconds = seconds_of(walk);
  if (seconds > budget_ + tolerance()) {
    return "it takes " + text_of(seconds) + " of " + text_of(budget_);
  }
  return "";
}

// Ways over motions are the quickest already; over stated legs they are found by Dijkstra.
std::vector<double> TourProblem::least_seconds_from(int view) const {
  const auto direct = legs_from(view);
  std::vector<double> least(direct.begin(), direct.end());
  if (!each_once()) return least;
  least[view] = 0;
  std::vector<char> settled(views(), 0);
  for (int turn = 0; turn < views(); ++turn) {
    int next = -1;
    for (int v = 0; v < views(); ++v) {
      if (!settled[v] && (next < 0 || least[v] < least[next])) next = v;
    }
    settled[next] = 1;
    const auto legs = legs_from(next);
    for (int v = 0; v < views(); ++v) least[v] = std::min(least[v], least[next] + legs[v]);
  }
  return least;
}

std::vector<int> TourProblem::reachable() const {
  std::vector<int> result;
  if (!why_infeasible().empty()) return result;
  const std::vector<double> out = least_seconds_from(start_), home = least_seconds_from(end_);
  for (int v = 0; v < views(); ++v) {
    if (fixed_seconds_ + out[v] + home[v] <= budget_ + tolerance() || v == start_ || v == end_) {
      result.push_back(v);
    }
  }
  return result;
}

std::string TourProblem::why_infeasible() const {
  const auto out = legs_from(start_);
  if (out[end_] == kNever) {
    const auto joined = std::count_if(out.begin(), out.end(), [](double s) { return s < kNever; });
    return "no motions lead from the start, " + name_of(start_) + ", to the end, " + name_of(end_) +
           ": " + std::to_string(joined) + " of " + std::to_string(views()) +
           " views can be reached from the start";
  }
  const double least = fixed_seconds_ + out[end_];
  if (least > budget_ + tolerance()) {
    return "a budget of " + text_of(budget_) + " is too small: " +
           (loop() ? "the view at the start alone" : "the shortest path from start to end") +
           " takes " + text_of(least);
  }
  std::vector<int> way{start_};
  append_way(start_, end_, way);
  if (image_limit_ && images_of(way) > *image_limit_) {
    return "the shortest path from start to end passes " + std::to_string(images_of(way)) +
           " views, more images than the " + std::to_string(*image_limit_) + " allowed";
  }
  return "";
}

}  // namespace lapwing
