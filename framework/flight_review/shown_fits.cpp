// SPDX-License-Identifier: Apache-2.0
#include "framework/flight_review/shown_fits.h"
#include "framework/core/units.h"

#include "framework/flight_review/fit_blocks.h"

namespace lapwing {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// What acts on the body but gravity, per mass, in the body.
std::optional<Vector3d> force_of(const ShownState& s) {
  if (s.specific_force) return s.specific_force;
  if (!s.orientation) return std::nullopt;
  return s.orientation->conjugate() * (s.acceleration + Vector3d(0, 0, kGravity));
}

}  // namespace

std::optional<DragFit> fit_drag(const ShownMotion& motion) {
  using Sums = NormalSums<5>;  // d/m, d/m times wind (2), bias (2)
  std::map<std::size_t, Sums> blocks;
  DragFit fit;
  double time = 0, fastest = 0;
  for (const ShownState& s : motion.states) {
    const auto force = force_of(s);
    if (!s.airborne || !s.orientation || !force) continue;
    const Eigen::Matrix3d to_body = s.orientation->conjugate().toRotationMatrix();
    const Vector3d velocity = to_body * s.velocity;
    time += motion.step;
    fit.drag.measured = s.specific_force.has_value();
    fastest = std::max(fastest, s.velocity.head<2>().norm());
    for (int axis = 0; axis < 2; ++axis) {
      Eigen::Matrix<double, 5, 1> row;
      row << -velocity[axis], to_body(axis, 0), to_body(axis, 1), axis == 0, axis == 1;
      blocks[block_of(motion, s.time)].add(row, (*force)[axis]);
    }
  }
  const std::vector<Sums> kept = filled(std::move(blocks));
  if (kept.size() < kLeastBlocks || fastest < 2) return std::nullopt;
  const bool measured = fit.drag.measured;
  fit.drag = interval<Sums>(kept, time, [](const Sums& b) { return b.solved()[0]; });
  fit.drag.measured = measured;
  Sums all;
  for (const Sums& block : kept) all.add(block);
  const auto solved = all.solved();
  if (solved[0] > 1e-6) fit.wind = Vector2d(solved[1], solved[2]) / solved[0];
  const bool clear = fit.drag.low > 0 && fit.drag.high - fit.drag.low < fit.drag.value;
  return clear ? std::optional(fit) : std::nullopt;
}

std::optional<FitResult> fit_hover(const ShownMotion& motion) {
  using Sums = NormalSums<1>;
  std::map<std::size_t, Sums> blocks;
  double time = 0;
  for (const ShownState& s : motion.states) {
    if (!s.airborne || !s.throttle || s.velocity.norm() > 1 || s.acceleration.norm() > 0.5)
      continue;
    blocks[block_of(motion, s.time)].add(Eigen::Matrix<double, 1, 1>(1.0), *s.throttle);
    time += motion.step;
  }
  const std::vector<Sums> kept = filled(std::move(blocks));
  if (time < 2) return std::nullopt;
  return interval<Sums>(kept, time, [](const Sums& b) { return b.solved()[0]; });
}

}  // namespace lapwing
