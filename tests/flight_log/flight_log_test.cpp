// SPDX-License-Identifier: Apache-2.0
#include "framework/flight_log/flight_log.h"

#include <gmock/gmock.h>

#include <cmath>

#include "framework/core/error.h"
#include "framework/flight_log/log_builder.h"
#include "framework/flight_log/log_time.h"

namespace lapwing {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(FlightLog, SeriesAreSortedAndWhatIsLeftOutIsSaid) {
  LogBuilder builder("test", 100);
  builder.add("position", 2, {2, 0, 0});
  builder.add("position", 1, {1, 0, 0});
  builder.add("position", 2, {9, 9, 9});
  builder.add("position", 3, {NAN, 0, 0});
  builder.add("position", INFINITY, {0, 0, 0});
  builder.add("yaw", NAN, {0});
  const FlightLog log = builder.finish();
  EXPECT_THAT(log.find("position")->times, ElementsAre(1, 2));
  EXPECT_THAT(log.find("position")->values, ElementsAre(1, 0, 0, 2, 0, 0));
  EXPECT_EQ(log.find("yaw"), nullptr);
  EXPECT_THAT(log.remarks,
              ElementsAre("'position': 2 samples not finite, 1 sample at a time that another has, "
                          "1 sample later in the file than in time",
                          "'yaw': 1 sample not finite"));
  EXPECT_TRUE(faults_of(log).empty());
}

TEST(FlightLog, WrongNamesAndWidthsAreDefects) {
  LogBuilder builder("test", 0);
  EXPECT_THROW(builder.add("speed", 0, {1}), Error);
  EXPECT_THROW(builder.add("position", 0, {1, 2}), Error);
}

TEST(FlightLog, FaultsAreFound) {
  FlightLog log;
  log.format = "test";
  log.series["position"] = {"", {0, 1, 1}, std::vector<double>(9, 0.0)};
  EXPECT_THAT(faults_of(log), ElementsAre(HasSubstr("times that do not rise, at sample 2")));
  log.series["position"] = {"", {0, 1}, std::vector<double>(5, 0.0)};
  EXPECT_THAT(faults_of(log), ElementsAre(HasSubstr("5 numbers for 2 samples of 3")));
  log.series["position"] = {"", {0, 1}, {0, 0, NAN, 0, 0, 0}};
  EXPECT_THAT(faults_of(log), ElementsAre(HasSubstr("not finite")));
  log.series.clear();
  log.series["nonsense"] = {"", {0}, {0}};
  EXPECT_THAT(faults_of(log), ElementsAre(HasSubstr("not a quantity")));
  log.series.clear();
  log.photographs = {2, 1};
  EXPECT_THAT(faults_of(log), ElementsAre(HasSubstr("photographs")));
}

TEST(LogTime, IsACalendarsInUtc) {
  EXPECT_EQ(utc_text(0), "1970-01-01 00:00:00.00 UTC");
  EXPECT_EQ(utc_text(1710000000.25), "2024-03-09 16:00:00.25 UTC");
  EXPECT_EQ(utc_text(1709251199.9996, 3), "2024-03-01 00:00:00.000 UTC") << "rounded over a day";
  EXPECT_EQ(utc_text(1709251199.4, 0), "2024-02-29 23:59:59 UTC");
  for (const double none : {-1.0, 1e18, static_cast<double>(NAN), static_cast<double>(INFINITY)})
    EXPECT_EQ(utc_text(none), "");
  FlightLog log;
  EXPECT_EQ(moment_in_words(log, 12.25), "12.25 s of the log");
  EXPECT_EQ(moment_in_words(log, 1.71e9, 1), "1710000000.0 s of the log");
  log.utc = 1710000000;
  EXPECT_EQ(moment_in_words(log, 0.5), "0.50 s of the log (2024-03-09 16:00:00.50 UTC)");
  log.utc = 0;
  EXPECT_EQ(moment_in_words(log, 1710000000.25), "2024-03-09 16:00:00.25 UTC");
}

TEST(FlightLog, ValuesBetweenSamples) {
  LogBuilder builder("test", 0);
  builder.add("position", 0, {0, 0, 0});
  builder.add("position", 1, {2, 4, 6});
  builder.add("position", 5, {0, 0, 0});
  builder.add("yaw", 0, {3});
  builder.add("yaw", 1, {-3});
  const FlightLog log = builder.finish();
  EXPECT_EQ(*value_at(log, "position", 0.5), Eigen::VectorXd(Eigen::Vector3d(1, 2, 3)));
  EXPECT_FALSE(value_at(log, "position", 3));  // a gap
  EXPECT_TRUE(value_at(log, "position", 5));
  EXPECT_FALSE(value_at(log, "position", -0.1));
  EXPECT_FALSE(value_at(log, "position", 5.1));
  EXPECT_FALSE(value_at(log, "velocity", 0.5));
  EXPECT_NEAR((*value_at(log, "yaw", 0.5))[0], M_PI, 1e-12);  // the shorter way
}

TEST(FlightLog, FramesOfAutopilots) {
  // Level and towards north: in the log's frame the body's x axis points along y.
  const Eigen::Vector4d north = orientation_of_euler(0, 0, 0);
  EXPECT_NEAR(north[0], std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(north[3], std::sqrt(0.5), 1e-12);
  // Nose up by 0.3 towards east: the x axis points up by 0.3.
  const Eigen::Vector4d q = orientation_of_euler(0, 0.3, M_PI / 2);
  const double x = 1 - 2 * (q[2] * q[2] + q[3] * q[3]), z = 2 * (q[1] * q[3] - q[0] * q[2]);
  EXPECT_NEAR(x, std::cos(0.3), 1e-12);
  EXPECT_NEAR(z, std::sin(0.3), 1e-12);
  EXPECT_NEAR(yaw_of_heading(0), M_PI / 2, 1e-12);
  EXPECT_NEAR(yaw_of_heading(M_PI / 2), 0, 1e-12);
}

TEST(FlightLog, OrientationsGiveAYaw) {
  LogBuilder builder("test", 0);
  const Eigen::Vector4d q = orientation_of_euler(0.1, -0.2, 1);
  builder.add("orientation", 0, {q.data(), 4});
  const FlightLog log = builder.finish();
  EXPECT_NEAR(log.find("yaw")->values[0], M_PI / 2 - 1, 1e-12);
}

}  // namespace
}  // namespace lapwing
