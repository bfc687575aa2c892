// SPDX-License-Identifier: Apache-2.0
#include "framework/export/keep_clear.h"

#include <cmath>

namespace lapwing {
namespace {

constexpr double kSpare = 0.05;  // m: corners are cut, coordinates are rounded
constexpr double kApart = 0.25;  // m, between places that are tried
constexpr int kMostTried = 400;  // on a line
constexpr int kRounds = 40;

// How far a place has to be moved, and which way, for the worst of all distances.
struct Push {
  double need = 0;
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();

  void see(double distance, double wanted, const Eigen::Vector3d& gradient) {
    if (wanted + kSpare - distance <= need || gradient.norm() < 1e-6) return;
    need = wanted + kSpare - distance;
    direction = gradient.normalized();
  }
};

Push push_at(const Environment& environment, const Eigen::Vector3d& p, double time) {
  Push push;
  for (const Obstacle& obstacle : environment.obstacles) {
    if (!obstacle.shape) continue;
    const double sign = obstacle.side == Side::keep_out ? 1 : -1;
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    const double distance = obstacle.shape->distance(p - obstacle.moved(time), &gradient);
    push.see(sign * distance, environment.margin, sign * gradient);
  }
  for (const Subject& subject : environment.subjects) {
    if (subject.distance <= 0) continue;
    const Eigen::Vector3d from = p - subject.position(time);
    push.see(from.norm(), subject.distance, from);
  }
  return push;
}

// One pass over a line, which moves its ends; whether it had to.
bool free_line(PlannedWaypoint& a, PlannedWaypoint& b, const Environment& environment) {
  const double length = (b.position - a.position).norm();
  const int parts = std::clamp(static_cast<int>(length / kApart) + 1, 1, kMostTried);
  bool moved = false;
  for (int i = 0; i <= parts; ++i) {
    const double s = static_cast<double>(i) / parts;
    const Eigen::Vector3d p = a.position + s * (b.position - a.position);
    const Push push = push_at(environment, p, a.time + s * (b.time - a.time));
    if (push.need <= 1e-4) continue;
    const double share = (1 - s) * (1 - s) + s * s;
    const Eigen::Vector3d step = (push.need / share) * push.direction;
    a.position += (1 - s) * step;
    b.position += s * step;
    moved = true;
  }
  return moved;
}

}  // namespace

void keep_clear(std::vector<PlannedWaypoint>& waypoints, const Environment& environment) {
  bool moved = true;
  for (int round = 0; round < kRounds && moved; ++round) {
    moved = false;
    for (std::size_t k = 1; k < waypoints.size(); ++k) {
      PlannedWaypoint &a = waypoints[k - 1], &b = waypoints[k];
      const bool rest = a.position == b.position;
      moved = free_line(a, b, environment) || moved;
      if (rest) b.position = a.position;
    }
    // A rest whose end was moved by the line after it.
    for (std::size_t k = waypoints.size(); k-- > 1;)
      if ((waypoints[k].position - waypoints[k - 1].position).norm() < 1e-3)
        waypoints[k - 1].position = waypoints[k].position;
  }
}

}  // namespace lapwing
