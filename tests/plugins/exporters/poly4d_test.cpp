// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <sstream>

#include "framework/trajectory/interpolate.h"
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
