// SPDX-License-Identifier: Apache-2.0
#include "framework/flight_review/shown_fits.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include <Eigen/Dense>

#include "framework/core/random.h"
#include "framework/vehicle/monte_carlo.h"

namespace lapwing {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kGravity = 9.80665;  // m/s^2
constexpr double kBlock = 5;          // s, of the bootstrap
constexpr int kDraws = 400;
constexpr std::size_t kLeastBlocks = 6;  // fewer tell no interval

// A linear least squares by blocks of time, so that blocks can be drawn again.
template <int N>
struct Normal {
  Eigen::Matrix<double, N, N> matrix = Eigen::Matrix<double, N, N>::Zero();
  Eigen::Matrix<double, N, 1> right = Eigen::Matrix<double, N, 1>::Zero();
  double square = 0;
  double rows = 0;

  void add(const Eigen::Matrix<double, N, 1>& row, double wanted) {
    matrix += row * row.transpose();
    right += row * wanted;
    square += wanted * wanted;
    ++rows;
  }
  void add(const Normal& other) {
    matrix += other.matrix;
    right += other.right;
    square += other.square;
    rows += other.rows;
  }
  Eigen::Matrix<double, N, 1> solved() const {
    const Eigen::Matrix<double, N, N> ridge =
        1e-9 * std::max(1.0, matrix.trace()) * Eigen::Matrix<double, N, N>::Identity();
    return (matrix + ridge).ldlt().solve(right);
  }
  double misses() const { return square - right.dot(solved()); }
};

// The interval of a figure over drawn blocks.
template <class Block>
FitResult interval(const std::vector<Block>& blocks, double time,
                   const std::function<double(const Block&)>& figure) {
  Block all;
  for (const Block& block : blocks) all.add(block);
  FitResult result{figure(all), 0, 0, time};
  Random random(1);
  std::vector<double> drawn;
  for (int draw = 0; draw < kDraws; ++draw) {
    Block some;
    for (std::size_t k = 0; k < blocks.size(); ++k)
      some.add(blocks[std::min(
          blocks.size() - 1,
          static_cast<std::size_t>(random.uniform() * static_cast<double>(blocks.size())))]);
    if (some.rows > 0) drawn.push_back(figure(some));
  }
  result.low = quantile_of(drawn, 0.025);
  result.high = quantile_of(drawn, 0.975);
  return result;
}

std::size_t block_of(const ShownMotion& motion, double time) {
  return static_cast<std::size_t>(std::max(0.0, time - motion.states.front().time) / kBlock);
}

template <class Block>
std::vector<Block> filled(std::vector<Block> blocks) {
  std::erase_if(blocks, [](const Block& block) { return block.rows == 0; });
  return blocks;
}

// What acts on the body but gravity, per mass, in the body.
std::optional<Vector3d> force_of(const ShownState& s) {
  if (s.specific_force) return s.specific_force;
  if (!s.orientation) return std::nullopt;
  return s.orientation->conjugate() * (s.acceleration + Vector3d(0, 0, kGravity));
}

}  // namespace

std::optional<DragFit> fit_drag(const ShownMotion& motion) {
  using Sums = Normal<5>;  // d/m, d/m times wind (2), bias (2)
  std::vector<Sums> blocks(block_of(motion, motion.states.back().time) + 1);
  double time = 0, fastest = 0;
  for (const ShownState& s : motion.states) {
    const auto force = force_of(s);
    if (!s.airborne || !s.orientation || !force) continue;
    const Eigen::Matrix3d to_body = s.orientation->conjugate().toRotationMatrix();
    const Vector3d velocity = to_body * s.velocity;
    time += motion.step;
    fastest = std::max(fastest, s.velocity.head<2>().norm());
    for (int axis = 0; axis < 2; ++axis) {
      Eigen::Matrix<double, 5, 1> row;
      row << -velocity[axis], to_body(axis, 0), to_body(axis, 1), axis == 0, axis == 1;
      blocks[block_of(motion, s.time)].add(row, (*force)[axis]);
    }
  }
  blocks = filled(std::move(blocks));
  if (blocks.size() < kLeastBlocks || fastest < 2) return std::nullopt;
  DragFit fit;
  fit.drag = interval<Sums>(blocks, time, [](const Sums& b) { return b.solved()[0]; });
  Sums all;
  for (const Sums& block : blocks) all.add(block);
  const auto solved = all.solved();
  if (solved[0] > 1e-6) fit.wind = Vector2d(solved[1], solved[2]) / solved[0];
  const bool clear = fit.drag.low > 0 && fit.drag.high - fit.drag.low < fit.drag.value;
  return clear ? std::optional(fit) : std::nullopt;
}

std::optional<FitResult> fit_hover(const ShownMotion& motion) {
  using Sums = Normal<1>;
  std::vector<Sums> blocks(block_of(motion, motion.states.back().time) + 1);
  double time = 0;
  for (const ShownState& s : motion.states) {
    if (!s.airborne || !s.throttle || s.velocity.norm() > 1 || s.acceleration.norm() > 0.5)
      continue;
    blocks[block_of(motion, s.time)].add(Eigen::Matrix<double, 1, 1>(1.0), *s.throttle);
    time += motion.step;
  }
  blocks = filled(std::move(blocks));
  if (time < 2) return std::nullopt;
  return interval<Sums>(blocks, time, [](const Sums& b) { return b.solved()[0]; });
}

