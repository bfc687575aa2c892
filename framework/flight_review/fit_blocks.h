// SPDX-License-Identifier: Apache-2.0
// Least squares by blocks of time, and what drawing the blocks again tells. Internal to this room.
#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <vector>

#include <Eigen/Dense>

#include "framework/core/random.h"
#include "framework/flight_review/shown_fits.h"
#include "framework/vehicle/monte_carlo.h"

namespace lapwing {

inline constexpr double kBlock = 5;             // s, of the bootstrap
inline constexpr std::size_t kLeastBlocks = 6;  // fewer tell no interval

// A linear least squares by blocks of time, so that blocks can be drawn again.
template <int N>
struct NormalSums {
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
  void add(const NormalSums& other) {
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
  constexpr int kDraws = 400;
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

inline std::size_t block_of(const ShownMotion& motion, double time) {
  return static_cast<std::size_t>(std::max(0.0, time - motion.states.front().time) / kBlock);
}

// Only those with data are kept: a log may be long, and a time in it wrong.
template <class Block>
std::vector<Block> filled(std::map<std::size_t, Block> blocks) {
  std::vector<Block> found;
  for (auto& [number, block] : blocks)
    if (block.rows > 0) found.push_back(std::move(block));
  return found;
}

}  // namespace lapwing
