// SPDX-License-Identifier: Apache-2.0
#include "framework/view/passes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "framework/core/error.h"

namespace lapwing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kOff = 1e-6;          // m, of a view from the line of its pass
constexpr double kGimbalShare = 0.9;   // of its rates, between two passes
constexpr double kGimbalSlack = 1e-9;  // rad, of rounding at the ends of its range
constexpr double kLookAt = 0.125;      // radians of a turn, between places that are looked at
constexpr double kEvery = 0.5;         // s, between places of a flight

CoursePoint ahead_by(const CoursePoint& p, double metres) {
  return {p.x + metres * std::cos(p.course), p.y + metres * std::sin(p.course), p.course};
}

// Of the camera's angle to the course, the one within the range that is nearest to 0.
std::optional<double> within(double angle, double least, double most) {
  std::optional<double> best;
  for (const int turns : {0, -1, 1}) {
    const double a = std::remainder(angle, 2 * std::numbers::pi) + 2 * std::numbers::pi * turns;
    if (a < least - kGimbalSlack || a > most + kGimbalSlack) continue;
    if (!best || std::abs(a) < std::abs(*best)) best = std::clamp(a, least, most);
  }
  return best;
}

// What the views of each pass show together, a voxel's sum at most its capacity.
ViewScore score_of_passes(const ViewScore& views, const std::vector<std::vector<int>>& passes) {
  std::vector<double> weights;
  for (const auto capacity : views.capacities()) weights.push_back(capacity * views.unit());
  ViewScoreBuilder builder(views.voxels(), weights);
  for (const std::vector<int>& pass : passes) {
    std::map<std::uint32_t, double> sums;
    for (const int view : pass)
      for (std::size_t k = 0; k < views.voxels_of(view).size(); ++k)
        sums[views.voxels_of(view)[k]] += views.amounts_of(view)[k] * views.unit();
    std::vector<ViewScore::Contribution> contributions;
    for (const auto& [voxel, amount] : sums)
      contributions.push_back({voxel, static_cast<float>(std::min(amount, weights[voxel]))});
    builder.add_view(contributions);
  }
  return std::move(builder).take();
}

}  // namespace

PassProblem::PassProblem(std::vector<Viewpoint> views, std::vector<std::vector<int>> passes,
                         std::vector<double> courses, const ViewScore& score,
                         const PassSettings& settings)
    : views_(std::move(views)), passes_(std::move(passes)), settings_(settings) {
  if (!(settings.speed > 0 && settings.radius > 0 && settings.climb > 0 && settings.lead >= 0))
    throw InputError("passes: speed, turn radius and climb must be above 0, the lead at least 0");
  if (settings.allowed.isEmpty()) throw InputError("passes: the air that is allowed is empty");
  if (courses.size() != passes_.size()) throw Error("passes: a course for each pass");
  for (std::size_t p = 0; p < passes_.size(); ++p) {
    const std::vector<int>& pass = passes_[p];
    if (pass.empty()) throw InputError("passes: a pass without a view");
    const Viewpoint& first = views_.at(static_cast<std::size_t>(pass.front()));
    const Eigen::Vector3d along(std::cos(courses[p]), std::sin(courses[p]), 0);
    double before = -kOff;
    for (const int v : pass) {
      const Viewpoint& view = views_.at(static_cast<std::size_t>(v));
      const Eigen::Vector3d step = view.position - first.position;
      const double at = step.dot(along);
      if ((step - at * along).norm() > kOff || at <= before || view.yaw != first.yaw ||
          view.pitch != first.pitch)
        throw InputError("passes: the views of pass " + std::to_string(p + 1) +
                         " are not in order along a level line, with one direction of view");
      before = at + kOff;
    }
    lengths_.push_back(
        (views_[static_cast<std::size_t>(pass.back())].position - first.position).norm());
    for (const bool back : {false, true})
      ends_.push_back(ends_of(static_cast<int>(p), back, courses[p]));
  }
  score_ = std::make_unique<ViewScore>(score_of_passes(score, passes_));
  legs_.assign(ends_.size() * ends_.size(), std::numeric_limits<double>::quiet_NaN());
}

std::optional<PassProblem::Ends> PassProblem::ends_of(int pass, bool back, double course) const {
  const std::vector<int>& numbers = passes_[static_cast<std::size_t>(pass)];
  const Viewpoint& first =
      views_[static_cast<std::size_t>(back ? numbers.back() : numbers.front())];
  const Viewpoint& last = views_[static_cast<std::size_t>(back ? numbers.front() : numbers.back())];
  if (back) course += std::numbers::pi;
  const auto yaw = within(first.yaw - course, settings_.gimbal.yaw_min, settings_.gimbal.yaw_max);
  if (!yaw || first.pitch < settings_.gimbal.pitch_min - kGimbalSlack ||
      first.pitch > settings_.gimbal.pitch_max + kGimbalSlack)
    return std::nullopt;
  Ends ends{{first.position.x(), first.position.y(), course},
            {last.position.x(), last.position.y(), course},
            first.position.z(),
            *yaw,
            first.pitch};
  for (const CoursePoint& p :
       {ahead_by(ends.first, -settings_.lead), ahead_by(ends.last, settings_.lead)})
    if (!settings_.allowed.contains(Eigen::Vector3d(p.x, p.y, ends.height))) return std::nullopt;
  return ends;
}

