// SPDX-License-Identifier: Apache-2.0
#include "framework/export/mission_items.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/core/units.h"
#include "framework/export/mission_fences.h"
#include "framework/export/take_off_place.h"
#include "framework/export/waypoint_timing.h"

namespace lapwing {
namespace {

constexpr std::size_t kMostPx4 = 2000, kMostArduPilot = 700;  // items, of a file
constexpr std::size_t kFrame = 8;  // items around the waypoints: take-off, video, landing ...
constexpr double kColumn = 0.25;   // m, between places of a climb that are tried
constexpr double kSameAngle = 0.0035, kSameSpeed = 0.01;  // rad, m/s: not ordered again

double heading_deg(double yaw) {
  const double heading = std::fmod(90 - degrees(yaw), 360);
  return heading < 0 ? heading + 360 : heading;
}

// In (-180, 180], clockwise.
double turn_deg(double angle) {
  return -degrees(std::remainder(angle, 2 * M_PI));
}

double rounded(double value, double scale) {
  return std::round(value * scale) / scale + 0.0;
}

MissionItem order(int command, std::array<double, 7> params) {
  return {command, mav::kNoPlace, params};
}

class Builder {
 public:
  Builder(const Plan& plan, const MissionFileOptions& options, const std::string& format)
      : plan_(plan),
        options_(options),
        format_(format),
        frame_(plan, std::nullopt, format),
        vehicle_(vehicle_from_value(plan.vehicle)),
        waypoints_(fewest_waypoints(plan, options.tolerance, format)) {
    mission_.home_z = take_off_z(plan, options.home_z);
    if (options.ardupilot)  // it holds whole seconds
      for (PlannedWaypoint& w : waypoints_) w.hold = std::ceil(w.hold - 1e-6);
    time_waypoints(waypoints_, vehicle_, options.tolerance.across);
  }

  PlannedMission build() {
    const auto [first, last] = chosen_part();
    const PlannedWaypoint& begin = waypoints_[first];
    home_ = take_off_place(plan_, options_.home_z, begin.position);
    mission_.home = frame_.at(home_);
    mission_.start = begin.time;
    mission_.finish = waypoints_[last].time;
    mission_.waypoints = last - first + 1;
    check_heights(first, last);
    add_start(first, last);
    for (std::size_t k = first; k <= last; ++k) add_waypoint(k, k == first);
    add_end(last);
    for (std::size_t k = first; k <= last; ++k)
      mission_.cruise = std::max(mission_.cruise, waypoints_[k].speed);
    mission_.fences = mission_fences(plan_, mission_.said);
    if (plan_.home)
      for (const Eigen::Vector3d& point : plan_.home->rally_points) {
        const auto p = at(point, {});
        mission_.rally_points.push_back({p[4], p[5], p[6]});
      }
    say(first, last);
    return std::move(mission_);
  }

 private:
  // Items that a waypoint takes at most.
  std::size_t items_of(std::size_t k) const {
    return 1 + 2 + (plan_.trajectory.has_gimbal ? 1 : 0) + (options_.ardupilot ? 1 : 0) +
           (waypoints_[k].photograph ? 1 : 0);
  }

  // First and last waypoint of the part that was asked for.
  std::pair<std::size_t, std::size_t> chosen_part() {
    const std::size_t most = options_.ardupilot ? kMostArduPilot : kMostPx4;
    std::vector<std::size_t> ends{0};
    std::size_t items = kFrame, all = kFrame;
    for (std::size_t k = 1; k < waypoints_.size(); ++k) {
      items += items_of(k);
      all += items_of(k);
      if (items > most) {
        ends.push_back(k - 1);
        items = kFrame + items_of(k);
      }
    }
    ends.push_back(waypoints_.size() - 1);
    const int parts = static_cast<int>(ends.size()) - 1;
    if (options_.part == 0 && parts > 1)
      throw InputError(format_ + ": up to " + std::to_string(all) + " items, and " +
                       (options_.ardupilot ? "ArduPilot" : "PX4") + " holds " +
                       std::to_string(most) + ": a larger `tolerance`, or " +
                       std::to_string(parts) + " files: part=1 to part=" + std::to_string(parts));
    if (options_.part > parts)
      throw InputError(format_ + ": part=" + std::to_string(options_.part) + ", and the plan has " +
                       std::to_string(parts) + " parts");
    mission_.parts = parts;
    mission_.part = std::max(1, options_.part);
    const auto place = static_cast<std::size_t>(mission_.part);
    return {ends[place - 1], ends[place]};
  }

