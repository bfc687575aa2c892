// SPDX-License-Identifier: Apache-2.0
// Views that are taken in passing, by a vehicle that cannot stand still: straight passes with
// images along them, and turns between passes.
//
// A pass is flown one way or the other. Its images look the same way in the world either way, so
// that the gimbal turns by half a turn. Passes are joined by the shortest way of a turn radius
// (dubins.h). Before and behind its images a pass goes on straight for `lead` metres, so that the
// bank of a turn is over when the first image is taken.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "framework/view/dubins.h"
#include "framework/view/view_score.h"
#include "framework/view/viewpoint.h"

namespace lapwing {

// Of the camera against the vehicle: yaw from the course, pitch positive up, rad and rad/s.
struct PassGimbal {
  double yaw_min = 0, yaw_max = 0, pitch_min = 0, pitch_max = 0;
  double yaw_rate = 0, pitch_rate = 0;
};

struct PassSettings {
  double speed = 0;             // m/s, of the whole flight
  double radius = 0;            // m, of turns
  double lead = 0;              // m
  double climb = 0;             // m/s, up and down
  PassGimbal gimbal;            // the axes' limits
  Eigen::AlignedBox3d allowed;  // where the vehicle's middle may be
};

// One way along a pass: 2 * pass, or 2 * pass + 1 for the way back.
using DirectedPass = int;

// What is flown: places with their times, images, and what the gimbal does.
struct PassFlight {
  struct Shot {
    int view = 0;
    double time = 0;  // s
  };
  struct Hold {               // of the gimbal, from a pass' first image to its last
    double from = 0, to = 0;  // s
    double yaw = 0, pitch = 0;
  };
  std::vector<double> times;  // s, from 0
  std::vector<Eigen::Vector3d> positions;
  std::vector<double> courses;  // rad, unwrapped
  std::vector<Shot> shots;
  std::vector<Hold> holds;
  double duration() const { return times.empty() ? 0 : times.back(); }
};

// Immutable once made; not thread-safe, because legs are computed when first asked for.
class PassProblem {
 public:
  // `passes`: numbers of views along a straight line, in order, one at least each; every view in
  // one pass at most, all views of a pass at one height and with one yaw and pitch. `score` has one
  // view each. A pass that neither way can be flown, by gimbal or by the allowed box, is kept and
  // never possible. InputError for settings that make no sense and views off their line.
  PassProblem(std::vector<Viewpoint> views, std::vector<std::vector<int>> passes,
              std::vector<double> courses, const ViewScore& score, const PassSettings& settings);

  int passes() const { return static_cast<int>(passes_.size()); }
  const std::vector<int>& views_of(int pass) const {
    return passes_[static_cast<std::size_t>(pass)];
  }
  // What passes show: one view of it is one pass.
  const ViewScore& score() const { return *score_; }
  const PassSettings& settings() const { return settings_; }
  bool possible(DirectedPass pass) const {
    return ends_[static_cast<std::size_t>(pass)].has_value();
  }
  // s, from the first image to the last.
  double seconds(int pass) const {
    return lengths_[static_cast<std::size_t>(pass)] / settings_.speed;
  }
  // s, from a pass' last image to the first one of another. Infinite where the turn leaves the
  // allowed box, where it is too short for the climb or for the gimbal's turn, and where one of the
  // two passes cannot be flown.
  double leg(DirectedPass a, DirectedPass b) const;
  // s, with the lead before the first image and behind the last one; 0 for none.
  double seconds_of(std::span<const DirectedPass> order) const;
  // What `order` looks like; its seconds are finite.
  PassFlight flight_of(std::span<const DirectedPass> order) const;

 private:
  // The camera against the vehicle, and both ends with the course there.
  struct Ends {
    CoursePoint first, last;  // at the first and last image
    double height = 0, gimbal_yaw = 0, gimbal_pitch = 0;
  };
  std::optional<Ends> ends_of(int pass, bool back, double course) const;
  DubinsWay turn(const Ends& a, const Ends& b) const;
  double leg_of(const Ends& a, const Ends& b) const;

  std::vector<Viewpoint> views_;
  std::vector<std::vector<int>> passes_;
  PassSettings settings_;
  std::unique_ptr<ViewScore> score_;
  std::vector<double> lengths_;            // m, per pass
  std::vector<std::optional<Ends>> ends_;  // per directed pass
  mutable std::vector<double> legs_;       // per pair; NaN: not known yet
};

}  // namespace lapwing
