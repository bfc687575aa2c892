// SPDX-License-Identifier: Apache-2.0
#include "framework/problem/convex_part.h"

#include <algorithm>

#include <Eigen/Eigenvalues>

namespace lapwing {

void take_convex_parts(std::vector<double>& blocks, int width) {
  const std::size_t size = static_cast<std::size_t>(width) * width;
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(width);
  for (std::size_t first = 0; first + size <= blocks.size(); first += size) {
    Eigen::Map<Eigen::MatrixXd> block(blocks.data() + first, width, width);
    if (std::all_of(block.data(), block.data() + size, [](double v) { return v == 0; })) continue;
    eigen.compute(block);
    block.setZero();
    for (int k = 0; k < width; ++k)
      if (eigen.eigenvalues()(k) > 0) {
        const auto axis = eigen.eigenvectors().col(k);
        block += eigen.eigenvalues()(k) * axis.lazyProduct(axis.transpose());
      }
  }
}

}  // namespace lapwing
