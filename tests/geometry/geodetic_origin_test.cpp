// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "framework/core/error.h"
#include "framework/geometry/geodetic_origin.h"

namespace lapwing {
namespace {

using testing::HasSubstr;

std::string refusal_of(double latitude, double longitude, double height, HeightOf reference) {
  try {
    stated_origin(latitude, longitude, height, reference);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// A model of the geoid in the format of GeographicLib: north to south by 10 degrees, the height
// 47.5 m at every node but those of the equator, where it is -20 m.
class GeoidFolder {
 public:
  GeoidFolder() : folder_(std::filesystem::temp_directory_path() / "lapwing_geoid") {
    std::filesystem::create_directories(folder_);
    std::ofstream file(folder_ / "own.pgm", std::ios::binary);
    file << "P5\n# Offset -108\n# Scale 0.003\n36 19\n65535\n";
    for (int row = 0; row < 19; ++row)
      for (int column = 0; column < 36; ++column) {
        const int number = static_cast<int>(((row == 9 ? -20 : 47.5) + 108) / 0.003 + 0.5);
        file.put(static_cast<char>(number >> 8)).put(static_cast<char>(number & 255));
      }
    file.close();
    setenv("GEOGRAPHICLIB_GEOID_PATH", folder_.c_str(), 1);
    setenv("GEOGRAPHICLIB_GEOID_NAME", "own", 1);
  }
  ~GeoidFolder() {
    unsetenv("GEOGRAPHICLIB_GEOID_PATH");
    unsetenv("GEOGRAPHICLIB_GEOID_NAME");
    std::filesystem::remove_all(folder_);
  }

 private:
  std::filesystem::path folder_;
};

TEST(GeodeticOrigin, AltitudeIsThatAboveTheEllipsoid) {
  EXPECT_EQ(stated_origin(46.5, 6.6, 400, HeightOf::ellipsoid).altitude(), 400);
  EXPECT_FALSE(stated_origin(46.5, 6.6, 2, HeightOf::ground).altitude());
  const GeoidFolder geoid;
  EXPECT_NEAR(*stated_origin(46.5, 6.6, 400, HeightOf::sea).altitude(), 447.5, 0.01);
  EXPECT_NEAR(geoid_height_at(46.5, 6.6, "origin"), 47.5, 0.01);
  EXPECT_NEAR(geoid_height_at(0, 30, "origin"), -20, 0.01);
}

TEST(GeodeticOrigin, HeightsAboveTheSeaSayHowToInstallAGeoid) {
  setenv("GEOGRAPHICLIB_GEOID_PATH", "/nowhere", 1);
  const std::string message = refusal_of(46.5, 6.6, 400, HeightOf::sea);
  unsetenv("GEOGRAPHICLIB_GEOID_PATH");
  EXPECT_THAT(message, HasSubstr("origin.height_of: heights above the sea"));
  EXPECT_THAT(message, HasSubstr("/nowhere"));
  EXPECT_THAT(message, HasSubstr("apt-get install geographiclib-tools"));
  EXPECT_THAT(message, HasSubstr("geographiclib-get-geoids minimal"));
}

TEST(GeodeticOrigin, ImplausibleFiguresAreRefusedByTheirKey) {
  const HeightOf ellipsoid = HeightOf::ellipsoid;
  EXPECT_EQ(refusal_of(46.5, 6.6, 400, ellipsoid), "");
  EXPECT_THAT(refusal_of(146.5, 6.6, 400, ellipsoid),
              HasSubstr("origin.latitude_deg: expected degrees north between -90 and 90, got 146"));
  EXPECT_THAT(refusal_of(46.5, 206.6, 400, ellipsoid), HasSubstr("origin.longitude_deg"));
  EXPECT_THAT(refusal_of(0, 0, 400, ellipsoid), HasSubstr("Gulf of Guinea"));
  EXPECT_THAT(refusal_of(46.5, 6.6, 40000, ellipsoid),
              HasSubstr("origin.height: expected m above the ellipsoid between -500 and 9000"));
  EXPECT_THAT(refusal_of(46.5, 6.6, 2000, HeightOf::ground),
              HasSubstr("above the ground between -100 and 1000"));
  for (const double bad : {std::nan(""), double(INFINITY)}) {
    EXPECT_NE(refusal_of(bad, 6.6, 400, ellipsoid), "");
    EXPECT_NE(refusal_of(46.5, bad, 400, ellipsoid), "");
    EXPECT_NE(refusal_of(46.5, 6.6, bad, ellipsoid), "");
  }
}

TEST(GeodeticOrigin, WordsOfHeights) {
  for (const HeightOf reference : {HeightOf::ellipsoid, HeightOf::sea, HeightOf::ground})
    EXPECT_EQ(height_of_named(to_string(reference)), reference);
  EXPECT_FALSE(height_of_named("AMSL"));
}

}  // namespace
}  // namespace lapwing
