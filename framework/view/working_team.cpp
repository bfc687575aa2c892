// SPDX-License-Identifier: Apache-2.0
// How: a move between two tours is found by the shortest ways between the views that stay, as
// shorter_order does within one tour. It is then made by `become`, which knows the views that ways
// pass, and taken back where that is not shorter, or a budget or an image limit does not hold. The
// first move of each kind and pair of tours that helps is taken, from the best saving on.
#include "framework/view/working_team.h"

#include <algorithm>

namespace lapwing {
namespace {

constexpr double kSaved = 1e-9;  // s; less is rounding

struct TeamMove {
  double saved = kSaved;
  int i = -1, j = -1;  // positions in the two walks
};

// What taking position `i` out saves.
double saved_without(const WorkingTour& tour, int i) {
  const auto& w = tour.walk();
  const TourProblem& p = tour.problem();
  return p.leg(w[i - 1], w[i]) + p.leg(w[i], w[i + 1]) - p.leg(w[i - 1], w[i + 1]);
}

// s from the start to every position.
std::vector<double> clock_of(const WorkingTour& tour) {
  std::vector<double> clock{0};
  for (int i = 1; i < tour.size(); ++i)
    clock.push_back(clock.back() + tour.problem().leg(tour.walk()[i - 1], tour.walk()[i]));
  return clock;
}

// Where each view may be visited once, a move must not put one in again.
bool visits_once(const WorkingTour& tour) {
  const bool closing = tour.problem().loop();
  return !tour.problem().each_once() || tour.size() == tour.images() + (closing ? 1 : 0);
}

}  // namespace

WorkingTeam::WorkingTeam(const TeamProblem& problem) : problem_(&problem), views_(problem.score()) {
  for (int t = 0; t < problem.size(); ++t) tours_.emplace_back(problem.tour(t), views_);
}

WorkingTeam::WorkingTeam(const WorkingTeam& other)
    : problem_(other.problem_), views_(other.views_), tours_(other.tours_) {
  for (WorkingTour& tour : tours_) tour.join(views_);
}

WorkingTeam& WorkingTeam::operator=(const WorkingTeam& other) {
  problem_ = other.problem_;
  views_ = other.views_;
  tours_ = other.tours_;
  for (WorkingTour& tour : tours_) tour.join(views_);
  return *this;
}

void WorkingTeam::become(const Walks& walks) {
  for (int t = 0; t < size(); ++t) tours_[t].become(walks[t]);
}

Walks WorkingTeam::finished() const {
  Walks walks;
  for (const WorkingTour& tour : tours_) walks.push_back(tour.finished());
  return walks;
}

double WorkingTeam::room() const {
  double room = 0;
  for (const WorkingTour& tour : tours_) room += tour.room();
  return room;
}

bool WorkingTeam::within_budgets() const {
  return std::all_of(tours_.begin(), tours_.end(),
                     [](const WorkingTour& tour) { return tour.room() >= 0; });
}

bool WorkingTeam::within_limits() const {
  return std::all_of(tours_.begin(), tours_.end(), [](const WorkingTour& tour) {
    const auto& limit = tour.problem().image_limit();
    return !limit || tour.images() <= *limit;
  });
}

std::vector<WorkingTour*> WorkingTeam::pointers() {
  std::vector<WorkingTour*> all;
  for (WorkingTour& tour : tours_) all.push_back(&tour);
  return all;
}

void WorkingTeam::grow_all(std::vector<double>& known, const GreedyGrowth& growth, TourWork& work,
                           std::int64_t iterations) {
  grow(pointers(), known, growth, work, iterations);
}

bool WorkingTeam::shorten() {
  bool shorter = false;
  for (WorkingTour& tour : tours_) shorter = tour.shorten() || shorter;
  for (int a = 0; a < size(); ++a) {
    for (int b = 0; b < size(); ++b) {
      if (a != b && relocate(a, b)) shorter = true;
      if (a < b && swap(a, b)) shorter = true;
      if (a < b && exchange_ends(a, b)) shorter = true;
    }
  }
  return shorter;
}

bool WorkingTeam::take(int a, std::vector<int> walk_a, int b, std::vector<int> walk_b) {
  WorkingTour &first = tours_[a], &second = tours_[b];
  const std::vector<int> old_a = first.walk(), old_b = second.walk();
  const double before = first.seconds() + second.seconds(), score = views_.state().score();
  first.become(walk_a);
  second.become(walk_b);
  const bool shorter = first.seconds() + second.seconds() < before - kSaved / 2;
  const bool sound = first.room() >= 0 && second.room() >= 0 && within_limits() &&
                     visits_once(first) && visits_once(second);
  if (shorter && sound && views_.state().score() >= score) return true;
  first.become(old_a);
  second.become(old_b);
  return false;
}

bool WorkingTeam::relocate(int from, int to) {
  const WorkingTour &source = tours_[from], &target = tours_[to];
  TeamMove best;
  for (int i = 1; i + 1 < source.size(); ++i) {
    const double saved = saved_without(source, i);
    if (saved <= best.saved) continue;
    const auto legs = target.problem().legs_from(source.walk()[i]);
    for (int j = 0; j + 1 < target.size(); ++j) {
      const int u = target.walk()[j], w = target.walk()[j + 1];
      const double extra = legs[u] + legs[w] - target.problem().leg(u, w);
      if (saved - extra > best.saved && extra <= target.room()) best = {saved - extra, i, j};
    }
  }
  if (best.i < 0) return false;
  std::vector<int> shorter = source.walk(), longer = target.walk();
  longer.insert(longer.begin() + best.j + 1, shorter[best.i]);
  shorter.erase(shorter.begin() + best.i);
  return take(from, std::move(shorter), to, std::move(longer));
}

bool WorkingTeam::swap(int a, int b) {
  const WorkingTour &first = tours_[a], &second = tours_[b];
  TeamMove best;
  // In the place of position `i` of a tour, another view.
  const auto change = [](const WorkingTour& tour, int i, int view) {
    const auto& w = tour.walk();
    const TourProblem& p = tour.problem();
    return p.leg(w[i - 1], view) + p.leg(view, w[i + 1]) - p.leg(w[i - 1], w[i]) -
           p.leg(w[i], w[i + 1]);
  };
  for (int i = 1; i + 1 < first.size(); ++i) {
    for (int j = 1; j + 1 < second.size(); ++j) {
      const int u = first.walk()[i], v = second.walk()[j];
      if (u == v) continue;
      const double more_a = change(first, i, v), more_b = change(second, j, u);
      if (more_a > first.room() || more_b > second.room()) continue;
      if (-more_a - more_b > best.saved) best = {-more_a - more_b, i, j};
    }
  }
  if (best.i < 0) return false;
  std::vector<int> walk_a = first.walk(), walk_b = second.walk();
  std::swap(walk_a[best.i], walk_b[best.j]);
  return take(a, std::move(walk_a), b, std::move(walk_b));
}

bool WorkingTeam::exchange_ends(int a, int b) {
  const WorkingTour &first = tours_[a], &second = tours_[b];
  if (!first.problem().same_ways(second.problem())) return false;
  const std::vector<double> clock_a = clock_of(first), clock_b = clock_of(second);
  TeamMove best;
  for (int i = 0; i + 1 < first.size(); ++i) {
    const auto legs = first.problem().legs_from(first.walk()[i]);
    for (int j = 0; j + 1 < second.size(); ++j) {
      const double into_b = legs[second.walk()[j + 1]];
      const double into_a = first.problem().leg(second.walk()[j], first.walk()[i + 1]);
      const double gone = clock_a[i + 1] - clock_a[i] + clock_b[j + 1] - clock_b[j];
      const double saved = gone - into_a - into_b;
      if (saved <= best.saved) continue;
      const double time_a = clock_a[i] + into_b + clock_b.back() - clock_b[j + 1];
      const double time_b = clock_b[j] + into_a + clock_a.back() - clock_a[i + 1];
      if (time_a > clock_a.back() + first.room() || time_b > clock_b.back() + second.room())
        continue;
      best = {saved, i, j};
    }
  }
  if (best.i < 0) return false;
  const auto &wa = first.walk(), &wb = second.walk();
  std::vector<int> walk_a(wa.begin(), wa.begin() + best.i + 1);
  walk_a.insert(walk_a.end(), wb.begin() + best.j + 1, wb.end());
  std::vector<int> walk_b(wb.begin(), wb.begin() + best.j + 1);
  walk_b.insert(walk_b.end(), wa.begin() + best.i + 1, wa.end());
  return take(a, std::move(walk_a), b, std::move(walk_b));
}

}  // namespace lapwing
