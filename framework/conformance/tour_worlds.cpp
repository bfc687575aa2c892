// SPDX-License-Identifier: Apache-2.0
#include "framework/conformance/tour_worlds.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <queue>

#include "framework/core/error.h"
#include "framework/core/random.h"

namespace lapwing {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kRounding = 1e-9;

using Matrix = std::vector<std::vector<double>>;

Matrix direct_seconds(const TourDefinition& d, int n) {
  Matrix seconds(n, std::vector<double>(n, kNever));
  for (int a = 0; a < n && !d.legs.empty(); ++a) {
    for (int b = 0; b < n; ++b) seconds[a][b] = d.legs[static_cast<std::size_t>(a) * n + b];
  }
  for (const TourMotion& m : d.motions) {
    seconds[m.a][m.b] = std::min(seconds[m.a][m.b], m.seconds);
    seconds[m.b][m.a] = seconds[m.a][m.b];
  }
  return seconds;
}

double score_of(const ViewScore& score, unsigned set) {
  std::vector<double> seen(score.voxels(), 0);
  for (int v = 0; v < score.views(); ++v) {
    if (!(set >> v & 1)) continue;
    for (std::size_t i = 0; i < score.voxels_of(v).size(); ++i) {
      seen[score.voxels_of(v)[i]] += score.amounts_of(v)[i];
    }
  }
  double sum = 0;
  for (std::size_t x = 0; x < seen.size(); ++x) {
    sum += std::min<double>(seen[x], score.capacities()[x]);
  }
  return sum * score.unit();
}

// The quickest walk that has seen exactly `set` and stands at a view: Dijkstra over both.
std::vector<double> quickest_walks(const TourDefinition& d, int n) {
  const Matrix seconds = direct_seconds(d, n);
  const auto stop = [&](int v) {
    return v == d.start || v == d.end  ? 0
           : d.view_seconds.size() > 1 ? d.view_seconds[v]
                                       : d.view_seconds.front();
  };
  std::vector<double> best((std::size_t{1} << n) * n, kNever);
  using Entry = std::pair<double, std::size_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  const std::size_t first = (std::size_t{1} << d.start) * n + d.start;
  best[first] = 0;
  open.push({0, first});
  while (!open.empty()) {
    const auto [time, at] = open.top();
    open.pop();
    if (time > best[at]) continue;
    const std::size_t set = at / n;
    const int here = static_cast<int>(at % n);
    for (int v = 0; v < n; ++v) {
      if (v == here || seconds[here][v] == kNever) continue;
      const bool again = set >> v & 1;
      // With stated legs nothing is visited twice, but a loop closes (and is then over).
      if (!d.legs.empty() && again && !(v == d.start && d.start == d.end)) continue;
      if (!d.legs.empty() && here == d.start && set != std::size_t{1} << d.start) continue;
      const std::size_t next = (set | std::size_t{1} << v) * n + v;
      const double reached = time + seconds[here][v] + stop(v);
      if (reached >= best[next]) continue;
      best[next] = reached;
      open.push({reached, next});
    }
  }
  return best;
}

// Whether some tour sees exactly that set, for every set of views.
std::vector<char> sets_within(const TourDefinition& d) {
  const int n = d.score->views();
  if (n > 16) throw Error("enumeration takes at most 16 views");
  const std::vector<double> walks = quickest_walks(d, n);
  const auto stop = [&](int v) {
    return d.view_seconds.size() > 1 ? d.view_seconds[v] : d.view_seconds.front();
  };
  const double fixed = stop(d.start) + (d.start == d.end ? 0 : stop(d.end));
  std::vector<char> within(std::size_t{1} << n, 0);
  for (std::size_t set = 1; set < within.size(); ++set) {
    if (d.image_limit && std::popcount(set) > *d.image_limit) continue;
    within[set] = fixed + walks[set * n + d.end] <= d.budget + kRounding * (1 + d.budget);
  }
  return within;
}

std::vector<double> random_weights(Random& random, int count) {
  std::vector<double> weights(count);
  for (double& w : weights) w = random.uniform(0.5, 2);
  return weights;
}

ViewScore random_coverage(Random& random, const std::vector<double>& x,
                          const std::vector<double>& y, int voxels) {
  ViewScoreBuilder builder(voxels, random_weights(random, voxels));
  std::vector<double> vx(voxels), vy(voxels);
  for (int i = 0; i < voxels; ++i) {
    vx[i] = random.uniform(0, 10);
    vy[i] = random.uniform(0, 10);
  }
  for (std::size_t v = 0; v < x.size(); ++v) {
    std::vector<ViewScore::Contribution> seen;
    for (int i = 0; i < voxels; ++i) {
      const double distance = std::hypot(x[v] - vx[i], y[v] - vy[i]);
      if (distance < 5) {
        seen.push_back({static_cast<std::uint32_t>(i), static_cast<float>(0.7 - 0.1 * distance)});
      }
    }
    builder.add_view(seen);
  }
  return std::move(builder).take();
}

}  // namespace

