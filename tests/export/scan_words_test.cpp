// SPDX-License-Identifier: Apache-2.0
// What is said of a scan's coverage.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "framework/export/scan_report.h"

namespace lapwing {
namespace {

using testing::HasSubstr;
using testing::Not;

ScanRecord record_with(std::vector<Opening> openings) {
  ScanRecord record;
  record.candidates.resize(40);
  record.areas = {.known = 1000, .visible = 990, .seen = 900};
  record.openings = std::move(openings);
  record.body_width = 2;
  return record;
}

TEST(ScanWords, TheUnknownIsALowerBoundRoundedDown) {
  const ScanRecord record =
      record_with({{47.96, {1, -2.04, 30.06}, false, {}}, {21.99, {4, 5, -0.01}, false, {}}});
  EXPECT_EQ(areas_in_words(record),
            "surface: the tour sees 90 % of the 1000 m^2 that are known; 99 % are visible from any "
            "of the 40 candidate views; unknown and not counted: at least 69 m^2, behind "
            "2 openings, the largest of 47 m^2 at (1.0, -2.0, 30.1)");
  const Value value = areas_as_value(record);
  EXPECT_DOUBLE_EQ(value.at("unknown").as_number(), 47.96 + 21.99);
  EXPECT_DOUBLE_EQ(value.at("largest_opening").at("area").as_number(), 47.96);
  EXPECT_THAT(areas_in_words(record_with({{0.314, {0, 0, -0.01}, false, {}}})),
              HasSubstr("at least 0.31 m^2, behind an opening of 0.31 m^2 at (0.0, 0.0, 0.0)"));
  EXPECT_THAT(areas_in_words(record_with({})),
              HasSubstr("unknown and not counted: none was found"));
}

TEST(ScanWords, MuchOfItAndAnOpeningThatAVehiclePassesAreWarnedOf) {
  const std::string much = areas_in_words(record_with({{134, {1, 2, 3}, false, {}}}));
  EXPECT_THAT(much, HasSubstr("at least 130 m^2"));
  EXPECT_THAT(
      much,
      HasSubstr("This is a large share: the first flight did not see behind it. Fly the first"));
  EXPECT_THAT(much, Not(HasSubstr("The vehicle")));
  ScanRecord surveyed = record_with({{134, {1, 2, 3}, false, {}}});
  surveyed.surveyed = true;
  EXPECT_THAT(areas_in_words(surveyed), HasSubstr("the data do not show what is behind it. Data"));
  EXPECT_THAT(areas_in_words(surveyed), Not(HasSubstr("first flight")));
  // Far less than a tenth, and a vehicle's width.
  const std::string open = areas_in_words(record_with({{9, {1, 2, 3}, true, {}}}));
  EXPECT_THAT(open, HasSubstr("The vehicle (2 m wide) would pass through the largest opening"));
  EXPECT_THAT(open, Not(HasSubstr("This is a large share")));
  EXPECT_THAT(areas_in_words(record_with({{20, {1, 2, 3}, false, {}}, {9, {4, 5, 6}, true, {}}})),
              HasSubstr("would pass through the opening of 9 m^2 at (4.0, 5.0, 6.0)"));
}

}  // namespace
}  // namespace lapwing
