// SPDX-License-Identifier: Apache-2.0
// What the kernel makes of a shape's one formula: derivatives, rays, distances through dual
// numbers.
#include "framework/shape/shape.h"

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "framework/shape/differentiable_shape.h"
#include "framework/shape/lifted_distance.h"
#include "framework/shape/surfaces.h"

namespace lapwing {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kEndless = std::numeric_limits<double>::infinity();

// An ellipsoid's bounded estimate of the distance: curved everywhere, and less than the truth.
class Egg final : public DifferentiableShape<Egg> {
 public:
  template <class T>
  T core(const T* p) const {
    using std::sqrt;
    const T x = p[0] / 3.0, y = p[1] / 2.0, z = p[2] / 1.0;
    return (sqrt(x * x + y * y + z * z + 1e-18) - 1.0) * 1.0;
  }
  double rounding() const override { return rounding_; }
  Eigen::AlignedBox3d bounds() const override {
    const Vector3d half(3, 2, 1);
    return {-(1 + rounding_) * half, (1 + rounding_) * half};
  }
  TriangleMesh triangles(double, const Eigen::AlignedBox3d&) const override { return {}; }
  Value record() const override { return Value::map(); }
  explicit Egg(double rounding = 0) : rounding_(rounding) {}

 private:
  double rounding_;
};

// A distance without a derivative of its own, and a box that may have no end.
class Plain final : public Shape {
 public:
  Plain(std::function<double(const Vector3d&)> formula, const Eigen::AlignedBox3d& box)
      : formula_(std::move(formula)), box_(box) {}
  double core_distance(const Vector3d& p, Vector3d* gradient) const override {
    if (gradient)
      for (int i = 0; i < 3; ++i)
        (*gradient)(i) =
            (formula_(p + 1e-7 * Vector3d::Unit(i)) - formula_(p - 1e-7 * Vector3d::Unit(i))) /
            2e-7;
    return formula_(p);
  }
  Eigen::AlignedBox3d bounds() const override { return box_; }
  TriangleMesh triangles(double, const Eigen::AlignedBox3d&) const override { return {}; }
  Value record() const override { return Value::map(); }

