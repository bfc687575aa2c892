// SPDX-License-Identifier: Apache-2.0
#include "framework/problem/block.h"

#include <Eigen/Geometry>

#include "framework/core/error.h"
#include "framework/core/random.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;
using Eigen::Vector4d;

const BlockSpec kTurn{.name = "turn", .size = 4, .topology = Topology::quaternion};
const BlockSpec kPlace{.name = "place", .size = 3, .unit = "m"};

Vector4d random_turn(Random& random) {
  Vector4d q;
  for (double& x : q) x = random.normal();
  return q.normalized();
}

Vector3d random_vector(Random& random, double length) {
  Vector3d v;
  for (double& x : v) x = random.normal();
  return length * v.normalized();
}

Vector4d moved(const Vector4d& q, const Vector3d& d) {
  Vector4d r;
  block_retract(kTurn, q.data(), d.data(), r.data());
  return r;
}

Vector3d turned(const Vector4d& from, const Vector4d& to) {
  Vector3d d;
  block_difference(kTurn, from.data(), to.data(), d.data());
  return d;
}

TEST(Block, DifferenceUndoesRetraction) {
  Random random(1);
  for (const double length : {0.0, 1e-14, 1e-9, 1e-5, 0.1, 1.0, 3.0, 3.1415})
    for (int trial = 0; trial < 20; ++trial) {
      const Vector4d q = random_turn(random);
      const Vector3d d = random_vector(random, length);
      EXPECT_NEAR((turned(q, moved(q, d)) - d).norm(), 0.0, 1e-11) << length;
      EXPECT_NEAR(moved(q, d).norm(), 1.0, 1e-15);
    }
}

TEST(Block, OppositeQuaternionsAreOneOrientation) {
  Random random(2);
  for (int trial = 0; trial < 50; ++trial) {
    const Vector4d p = random_turn(random), q = random_turn(random);
    EXPECT_NEAR((turned(p, q) - turned(-p, q)).norm(), 0.0, 1e-14);
    EXPECT_NEAR((turned(p, q) - turned(p, -q)).norm(), 0.0, 1e-14);
    EXPECT_LE(turned(p, q).norm(), M_PI + 1e-12) << "the shortest turn";
    EXPECT_NEAR(turned(q, -q).norm(), 0.0, 1e-15);
  }
}

TEST(Block, TurnsAboutTheBodysAxes) {
  // A quarter turn about z, then the body's x axis is the world's y.
  const Vector4d quarter = moved(Vector4d(1, 0, 0, 0), Vector3d(0, 0, M_PI / 2));
  const Vector4d rolled = moved(quarter, Vector3d(M_PI / 2, 0, 0));
  const Eigen::Quaterniond q(rolled[0], rolled[1], rolled[2], rolled[3]);
  EXPECT_NEAR((q * Vector3d::UnitX() - Vector3d::UnitY()).norm(), 0.0, 1e-15);
  EXPECT_NEAR((q * Vector3d::UnitY() - Vector3d::UnitZ()).norm(), 0.0, 1e-15);
}

TEST(Block, RetractionJacobianEqualsDifferences) {
  Random random(3);
  const double h = 1e-6;
  for (int trial = 0; trial < 20; ++trial) {
    const Vector4d q = random_turn(random);
    const Eigen::MatrixXd jacobian = retraction_jacobian(kTurn, q.data());
    for (int k = 0; k < 3; ++k) {
      const Vector3d d = h * Vector3d::Unit(k);
      EXPECT_NEAR((jacobian.col(k) - (moved(q, d) - moved(q, -d)) / (2 * h)).norm(), 0.0, 1e-9);
    }
  }
  EXPECT_TRUE(retraction_jacobian(kPlace, nullptr).isIdentity(0.0));
}

