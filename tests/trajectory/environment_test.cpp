// SPDX-License-Identifier: Apache-2.0
// What surrounds a flight: moves of subjects and obstacles, the nearest of them, and their names.
#include "framework/trajectory/environment.h"

#include <gtest/gtest.h>

#include "framework/core/json.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

// A ball as a shape.
class PlainBall final : public Shape {
 public:
  PlainBall(const Vector3d& center, double radius) : center_(center), radius_(radius) {}
  double core_distance(const Vector3d& p, Vector3d* gradient) const override {
    if (gradient) *gradient = (p - center_).normalized();
    return (p - center_).norm();
  }
  double rounding() const override { return radius_; }
  Eigen::AlignedBox3d bounds() const override { return {center_, center_}; }
  TriangleMesh triangles(double, const Eigen::AlignedBox3d&) const override { return {}; }
  Value record() const override { return Value::map(); }

 private:
  Vector3d center_;
  double radius_;
};

Obstacle ball(const std::string& name, const Vector3d& center, double radius) {
  Obstacle obstacle;
  obstacle.name = name;
  obstacle.type = "sphere";
  obstacle.shape = std::make_shared<PlainBall>(center, radius);
  return obstacle;
}

TEST(Environment, TracksAreStraightBetweenTheirTimes) {
  Subject walker;
  walker.times = {1, 3, 4};
  walker.positions = {{0, 0, 0}, {4, 2, 0}, {4, 2, 6}};
  for (const auto& [time, place] :
       std::initializer_list<std::pair<double, Vector3d>>{{-5, {0, 0, 0}},
                                                          {1, {0, 0, 0}},
                                                          {2, {2, 1, 0}},
                                                          {3, {4, 2, 0}},
                                                          {3.25, {4, 2, 1.5}},
                                                          {4, {4, 2, 6}},
                                                          {99, {4, 2, 6}}})
    EXPECT_LT((walker.position(time) - place).norm(), 1e-12) << time;
  Obstacle gate;
  EXPECT_EQ(gate.moved(7), Vector3d(0, 0, 0)) << "stands still";
  EXPECT_EQ(gate.speed(), 0);
  gate.times = walker.times;
  gate.moves = walker.positions;
  EXPECT_LT((gate.moved(2) - Vector3d(2, 1, 0)).norm(), 1e-12);
  EXPECT_DOUBLE_EQ(gate.speed(), 6) << "the fastest of its pieces";
  gate.times = {5};
  gate.moves = {{1, 2, 3}};
  EXPECT_EQ(gate.moved(0), Vector3d(1, 2, 3));
  EXPECT_EQ(gate.speed(), 0);
}

TEST(Environment, TheNearestObstacleIsNamed) {
  Environment environment;
  environment.obstacles = {ball("", {10, 0, 0}, 1), ball("tree", {0, 5, 0}, 2),
                           ball("", {0, 0, 9}, 1)};
  NearestObstacle nearest = nearest_obstacle(environment, {0, 0, 0});
  EXPECT_DOUBLE_EQ(nearest.distance, 3);
  EXPECT_EQ(nearest.name, "tree");
  nearest = nearest_obstacle(environment, {0, -9, 8});
  EXPECT_EQ(nearest.name, "sphere 3") << "its number among those of its type";
  nearest = nearest_obstacle(environment, {0, 5.5, 0});
  EXPECT_DOUBLE_EQ(nearest.distance, -1.5) << "inside";
  EXPECT_TRUE(std::isinf(nearest_obstacle({}, {0, 0, 0}).distance));
  EXPECT_EQ(nearest_obstacle({}, {0, 0, 0}).name, "");
  // Without a shape there is nothing to measure, but it counts.
  environment.obstacles[0].shape = nullptr;
  EXPECT_EQ(nearest_obstacle(environment, {0, 0, 8}).name, "sphere 3");
}

TEST(Environment, MovingObstaclesAreWhereTheyAre) {
  Environment environment;
  environment.obstacles = {ball("car", {0, 0, 0}, 1)};
  environment.obstacles[0].times = {0, 10};
  environment.obstacles[0].moves = {{0, 0, 0}, {20, 0, 0}};
  for (const double time : {0.0, 2.5, 10.0, 50.0})
    EXPECT_NEAR(nearest_obstacle(environment, {20, 3, 0}, time).distance,
                std::hypot(20 - 2 * std::min(time, 10.0), 3) - 1, 1e-12);
}

// What the flight stays inside of is measured the other way round, and apart from the others.
TEST(Environment, InsideIsMeasuredFromTheInside) {
  Environment environment;
  environment.obstacles = {ball("park", {0, 0, 0}, 10), ball("tree", {3, 0, 0}, 1)};
  environment.obstacles[0].side = Side::keep_inside;
  EXPECT_DOUBLE_EQ(least_inside(environment, {4, 0, 0}).distance, 6);
  EXPECT_DOUBLE_EQ(least_inside(environment, {12, 0, 0}).distance, -2) << "outside of it";
  EXPECT_EQ(least_inside(environment, {4, 0, 0}).name, "park");
  EXPECT_EQ(nearest_obstacle(environment, {4, 0, 0}).name, "tree");
}

TEST(Environment, LabelsSayWhatItIs) {
  Obstacle obstacle;
  obstacle.type = "sphere";
  EXPECT_EQ(obstacle.label(2), "sphere 2");
  obstacle.name = "tree";
  EXPECT_EQ(obstacle.label(2), "sphere 'tree'");
  obstacle.type = "prism";
  EXPECT_EQ(obstacle.label(2), "zone 'tree'");
  obstacle.side = Side::keep_inside;
  EXPECT_EQ(obstacle.label(2), "flight zone 'tree'");
  obstacle.type = "sphere";
  obstacle.name = "";
  EXPECT_EQ(obstacle.label(1), "inside of sphere 1");
}

TEST(Environment, ObstaclesAreFoundByTypeAndName) {
  Environment environment;
  environment.obstacles = {ball("a", {0, 0, 0}, 1), ball("b", {0, 0, 0}, 2)};
  EXPECT_EQ(find_obstacle(environment, "sphere", "b"), &environment.obstacles[1]);
  EXPECT_EQ(find_obstacle(environment, "box", "b"), nullptr);
  EXPECT_EQ(find_obstacle(environment, "sphere", ""), nullptr);
}

TEST(Environment, RecordedNumbersAreNumbersOrNothing) {
  const Value value = from_json(
      R"({"good": [1, 2.5, -3], "mixed": [1, "2"], "one": 4, "empty": [], "deep": [[1]]})",
      "record");
  EXPECT_EQ(recorded_numbers(value, "good"), (std::vector<double>{1, 2.5, -3}));
  for (const char* key : {"mixed", "one", "empty", "deep", "absent"})
    EXPECT_TRUE(recorded_numbers(value, key).empty()) << key;
  EXPECT_TRUE(recorded_numbers(Value(3.0), "good").empty());
}

}  // namespace
}  // namespace lapwing