std::optional<ThrustFit> fit_thrust(const ShownMotion& motion) {
  using Sums = Normal<2>;  // log c, p
  std::vector<Sums> blocks(block_of(motion, motion.states.back().time) + 1);
  double time = 0;
  // Over half a second, so that the lag of the rotors does not matter.
  const auto window = static_cast<std::size_t>(std::max(1.0, 0.5 / motion.step));
  for (std::size_t i = 0; i + window <= motion.states.size(); i += window) {
    double throttle = 0, lift = 0;
    bool whole = true;
    for (std::size_t k = i; k < i + window && whole; ++k) {
      const ShownState& s = motion.states[k];
      const auto force = force_of(s);
      whole = s.airborne && s.throttle && force;
      if (whole) throttle += *s.throttle, lift += force->z();
    }
    throttle /= static_cast<double>(window);
    lift /= static_cast<double>(window);
    if (!whole || !(throttle > 0.02) || !(lift > 1)) continue;
    blocks[block_of(motion, motion.states[i].time)].add(Eigen::Vector2d(1, std::log(throttle)),
                                                        std::log(lift));
    time += 0.5;
  }
  blocks = filled(std::move(blocks));
  if (blocks.size() < kLeastBlocks) return std::nullopt;
  ThrustFit fit;
  fit.full = interval<Sums>(blocks, time, [](const Sums& b) { return std::exp(b.solved()[0]); });
  fit.exponent = interval<Sums>(blocks, time, [](const Sums& b) { return b.solved()[1]; });
  const bool clear = fit.exponent.low > 0.3 && fit.exponent.high < 3 &&
                     fit.exponent.high - fit.exponent.low < 0.6 &&
                     fit.full.high - fit.full.low < 0.3 * fit.full.value;
  return clear ? std::optional(fit) : std::nullopt;
}

namespace {

// Sums of one block for every time constant that is tried: specific force along the body's z axis
// as a constant, the followed input, and the drag along that axis.
struct LagBlock {
  static constexpr int kTried = 61;
  static double constant(int k) { return 0.005 * k; }  // s
  std::array<Normal<3>, kTried> sums;
  double rows = 0;

  void add(const LagBlock& other) {
    for (int k = 0; k < kTried; ++k)
      sums[static_cast<std::size_t>(k)].add(other.sums[static_cast<std::size_t>(k)]);
    rows += other.rows;
  }
  // The constant with the least squares, between those tried by the parabola through three.
  double best() const {
    Eigen::ArrayXd misses(kTried);
    for (int k = 0; k < kTried; ++k) misses[k] = sums[static_cast<std::size_t>(k)].misses();
    Eigen::Index at = 0;
    misses.minCoeff(&at);
    if (at == 0 || at + 1 == kTried) return constant(static_cast<int>(at));
    const double a = misses[at - 1], b = misses[at], c = misses[at + 1];
    const double bend = a - 2 * b + c;
    return 0.005 * (static_cast<double>(at) + (bend > 0 ? 0.5 * (a - c) / bend : 0));
  }
};

}  // namespace

std::optional<FitResult> fit_lag(const FlightLog& log, const ShownMotion& motion, double exponent) {
  const LogSeries* throttle = log.find("throttle");
  const LogSeries* force = log.find("specific_force");
  if (!throttle || !force) return std::nullopt;
  std::vector<LagBlock> blocks(block_of(motion, motion.states.back().time) + 1);
  Eigen::ArrayXd followed = Eigen::ArrayXd::Constant(LagBlock::kTried, NAN);
  double input = NAN, now = 0, time = 0;
  std::size_t next = 0;
  // Commands are held until the next; the followed value is exact between them.
  const auto advance = [&](double to) {
    for (int k = 0; k < LagBlock::kTried && to > now; ++k) {
      const double constant = LagBlock::constant(k);
      followed[k] =
          constant == 0 ? input : input + (followed[k] - input) * std::exp(-(to - now) / constant);
    }
    now = to;
  };
  double before = NAN;
  for (std::size_t i = 0; i < force->size(); ++i) {
    const double at = force->times[i];
    while (next < throttle->size() && throttle->times[next] <= at) {
      const double value = std::pow(std::max(0.0, throttle->values[next]), exponent);
      if (std::isnan(input)) {
        followed.setConstant(value);
        now = throttle->times[next];
      } else {
        advance(throttle->times[next]);
      }
      input = value;
      ++next;
    }
    if (std::isnan(input) || at - throttle->times[next - 1] > 0.5) continue;
    advance(at);
    const double share = (at - motion.states.front().time) / motion.step;
    if (share < 0 || share >= static_cast<double>(motion.states.size())) continue;
    const ShownState& state = motion.states[static_cast<std::size_t>(share)];
    if (!state.airborne) continue;
    const double fall = state.orientation ? (state.orientation->conjugate() * state.velocity).z()
                                          : state.velocity.z();
    LagBlock& block = blocks[block_of(motion, at)];
    for (int k = 0; k < LagBlock::kTried; ++k)
      block.sums[static_cast<std::size_t>(k)].add(Vector3d(1, followed[k], fall),
                                                  force->values[3 * i + 2]);
    ++block.rows;
    if (!std::isnan(before)) time += std::min(0.1, at - before);
    before = at;
  }
  blocks = filled(std::move(blocks));
  if (blocks.size() < kLeastBlocks) return std::nullopt;
  const FitResult fit =
      interval<LagBlock>(blocks, time, [](const LagBlock& b) { return b.best(); });
  const bool clear = fit.high - fit.low < 0.05 && fit.low > 0.005 && fit.value < 0.29;
  return clear ? std::optional(fit) : std::nullopt;
}

}  // namespace lapwing
