// SPDX-License-Identifier: Apache-2.0
// The checks of shapes catch balls with one mistake each, and leave a sound one alone.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "framework/conformance/check.h"
#include "framework/core/error.h"
#include "framework/shape/shape.h"
#include "framework/shape/surfaces.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

enum class ShapeMistake {
  none,
  not_finite,
  other_without_gradient,
  gradient,
  too_steep,
  curvature,
  too_large,
  hollow,
  too_deep,
  ray_too_far,
  ray_normal,
  ray_misses,
  hole,
  surface_inside_out,
  surface_too_wide,
  box_too_small,
  convex,
  rounding,
  record,
  record_throws,
  throws,
  refuses,
};

TriangleMesh ball_surface(const Vector3d& center, double radius, double tolerance) {
  const int chords = chords_of(radius, tolerance / 2);
  std::vector<Eigen::Vector2d> profile;
  const int steps = (chords + 1) / 2;
  for (int k = 0; k <= steps; ++k) {
    const double angle = std::numbers::pi * k / steps;
    const double across = k == 0 || k == steps ? 0 : radius * std::sin(angle);
    profile.emplace_back(across, -radius * std::cos(angle));
  }
  return turned_surface(profile, chords, center);
}

class BrokenBall final : public Shape {
 public:
  static ParameterTable parameters() {
    return ParameterTable{}
        .required_numbers("center", 3, "m", "world", between(-1e6, 1e6))
        .required_number("radius", "m", "of the ball", between(0.1, 1e6));
  }
  BrokenBall(ShapeMistake mistake, const Parameters& parameters)
      : mistake_(mistake),
        center_(parameters.numbers("center").data()),
        radius_(parameters.number("radius")) {
    if (is(ShapeMistake::refuses)) throw InputError("a ball of this size will not do");
  }

  double rounding() const override { return is(ShapeMistake::rounding) ? -1 : 0; }

  double core_distance(const Vector3d& p, Vector3d* gradient) const override {
    if (is(ShapeMistake::throws) && p.x() > 5) throw std::runtime_error("no");
    const Vector3d away = p - center_;
    double told = away.norm() - radius_;
    double slope = 1;
    if (is(ShapeMistake::convex)) {  // a second ball, far enough to leave a gap
      const Vector3d other = away - Vector3d(0, 0, 2.5 * radius_);
      if (other.norm() < away.norm()) {
        if (gradient) *gradient = other.normalized();
        return other.norm() - radius_;
      }
    }
    if (is(ShapeMistake::hollow)) {
      slope = told < 0 ? -1 : 1;
      told = std::abs(told);
    }
    if (is(ShapeMistake::too_deep) && told < 0) slope = 1.2, told *= 1.2;
    if (is(ShapeMistake::too_steep) && told > 1) slope = 1.1, told += 0.1 * (told - 1);
    if (is(ShapeMistake::too_large)) told += 0.05;
    if (is(ShapeMistake::not_finite) && p.x() > 10) told = std::nan("");
    if (is(ShapeMistake::other_without_gradient) && !gradient) told -= 1e-9;
    if (gradient) *gradient = slope * away.normalized();
    if (gradient && is(ShapeMistake::gradient)) *gradient *= 0.99;
    return told - (is(ShapeMistake::rounding) ? 1 : 0);
  }

  Eigen::Matrix3d curvature(const Vector3d& p) const override {
    if (is(ShapeMistake::curvature)) return Eigen::Matrix3d::Zero();
    return Shape::curvature(p);
  }

  std::optional<SurfaceHit> hit(const Vector3d& origin, const Vector3d& way) const override {
    if (is(ShapeMistake::ray_misses)) return std::nullopt;
    std::optional<SurfaceHit> found = Shape::hit(origin, way);
    if (found && is(ShapeMistake::ray_too_far)) found->distance += 0.01;
    if (found && is(ShapeMistake::ray_normal)) found->normal *= -1;
    return found;
  }

  bool convex() const override { return true; }

  Eigen::AlignedBox3d bounds() const override {
    const double half = (is(ShapeMistake::box_too_small) ? 0.9 : 1.0) * radius_;
    Eigen::AlignedBox3d box(center_ - Vector3d::Constant(half), center_ + Vector3d::Constant(half));
    if (is(ShapeMistake::convex)) box.extend(box.max() + Vector3d(0, 0, 2.5 * radius_));
    return box;
  }

  TriangleMesh triangles(double tolerance, const Eigen::AlignedBox3d&) const override {
    const double wider = is(ShapeMistake::surface_too_wide) ? 0.02 : 0;
    TriangleMesh mesh = ball_surface(center_, radius_ + wider, tolerance);
    if (is(ShapeMistake::hole)) mesh.triangles.pop_back();
    if (is(ShapeMistake::surface_inside_out))
      for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
    if (!is(ShapeMistake::convex)) return mesh;
    const TriangleMesh other =
        ball_surface(center_ + Vector3d(0, 0, 2.5 * radius_), radius_, tolerance);
    const auto first = static_cast<int>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
    for (auto t : other.triangles)
      mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    return mesh;
  }

  Value record() const override {
    if (is(ShapeMistake::record_throws)) throw std::runtime_error("no");
    Value value = Value::map();
    value.set("center", Value(Value::List{center_.x(), center_.y(), center_.z()}));
    value.set("radius", radius_ + (is(ShapeMistake::record) ? 1e-6 : 0));
    return value;
  }

 private:
  bool is(ShapeMistake mistake) const { return mistake_ == mistake; }

