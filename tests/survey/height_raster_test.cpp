// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/survey/height_raster.h"
#include "tests/survey/made_rasters.h"
#include "tests/tool.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class HeightRaster : public testing::Test {
 protected:
  void SetUp() override {
    if (!rasters_available()) GTEST_SKIP() << "Lapwing was built without libgdal-dev";
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path written(const std::string& name, const std::string& bytes) const {
    write_file_atomically(folder_ / name, bytes);
    return folder_ / name;
  }
  static std::string refusal(const fs::path& file) {
    try {
      const RasterInfo info = raster_info(file);
      raster_values(file, {0, 0, info.width, info.height});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  const fs::path folder_ =
      fs::path(testing::TempDir()) / ("lapwing_rasters_" + std::to_string(::getpid()));
};

MadeRaster house_raster() {
  MadeRaster made;
  made.left = -20;
  made.upper = 20;
  made.height_at = house_height;
  return made;
}

TEST_F(HeightRaster, ValuesPlaceAndSystem) {
  MadeRaster made = house_raster();
  made.system = 28992;
  const fs::path file = written("house.tif", tiff_bytes(made));
  const RasterInfo info = raster_info(file);
  EXPECT_EQ(info.format, "GeoTIFF");
  EXPECT_EQ(info.width, 40);
  EXPECT_EQ(info.height, 40);
  EXPECT_EQ(info.system, "EPSG:28992");
  EXPECT_FLOAT_EQ(static_cast<float>(info.lowest), -1.95f);
  const std::vector<float> values = raster_values(file, {10, 2, 20, 30});
  for (int row = 0; row < 30; ++row)
    for (int column = 0; column < 20; ++column) {
      const Eigen::Vector2d p =
          info.to_coordinates * Eigen::Vector2d(10 + column + 0.5, 2 + row + 0.5);
      const float z = values[static_cast<std::size_t>(20 * row + column)];
      EXPECT_EQ(z, house_height(p.x(), p.y())) << p.transpose();
    }
  EXPECT_TRUE(std::isnan(raster_values(file, {39, 0, 1, 1}).at(0))) << "no data";
  EXPECT_THROW(raster_values(file, {30, 0, 11, 1}), InputError);
}

// GDAL's own program reads the same at places of the world.
TEST_F(HeightRaster, AsGdallocationinfo) {
  if (tool_on_path({"gdallocationinfo"}).empty())
    GTEST_SKIP() << "no gdallocationinfo: apt-get install gdal-bin";
  const fs::path file = written("house.tif", tiff_bytes(house_raster()));
  const RasterInfo info = raster_info(file);
  for (const auto& [x, y] : {std::pair{0.5, 0.5}, {-11.5, 7.5}, {3.5, -4.5}}) {
    const fs::path answer = folder_ / "answer";
    const std::string command = "gdallocationinfo -valonly -geoloc '" + file.string() + "' " +
                                std::to_string(x) + " " + std::to_string(y) + " > '" +
                                answer.string() + "'";
    ASSERT_EQ(std::system(command.c_str()), 0);
    const Eigen::Vector2d pixel = info.to_coordinates.inverse() * Eigen::Vector2d(x, y);
    const float z =
        raster_values(file, {static_cast<int>(pixel.x()), static_cast<int>(pixel.y()), 1, 1}).at(0);
    EXPECT_NEAR(std::stod(read_file(answer)), static_cast<double>(z), 1e-6);
  }
}

TEST_F(HeightRaster, AsciiGrids) {
  const fs::path file =
      written("g.asc",
              "ncols 3\nnrows 2\nxllcorner 100\nyllcorner 200\ncellsize 2\nNODATA_value -1\n"
              "1 2 3\n4 -1 6\n");
  const RasterInfo info = raster_info(file);
  EXPECT_EQ(info.system, "");
  EXPECT_TRUE((info.to_coordinates * Eigen::Vector2d(0, 0)).isApprox(Eigen::Vector2d(100, 204)));
  const std::vector<float> values = raster_values(file, {0, 0, 3, 2});
  EXPECT_EQ(values[2], 3);
  EXPECT_TRUE(std::isnan(values[4]));
}

TEST_F(HeightRaster, WhatIsWrongIsSaid) {
  MadeRaster made = house_raster();
  made.placed = false;
  EXPECT_THAT(refusal(written("a.tif", tiff_bytes(made))),
              AllOf(HasSubstr("a.tif'"), HasSubstr("no georeferencing"), HasSubstr("-a_ullr")));
  const std::string whole = tiff_bytes(house_raster());
  EXPECT_THAT(refusal(written("words.tif", "not a raster")), HasSubstr("expected a GeoTIFF"));
  EXPECT_THAT(refusal(written("short.tif", whole.substr(0, 2000))), HasSubstr("short.tif'"));
  made = house_raster();
  made.height_at = [](double, double) { return std::nanf(""); };
  EXPECT_THAT(refusal(written("b.tif", tiff_bytes(made))),
              HasSubstr("none of its pixels has data"));
  EXPECT_THAT(refusal(folder_ / "none.tif"), HasSubstr("no file"));
  // A strip that reaches beyond the end of the file.
  std::string cut = whole;
  cut.replace(cut.find(std::string("\x11\x01\x04\x00\x01\x00\x00\x00", 8)) + 8, 4,
              std::string("\x00\xff\xff\x00", 4));
  EXPECT_THAT(refusal(written("c.tif", cut)), HasSubstr("damaged or cut short"));
}

TEST(Rasters, WithoutGdalTheyNameThePackage) {
  if (rasters_available()) GTEST_SKIP() << "Lapwing was built with libgdal-dev";
  try {
    raster_info("a.tif");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("a.tif"), HasSubstr("libgdal-dev")));
  }
}

}  // namespace
}  // namespace lapwing