TEST(Block, DifferenceJacobiansEqualDifferences) {
  Random random(4);
  const double h = 1e-5;
  for (const double angle : {0.0, 1e-7, 5e-5, 2e-4, 9e-3, 1.1e-2, 0.7, 2.0, 3.0, 3.14})
    for (int trial = 0; trial < 5; ++trial) {
      const Vector4d p = random_turn(random), q = moved(p, random_vector(random, angle));
      for (const double sign : {1.0, -1.0}) {
        const Vector4d to = sign * q;
        const DifferenceJacobians j = difference_jacobians(kTurn, p.data(), to.data());
        for (int k = 0; k < 3; ++k) {
          const Vector3d d = h * Vector3d::Unit(k);
          const Vector3d from_slope =
              (turned(moved(p, d), to) - turned(moved(p, -d), to)) / (2 * h);
          const Vector3d to_slope = (turned(p, moved(to, d)) - turned(p, moved(to, -d))) / (2 * h);
          EXPECT_NEAR((j.from.col(k) - from_slope).norm(), 0.0, 1e-8) << "angle " << angle;
          EXPECT_NEAR((j.to.col(k) - to_slope).norm(), 0.0, 1e-8) << "angle " << angle;
        }
      }
    }
  const Vector4d p = random_turn(random), half = moved(p, Vector3d(M_PI, 0, 0));
  EXPECT_TRUE(difference_jacobians(kTurn, p.data(), half.data()).to.allFinite());
  const DifferenceJacobians line = difference_jacobians(kPlace, nullptr, nullptr);
  EXPECT_TRUE(line.to.isIdentity(0.0) && (-line.from).isIdentity(0.0));
}

TEST(Block, DifferenceCurvatureEqualsDifferences) {
  Random random(5);
  const double h = 1e-3;
  for (const double angle : {0.0, 1e-4, 1e-3, 3e-3, 0.5, 2.5})
    for (const double sign : {1.0, -1.0}) {
      const Vector4d p = random_turn(random), q = sign * moved(p, random_vector(random, angle));
      const Vector3d lambda = random_vector(random, 1.0);
      const auto value = [&](const Eigen::Matrix<double, 6, 1>& d) {
        return lambda.dot(turned(moved(p, d.head<3>()), moved(q, d.tail<3>())));
      };
      const Eigen::MatrixXd curvature =
          difference_curvature(kTurn, p.data(), q.data(), lambda.data());
      for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) {
          const Eigen::Matrix<double, 6, 1> a = h * Eigen::Matrix<double, 6, 1>::Unit(i),
                                            b = h * Eigen::Matrix<double, 6, 1>::Unit(j);
          const double expected =
              (value(a + b) - value(a - b) - value(b - a) + value(-a - b)) / (4 * h * h);
          EXPECT_NEAR(curvature(i, j), expected, 2e-5) << i << ", " << j << " angle " << angle;
        }
    }
}

TEST(Block, LinesSubtractAndAdd) {
  const Vector3d a(1, 2, 3), b(4, 6, 8);
  Vector3d d, back;
  block_difference(kPlace, a.data(), b.data(), d.data());
  EXPECT_EQ(d, Vector3d(3, 4, 5));
  block_retract(kPlace, a.data(), d.data(), back.data());
  EXPECT_EQ(back, b);
}

TEST(StageLayout, KeepsOffsetsAndNames) {
  StageLayout layout;
  layout.add(kPlace);
  layout.add(kTurn);
  layout.add({.name = "yaw"});
  layout.add({.name = "rotors", .size = 4});
  EXPECT_EQ(layout.size(), 12);
  EXPECT_EQ(layout.tangent_size(), 11);
  EXPECT_EQ(layout.offset(2), 7);
  EXPECT_EQ(layout.tangent_offset(2), 6);
  EXPECT_EQ(layout.find("nothing"), -1);
  EXPECT_EQ(layout.indices({"yaw", "place"}), (std::vector<int>{2, 0}));
  EXPECT_EQ(component_name(kPlace, 1), "place.y");
  EXPECT_EQ(component_name(kTurn, 2), "turn.z");
  EXPECT_EQ(component_name(layout.block(2), 0), "yaw");
  EXPECT_EQ(component_name(layout.block(3), 3), "rotors.3");
}

std::string message_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(StageLayout, RefusesWhatMakesNoSense) {
  StageLayout layout;
  layout.add(kPlace);
  EXPECT_THROW(layout.add(kPlace), Error);
  EXPECT_THROW(layout.add({.name = "", .size = 1}), Error);
  EXPECT_THROW(layout.add({.name = "empty", .size = 0}), Error);
  EXPECT_THROW(layout.add({.name = "q", .size = 3, .topology = Topology::quaternion}), Error);
  const std::string message = message_of([&] { layout.index("plaec"); });
  EXPECT_NE(message.find("no block 'plaec'"), std::string::npos) << message;
  EXPECT_NE(message.find("did you mean 'place'"), std::string::npos) << message;
}

}  // namespace
}  // namespace lapwing
