// SPDX-License-Identifier: Apache-2.0
// How: each step takes an image into the map, adds the neighbours of the viewpoint to the graph,
// and takes the next view from a queue by value. Values may be of older maps. They usually fall as
// the map grows, so an old value counts as an upper bound: the top entries are valued anew, four at
// a time, until an entry of this step is on top (lazy evaluation). The way there is searched in the
// graph of viewpoints. Motions whose voxels are no longer free are left out. When the best value is
// 0, all others are valued anew before the episode ends.
#include "framework/explore/episode.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <queue>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/explore/episode_map.h"
#include "framework/explore/lookahead.h"

namespace lapwing {
namespace {

constexpr double kMostCleared = 1 << 24;  // voxels
constexpr int kRescored = 4;              // views that are re-scored together; a part of the result
constexpr std::size_t kListed = 64;       // candidates valued between two looks at the clock

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void require_sense(const EpisodeSettings& s, const Map& map) {
  check_camera(s.sensor.pinhole, s.sensor.range);
  const auto above = [](double value, const char* what) {
    if (!(value > 0 && std::isfinite(value)))
      throw InputError(std::string(what) + " must be above 0, not " + plain_number(value));
  };
  above(s.step, "the step to a neighbour");
  above(s.turn, "the turn to a neighbour");
  above(s.body, "the edge of the body");
  above(s.speed, "the speed");
  above(s.turn_rate, "the turn rate");
  if (!(s.acceleration >= 0) || !std::isfinite(s.acceleration) || !(s.turn_acceleration >= 0) ||
      !std::isfinite(s.turn_acceleration) || (s.acceleration > 0) != (s.turn_acceleration > 0))
    throw InputError("accelerations of moves must be above 0, or both 0");
  if (!(s.pause >= 0) || !std::isfinite(s.pause))
    throw InputError("the pause for an image must be at least 0 s");
  if (s.per_second && !(s.pause > 0))
    throw InputError("an exploration by seconds needs a pause for an image above 0 s");
  if (!(s.clear >= s.body)) throw InputError("the box cleared at the start must hold the body");
  if (const double edge = s.clear / map.grid().resolution() + 2; edge * edge * edge > kMostCleared)
    throw InputError("the box of " + plain_number(s.clear) + " m cleared at the start holds " +
                     "more than 2^24 voxels of " + plain_number(map.grid().resolution()) + " m");
  if (s.lookahead < 1 || s.lookahead > EpisodeSettings::kMostLookahead)
    throw InputError("lookahead: expected 1 to " + std::to_string(EpisodeSettings::kMostLookahead) +
                     " views, not " + std::to_string(s.lookahead));
  if (s.visits < 1 || s.steps < 1) throw InputError("expected at least one visit and one step");
  if (!map.settings().observations)
    throw InputError("an exploration needs a map that counts observations");
  if (std::abs(map.settings().maximum_range - s.sensor.range) > 1e-9)
    throw InputError("the map's maximum_range must be the camera's range");
}

// The viewpoints that could be gone to, by rank; values of older maps are upper bounds.
class Candidates {
 public:
  struct Entry {
    double value;
    int place;
    int scored;   // at which step
    double rank;  // the value, or the value for each second
    // The highest rank on top, of equal ones the one that was known first.
    bool operator<(const Entry& other) const {
      return rank != other.rank ? rank < other.rank : place > other.place;
    }
  };
  void push(const Entry& entry) { queue_.push(entry); }
  bool empty() const { return queue_.empty(); }
  const Entry& top() const { return queue_.top(); }
  Entry pop() {
    const Entry entry = queue_.top();
    queue_.pop();
    return entry;
  }
  // Ranks all anew.
  template <class Rank>
  void rank_anew(Rank rank) {
    std::vector<Entry> entries;
    while (!empty()) {
      entries.push_back(pop());
      entries.back().rank = rank(entries.back().value, entries.back().place);
    }
    queue_ = std::priority_queue<Entry>(std::less<Entry>(), std::move(entries));
  }

 private:
  std::priority_queue<Entry> queue_;
};

class Explorer {
 public:
  Explorer(const EpisodeSettings& settings, const GroundTruth& truth, ObservedSurface& observed,
           const ViewUtility& utility, Map& map, const EpisodeObserver& observer,
           const ChoiceObserver& before)
      : settings_(settings),
        truth_(truth),
        observed_(observed),
        utility_(utility),
        map_(map),
        observer_(observer),
        before_(before),
        means_(map),
        hidden_(map),
        graph_(map, Eigen::Vector3d::Constant(settings.body / 2), move_times(settings)) {
    known_ = {&map,
              &means_,
              settings.sensor.pinhole,
              settings.sensor.range,
              0,
              settings.show_truth ? &observed : nullptr,
              settings.threads,
              &hidden_};
  }