double best_score_by_enumeration(const TourDefinition& d) {
  const std::vector<char> seen = sets_within(d);
  double best = -1;
  for (std::size_t set = 1; set < seen.size(); ++set)
    if (seen[set]) best = std::max(best, score_of(*d.score, static_cast<unsigned>(set)));
  return best;
}

double best_team_score_by_enumeration(const std::vector<TourDefinition>& tours) {
  if (tours.front().score->views() > 13) throw Error("enumeration of teams takes at most 13 views");
  std::vector<unsigned> unions{0};
  for (const TourDefinition& d : tours) {
    const std::vector<char> within = sets_within(d);
    std::vector<unsigned> own;
    for (unsigned set = 0; set < within.size(); ++set)
      if (within[set]) own.push_back(set);
    std::vector<char> with(within.size(), 0);
    for (const unsigned a : unions)
      for (const unsigned b : own) with[a | b] = 1;
    unions.clear();
    for (unsigned set = 0; set < with.size(); ++set)
      if (with[set]) unions.push_back(set);
  }
  double best = -1;
  for (const unsigned set : unions) best = std::max(best, score_of(*tours.front().score, set));
  return best;
}

std::string fault_of_walk(const TourDefinition& d, const std::vector<int>& walk) {
  const int n = d.score->views();
  if (walk.empty() || walk.front() != d.start || walk.back() != d.end)
    return "does not go from the start to the end";
  const Matrix direct = direct_seconds(d, n);
  const auto stop = [&](int v) {
    return d.view_seconds.size() > 1 ? d.view_seconds[v] : d.view_seconds.front();
  };
  std::vector<int> visits(n, 0);
  for (const int v : walk) {
    if (v < 0 || v >= n) return "visits view " + std::to_string(v) + ", which does not exist";
    ++visits[v];
  }
  // Start and end are stopped at once, every other view whenever it is reached.
  double seconds = stop(d.start) + (d.start == d.end ? 0 : stop(d.end));
  for (std::size_t i = 1; i < walk.size(); ++i) {
    const double way = direct[walk[i - 1]][walk[i]];
    if (walk[i - 1] == walk[i] || way == kNever)
      return "goes from " + std::to_string(walk[i - 1]) + " to " + std::to_string(walk[i]) +
             ", where no motion leads";
    seconds += way + (walk[i] == d.start || walk[i] == d.end ? 0 : stop(walk[i]));
  }
  int images = 0;
  for (int v = 0; v < n; ++v) {
    const bool closes = v == d.start && d.start == d.end;
    if (!d.legs.empty() && visits[v] > (closes ? 2 : 1))
      return "visits view " + std::to_string(v) + " twice";
    images += visits[v] > 0;
  }
  if (seconds > d.budget + kRounding * (1 + d.budget))
    return "takes " + std::to_string(seconds) + " s of a budget of " + std::to_string(d.budget) +
           " s";
  if (d.image_limit && images > *d.image_limit)
    return "takes " + std::to_string(images) + " images where " + std::to_string(*d.image_limit) +
           " are allowed";
  return "";
}

double score_of_walk(const TourDefinition& d, const std::vector<int>& walk) {
  unsigned set = 0;
  for (const int v : walk) set |= 1u << v;
  return score_of(*d.score, set);
}

double score_of_walks(const TourDefinition& d, const std::vector<std::vector<int>>& walks) {
  unsigned set = 0;
  for (const std::vector<int>& walk : walks)
    for (const int v : walk) set |= 1u << v;
  return score_of(*d.score, set);
}