  std::array<double, 7> at(const Eigen::Vector3d& p, std::array<double, 4> first) const {
    const EarthPoint point = frame_.at(p);
    return {first[0],
            first[1],
            first[2],
            first[3],
            rounded(point.latitude_deg, 1e7),
            rounded(point.longitude_deg, 1e7),
            rounded(point.height - mission_.home.height, 1e3)};
  }

  void add(MissionItem item) { mission_.items.push_back(item); }

  void add_start(std::size_t first, std::size_t last) {
    const PlannedWaypoint& w = waypoints_[first];
    if (options_.take_off) {
      const Eigen::Vector3d above{home_.x(), home_.y(), w.position.z()};
      check_column(above, "take-off", "`take_off=false`", w.time);
      check_way_to(w.position, above, w.time);
      add({mav::kTakeOff, mav::kRelative, at(above, {0, 0, 0, rounded(yaw_of(first), 100)})});
    }
    if (!plan_.trajectory.has_gimbal) return;
    if (options_.gimbal == mav::kGimbal) add(order(mav::kGimbalOwner, {-2, -2, -1, -1, 0, 0, 0}));
    order_camera(std::min(first + 1, last));
    if (!plan_.task.scan) add(order(mav::kVideoStart, {0, 0, 0, 0, 0, 0, 0}));
  }

  // Clockwise from north, of the line that ends at a waypoint; of the first, that of the next one.
  double yaw_of(std::size_t k) const { return heading_deg(waypoints_[k].yaw); }

  void add_waypoint(std::size_t k, bool first) {
    const PlannedWaypoint& w = waypoints_[k];
    if (!first) order_line(k);
    // A rest is the same place again, with a time to hold: it turns the vehicle too.
    add({mav::kWaypoint, mav::kRelative,
         at(w.position, {rounded(first ? 0 : w.hold, 100), rounded(w.radius, 1000), 0,
                         rounded(yaw_of(k), 100)})});
    if (w.photograph) add(order(mav::kPhotograph, {0, 0, 1, ++photographs_, 0, 0, 0}));
  }

  // What holds for the line to a waypoint, ordered at the one before.
  void order_line(std::size_t k) {
    const PlannedWaypoint& w = waypoints_[k];
    if (!w.rests() && std::abs(w.speed - speed_) > std::max(kSameSpeed, 0.02 * speed_)) {
      add(order(mav::kChangeSpeed, {1, rounded(w.speed, 1000), -1, 0, 0, 0, 0}));
      speed_ = w.speed;
    }
    if (options_.ardupilot && std::abs(std::remainder(w.yaw - heading_, 2 * M_PI)) > kSameAngle) {
      add(order(mav::kConditionYaw, {rounded(yaw_of(k), 100), 0, 0, 0, 0, 0, 0}));
      heading_ = w.yaw;
    }
    if (plan_.trajectory.has_gimbal) order_camera(k);
  }

  void order_camera(std::size_t k) {
    const PlannedWaypoint& w = waypoints_[k];
    if (w.subject >= 0) {
      if (w.subject == subject_) return;
      subject_ = w.subject;
      const Subject& subject = plan_.environment.subjects[static_cast<std::size_t>(subject_)];
      add({mav::kRoi, mav::kRelative, at(subject.positions.front(), {0, 0, 0, 0})});
      return;
    }
    if (subject_ >= 0) add(order(mav::kRoiNone, {0, 0, 0, 0, 0, 0, 0}));
    const bool known = subject_ < 0 && ordered_;
    subject_ = -1;
    const bool turns = turns_to_the_side();
    const double yaw = options_.gimbal == mav::kGimbal ? w.camera_yaw : w.camera_yaw - w.yaw;
    if (known && std::abs(w.camera_pitch - pitch_) < kSameAngle &&
        (!turns || std::abs(std::remainder(yaw - yaw_, 2 * M_PI)) < kSameAngle))
      return;
    ordered_ = true;
    pitch_ = w.camera_pitch;
    yaw_ = yaw;
    const double pitch = rounded(degrees(pitch_), 100);
    const double side =
        turns ? rounded(turn_deg(yaw_ - (options_.gimbal == mav::kGimbal ? M_PI / 2 : 0)), 100) : 0;
    if (options_.gimbal == mav::kGimbal)  // roll and pitch locked to the horizon, yaw to north
      add(order(mav::kGimbal, {pitch, side, 0, 0, turns ? 28.0 : 12.0, 0, 0}));
    else
      add(order(mav::kMountControl, {pitch, 0, side, 0, 0, 0, 2}));
  }

  bool turns_to_the_side() const {
    return vehicle_.gimbal && vehicle_.gimbal->yaw_max > vehicle_.gimbal->yaw_min;
  }