  EpisodeResult run(const Viewpoint& start);

 private:
  void begin(const Viewpoint& start);
  // The next viewpoint and the way there; false where the episode ends.
  bool choose(EpisodeStep& taken, int& place);
  void look(EpisodeStep& taken, int place);
  void add_neighbours(int place, std::vector<Viewpoint>& reachable);
  void score(std::span<const int> places);
  double rank_of(double value, int place) const;
  // As the explorer chooses by them; how many views the utility was asked for.
  int value_of(std::span<const Viewpoint> views, std::span<double> values) const;
  // All candidates whose values are of older maps; false where there are none.
  bool rescore_all();
  void list_what_is_left();
  // The neighbours that a way could go on to.
  std::vector<Viewpoint> worth_looking_from(const Viewpoint& view) const;
  double share_done() const;
  // Why it must not go on.
  std::optional<EpisodeEnd> stopped() const;
  // What an observer does is not the explorer's time.
  template <class Work>
  void unhurried(Work work) {
    const double before = wall_seconds();
    work();
    began_ += wall_seconds() - before;
  }
  bool within_bounds(const Viewpoint& view) const {
    return !settings_.bounds || settings_.bounds->contains(view.position);
  }

  const EpisodeSettings& settings_;
  const GroundTruth& truth_;
  ObservedSurface& observed_;
  const ViewUtility& utility_;
  Map& map_;
  const EpisodeObserver& observer_;
  const ChoiceObserver& before_;
  MapMeans means_;
  HiddenVoxels hidden_;
  ViewpointGraph graph_;
  EpisodeView known_;
  Candidates candidates_;
  std::vector<int> visits_;    // by place
  std::vector<double> reach_;  // s, by place: the quickest ways from here, if seconds count
  int at_ = 0;
  int step_ = 0;
  int scored_ = 0;
  double began_ = 0;
  EpisodeResult result_;
};

void Explorer::begin(const Viewpoint& start) {
  known_.pitch = start.pitch;
  in_plugin(utility_, "require_fit", [&] { utility_.require_fit(known_); });
  if (!map_.grid().contains(start.position))
    throw InputError("the start lies outside the largest map");
  if (!within_bounds(start))
    throw InputError("the start lies outside the bounds of the exploration");
  const Eigen::AlignedBox3d cleared = cleared_box(map_.grid(), start.position, settings_.clear);
  if (truth_.box_blocked(cleared))
    throw StartError("the start at (" + plain_number(start.position.x()) + ", " +
                     plain_number(start.position.y()) + ", " + plain_number(start.position.z()) +
                     ") lies in an obstacle: a box of " + plain_number(settings_.clear) +
                     " m around it must be free");
  means_.touch(clear_box(map_, cleared));
  int ways = 0;
  for (const Viewpoint& next : neighbours_of(start, settings_.step, settings_.turn))
    ways += next.position != start.position && within_bounds(next) && graph_.free(start, next);
  if (ways == 0)
    throw StartError("no neighbour of the start is reachable: a step of " +
                     plain_number(settings_.step) + " m leaves the box of " +
                     plain_number(settings_.clear) + " m that is known to be free, or the bounds");
  at_ = graph_.add(start);
  visits_.push_back(0);
  score(std::vector<int>{at_});
}

void Explorer::score(std::span<const int> places) {
  std::vector<Viewpoint> views;
  for (const int place : places) views.push_back(graph_[place]);
  std::vector<double> values(views.size());
  scored_ += value_of(views, values);
  for (std::size_t k = 0; k < places.size(); ++k)
    candidates_.push({values[k], places[k], step_, rank_of(values[k], places[k])});
}

double Explorer::rank_of(double value, int place) const {
  if (!settings_.per_second) return value;
  // Of a view that nobody has asked for the way to: until then it is a neighbour.
  const auto at = static_cast<std::size_t>(place);
  const double reach = at < reach_.size() ? reach_[at] : 0;
  return value / (reach + settings_.pause);
}

int Explorer::value_of(std::span<const Viewpoint> views, std::span<double> values) const {
  if (settings_.lookahead > 1)
    return score_ahead(
        utility_, known_, views, settings_.lookahead,
        [&](const Viewpoint& view) { return worth_looking_from(view); }, values);
  utility_.score(known_, views, values);
  return static_cast<int>(views.size());
}

std::vector<Viewpoint> Explorer::worth_looking_from(const Viewpoint& view) const {
  std::vector<Viewpoint> views;
  for (const Viewpoint& next : neighbours_of(view, settings_.step, settings_.turn)) {
    const int place = graph_.find(next);
    const bool done = place >= 0 && visits_[static_cast<std::size_t>(place)] >= settings_.visits;
    if (!done && within_bounds(next) && graph_.free(view, next)) views.push_back(next);
  }
  return views;
}

bool Explorer::rescore_all() {
  std::vector<Candidates::Entry> fresh;
  std::vector<int> stale;
  while (!candidates_.empty()) {
    const Candidates::Entry entry = candidates_.pop();
    if (visits_[static_cast<std::size_t>(entry.place)] >= settings_.visits) continue;
    if (entry.scored == step_)
      fresh.push_back(entry);
    else
      stale.push_back(entry.place);
  }
  for (const Candidates::Entry& entry : fresh) candidates_.push(entry);
  score(stale);
  return !stale.empty();
}

bool Explorer::choose(EpisodeStep& taken, int& place) {
  if (settings_.per_second) {
    reach_ = graph_.seconds_from(at_);
    candidates_.rank_anew([&](double value, int at) { return rank_of(value, at); });
  }
  std::vector<Candidates::Entry> unreachable;
  const auto keep = [&] {
    for (const Candidates::Entry& entry : unreachable) candidates_.push(entry);
  };
  while (!candidates_.empty()) {
    std::vector<int> stale;
    while (!candidates_.empty() && candidates_.top().scored != step_ &&
           static_cast<int>(stale.size()) < kRescored) {
      const int old = candidates_.pop().place;
      if (visits_[static_cast<std::size_t>(old)] < settings_.visits) stale.push_back(old);
    }
    if (!stale.empty()) {
      score(stale);
      continue;
    }
    if (candidates_.empty()) break;
    const Candidates::Entry best = candidates_.pop();
    if (visits_[static_cast<std::size_t>(best.place)] >= settings_.visits) continue;
    if (!(best.value > 0) && step_ > 0) {
      candidates_.push(best);
      // Values that are no upper bounds may have risen with the map.
      if (rescore_all()) continue;
      keep();
      result_.end = EpisodeEnd::nothing_to_gain;
      return false;
    }
    const std::vector<int> way = graph_.way(at_, best.place);
    if ((way.empty() && best.place != at_) ||
        !graph_.free(graph_[best.place], graph_[best.place])) {
      unreachable.push_back(best);
      continue;
    }
    const MoveTimes times = move_times(settings_);
    double seconds = 0, length = 0;
    int from = at_;
    for (const int next : way) {
      length += (graph_[next].position - graph_[from].position).norm();
      seconds += times.of(graph_[from], graph_[next]);
      from = next;
    }
    if (settings_.per_second) {
      // A move on the way was found to be blocked: it is worth less than it was ranked by.
      reach_[static_cast<std::size_t>(best.place)] = seconds;
      if (const double rank = rank_of(best.value, best.place); rank < best.rank * (1 - 1e-9)) {
        candidates_.push({best.value, best.place, best.scored, rank});
        continue;
      }
    }
    taken.value = best.value;
    taken.length += length;
    for (const int next : way) taken.way.push_back(graph_[next]);
    taken.time += seconds + settings_.pause;
    keep();
    if (settings_.budget && taken.time > *settings_.budget) {
      candidates_.push(best);
      result_.end = EpisodeEnd::budget;
      return false;
    }
    if (visits_[static_cast<std::size_t>(best.place)] + 1 < settings_.visits)
      candidates_.push({best.value, best.place, step_, best.rank});
    place = best.place;
    return true;
  }
  keep();
  result_.end = EpisodeEnd::no_way;
  return false;
}

void Explorer::look(EpisodeStep& taken, int place) {
  taken.view = graph_[place];
  const double before = wall_seconds();
  PosedDepthImage image = settings_.sensor.measure(
      truth_.scene(), taken.view, settings_.seed + static_cast<std::uint64_t>(step_),
      settings_.threads);
  const double after = wall_seconds();
  began_ += after - before;  // the camera's time is not the explorer's
  settings_.sensor.smooth(image, settings_.threads);
  map_.integrate(image);
  hidden_.saw(image);
  means_.touch(
      reach_box(map_.grid(), taken.view, settings_.sensor.pinhole, settings_.sensor.range));
  if (const auto cleared = clear_body(map_, taken.view, settings_.body)) means_.touch(*cleared);
  graph_.look_again();
  const double mapped = wall_seconds();
  observed_.update(map_, taken.view);
  began_ += wall_seconds() - mapped;  // nor is what the truth says of it
  taken.observed = observed_.observed();
  ++visits_[static_cast<std::size_t>(place)];
  at_ = place;
}

void Explorer::add_neighbours(int place, std::vector<Viewpoint>& reachable) {
  const Viewpoint here = graph_[place];
  std::vector<int> fresh;
  for (const Viewpoint& next : neighbours_of(here, settings_.step, settings_.turn)) {
    if (!within_bounds(next) || !graph_.free(here, next)) continue;
    reachable.push_back(next);
    const bool known = graph_.find(next) >= 0;
    const int added = graph_.add(next);
    graph_.join(place, added);
    if (known) continue;
    visits_.push_back(0);
    fresh.push_back(added);
  }
  score(fresh);
}

// Of the images or of the budget, whichever ends first.
double Explorer::share_done() const {
  const double images = static_cast<double>(step_) / settings_.steps;
  if (!settings_.budget || result_.steps.empty()) return images;
  return std::min(1.0, std::max(images, result_.steps.back().time / *settings_.budget));
}

std::optional<EpisodeEnd> Explorer::stopped() const {
  if (settings_.cancellation && settings_.cancellation->cancelled()) return EpisodeEnd::cancelled;
  if (settings_.wall_clock_guard && wall_seconds() - began_ > *settings_.wall_clock_guard)
    return EpisodeEnd::time;
  return std::nullopt;
}

EpisodeResult Explorer::run(const Viewpoint& start) {
  result_.surface = static_cast<double>(truth_.size());
  result_.end = EpisodeEnd::steps;
  began_ = wall_seconds();
  const double first = began_;
  double last = began_;
  begin(start);
  for (step_ = 0; step_ < settings_.steps; ++step_) {
    if (const auto end = stopped()) {
      result_.end = *end;
      break;
    }
    if (settings_.progress)
      settings_.progress->report(share_done(), "view " + std::to_string(step_ + 1) + " of " +
                                                   std::to_string(settings_.steps));
    EpisodeStep taken;
    if (!result_.steps.empty()) {
      taken.length = result_.steps.back().length;
      taken.time = result_.steps.back().time;
    }
    int place = 0;
    if (!choose(taken, place)) break;
    if (before_) unhurried([&] { before_({step_, known_, graph_[place]}); });
    look(taken, place);
    std::vector<Viewpoint> reachable;
    ++step_;  // new views are scored for the map as it is now
    add_neighbours(place, reachable);
    --step_;
    taken.scored = scored_;
    scored_ = 0;
    const double now = wall_seconds() - (began_ - first);
    taken.seconds = now - last;
    last = now;
    result_.steps.push_back(std::move(taken));
    if (observer_) unhurried([&] { observer_({step_, known_, reachable, result_.steps.back()}); });
  }
  if (settings_.list_candidates && result_.end != EpisodeEnd::cancelled &&
      result_.end != EpisodeEnd::time)
    list_what_is_left();
  return std::move(result_);
}

// What could be gone to, all for the last map, in the order in which it became known.
void Explorer::list_what_is_left() {
  const std::vector<bool> reached = graph_.reached_from(at_);
  std::vector<Viewpoint> views;
  for (int place = 0; place < graph_.size(); ++place) {
    const auto at = static_cast<std::size_t>(place);
    if (visits_[at] < settings_.visits && reached[at] && graph_.free(graph_[place], graph_[place]))
      views.push_back(graph_[place]);
  }
  std::vector<double> values(views.size());
  for (std::size_t k = 0; k < views.size(); k += kListed) {
    if (stopped()) return;  // what was flown is whole, and ended as it did
    const std::size_t count = std::min(kListed, views.size() - k);
    value_of(std::span(views).subspan(k, count), std::span(values).subspan(k, count));
  }
  for (std::size_t k = 0; k < views.size(); ++k)
    result_.candidates.push_back({views[k], values[k]});
}

}  // namespace

EpisodeResult explore(const EpisodeSettings& settings, const Viewpoint& start,
                      const GroundTruth& truth, ObservedSurface& observed,
                      const ViewUtility& utility, Map& map, const EpisodeObserver& observer,
                      const ChoiceObserver& before) {
  require_sense(settings, map);
  map.set_threads(settings.threads);
  Explorer explorer(settings, truth, observed, utility, map, observer, before);
  return explorer.run(start);
}

}  // namespace lapwing
