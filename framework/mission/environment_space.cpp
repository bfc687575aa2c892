// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/environment_space.h"

#include <algorithm>
#include <limits>

namespace lapwing {
namespace {

using Eigen::Vector3d;

class EnvironmentSpace final : public FreeSpace {
 public:
  EnvironmentSpace(const Environment& environment, std::vector<KeptBall> balls, double more)
      : environment_(environment), balls_(std::move(balls)), margin_(environment.margin + more) {
    std::erase_if(environment_.obstacles,
                  [](const Obstacle& obstacle) { return !obstacle.still(); });
    for (const Obstacle& obstacle : environment_.obstacles)
      margin_ = std::max(margin_, environment.margin + more + obstacle.tolerance);
  }

  bool point_free(const Vector3d& p) const override { return distance(p) >= margin_; }
  bool segment_free(const Vector3d& from, const Vector3d& to) const override {
    return clear(from, to, margin_);
  }
  bool swept_box_free(const Vector3d& from, const Vector3d& to,
                      const Vector3d& half) const override {
    return from == to ? box_clear(from, half) : clear(from, to, margin_ + half.norm());
  }
  Eigen::AlignedBox3d bounds() const override {
    constexpr double kFar = std::numeric_limits<double>::max();
    return {Vector3d::Constant(-kFar), Vector3d::Constant(kFar)};
  }

 private:
  double distance(const Vector3d& p) const {
    double least = std::min(nearest_obstacle(environment_, p).distance,
                            least_inside(environment_, p).distance);
    for (const KeptBall& ball : balls_)
      least = std::min(least, (p - ball.center).norm() - (ball.distance - environment_.margin));
    return least;
  }

  // A box at rest is judged part by part: one whose middle has room enough for all of it is free.
  bool box_clear(const Vector3d& middle, const Vector3d& half) const {
    constexpr double kLeast = 0.15;  // m; smaller parts in doubt are taken for blocked
    const double room = distance(middle) - margin_, radius = half.norm();
    if (room < 0) return false;
    if (room >= radius) return true;
    if (radius < kLeast) return false;
    int axis = 0;
    half.maxCoeff(&axis);
    Vector3d step = Vector3d::Zero(), part = half;
    step(axis) = part(axis) = half(axis) / 2;
    return box_clear(middle - step, part) && box_clear(middle + step, part);
  }

  // Distances change by no more than the way travelled: from each place as far as it is sure to be
  // free, in steps of a millimetre at least.
  bool clear(const Vector3d& from, const Vector3d& to, double kept) const {
    constexpr double kLeast = 1e-3;  // m
    const double length = (to - from).norm();
    for (double at = 0;;) {
      const Vector3d p = length > 0 ? Vector3d(from + at / length * (to - from)) : from;
      const double room = distance(p) - kept;
      if (room < 0) return false;
      if (at >= length) return true;
      at = std::min(length, at + std::max(room, kLeast));
    }
  }

  Environment environment_;
  std::vector<KeptBall> balls_;
  double margin_;
};

}  // namespace

std::unique_ptr<FreeSpace> free_space_of(const Environment& environment,
                                         std::vector<KeptBall> balls, double more) {
  return std::make_unique<EnvironmentSpace>(environment, std::move(balls), more);
}

}  // namespace lapwing