  void add_end(std::size_t last) {
    const PlannedWaypoint& w = waypoints_[last];
    if (plan_.trajectory.has_gimbal) {
      if (!plan_.task.scan) add(order(mav::kVideoStop, {0, 0, 0, 0, 0, 0, 0}));
      if (subject_ >= 0) add(order(mav::kRoiNone, {0, 0, 0, 0, 0, 0, 0}));
    }
    if (options_.finish == "return") add(order(mav::kReturn, {0, 0, 0, 0, 0, 0, 0}));
    if (options_.finish != "land") return;
    check_column(w.position, "landing", "`finish=return` or `finish=hover`", w.time);
    add({mav::kLand, mav::kRelative,
         at({w.position.x(), w.position.y(), mission_.home_z},
            {0, 0, 0, rounded(yaw_of(last), 100)})});
    mission_.items.back().params[6] = 0;
  }

  // A take-off climbs, a landing descends, and no waypoint lies in the ground where the origin
  // tells where that is.
  void check_heights(std::size_t first, std::size_t last) {
    const double begin = above_home(first), end = above_home(last);
    if (options_.take_off && begin <= 0)
      throw InputError(format_ + ": take-off: the first waypoint (z = " + z_of(first) + ") is " +
                       plain_number(0 - begin, 4) +
                       " m below the take-off place (z = " + plain_number(mission_.home_z, 4) +
                       " m); expected one above it: a lower `home_z`, or `take_off=false`");
    if (options_.finish == "land" && end < 0)
      throw InputError(format_ + ": landing: the last waypoint (z = " + z_of(last) + ") is " +
                       plain_number(0 - end, 4) +
                       " m below the landing place (z = " + plain_number(mission_.home_z, 4) +
                       " m); expected one above it: a lower `home_z`, `finish=return` or "
                       "`finish=hover`");
    const std::vector<FilePlace> places = places_of(first, last);
    require_above_ground(places, frame_, format_);
    const std::string below = below_take_off(places, frame_, mission_.home);
    if (!below.empty()) mission_.said.push_back(below);
  }

  std::vector<FilePlace> places_of(std::size_t first, std::size_t last) const {
    std::vector<FilePlace> places;
    for (std::size_t k = first; k <= last; ++k)
      places.push_back({waypoints_[k].time, waypoints_[k].position});
    return places;
  }

  double above_home(std::size_t k) const {
    return height_above(mission_.home, frame_, waypoints_[k].position);
  }

  std::string z_of(std::size_t k) const {
    return plain_number(waypoints_[k].position.z(), 4) + " m";
  }

  // The way up or down, as far as shapes are open, to the margin above the take-off place.
  void check_column(const Eigen::Vector3d& top, const char* what, const char* help,
                    double time) const {
    const double margin = plan_.environment.margin;
    for (double z = top.z() - kColumn; z > mission_.home_z + margin + kColumn; z -= kColumn) {
      const NearestObstacle nearest =
          nearest_obstacle(plan_.environment, {top.x(), top.y(), z}, time);
      if (nearest.distance < margin - 1e-3)
        throw InputError(format_ + ": " + what +
                         ": straight up from or down to z = " + plain_number(mission_.home_z) +
                         " m, the way comes within " + plain_number(nearest.distance, 3) +
                         " m of '" + nearest.name + "' (at z = " + plain_number(z, 3) + " m); " +
                         help + " leaves it to the pilot");
    }
  }

  // The level way from above the plan's home to the first waypoint, as far as shapes are open.
  void check_way_to(const Eigen::Vector3d& first, const Eigen::Vector3d& above, double time) const {
    const double margin = plan_.environment.margin, length = (first - above).norm();
    const auto refuse = [&](const NearestObstacle& nearest) {
      throw InputError(format_ + ": take-off: the level way from above the take-off place to the " +
                       "first waypoint comes within " + plain_number(nearest.distance, 3) +
                       " m of '" + nearest.name + "', and " + plain_number(margin, 3) +
                       " m are kept; expected another `home`, or `take_off=false`, which leaves "
                       "the way to the pilot");
    };
    for (double s = 0; s < length; s += kColumn) {
      const Eigen::Vector3d p = above + s / length * (first - above);
      const NearestObstacle outside = nearest_obstacle(plan_.environment, p, time);
      if (outside.distance < margin - 1e-3) refuse(outside);
      const NearestObstacle inside = least_inside(plan_.environment, p, time);
      if (inside.distance < margin - 1e-3) refuse(inside);
    }
  }

