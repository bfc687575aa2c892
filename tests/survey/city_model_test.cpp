// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/survey/city_model.h"
#include "tests/survey/made_cities.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;

class CityModels : public testing::Test {
 protected:
  void SetUp() override {
    if (!city_models_available()) GTEST_SKIP() << "Lapwing was built without libcitygml-dev";
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  CityModel read(const std::string& text) const {
    write_file_atomically(folder_ / "town.gml", text);
    return read_city_model(folder_ / "town.gml");
  }
  std::string refusal(const std::string& text) const {
    try {
      read(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  static double area(const CityModel& model) {
    double sum = 0;
    for (std::size_t i = 0; i < model.mesh.triangles.size(); ++i) sum += model.mesh.area(i);
    return sum;
  }
  // By the divergence theorem; right where all triangles face outwards.
  static double volume(const CityModel& model) {
    double sum = 0;
    for (std::size_t i = 0; i < model.mesh.triangles.size(); ++i) {
      const Vector3d across = model.mesh.corner(i, 1).cross(model.mesh.corner(i, 2));
      sum += model.mesh.corner(i, 0).dot(across) / 6;
    }
    return sum;
  }

  const fs::path folder_ =
      fs::path(testing::TempDir()) / ("lapwing_cities_" + std::to_string(::getpid()));
};

const Vector3d kLow(2, 3, 1), kHigh(8, 7, 5);

TEST_F(CityModels, ABoxHasItsAreaItsVolumeAndItsSystem) {
  const CityModel model =
      read(city_gml(gml_building(gml_solid(1, gml_box(kLow, kHigh))), "EPSG:28992"));
  EXPECT_NEAR(area(model), 2 * (6 * 4 + 6 * 4 + 4 * 4), 1e-9);
  EXPECT_NEAR(volume(model), 6 * 4 * 4, 1e-9);
  EXPECT_EQ(model.mesh.bounds().min(), kLow);
  EXPECT_EQ(model.mesh.bounds().max(), kHigh);
  EXPECT_EQ(model.system, "EPSG:28992");
  EXPECT_EQ(model.objects, (std::map<int, std::size_t>{{1, 1}}));
}

// Real coordinates lose nothing: 455,000 m north.
TEST_F(CityModels, LargeCoordinatesAreExact) {
  const Vector3d far(84000.125, 447000.375, 0);
  const CityModel model =
      read(city_gml(gml_building(gml_solid(1, gml_box(far + kLow, far + kHigh)))));
  EXPECT_EQ(model.mesh.bounds().min(), far + kLow);
  EXPECT_EQ(model.system, "");
}

TEST_F(CityModels, OfAnObjectTheFinestLevelCounts) {
  // Level 1: a box. Level 2: a wall with a hole, as boundary surface.
  const CityRing wall{{0, 0, 0}, {10, 0, 0}, {10, 0, 6}, {0, 0, 6}};
  const CityRing hole{{2, 0, 2}, {2, 0, 4}, {5, 0, 4}, {5, 0, 2}};
  const std::string both =
      gml_solid(1, gml_box(kLow, kHigh)) + gml_boundary("WallSurface", gml_surface({wall, hole}));
  const CityModel model = read(city_gml(gml_building(both)));
  EXPECT_NEAR(area(model), 10 * 6 - 3 * 2, 1e-9);
  EXPECT_EQ(model.objects, (std::map<int, std::size_t>{{2, 1}}));
  // Of another building level 1 is the finest.
  const CityModel two =
      read(city_gml(gml_building(both) + gml_building(gml_solid(1, gml_box(kLow, kHigh)))));
  EXPECT_NEAR(area(two), 54 + 128, 1e-9);
  EXPECT_EQ(two.objects, (std::map<int, std::size_t>{{1, 1}, {2, 1}}));
}

TEST_F(CityModels, PartsHaveTheirOwnLevels) {
  const std::string part = "<bldg:consistsOfBuildingPart><bldg:BuildingPart>" +
                           gml_solid(1, gml_box(kLow, kHigh)) +
                           "</bldg:BuildingPart></bldg:consistsOfBuildingPart>";
  const CityRing roof{{0, 0, 6}, {10, 0, 6}, {10, 10, 6}, {0, 10, 6}};
  const CityModel model =
      read(city_gml(gml_building(gml_boundary("RoofSurface", gml_surface({roof})) + part)));
  EXPECT_NEAR(area(model), 100 + 128, 1e-9);
}

TEST_F(CityModels, SurfaceThatIsNotThereIsLeftOut) {
  const CityRing wall{{0, 0, 0}, {10, 0, 0}, {10, 0, 6}, {0, 0, 6}};
  const CityModel model =
      read(city_gml(gml_building(gml_boundary("WallSurface", gml_surface({wall})) +
                                 gml_boundary("ClosureSurface", gml_surface({wall})))));
  EXPECT_NEAR(area(model), 60, 1e-9);
}

TEST_F(CityModels, HostileFilesAreOneMessage) {
  const std::string whole = city_gml(gml_building(gml_solid(1, gml_box(kLow, kHigh))));
  const std::string half = whole.substr(0, whole.size() / 2);
  EXPECT_THAT(refusal(half), HasSubstr("its XML is damaged or cut short"));
  EXPECT_THAT(refusal("this is no XML"), HasSubstr("it is no CityGML that can be read"));
  EXPECT_THAT(refusal(""), HasSubstr("it is no CityGML that can be read"));
  EXPECT_THAT(refusal("<?xml version=\"1.0\"?><kml><Document/></kml>"),
              HasSubstr("town.gml': it "));
  EXPECT_THAT(refusal(city_gml("")), HasSubstr("it has no surface"));
  EXPECT_THAT(refusal(city_gml(gml_building(""))), HasSubstr("it has no surface"));
  const CityRing nothing{{0, 0, std::nan("")}, {10, 0, 0}, {10, 0, 6}};
  EXPECT_NE(refusal(city_gml(gml_building(gml_solid(1, gml_surface({nothing}))))), "");
}

TEST(CityModelNames, AreKnownByTheirEnding) {
  EXPECT_TRUE(is_city_model("a/b/town.gml"));
  EXPECT_TRUE(is_city_model("town.CityGML"));
  EXPECT_FALSE(is_city_model("town.obj"));
}

TEST(CityModelPrograms, WithoutThemThePackageIsNamed) {
  if (city_models_available()) GTEST_SKIP() << "Lapwing was built with libcitygml-dev";
  try {
    read_city_model("a.gml");
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("a.gml"), HasSubstr("libcitygml-dev")));
  }
}

}  // namespace
}  // namespace lapwing
