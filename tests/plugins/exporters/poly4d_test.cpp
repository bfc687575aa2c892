// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <sstream>

#include "framework/export/flown_comparison.h"
#include "framework/trajectory/interpolate.h"
#include "tests/obstacles.h"
#include "tests/plugins/exporters/placed_plan.h"

namespace lapwing {
namespace {

using testing::HasSubstr;
using testing::Not;

// Rows of numbers, whatever stands around them.
std::vector<std::vector<double>> csv_rows(const std::string& text) {
  std::vector<std::vector<double>> rows;
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    rows.emplace_back();
    std::istringstream words(line);
    for (std::string word; std::getline(words, word, ',');) rows.back().push_back(std::stod(word));
  }
  return rows;
}

double power_sum(const std::vector<double>& row, std::size_t axis, double t) {
  double sum = 0;
  for (std::size_t i = 0; i < 8; ++i)
    sum += row[1 + 8 * axis + i] * std::pow(t, static_cast<double>(i));
  return sum;
}

TEST(Poly4d, PiecesHoldTheTolerance) {
  const Plan plan = planned_camera();
  std::size_t before = 1000;
  for (const double tolerance : {1e-4, 1e-2}) {
    const auto rows = csv_rows(exporter_named("poly4d", with("tolerance", tolerance))->write(plan));
    EXPECT_LE(rows.size(), before);
    before = rows.size();
    double start = 0;
    for (const auto& row : rows) {
      ASSERT_EQ(row.size(), 33u);
      for (int i = 0; i <= 50; ++i) {
        const double t = row[0] * i / 50;
        const Sample s = sample_at(plan.trajectory, std::min(start + t, 2.03));
        const Eigen::Vector3d p(power_sum(row, 0, t), power_sum(row, 1, t), power_sum(row, 2, t));
        EXPECT_LT((p - s.position).norm(), tolerance);
        EXPECT_NEAR(power_sum(row, 3, t), s.yaw, 0.009);
      }
      start += row[0];
    }
    EXPECT_NEAR(start, 2.03, 1e-9);
  }
}

TEST(Poly4d, BothLayoutsHoldTheSameAndStateTheirError) {
  const Plan plan = planned_camera();
  const auto csv = exporter_named("poly4d"),
             yaml = exporter_named("poly4d", with("layout", "yaml"));
  EXPECT_EQ(csv->file_extension(), ".csv");
  EXPECT_EQ(yaml->file_extension(), ".yaml");
  EXPECT_EQ(csv->losses(plan, csv->write(plan)), yaml->losses(plan, yaml->write(plan)));
  EXPECT_THAT(yaml->write(plan), HasSubstr("# not certified\nsegments:\n  - N: 8\n    D: 4\n    "
                                           "time: "));
  std::string moved = csv->write(plan);
  moved.insert(moved.find('\n') + 1 + moved.substr(moved.find('\n') + 1).find(',') + 1, "9");
  EXPECT_NE(csv->losses(plan, moved), csv->losses(plan, csv->write(plan)));
  EXPECT_THROW(csv->losses(plan, "duration\n1,2\n"), InputError);
  Plan good = plan;
  good.certificate = with("feasible", true);
  EXPECT_THAT(csv->write(good), Not(HasSubstr("not certified")));
  EXPECT_THAT(csv->write(plan), HasSubstr("yaw^7,not certified\n"));
}

TEST(Poly4d, TheEvaluatedFlightIsJudged) {
  // Over a hill around a pole, whose shoulders a loose piece cuts.
  Plan plan = planned_camera();
  plan.environment.margin = 0.5;
  for (Sample& s : plan.trajectory.samples) {
    const double w = 2 * M_PI / 2.03, a = w * s.time;
    s.position = {s.time, 1 - std::cos(a), 3};
    s.velocity = {1, w * std::sin(a), 0};
    s.acceleration = {0, w * w * std::cos(a), 0};
    s.yaw = 0.1 * s.time;
    s.yaw_rate = 0.1;
  }
  plan.environment.obstacles = {sphere_at("pole", {1.015, 0.55, 3}, 0.1)};
  for (const char* layout : {"csv", "yaml"}) {
    Value given = with("layout", layout);
    const auto fine = exporter_named("poly4d", given);
    const FlownFile flown = *fine->flown(plan, fine->write(plan));
    EXPECT_NEAR(flown.trajectory.samples.back().time, 2.03, 1e-6);
    const FlownComparison kept = compare_flown(plan, flown, {});
    EXPECT_LT(kept.across, 0.006) << layout;
    EXPECT_TRUE(kept.refusals.empty()) << kept.refusals.front();
    EXPECT_FALSE(says(kept.sentences, "camera"));
    given.set("tolerance", 1.0);
    given.set("yaw_tolerance", 90.0);
    const auto loose = exporter_named("poly4d", given);
    const FlownComparison broken = compare_flown(plan, *loose->flown(plan, loose->write(plan)), {});
    EXPECT_GT(broken.across, 0.05);
    EXPECT_TRUE(says(broken.refusals, "flown so: clearance")) << layout;
    EXPECT_THROW(fine->flown(plan, "duration\n"), InputError);
  }
}

TEST(Poly4d, PiecesKeepTheLimitsThatThePlanKeeps) {
  // Sped up at 2 m/s^2 to the largest speed of climbing, and held there.
  Plan plan = planned_camera();
  const double most = vehicle_from_value(plan.vehicle).climb_speed_max;
  plan.trajectory.samples.clear();
  for (int i = 0; i <= 400; ++i) {
    const double t = 0.01 * i, turn = most / 2;
    Sample s;
    s.time = t;
    s.position.z() = t < turn ? t * t : turn * turn + most * (t - turn);
    s.velocity.z() = std::min(2 * t, most);
    s.acceleration.z() = t < turn ? 2 : 0;
    plan.trajectory.samples.push_back(s);
  }
  ASSERT_LT(most, 7);  // it is reached
  for (const double tolerance : {0.005, 0.1}) {
    const auto exporter = exporter_named("poly4d", with("tolerance", tolerance));
    const FlownComparison compared =
        compare_flown(plan, *exporter->flown(plan, exporter->write(plan)), {});
    EXPECT_TRUE(compared.refusals.empty()) << tolerance << compared.refusals.front();
  }
}

TEST(Poly4d, LimitsThatThePlanItselfPassesAreNoRefusal) {
  const Plan plan = planned_camera();
  ASSERT_LT(vehicle_from_value(plan.vehicle).yaw_rate_max, 3);  // it turns at 3 rad/s
  const auto exporter = exporter_named("poly4d");
  const FlownComparison compared =
      compare_flown(plan, *exporter->flown(plan, exporter->write(plan)), {});
  EXPECT_TRUE(compared.refusals.empty()) << compared.refusals.front();
}

TEST(Poly4d, PathsAreStraight) {
  Plan plan = planned_camera();
  plan.trajectory.motion = path_motion();
  const auto rows = csv_rows(exporter_named("poly4d")->write(plan));
  for (const auto& row : rows)
    for (std::size_t axis = 0; axis < 4; ++axis)
      for (std::size_t i = 2; i < 8; ++i) EXPECT_EQ(row[1 + 8 * axis + i], 0);
}

TEST(Poly4d, RefusesWhatItCannotHold) {
  Plan still = planned_camera();
  still.trajectory.samples.resize(1);
  EXPECT_THAT(refusal_of(*exporter_named("poly4d"), still), HasSubstr("has no length"));
  Plan lost = planned_camera();
  lost.trajectory.samples[4].position.z() = std::nan("");
  EXPECT_THAT(refusal_of(*exporter_named("poly4d"), lost), HasSubstr("finite numbers"));
  Plan jumpy = planned_camera();
  for (Sample& s : jumpy.trajectory.samples) s.acceleration.setConstant(1e4);
  EXPECT_THAT(refusal_of(*exporter_named("poly4d"), jumpy), HasSubstr("a larger `tolerance`"));
}

}  // namespace
}  // namespace lapwing