TourDefinition random_tour(std::uint64_t seed, const TourWorldOptions& options) {
  Random random(seed);
  const int n = options.views;
  std::vector<double> x(n), y(n);
  for (int v = 0; v < n; ++v) {
    x[v] = random.uniform(0, 10);
    y[v] = random.uniform(0, 10);
  }
  TourDefinition d;
  if (options.additive) {
    std::vector<double> scores(n);
    for (double& s : scores) s = static_cast<double>(random.integer(0, 9));
    d.score = std::make_shared<const ViewScore>(additive_score(scores));
  } else {
    d.score = std::make_shared<const ViewScore>(random_coverage(random, x, y, options.voxels));
  }
  for (int v = 0; v < n; ++v) d.view_seconds.push_back(random.uniform(0, 2));
  if (options.legs) d.legs.resize(static_cast<std::size_t>(n) * n);
  for (int a = 0; a < n; ++a) {
    for (int b = a + 1; b < n; ++b) {
      const double seconds = std::hypot(x[a] - x[b], y[a] - y[b]);
      if (options.legs)
        d.legs[a * n + b] = d.legs[b * n + a] = seconds;
      else if (seconds < 5 || b == a + 1)
        d.motions.push_back({a, b, seconds});
    }
  }
  d.end = options.loop ? 0 : n - 1;
  d.budget = options.budget_share * n * 3.5;
  if (options.image_limit > 0) d.image_limit = options.image_limit;
  return d;
}

std::vector<TourWorld> tour_worlds() {
  std::vector<TourWorld> worlds;
  const auto add = [&](std::string name, TourDefinition definition) {
    const double best = best_score_by_enumeration(definition);
    worlds.push_back({std::move(name), std::move(definition), best});
  };
  add("a loop over motions", random_tour(1, {}));
  add("a way over motions", random_tour(2, {.loop = false, .budget_share = 0.7}));
  add("a loop over legs", random_tour(3, {.legs = true}));
  add("a way over legs", random_tour(4, {.legs = true, .loop = false, .budget_share = 0.7}));
  add("scores of views", random_tour(5, {.legs = true, .additive = true}));
  add("few images", random_tour(6, {.budget_share = 1, .image_limit = 4}));
  add("budget for all", random_tour(7, {.views = 7, .budget_share = 4}));
  add("a tiny budget", random_tour(8, {.budget_share = 0.15}));
  TourDefinition apart = random_tour(9, {.loop = false});
  std::erase_if(apart.motions, [](const TourMotion& m) { return m.a == 9 || m.b == 9; });
  add("an end that no motion leads to", apart);
  TourDefinition poor = random_tour(10, {});
  poor.budget = 0.5 * poor.view_seconds[0];
  add("a budget too small for one view", poor);
  TourDefinition lonely = random_tour(11, {});
  std::erase_if(lonely.motions, [](const TourMotion& m) { return m.a == 0 || m.b == 0; });
  add("a start that no motion leaves", lonely);
  return worlds;
}

TeamProblem team_of(const TeamWorld& world) {
  std::vector<TeamTour> tours;
  for (std::size_t t = 0; t < world.tours.size(); ++t)
    tours.push_back({std::to_string(t + 1), TourProblem(world.tours[t])});
  return TeamProblem(std::move(tours));
}

std::vector<TeamWorld> team_worlds() {
  std::vector<TeamWorld> worlds;
  const auto add = [&](std::string name, std::vector<TourDefinition> tours) {
    const double best = best_team_score_by_enumeration(tours);
    worlds.push_back({std::move(name), std::move(tours), best});
  };
  const auto base = [](std::uint64_t seed, TourWorldOptions options) {
    options.views = 9;
    return random_tour(seed, options);
  };
  const TourDefinition loop = base(21, {.budget_share = 0.3});
  add("two loops over motions", {loop, loop});
  const TourDefinition way = base(22, {.legs = true, .loop = false, .budget_share = 0.4});
  add("three ways over legs", {way, way, way});
  const TourDefinition scores = base(23, {.legs = true, .additive = true, .budget_share = 0.3});
  add("two tours for scores of views", {scores, scores});
  TourDefinition home = base(24, {.budget_share = 0.3}), other = home;
  other.start = other.end = 5;
  other.budget *= 1.5;
  for (TourMotion& motion : other.motions) motion.seconds *= 2;  // a slower vehicle
  add("two homes and two vehicles", {home, other});
  TourDefinition few = base(25, {.budget_share = 0.6, .image_limit = 3});
  add("few images each", {few, few});
  const TourDefinition rich = base(26, {.budget_share = 4});
  add("budgets for all", {rich, rich});
  TourDefinition poor = loop;
  poor.budget = 0.5 * poor.view_seconds[0];
  add("a budget too small for one view", {loop, poor});
  return worlds;
}

}  // namespace lapwing