DubinsWay PassProblem::turn(const Ends& a, const Ends& b) const {
  return shortest_dubins_way(ahead_by(a.last, settings_.lead), ahead_by(b.first, -settings_.lead),
                             settings_.radius);
}

double PassProblem::leg_of(const Ends& a, const Ends& b) const {
  const DubinsWay way = turn(a, b);
  const double length = way.length(), every = kLookAt * settings_.radius;
  for (double along = 0; along < length; along += every) {
    const CoursePoint p = way.at(along);
    if (!settings_.allowed.contains(Eigen::Vector3d(p.x, p.y, a.height))) return kInfinity;
  }
  const double seconds = (length + 2 * settings_.lead) / settings_.speed;
  const PassGimbal& gimbal = settings_.gimbal;
  const double yaw = std::abs(b.gimbal_yaw - a.gimbal_yaw);
  const double pitch = std::abs(b.gimbal_pitch - a.gimbal_pitch);
  // Of the turn alone: the leads hold the camera still.
  const double turning = kGimbalShare * length / settings_.speed;
  if (yaw > turning * gimbal.yaw_rate || pitch > turning * gimbal.pitch_rate) return kInfinity;
  if (std::abs(b.height - a.height) > turning * settings_.climb) return kInfinity;
  return seconds;
}

double PassProblem::leg(DirectedPass a, DirectedPass b) const {
  const auto from = static_cast<std::size_t>(a), to = static_cast<std::size_t>(b);
  if (!ends_[from] || !ends_[to]) return kInfinity;
  double& known = legs_[from * ends_.size() + to];
  if (std::isnan(known)) known = leg_of(*ends_[from], *ends_[to]);
  return known;
}

double PassProblem::seconds_of(std::span<const DirectedPass> order) const {
  if (order.empty()) return 0;
  double sum = 2 * settings_.lead / settings_.speed;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (!possible(order[i])) return kInfinity;
    sum += seconds(order[i] / 2);
    if (i > 0) sum += leg(order[i - 1], order[i]);
  }
  return sum;
}

PassFlight PassProblem::flight_of(std::span<const DirectedPass> order) const {
  PassFlight flight;
  double clock = 0, turned = 0;
  // Places along a way at one speed; heights change evenly from one end to the other.
  const auto go = [&](const DubinsWay& way, double length, double from, double to) {
    const int steps = std::max(1, static_cast<int>(std::ceil(length / settings_.speed / kEvery)));
    for (int k = flight.times.empty() ? 0 : 1; k <= steps; ++k) {
      const double share = static_cast<double>(k) / steps;
      const CoursePoint p = way.at(share * length);
      flight.times.push_back(clock + share * length / settings_.speed);
      flight.positions.emplace_back(p.x, p.y, from + share * (to - from));
      const double before = flight.courses.empty() ? p.course : flight.courses.back();
      turned = p.course +
               2 * std::numbers::pi * std::round((before - p.course) / (2 * std::numbers::pi));
      flight.courses.push_back(turned);
    }
    clock += length / settings_.speed;
  };
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Ends& here = *ends_[static_cast<std::size_t>(order[i])];
    const double length = lengths_[static_cast<std::size_t>(order[i] / 2)];
    if (i > 0) {
      const Ends& before = *ends_[static_cast<std::size_t>(order[i - 1])];
      const DubinsWay way = turn(before, here);
      go(way, way.length(), before.height, here.height);
    }
    const double begins = clock + settings_.lead / settings_.speed;
    const std::vector<int>& views = passes_[static_cast<std::size_t>(order[i] / 2)];
    const auto shoot = [&](int v) {
      const Eigen::Vector3d& at = views_[static_cast<std::size_t>(v)].position;
      const double along = std::hypot(at.x() - here.first.x, at.y() - here.first.y);
      flight.shots.push_back({v, begins + along / settings_.speed});
    };
    if (order[i] % 2 == 0)
      std::for_each(views.begin(), views.end(), shoot);
    else
      std::for_each(views.rbegin(), views.rend(), shoot);
    flight.holds.push_back(
        {begins, begins + length / settings_.speed, here.gimbal_yaw, here.gimbal_pitch});
    go({ahead_by(here.first, -settings_.lead), {}}, length + 2 * settings_.lead, here.height,
       here.height);
  }
  return flight;
}

}  // namespace lapwing