  void say(std::size_t first, std::size_t last) {
    std::vector<EarthPoint> points;
    for (std::size_t k = first; k <= last; ++k) points.push_back(frame_.at(waypoints_[k].position));
    std::vector<std::string> said{frame_.sentence(points)};
    said.push_back(sentence_of_heights(mission_.items, mission_.home_z));
    std::string count = std::to_string(mission_.waypoints) + " waypoints, " +
                        std::to_string(mission_.items.size()) + " items for " +
                        (options_.ardupilot ? "ArduPilot" : "PX4");
    if (mission_.parts > 1)
      count += "; part " + std::to_string(mission_.part) + " of " + std::to_string(mission_.parts) +
               ", " + plain_number(mission_.start, 5) + " s to " +
               plain_number(mission_.finish, 5) + " s of the plan";
    said.push_back(count);
    if (!plan_.lights.empty())
      said.emplace_back("the light is not in the file: nothing switches it");
    if (!plan_.cuts.empty()) said.emplace_back("cuts are not marked: the video runs on");
    said.emplace_back("take-off and landing are not compared with the plan, which has none");
    mission_.said.insert(mission_.said.begin(), said.begin(), said.end());
  }

  const Plan& plan_;
  const MissionFileOptions& options_;
  const std::string& format_;
  EarthFrame frame_;
  Vehicle vehicle_;
  std::vector<PlannedWaypoint> waypoints_;
  PlannedMission mission_;
  Eigen::Vector3d home_ = Eigen::Vector3d::Zero();
  double speed_ = 0, heading_ = 0, pitch_ = 0, yaw_ = 0, photographs_ = 0;
  int subject_ = -1;
  bool ordered_ = false;
};

}  // namespace

ParameterTable mission_parameters() {
  return ParameterTable{}
      .number("tolerance", 0.25, "m", "largest distance of the lines from the path",
              between(0.05, 10))
      .number("time_tolerance", 1, "s", "largest difference in time on a line at constant speed",
              between(0.05, 1000))
      .number("angle_tolerance", 5, "deg", "largest error of camera or heading on a line",
              between(0.5, 180))
      .choice("autopilot", "px4", {"px4", "ardupilot"},
              "autopilot for which the commands are written")
      .integer("gimbal", 1000, "command that turns the gimbal: 1000, or 205 for older autopilots",
               between(205, 1000))
      .optional_number("home_z", "m", kHomeParameter)
      .boolean("take_off", true, "whether the mission begins with a take-off")
      .choice("finish", "land", {"land", "return", "hover"}, "action after the last waypoint")
      .integer("part", 0, "part of a plan that is too long for one file; 0: it must fit",
               between(0, 1000));
}

MissionFileOptions mission_file_options(const Parameters& given) {
  MissionFileOptions options;
  options.tolerance = {given.number("tolerance"), given.number("time_tolerance"),
                       radians(given.number("angle_tolerance"))};
  options.ardupilot = given.text("autopilot") == "ardupilot";
  options.gimbal = static_cast<int>(given.integer("gimbal"));
  if (options.gimbal != mav::kGimbal && options.gimbal != mav::kMountControl)
    throw InputError(given.origin("gimbal"), "gimbal: expected 1000 or 205");
  if (given.has("home_z")) options.home_z = given.number("home_z");
  options.take_off = given.boolean("take_off");
  options.finish = given.text("finish");
  options.part = static_cast<int>(given.integer("part"));
  return options;
}

std::optional<double> home_above_sea(const EarthFrame& frame, const EarthPoint& home,
                                     std::vector<std::string>* said) {
  if (frame.heights() == HeightOf::sea) return home.height;
  if (frame.heights() == HeightOf::ellipsoid) {
    try {
      return home.height - geoid_height_at(home.latitude_deg, home.longitude_deg, "home");
    } catch (const InputError&) {  // said below: nothing in the flight depends on it
    }
  }
  if (said)
    said->push_back(
        "the height of the take-off place above the sea is not known, and is written "
        "as 0; heights of waypoints do not depend on it");
  return std::nullopt;
}

PlannedMission mission_of(const Plan& plan, const MissionFileOptions& options,
                          const std::string& format) {
  return Builder(plan, options, format).build();
}

std::string sentence_of_heights(const std::vector<MissionItem>& items, double home_z) {
  double lowest = INFINITY, highest = -INFINITY;
  for (const MissionItem& item : items)
    if (item.command == mav::kWaypoint && item.frame == mav::kRelative) {
      lowest = std::min(lowest, item.params[6]);
      highest = std::max(highest, item.params[6]);
    }
  return "heights in the file are above the take-off place, which is at z = " +
         plain_number(home_z) + " m of the plan: from " + plain_number(lowest, 4) + " m to " +
         plain_number(highest, 4) + " m";
}

}  // namespace lapwing
