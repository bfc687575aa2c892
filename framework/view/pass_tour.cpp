// SPDX-License-Identifier: Apache-2.0
#include "framework/view/pass_tour.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "framework/core/random.h"

namespace lapwing {
namespace {

using Order = std::vector<DirectedPass>;
constexpr double kShorter = 1e-9;    // s, what is less is rounding
constexpr double kNoise = 0.3;       // of a pass' worth, while a tour is filled again
constexpr double kMostRuined = 0.4;  // of the passes of a tour

DirectedPass turned(DirectedPass pass) {
  return pass ^ 1;
}

class PassSearch {
 public:
  PassSearch(const PassProblem& problem, const PassRequest& request)
      : problem_(problem), request_(request), random_(request.seed), state_(problem.score()) {}

  // Inserts what fits until nothing is left that shows more.
  void fill(Order& order, double noise) {
    set(order);
    while (insert_best(order, noise)) shorten(order);
  }

  // Without some passes, next to each other or anywhere.
  Order ruined(const Order& order) {
    const auto count = static_cast<std::int64_t>(order.size());
    const auto most =
        std::max<std::int64_t>(1, std::llround(kMostRuined * static_cast<double>(count)));
    const std::int64_t removed = random_.integer(1, most);
    Order left = order;
    if (random_.bits() & 1) {
      const auto first = left.begin() + random_.integer(0, count - removed);
      left.erase(first, first + removed);
      return left;
    }
    for (std::int64_t k = 0; k < removed; ++k)
      left.erase(left.begin() + random_.integer(0, static_cast<std::int64_t>(left.size()) - 1));
    return left;
  }

  double score_of(const Order& order) {
    set(order);
    return state_.score();
  }
  std::int64_t evaluations() const { return state_.evaluations(); }
  int images_of(const Order& order) const {
    std::size_t images = 0;
    for (const DirectedPass p : order) images += problem_.views_of(p / 2).size();
    return static_cast<int>(images);
  }

 private:
  void set(const Order& order) {
    std::vector<char> wanted(static_cast<std::size_t>(problem_.passes()), 0);
    for (const DirectedPass p : order) wanted[static_cast<std::size_t>(p / 2)] = 1;
    for (int p = 0; p < problem_.passes(); ++p) {
      if (wanted[static_cast<std::size_t>(p)])
        state_.add(p);
      else
        state_.remove(p);
    }
  }

  // s that a directed pass before place `at` adds.
  double added(const Order& order, std::size_t at, DirectedPass pass) const {
    if (order.empty()) return problem_.seconds_of(std::span(&pass, 1));
    double sum = problem_.seconds(pass / 2);
    if (at > 0) sum += problem_.leg(order[at - 1], pass);
    if (at < order.size()) sum += problem_.leg(pass, order[at]);
    if (at > 0 && at < order.size()) sum -= problem_.leg(order[at - 1], order[at]);
    return sum;
  }

  bool insert_best(Order& order, double noise) {
    const double left = request_.budget - problem_.seconds_of(order);
    const int images = images_of(order);
    double best = 0;
    std::size_t place = 0;
    DirectedPass chosen = -1;
    for (int p = 0; p < problem_.passes(); ++p) {
      if (state_.contains(p)) continue;
      if (request_.image_limit &&
          images + static_cast<int>(problem_.views_of(p).size()) > *request_.image_limit)
        continue;
      const double factor = noise > 0 ? random_.uniform(1 - noise, 1 + noise) : 1;
      double least = left;
      std::size_t where = 0;
      DirectedPass which = -1;
      for (const DirectedPass way : {2 * p, 2 * p + 1}) {
        if (!problem_.possible(way)) continue;
        for (std::size_t at = 0; at <= order.size(); ++at) {
          const double more = added(order, at, way);
          if (more < least) least = more, where = at, which = way;
        }
      }
      if (which < 0) continue;
      const double gain = state_.gain(p);
      if (!(gain > 0)) continue;
      const double worth = factor * gain / std::max(least, kShorter);
      if (worth > best) best = worth, place = where, chosen = which;
    }
    if (chosen < 0) return false;
    order.insert(order.begin() + static_cast<std::ptrdiff_t>(place), chosen);
    state_.add(chosen / 2);
    return true;
  }

