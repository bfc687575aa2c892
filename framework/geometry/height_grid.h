// SPDX-License-Identifier: Apache-2.0
// Heights over a regular grid of places: terrain, or the surface with all that stands on it.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>

namespace lapwing {

// Immutable; const calls are thread-safe. World frame, metres.
class HeightGrid {
 public:
  // Rows of `columns` heights, x fastest; the first one is at `corner`, `step` apart. NaN where the
  // height is not known. InputError: fewer than two rows or columns, a step that is not above 0, a
  // number of heights that is no multiple of `columns`, an infinite height, or no height at all.
  HeightGrid(const Eigen::Vector2d& corner, double step, int columns, std::vector<float> heights);

  // Between the four grid points around it, bilinear (on a grid point: that one). Nothing where one
  // of them is not known, and outside of the grid.
  std::optional<double> height(double x, double y) const;
  // The same of a grid point; NaN where it is not known.
  float at(int column, int row) const {
    return heights_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                    static_cast<std::size_t>(column)];
  }
  Eigen::Vector2d place(int column, int row) const {
    return corner_ + step_ * Eigen::Vector2d(column, row);
  }

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  double step() const { return step_; }
  // Of all grid points whose height is known.
  const Eigen::AlignedBox3d& bounds() const { return bounds_; }
  // Share of the grid points whose height is known.
  double known() const { return known_; }

 private:
  Eigen::Vector2d corner_;
  double step_;
  int columns_, rows_;
  std::vector<float> heights_;
  Eigen::AlignedBox3d bounds_;
  double known_ = 0;
};

}  // namespace lapwing
