// SPDX-License-Identifier: Apache-2.0
#include "framework/view/pattern_tour.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <optional>
#include <string_view>

#include "framework/core/error.h"

namespace lapwing {
namespace {

constexpr double kRadian = std::numbers::pi / 180;
constexpr double kLowestRing = 10 * kRadian, kHighestRing = 80 * kRadian;

Viewpoint looking_at(const Eigen::Vector3d& position, const Eigen::Vector3d& target) {
  const Eigen::Vector3d d = target - position;
  return {position, std::atan2(d.y(), d.x()), std::atan2(d.z(), d.head<2>().norm())};
}

void add_ellipse(const Pattern& p, const Eigen::Vector3d& floor, const Eigen::Vector3d& middle,
                 std::vector<Viewpoint>& views) {
  for (int i = 0; i < p.views; ++i) {
    const double angle = 2 * std::numbers::pi * i / p.views;
    const Eigen::Vector3d offset(p.along_x * std::cos(angle), p.along_y * std::sin(angle),
                                 p.height);
    views.push_back(looking_at(floor + offset, middle));
  }
}

// As many lines as make views as far apart along a line as lines are from each other.
void add_meander(const Pattern& p, const Eigen::Vector3d& floor, std::vector<Viewpoint>& views) {
  const double share = std::sqrt(p.views * p.along_x / p.along_y);
  const int lines = std::clamp(static_cast<int>(std::lround(share)), 1, p.views);
  const int in_line = (p.views + lines - 1) / lines;
  const auto place = [](double edge, int i, int count) {
    return count > 1 ? edge * (static_cast<double>(i) / (count - 1) - 0.5) : 0.0;
  };
  for (int line = 0; line < lines; ++line) {
    for (int k = 0; k < in_line; ++k) {
      const int along = line % 2 ? in_line - 1 - k : k;
      const Eigen::Vector3d offset(place(p.along_x, line, lines), place(p.along_y, along, in_line),
                                   p.height);
      views.push_back({floor + offset, 0, -std::numbers::pi / 2});
    }
  }
}

// Rings at equal steps of elevation, each with views in the measure of its length.
void add_hemisphere(const Pattern& p, const Eigen::Vector3d& floor, const Eigen::Vector3d& middle,
                    std::vector<Viewpoint>& views) {
  const int rings = std::max(1, static_cast<int>(std::lround(std::sqrt(p.views / 5.0))));
  std::vector<double> elevations;
  double length = 0;
  for (int ring = 0; ring < rings; ++ring) {
    const double share = rings > 1 ? static_cast<double>(ring) / (rings - 1) : 0.5;
    elevations.push_back(kLowestRing + share * (kHighestRing - kLowestRing));
    length += std::cos(elevations.back());
  }
  double passed = 0;
  int placed = 0;
  for (const double elevation : elevations) {
    passed += std::cos(elevation);
    const int count = static_cast<int>(std::lround(p.views * passed / length)) - placed;
    placed += count;
    for (int i = 0; i < count; ++i) {
      const double angle = 2 * std::numbers::pi * i / count;
      const Eigen::Vector3d offset(p.along_x * std::cos(elevation) * std::cos(angle),
                                   p.along_y * std::cos(elevation) * std::sin(angle),
                                   p.along_x * std::sin(elevation));
      views.push_back(looking_at(floor + offset, middle));
    }
  }
}

}  // namespace

const char* to_string(PatternKind kind) {
  switch (kind) {
    case PatternKind::circle:
      return "circle";
    case PatternKind::ellipse:
      return "ellipse";
    case PatternKind::meander:
      return "meander";
    case PatternKind::hemisphere:
      break;
  }
  return "hemisphere";
}

namespace {

constexpr PatternKind kKinds[] = {PatternKind::circle, PatternKind::ellipse, PatternKind::meander,
                                  PatternKind::hemisphere};
constexpr int kMostViews = 10'000;
constexpr const char* kViewsKey = ":views=";

// As the thesis has them (4.5.4).
int usual_views(PatternKind kind) {
  if (kind == PatternKind::circle) return 120;
  return kind == PatternKind::meander ? 144 : 160;
}

bool has_one_size(PatternKind kind) {
  return kind == PatternKind::circle || kind == PatternKind::hemisphere;
}

std::optional<PatternKind> kind_named(const std::string& name) {
  for (const PatternKind kind : kKinds)
    if (name == to_string(kind)) return kind;
  return std::nullopt;
}

// The whole text as a number; nothing where it is none.
template <class Number>
std::optional<Number> number_in(std::string_view text) {
  Number number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace

std::string name_of(const Pattern& pattern) {
  char text[80];
  if (has_one_size(pattern.kind)) {
    std::snprintf(text, sizeof text, "%s_%g", to_string(pattern.kind), pattern.along_x);
  } else {
    std::snprintf(text, sizeof text, "%s_%gx%g", to_string(pattern.kind), pattern.along_x,
                  pattern.along_y);
  }
  if (pattern.views == usual_views(pattern.kind)) return text;
  return text + (kViewsKey + std::to_string(pattern.views));
}

Pattern pattern_named(const std::string& name, double height) {
  const auto refuse = [&] {
    throw InputError("no pattern '" + name +
                     "'; patterns are circle_RADIUS, hemisphere_RADIUS, ellipse_AxB and "
                     "meander_AxB, in metres, each with `:views=N` for another number of views");
  };
  const std::string_view all = name;
  const std::size_t bar = all.find('_'), colon = std::min(all.find(':'), all.size());
  const auto kind = kind_named(name.substr(0, bar));
  if (!kind || bar == all.npos || colon < bar) refuse();
  Pattern pattern{.kind = *kind, .views = usual_views(*kind), .height = height};
  const auto size_in = [&](std::string_view text) {
    const auto size = number_in<double>(text);
    if (!size || !(*size > 0) || *size > 1e4) refuse();
    return *size;
  };
  const std::string_view sizes = all.substr(bar + 1, colon - bar - 1);
  const std::size_t cross = sizes.find('x');
  if (has_one_size(*kind) == (cross != sizes.npos)) refuse();
  pattern.along_x = pattern.along_y = size_in(sizes.substr(0, cross));
  if (cross != sizes.npos) pattern.along_y = size_in(sizes.substr(cross + 1));
  if (colon == all.size()) return pattern;
  if (!all.substr(colon).starts_with(kViewsKey)) refuse();
  const auto views = number_in<int>(all.substr(colon + std::strlen(kViewsKey)));
  if (!views || *views < 1 || *views > kMostViews) refuse();
  pattern.views = *views;
  return pattern;
}

std::vector<Viewpoint> pattern_viewpoints(const Pattern& pattern,
                                          const Eigen::AlignedBox3d& region) {
  if (region.isEmpty()) throw InputError("pattern: the region is empty");
  if (pattern.views < 1) throw InputError("pattern: views must be at least 1");
  if (!(pattern.along_x > 0 && pattern.along_y > 0 && std::isfinite(pattern.along_x) &&
        std::isfinite(pattern.along_y))) {
    throw InputError("pattern: sizes must be above 0 m");
  }
  const Eigen::Vector3d middle = region.center();
  const Eigen::Vector3d floor(middle.x(), middle.y(), region.min().z());
  std::vector<Viewpoint> views;
  switch (pattern.kind) {
    case PatternKind::circle:
    case PatternKind::ellipse:
      add_ellipse(pattern, floor, middle, views);
      break;
    case PatternKind::meander:
      add_meander(pattern, floor, views);
      break;
    case PatternKind::hemisphere:
      add_hemisphere(pattern, floor, middle, views);
      break;
  }
  return views;
}

namespace {

class Laying {
 public:
  Laying(const TourProblem& problem, const std::vector<Viewpoint>& viewpoints,
         double metres_per_radian)
      : problem_(problem),
        viewpoints_(viewpoints),
        weight_(metres_per_radian),
        reachable_(problem.reachable()) {}

  // The views that a pattern takes, each once in a row; `moved` is how far off they are on average.
  std::vector<int> lay(const std::vector<Viewpoint>& pattern, double& moved) const {
    std::vector<int> views;
    moved = 0;
    for (const Viewpoint& wanted : pattern) {
      const int view = nearest(wanted);
      if (view < 0) continue;
      moved += (viewpoints_[view].position - wanted.position).norm() /
               static_cast<double>(pattern.size());
      if (views.empty() || views.back() != view) views.push_back(view);
    }
    return views;
  }

  // `stops` by shortest ways; empty where there is none.
  std::vector<int> walk_through(const std::vector<int>& stops) const {
    std::vector<int> walk{problem_.start()};
    for (const int stop : stops) problem_.append_way(walk.back(), stop, walk);
    problem_.append_way(walk.back(), problem_.end(), walk);
    return walk;
  }

 private:
  int nearest(const Viewpoint& wanted) const {
    int best = -1;
    double least = std::numeric_limits<double>::infinity();
    for (const int view : reachable_) {
      const Viewpoint& v = viewpoints_[view];
      const double apart =
          (v.position - wanted.position).norm() + weight_ * angle_between(v, wanted);
      if (apart >= least) continue;
      least = apart;
      best = view;
    }
    return best;
  }

  const TourProblem& problem_;
  const std::vector<Viewpoint>& viewpoints_;
  double weight_;
  std::vector<int> reachable_;
};

// `count` of the stops, evenly.
std::vector<int> thinned(const std::vector<int>& stops, int count) {
  std::vector<int> fewer;
  for (int i = 0; i < count; ++i) {
    const std::size_t at = static_cast<std::size_t>(i) * stops.size() / count;
    if (fewer.empty() || fewer.back() != stops[at]) fewer.push_back(stops[at]);
  }
  return fewer;
}

int different(std::vector<int> views) {
  std::sort(views.begin(), views.end());
  return static_cast<int>(std::unique(views.begin(), views.end()) - views.begin());
}

}  // namespace

bool flown_freely(PatternKind kind) {
  return kind != PatternKind::hemisphere;
}

FreePattern fly_freely(const std::vector<Viewpoint>& pattern, double budget,
                       const LegSeconds& leg_seconds) {
  if (pattern.empty()) throw InputError("pattern: it has no viewpoint");
  const auto evenly = [&](std::size_t count) {
    FreePattern flown;
    for (std::size_t i = 0; i < count; ++i)
      flown.views.push_back(pattern[i * pattern.size() / count]);
    for (std::size_t i = 1; i < count; ++i)
      flown.seconds += leg_seconds(flown.views[i - 1], flown.views[i]);
    return flown;
  };
  FreePattern best = evenly(pattern.size());
  const double whole = best.seconds;
  if (whole > budget) {
    best = {};
    std::size_t low = 1, high = pattern.size();  // fits, does not
    while (high - low > 1) {
      const std::size_t middle = (low + high) / 2;
      FreePattern tried = evenly(middle);
      if (tried.seconds > budget) {
        high = middle;
      } else {
        low = middle;
        best = std::move(tried);
      }
    }
  }
  char text[160];
  if (best.views.empty())
    std::snprintf(
        text, sizeof text,
        "fewer than two of the %zu viewpoints of the pattern fit into the budget of %.6g s",
        pattern.size(), budget);
  else if (best.views.size() == pattern.size())
    std::snprintf(text, sizeof text, "the whole pattern, %zu viewpoints", pattern.size());
  else
    std::snprintf(text, sizeof text,
                  "%zu of the %zu viewpoints of the pattern: all take %.6g s of %.6g s",
                  best.views.size(), pattern.size(), whole, budget);
  best.message = text;
  return best;
}

PatternTour fly_pattern(const TourProblem& problem, const std::vector<Viewpoint>& viewpoints,
                        const std::vector<Viewpoint>& pattern, double metres_per_radian) {
  if (static_cast<int>(viewpoints.size()) != problem.views()) {
    throw InputError("pattern: " + std::to_string(problem.views()) + " views need as many places");
  }
  PatternTour tour;
  const std::string hindrance = problem.why_infeasible();
  if (!hindrance.empty()) {
    tour.message = hindrance;
    return tour;
  }
  const Laying laying(problem, viewpoints, metres_per_radian);
  std::vector<int> stops = laying.lay(pattern, tour.moved);
  tour.asked = static_cast<int>(pattern.size());
  if (stops.empty()) {
    tour.message = "the pattern has no viewpoint";
    return tour;
  }
  // From either end, or, where it is closed, from its nearest viewpoint: as is quickest.
  std::vector<std::vector<int>> orders{stops, {stops.rbegin(), stops.rend()}, stops};
  const auto legs = problem.legs_from(problem.start());
  const auto entry = std::min_element(orders[2].begin(), orders[2].end(),
                                      [&](int a, int b) { return legs[a] < legs[b]; });
  std::rotate(orders[2].begin(), entry, orders[2].end());
  for (const std::vector<int>& order : orders) {
    const double seconds = problem.seconds_of(laying.walk_through(order));
    if (seconds >= tour.whole_seconds) continue;
    tour.whole_seconds = seconds;
    stops = order;
  }
  tour.wanted = different(stops);
  const int whole = static_cast<int>(stops.size());
  for (int count = whole; count > 0; --count) {
    const std::vector<int> fewer = count == whole ? stops : thinned(stops, count);
    std::vector<int> walk = laying.walk_through(fewer);
    if (!problem.problem_of(walk).empty()) continue;
    tour.walk = std::move(walk);
    tour.flown = different(fewer);
    break;
  }
  char laid[120], text[240];
  std::snprintf(laid, sizeof laid, "%d viewpoints take %d different candidates, %.3g m off",
                tour.asked, tour.wanted, tour.moved);
  if (tour.walk.empty()) {
    std::snprintf(text, sizeof text, "%s, none of which fits into the budget of %.6g s", laid,
                  problem.budget());
  } else if (tour.flown == tour.wanted) {
    std::snprintf(text, sizeof text, "the whole pattern: %s", laid);
  } else {
    std::snprintf(text, sizeof text, "%s; %d of them: all take %.6g s of %.6g s", laid, tour.flown,
                  tour.whole_seconds, problem.budget());
  }
  tour.message = text;
  return tour;
}

}  // namespace lapwing