 private:
  std::function<double(const Vector3d&)> formula_;
  Eigen::AlignedBox3d box_;
};

const Eigen::AlignedBox3d kEverywhere(Vector3d::Constant(-kEndless), Vector3d::Constant(kEndless));

Vector3d within_egg(Random& random) {
  return {random.uniform(-4, 4), random.uniform(-3, 3), random.uniform(-2, 2)};
}

TEST(DifferentiableShapes, GradientAndCurvatureEqualDifferences) {
  Random random(1);
  const Egg egg(0.25);
  const double h = 1e-5;
  for (int k = 0; k < 200; ++k) {
    const Vector3d p = within_egg(random);
    if (p.norm() < 0.1) continue;
    Vector3d gradient;
    EXPECT_EQ(egg.distance(p, &gradient), egg.distance(p, nullptr)) << "asked or not";
    EXPECT_EQ(egg.core_distance(p, nullptr) - 0.25, egg.distance(p, nullptr));
    const Matrix3d curvature = egg.curvature(p);
    EXPECT_LT((curvature - curvature.transpose()).norm(), 1e-12);
    for (int i = 0; i < 3; ++i) {
      const Vector3d step = h * Vector3d::Unit(i);
      Vector3d after, before;
      const double slope =
          (egg.distance(p + step, &after) - egg.distance(p - step, &before)) / (2 * h);
      EXPECT_NEAR(gradient(i), slope, 1e-8);
      EXPECT_LT((curvature.col(i) - (after - before) / (2 * h)).norm(), 1e-6);
    }
  }
}

TEST(DistanceFields, CurvatureByDifferencesIsThatOfTheFormula) {
  const Egg egg;
  const Plain plain([&](const Vector3d& p) { return egg.distance(p, nullptr); }, kEverywhere);
  Random random(2);
  for (int k = 0; k < 50; ++k) {
    const Vector3d p = within_egg(random);
    if (p.norm() < 0.5) continue;
    // Differences of differences: a few digits.
    EXPECT_LT((plain.curvature(p) - egg.curvature(p)).norm(), 2e-3) << p.transpose();
  }
}

TEST(LiftedDistance, CarriesOneLayerOfDerivativesAndNumbersAlone) {
  const Egg egg(0.5);
  Random random(3);
  for (int k = 0; k < 50; ++k) {
    const Vector3d at = within_egg(random), way(random.normal(), random.normal(), random.normal());
    EXPECT_EQ(lifted_distance(egg, at.data()), egg.distance(at, nullptr));
    EXPECT_EQ(lifted_core_distance(egg, at.data()), egg.core_distance(at, nullptr));
    using One = Dual<double, 1>;
    One p[3];
    for (int i = 0; i < 3; ++i) {
      p[i] = One(at(i));
      p[i].d[0] = way(i);
    }
    Vector3d gradient;
    const double value = egg.distance(at, &gradient);
    const One lifted = lifted_distance(egg, static_cast<const One*>(p));
    EXPECT_EQ(lifted.v, value);
    EXPECT_NEAR(lifted.d[0], gradient.dot(way), 1e-12);
  }
}

// Along a path p(t) the second derivative has a share of the path's own curvature.
TEST(LiftedDistance, SecondDerivativesAlongACurveEqualDifferences) {
  const Egg egg;
  const auto along = [&](const auto& t) {
    using std::cos, std::sin;
    using T = std::decay_t<decltype(t)>;
    const T p[3] = {3.5 * cos(t), 2.5 * sin(t), 0.3 * t * t};
    return lifted_distance(egg, static_cast<const T*>(p));
  };
  using Inner = Dual<double, 1>;
  using Outer = Dual<Inner, 1>;
  for (const double t : {0.2, 0.9, 1.7, 2.8}) {
    Outer twice(t);
    twice.v.d[0] = 1;
    twice.d[0] = Inner(1.0);
    const Outer result = along(twice);
    const double h = 1e-4;
    const double before = along(t - h), here = along(t), after = along(t + h);
    EXPECT_DOUBLE_EQ(result.v.v, here);
    EXPECT_NEAR(result.v.d[0], (after - before) / (2 * h), 1e-6);
    EXPECT_NEAR(result.d[0].v, result.v.d[0], 1e-12);
    EXPECT_NEAR(result.d[0].d[0], (after - 2 * here + before) / (h * h), 1e-5);
  }
}

// Steps as long as the distance find what a quadratic equation finds.
TEST(ShapeRays, EqualTheClosedFormOfAnEllipsoid) {
  const Egg egg;
  const Vector3d half(3, 2, 1);
  Random random(4);
  int hits = 0, inside = 0, misses = 0;
  for (int k = 0; k < 1000; ++k) {
    const Vector3d from =
        k % 5 == 0 ? Vector3d(0.5 * within_egg(random))
                   : Vector3d(random.uniform(-8, 8), random.uniform(-8, 8), random.uniform(-8, 8));
    const Vector3d to = 1.2 * within_egg(random), way = (to - from).normalized();
    const Vector3d o = from.cwiseQuotient(half), d = way.cwiseQuotient(half);
    const double a = d.squaredNorm(), b = o.dot(d), c = o.squaredNorm() - 1;
    const double root2 = b * b - a * c;
    if (std::abs(root2) < 1e-3 || std::abs(c) < 1e-3) continue;  // grazing, or on it
    const bool starts_inside = c < 0;
    const double expected =
        root2 < 0 ? kEndless : (-b + (starts_inside ? 1 : -1) * std::sqrt(root2)) / a;
    const auto hit = egg.hit(from, way);
    if (root2 < 0 || expected < 0) {
      ++misses;
      EXPECT_FALSE(hit) << k;
      continue;
    }
    ++(starts_inside ? inside : hits);
    ASSERT_TRUE(hit) << k;
    EXPECT_NEAR(hit->distance, expected, 1e-5) << k;
    EXPECT_NEAR(hit->normal.norm(), 1, 1e-9);
    EXPECT_LT(hit->normal.dot(way), 0) << "towards where the ray came from";
    const Vector3d place = from + expected * way;
    const Vector3d out = place.cwiseQuotient(half.cwiseAbs2()).normalized();
    EXPECT_LT((hit->normal - (starts_inside ? Vector3d(-out) : out)).norm(), 1e-4);
  }
  EXPECT_GT(hits, 200);
  EXPECT_GT(inside, 50);
  EXPECT_GT(misses, 50);
}

TEST(ShapeRays, BeginningOnTheSurfaceLeavesIt) {
  const Plain ball([](const Vector3d& p) { return p.norm() - 1; },
                   {Vector3d::Constant(-1), Vector3d::Constant(1)});
  EXPECT_FALSE(ball.hit({1, 0, 0}, {1, 0, 0})) << "outwards";
  const auto across = ball.hit({1, 0, 0}, {-1, 0, 0});
  ASSERT_TRUE(across) << "inwards, to the far side";
  EXPECT_NEAR(across->distance, 2, 1e-5);
  EXPECT_TRUE(ball.hit({0.999, 0, -3}, {0, 0, 1}));
  EXPECT_FALSE(ball.hit({1.001, 0, -3}, {0, 0, 1}));
}

TEST(ShapeRays, BodiesWithoutEndAndWithoutAnythingAreAnswered) {
  const Plain floor([](const Vector3d& p) { return p.z(); }, kEverywhere);
  const auto down = floor.hit({5, 5, 100}, {0, 0, -1});
  ASSERT_TRUE(down);
  EXPECT_NEAR(down->distance, 100, 1e-6);
  EXPECT_LT((down->normal - Vector3d::UnitZ()).norm(), 1e-6);
  const auto slanted = floor.hit({0, 0, 3}, Vector3d(0.8, 0, -0.6));
  ASSERT_TRUE(slanted);
  EXPECT_NEAR(slanted->distance, 5, 1e-5);
  EXPECT_FALSE(floor.hit({0, 0, 1}, {1, 0, 0})) << "level for ever";
  EXPECT_FALSE(floor.hit({0, 0, 1}, {0, 0, 1}));
  const auto from_below = floor.hit({0, 0, -2}, {0, 0, 1});
  ASSERT_TRUE(from_below);
  EXPECT_NEAR(from_below->distance, 2, 1e-6);
  EXPECT_LT(from_below->normal.z(), 0);
  const Plain none([](const Vector3d&) { return 1.0; }, Eigen::AlignedBox3d());
  EXPECT_FALSE(none.hit({0, 0, 0}, {1, 0, 0}));
}

// A wall thinner than the steps beside it is not stepped over.
TEST(ShapeRays, ThinBodiesAreNotSteppedOver) {
  const Vector3d half(1e-4, 5, 5);
  const auto sheet = [half](const Vector3d& p) {
    const Vector3d q = p.cwiseAbs() - half;
    return q.cwiseMax(0).norm() + std::min(q.maxCoeff(), 0.0);
  };
  const Plain wall(sheet, {-half, half});
  for (const double slope : {0.0, 0.3, 1.0, 2.0}) {
    const Vector3d way = Vector3d(1, slope, 0).normalized();
    const Vector3d from = -4 / way.x() * way;
    const auto hit = wall.hit(from, way);
    ASSERT_TRUE(hit) << slope;
    EXPECT_NEAR(hit->distance, (4 - 1e-4) / way.x(), 1e-5) << slope;
    EXPECT_NEAR(hit->normal.x(), -1, 1e-3);
    EXPECT_FALSE(wall.hit(from + Vector3d(0, 5.01, 0), way)) << "past its edge";
  }
}

TEST(Shapes, SayLittleOfThemselvesUnlessTheyKnowBetter) {
  const Egg egg;
  EXPECT_EQ(egg.reach(), kEndless);
  EXPECT_EQ(egg.rounding(), 0);
  EXPECT_FALSE(egg.convex()) << "nobody said so";
  EXPECT_TRUE(egg.solid());
  EXPECT_FALSE(egg.surrounds());
  EXPECT_FALSE(egg.simple_form());
}

}  // namespace
}  // namespace lapwing