  ShapeMistake mistake_;
  Vector3d center_;
  double radius_;
};

std::vector<CheckResult> judged_ball(ShapeMistake mistake, const CheckOptions& options = {}) {
  return check_shape_plugin({"ball", BrokenBall::parameters(),
                             [=](const Value& given) {
                               return std::make_unique<BrokenBall>(
                                   mistake, check(BrokenBall::parameters(), given));
                             }},
                            options);
}

// The names of the checks that fail, in order of the alphabet.
std::set<std::string> failed_checks(const std::vector<CheckResult>& results) {
  std::set<std::string> names;
  for (const CheckResult& result : results) {
    if (result.outcome != Outcome::failed) continue;
    EXPECT_FALSE(result.message.empty()) << result.name;
    names.insert(result.name);
  }
  return names;
}

TEST(BrokenShape, TheSoundOnePassesEveryCheck) {
  std::set<std::string> passed;
  for (const CheckResult& result : judged_ball(ShapeMistake::none)) {
    EXPECT_EQ(result.outcome, Outcome::passed) << result.name << ": " << result.message;
    passed.insert(result.name);
  }
  for (const char* name :
       {"creation", "exceptions", "values", "gradient", "curvature", "sign", "never too large",
        "depth", "rays", "surface", "bounds", "convex", "record"})
    EXPECT_TRUE(passed.contains(name)) << name;
}

struct Caught {
  ShapeMistake mistake;
  const char* by;     // the check that is meant for it
  bool alone = true;  // whether no other sees it
};

class BrokenShapeMistakes : public ::testing::TestWithParam<Caught> {};

TEST_P(BrokenShapeMistakes, FailTheirOwnCheck) {
  const Caught& caught = GetParam();
  const std::set<std::string> failed = failed_checks(judged_ball(caught.mistake));
  if (caught.alone)
    EXPECT_EQ(failed, std::set<std::string>{caught.by});
  else
    EXPECT_TRUE(failed.contains(caught.by));
}

INSTANTIATE_TEST_SUITE_P(
    Balls, BrokenShapeMistakes,
    ::testing::Values(
        Caught{ShapeMistake::other_without_gradient, "values"},
        Caught{ShapeMistake::rounding, "values"}, Caught{ShapeMistake::gradient, "gradient"},
        Caught{ShapeMistake::curvature, "curvature"}, Caught{ShapeMistake::ray_too_far, "rays"},
        Caught{ShapeMistake::ray_normal, "rays"}, Caught{ShapeMistake::ray_misses, "rays"},
        Caught{ShapeMistake::hole, "surface"}, Caught{ShapeMistake::convex, "convex"},
        Caught{ShapeMistake::record, "record"}, Caught{ShapeMistake::record_throws, "exceptions"},
        Caught{ShapeMistake::throws, "exceptions"}, Caught{ShapeMistake::refuses, "creation"},
        Caught{ShapeMistake::not_finite, "values", false},
        Caught{ShapeMistake::too_steep, "gradient", false},
        Caught{ShapeMistake::too_large, "never too large", false},
        Caught{ShapeMistake::hollow, "sign", false}, Caught{ShapeMistake::too_deep, "depth", false},
        Caught{ShapeMistake::surface_inside_out, "sign", false},
        Caught{ShapeMistake::surface_too_wide, "surface", false},
        Caught{ShapeMistake::box_too_small, "bounds", false}));

// Asked for alone, a check finds the same, and nothing else is noted.
TEST(BrokenShape, ChecksCanBeMadeOneByOne) {
  for (const auto& [mistake, name] : std::initializer_list<std::pair<ShapeMistake, const char*>>{
           {ShapeMistake::record, "record"}, {ShapeMistake::convex, "convex"}}) {
    CheckOptions options;
    options.only = {name};
    EXPECT_EQ(failed_checks(judged_ball(mistake, options)), std::set<std::string>{name});
  }
  CheckOptions options;
  options.only = {"convex"};
  EXPECT_EQ(failed_checks(judged_ball(ShapeMistake::curvature, options)), std::set<std::string>{});
}

TEST(BrokenShape, MessagesNamePlaceAndNumbers) {
  for (const CheckResult& result : judged_ball(ShapeMistake::gradient)) {
    if (result.name != "gradient") continue;
    EXPECT_NE(result.message.find("at ("), std::string::npos) << result.message;
    EXPECT_NE(result.message.find("differences say"), std::string::npos) << result.message;
  }
  for (const CheckResult& result : judged_ball(ShapeMistake::refuses))
    EXPECT_NE(result.message.find("a ball of this size will not do"), std::string::npos);
}

// A shape of a file that is not at hand is skipped, with the reason.
class OfAFile final : public Shape {
 public:
  void open(ShapeSetting& setting) override { setting.find("x", "pictures"); }
  double core_distance(const Vector3d&, Vector3d*) const override { return 0; }
  Eigen::AlignedBox3d bounds() const override { return {}; }
  TriangleMesh triangles(double, const Eigen::AlignedBox3d&) const override { return {}; }
  Value record() const override { return Value::map(); }
};

TEST(BrokenShape, OneWithoutItsFileIsSkipped) {
  const auto results = check_shape_plugin(
      {"of_a_file", {}, [](const Value&) { return std::make_unique<OfAFile>(); }});
  ASSERT_EQ(results.size(), 1u);
  EXPECT_EQ(results[0].outcome, Outcome::skipped);
  EXPECT_NE(results[0].message.find("pictures"), std::string::npos) << results[0].message;
}

}  // namespace
}  // namespace lapwing
