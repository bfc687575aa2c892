// SPDX-License-Identifier: Apache-2.0
#include "tests/plugins/bound_term.h"

namespace lapwing {
namespace {

Value numbers_of(const std::vector<double>& numbers) {
  return Value(Value::List(numbers.begin(), numbers.end()));
}

// East for 5 m, then north for 5 m; the corner is stated twice.
BoundCost corner() {
  return BoundCost("path_distance",
                   map_of({{"points", numbers_of({0, 0, 3, 5, 0, 3, 5, 0, 3, 5, 5, 3})}}));
}

TEST(PathDistance, IsTheWayFromTheNearestPoint) {
  const BoundCost term = corner();
  const auto way = [&](double x, double y, double z) {
    return Eigen::Vector3d(term.values(Eigen::Vector3d(x, y, z)));
  };
  EXPECT_NEAR(way(2, 0, 3).norm(), 0, 1e-14);
  EXPECT_NEAR((way(2, -1, 4) - Eigen::Vector3d(0, -1, 1)).norm(), 0, 1e-14);
  EXPECT_NEAR((way(4.5, 3, 3) - Eigen::Vector3d(-0.5, 0, 0)).norm(), 0, 1e-14);
  EXPECT_NEAR((way(6, -1, 3) - Eigen::Vector3d(1, -1, 0)).norm(), 0, 1e-14) << "of the corner";
  EXPECT_NEAR((way(-2, 1, 3) - Eigen::Vector3d(-2, 1, 0)).norm(), 0, 1e-14) << "of the beginning";
  EXPECT_NEAR((way(5, 8, 2) - Eigen::Vector3d(0, 3, -1)).norm(), 0, 1e-14) << "of the end";
}

TEST(PathDistance, DerivativesHoldBesideThePathAndBeyondItsEnds) {
  const BoundCost term = corner();
  term.expect_derivatives(Eigen::Vector3d(2, -1, 4), "beside");
  term.expect_derivatives(Eigen::Vector3d(2, 0, 3), "on it");
  term.expect_derivatives(Eigen::Vector3d(6, -1, 3), "at the corner");
  term.expect_derivatives(Eigen::Vector3d(-2, 1, 3), "before it");
  // A slanted part, along which the residual does not change.
  const BoundCost slanted("path_distance", map_of({{"points", numbers_of({1, 2, 3, 4, 6, 15})}}));
  const Eigen::Vector3d along = Eigen::Vector3d(3, 4, 12) / 13;
  EXPECT_NEAR((slanted.jacobian(Eigen::Vector3d(2, 4, 9)) * along).norm(), 0, 1e-14);
  slanted.expect_derivatives(Eigen::Vector3d(2, 4, 9), "beside a slanted part");
}

TEST(PathDistance, RefusesWhatIsNoPath) {
  for (const auto& numbers : {std::vector<double>{1, 2, 3}, {1, 2, 3, 4, 5, 6, 7}})
    expect_message(
        [&] {
          BoundCost("path_distance", map_of({{"points", numbers_of(numbers)}}));
        },
        {"points", "expected x, y, z of two points or more", std::to_string(numbers.size())});
}

}  // namespace
}  // namespace lapwing
