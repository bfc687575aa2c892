// SPDX-License-Identifier: Apache-2.0
#include "framework/geometry/height_grid.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"

namespace lapwing {

HeightGrid::HeightGrid(const Eigen::Vector2d& corner, double step, int columns,
                       std::vector<float> heights)
    : corner_(corner), step_(step), columns_(columns), heights_(std::move(heights)) {
  if (!(step > 0) || !std::isfinite(step) || !corner.allFinite())
    throw InputError("height grid: the step must be above 0 m");
  const auto width = static_cast<std::size_t>(std::max(columns, 0));
  if (width < 2 || heights_.size() % width != 0 || heights_.size() / width < 2)
    throw InputError("height grid: at least two rows and columns are needed, all alike");
  rows_ = static_cast<int>(heights_.size() / width);
  std::size_t known = 0;
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column) {
      const double z = at(column, row);
      if (std::isinf(z)) throw InputError("height grid: a height is infinite");
      if (std::isnan(z)) continue;
      const Eigen::Vector2d p = place(column, row);
      bounds_.extend(Eigen::Vector3d(p.x(), p.y(), z));
      ++known;
    }
  if (known == 0) throw InputError("height grid: no height is known");
  known_ = static_cast<double>(known) / static_cast<double>(heights_.size());
}

std::optional<double> HeightGrid::height(double x, double y) const {
  const double across = (x - corner_.x()) / step_, along = (y - corner_.y()) / step_;
  if (!(across >= 0 && along >= 0 && across <= columns_ - 1 && along <= rows_ - 1))
    return std::nullopt;
  const int column = std::min(static_cast<int>(across), columns_ - 2);
  const int row = std::min(static_cast<int>(along), rows_ - 2);
  const double s = across - column, t = along - row;
  double sum = 0;
  for (int corner = 0; corner < 4; ++corner) {
    const int right = corner & 1, up = corner >> 1;
    const double weight = (right ? s : 1 - s) * (up ? t : 1 - t);
    if (weight == 0) continue;
    sum += weight * static_cast<double>(at(column + right, row + up));
  }
  if (std::isnan(sum)) return std::nullopt;
  return sum;
}

}  // namespace lapwing