  // The first change that makes it shorter, until there is none.
  void shorten(Order& order) const {
    double seconds = problem_.seconds_of(order);
    const auto better = [&](const Order& changed) {
      const double other = problem_.seconds_of(changed);
      if (!(other < seconds - kShorter)) return false;
      seconds = other;
      order = changed;
      return true;
    };
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t i = 0; i < order.size(); ++i)
        for (std::size_t j = i; j < order.size(); ++j) {
          Order other = order;  // flown the other way from i to j
          std::reverse(other.begin() + static_cast<std::ptrdiff_t>(i),
                       other.begin() + static_cast<std::ptrdiff_t>(j) + 1);
          for (std::size_t k = i; k <= j; ++k) other[k] = turned(other[k]);
          changed = better(other) || changed;
        }
      for (std::size_t i = 0; i < order.size(); ++i)
        for (std::size_t j = 0; j < order.size(); ++j)
          for (const bool turn : {false, true}) {
            Order other = order;
            const DirectedPass pass = turn ? turned(other[i]) : other[i];
            other.erase(other.begin() + static_cast<std::ptrdiff_t>(i));
            other.insert(other.begin() + static_cast<std::ptrdiff_t>(j), pass);
            changed = better(other) || changed;
          }
    }
  }

  const PassProblem& problem_;
  const PassRequest& request_;
  Random random_;
  ScoreState state_;
};

// Passes that fit by themselves, and what all of them show.
void see_reachable(const PassProblem& problem, double budget, TourReport& report) {
  ScoreState all(problem.score());
  for (int p = 0; p < problem.passes(); ++p)
    for (const DirectedPass way : {2 * p, 2 * p + 1}) {
      if (all.contains(p) || !(problem.seconds_of(std::span(&way, 1)) <= budget)) continue;
      all.add(p);
      report.reachable += static_cast<int>(problem.views_of(p).size());
    }
  report.reachable_score = report.upper_bound = all.score();
}

}  // namespace

PassTour find_pass_tour(const PassProblem& problem, const PassRequest& request) {
  const auto began = std::chrono::steady_clock::now();
  PassTour tour;
  see_reachable(problem, request.budget, tour.report);
  PassSearch search(problem, request);
  search.fill(tour.order, 0);
  double score = search.score_of(tour.order);
  TourReport& report = tour.report;
  report.status = TourStatus::feasible;
  for (std::int64_t k = 0; k < request.iterations && !tour.order.empty(); ++k) {
    if (request.cancellation && request.cancellation->cancelled()) {
      report.status = TourStatus::cancelled;
      break;
    }
    Order other = search.ruined(tour.order);
    search.fill(other, kNoise);
    search.fill(other, 0);
    const double shown = search.score_of(other);
    if (shown > score ||
        (shown == score && problem.seconds_of(other) < problem.seconds_of(tour.order) - kShorter)) {
      score = shown;
      tour.order = std::move(other);
    }
    ++report.iterations;
    if (request.progress)
      request.progress->report(static_cast<double>(k + 1) / static_cast<double>(request.iterations),
                               "order of passes");
  }
  report.score = score;
  report.seconds_used = problem.seconds_of(tour.order);
  report.images = search.images_of(tour.order);
  report.evaluations = search.evaluations();
  report.gap = report.upper_bound > 0 ? (report.upper_bound - score) / report.upper_bound : 0;
  char text[160];
  if (tour.order.empty()) {
    report.status = TourStatus::infeasible;
    std::snprintf(text, sizeof text, "none of %d passes fits into %.6g s and shows anything",
                  problem.passes(), request.budget);
  } else {
    std::snprintf(text, sizeof text, "%zu of %d passes with %d images", tour.order.size(),
                  problem.passes(), report.images);
  }
  report.message = text;
  report.wall_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  return tour;
}

}  // namespace lapwing
