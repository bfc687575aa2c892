// SPDX-License-Identifier: Apache-2.0
#include "tests/plugins/bound_term.h"

namespace lapwing {
namespace {

// position[3] yaw gimbal_yaw gimbal_pitch, then target[3] or time.
Eigen::VectorXd seen(const Eigen::Vector3d& position, double yaw, double pitch,
                     const std::vector<double>& last) {
  Eigen::VectorXd x(6 + static_cast<Eigen::Index>(last.size()));
  x.head<6>() << position, yaw, 0.0, pitch;
  for (std::size_t i = 0; i < last.size(); ++i) x(6 + static_cast<Eigen::Index>(i)) = last[i];
  return x;
}

Environment walkers() {
  Environment environment;
  environment.subjects = {{"walker", {1.05, 2.05}, {{10, 0, 1}, {10, 2, 1}}, 1.8, 0.5},
                          {"point", {0}, {{5, 5, 0}}}};
  return environment;
}

// The point at 10 m that a camera at the origin, looking east and level, shows at these pixels.
std::vector<double> shown_at(double horizontal, double vertical) {
  const Camera camera = gimbal_drone().camera;
  const double x = (horizontal * camera.width - 0.5 - camera.principal_x) / camera.focal_x;
  const double y = (vertical * camera.height - 0.5 - camera.principal_y) / camera.focal_y;
  return {10, -10 * x, -10 * y};
}

const Eigen::Vector3d kOrigin = Eigen::Vector3d::Zero();

TEST(Framing, IsZeroWhereTheImageShowsTheTargetInItsPlace) {
  for (const auto& [u, v] : {std::pair{0.5, 0.5}, {1.0 / 3, 0.5}, {2.0 / 3, 1.0 / 3}, {0.0, 1.0}}) {
    const BoundCost term("framing", map_of({{"horizontal", u}, {"vertical", v}}));
    EXPECT_NEAR(term.values(seen(kOrigin, 0, 0, shown_at(u, v))).norm(), 0, 1e-9) << u << ", " << v;
  }
  // On the left third instead of the middle: the angle between the two, and to the left.
  const BoundCost middle("framing", map_of({}));
  const Eigen::VectorXd off = middle.values(seen(kOrigin, 0, 0, shown_at(1.0 / 3, 0.5)));
  EXPECT_NEAR(off(0), -std::atan(640.0 / 2300), 1e-12);
  EXPECT_NEAR(off(1), 0, 1e-12);
  const BoundCost third("framing", map_of({{"horizontal", 1.0 / 3}}));
  EXPECT_NEAR(third.values(seen(kOrigin, 0, 0, {10, 0, 0}))(0), std::atan(640.0 / 2300), 1e-12)
      << "seen to the right of where it ought to be";
}

TEST(Framing, EqualsTheCameraAngleInTheMiddle) {
  const BoundCost framing("framing", map_of({})), angle("camera_angle", map_of({}));
  const Eigen::VectorXd x = seen({1, 2, 3}, 0.4, -0.7, {6, -4, 0});
  EXPECT_NEAR((framing.values(x) - angle.values(x)).norm(), 0, 1e-14);
}

TEST(Framing, MeasuresSizeByTheLogarithmOfDistance) {
  // 1.8 m at 2300 px in an image of 2160 px: 0.25 of it from 7.6667 m.
  const BoundCost term("framing", map_of({{"subject", "walker"}, {"size", 0.25}}), walkers());
  ASSERT_EQ(term.shape.rows, 3);
  const double right = 1.8 * 2300 / (0.25 * 2160);
  EXPECT_NEAR(term.values(seen({10 - right, 0, 1}, 0, 0, {0.0})).norm(), 0, 1e-12);
  EXPECT_NEAR(term.values(seen({10 - 2 * right, 0, 1}, 0, 0, {0.0}))(2), std::log(2.0), 1e-12);
  const BoundCost heavy("framing", map_of({{"size", 0.25}, {"height", 1.8}, {"size_weight", 4.0}}),
                        walkers());
  EXPECT_NEAR(heavy.values(seen({10 - right / 2, 0, 1}, 0, 0, {10, 0, 1}))(2), 2 * std::log(0.5),
              1e-12);
}

TEST(Framing, FollowsASubjectInTime) {
  const BoundCost term("framing", map_of({{"subject", "walker"}}), walkers());
  const auto angle = [&](double time) { return -term.values(seen({0, 0, 1}, 0, 0, {time}))(0); };
  EXPECT_NEAR(angle(0.0), 0, 1e-14) << "at rest before its track";
  EXPECT_NEAR(angle(1.55), std::atan(0.1), 1e-14);
  EXPECT_NEAR(angle(3.0), std::atan(0.2), 1e-14) << "and after it";
  term.expect_derivatives(seen({1, 2, 3}, 0.3, -0.2, {1.4}), "while it walks");
  EXPECT_GT(std::abs(term.jacobian(seen({1, 2, 3}, 0.3, -0.2, {1.4}))(0, 6)), 0.1) << "by time";
}

TEST(Framing, DerivativesHoldWhereverTheCameraLooks) {
  const BoundCost term(
      "framing", map_of({{"horizontal", 0.3}, {"vertical", 0.6}, {"size", 0.4}, {"height", 2.0}}));
  term.expect_derivatives(seen({1, 2, 3}, 0.4, -0.7, {6, -4, 0}), "somewhere");
  term.expect_derivatives(seen(kOrigin, 0, 0, shown_at(0.3, 0.6)), "in its place");
  term.expect_derivatives(seen({0, 0, 12}, 0.4, -M_PI / 2, {0, 0, 0}), "straight above");
  term.expect_derivatives(seen(kOrigin, 3.2, -0.2, {-8, 0.2, 1}), "yaw across pi");
  term.expect_derivatives(seen(kOrigin, 0, 0, {-5, 1, 0.5}), "behind");
  term.expect_derivatives(seen(kOrigin, 0.2, 0, {0.05, 0.02, 0}), "too near", 0, 1e-7, 1e-5);
  term.expect_finite(seen(kOrigin, 0.2, 0, {0, 0, 0}), "at the target");
  const std::vector<double> place = shown_at(0.3, 0.6);
  const Eigen::VectorXd behind = seen(kOrigin, 0, 0, {-place[0], -place[1], -place[2]});
  term.expect_finite(behind, "straight behind its place");
  EXPECT_NEAR(term.values(behind).head<2>().norm(), M_PI, 1e-9);
}

TEST(Framing, IsAskedInItsSpansAndNotInCuts) {
  const BoundCost term("framing", map_of({{"spans", spans_of({{0.2, 0.5}, {0.7, 1.0}})},
                                          {"except", spans_of({{0.3, 0.4}})}}));
  EXPECT_EQ(term.shape.stages, (std::vector{2, 5, 7, 8, 9, 10}));
  const BoundCost never("framing", map_of({{"except", spans_of({{0, 1}})}}));
  EXPECT_EQ(never.shape.rows, 0);
}

TEST(Framing, RefusesWhatDoesNotFit) {
  const auto bound = [](const Value& parameters) { BoundCost("framing", parameters, walkers()); };
  expect_message(
      [&] {
        bound(map_of({{"subject", "wlaker"}}));
      },
      {"no subject 'wlaker'", "'walker', 'point'", "did you mean 'walker'"});
  expect_message(
      [&] {
        bound(map_of({{"size", 0.5}}));
      },
      {"size needs a height", "'height', in m"});
  expect_message(
      [&] {
        bound(map_of({{"size", 0.5}, {"subject", "point"}}));
      },
      {"size needs a height", "subject 'point' lacks"});
  expect_message([&] { bound(map_of({{"horizontal", 1.5}})); }, {"horizontal", "between 0 and 1"});
  expect_message(
      [] {
        BoundCost("framing", map_of({{"subject", "walker"}}));
      },
      {"no subject 'walker'", "has none"});
}

}  // namespace
}  // namespace lapwing
