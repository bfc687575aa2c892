// SPDX-License-Identifier: Apache-2.0
// What is solid under a raster of heights: never lower than the surface, however narrow a wall is.
#include "framework/mission/site_terrain.h"

#include <filesystem>

#include <gtest/gtest.h>
#include <unistd.h>

#include "framework/core/files.h"
#include "framework/survey/height_raster.h"
#include "tests/survey/made_rasters.h"

namespace lapwing {
namespace {

using Eigen::Vector2d;

class SiteTerrain : public testing::Test {
 protected:
  SiteTerrain()
      : folder_(std::filesystem::temp_directory_path() /
                ("lapwing_terrain_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~SiteTerrain() override { std::filesystem::remove_all(folder_); }

  Site site_of(const MadeRaster& raster, double resolution) const {
    write_file_atomically(folder_ / "surface.tif", tiff_bytes(raster));
    TerrainRequest request;
    request.surface = folder_ / "surface.tif";
    request.surface_name = "surface.tif";
    request.reference.option = "terrain";
    request.resolution = resolution;
    request.cell = resolution;
    return read_site_terrain(request, {});
  }

  std::filesystem::path folder_;
};

// Walls of 5 m, one pixel wide, on flat ground: along the rows, along the columns and one pixel
// alone. The crest of each is solid at 5 m for pixels smaller and larger than the voxels.
TEST_F(SiteTerrain, WallsOnePixelWideStaySolid) {
  if (!rasters_available()) GTEST_SKIP() << "Lapwing was built without libgdal-dev";
  for (const double pixel : {0.1, 0.25, 0.5, 1.0, 1.7}) {
    constexpr double kResolution = 0.5, kHeight = 5.2;
    MadeRaster raster{.width = 60, .height = 60, .left = 0, .upper = 60 * pixel, .pixel = pixel};
    const auto middle = [&](int k) { return (k + 0.5) * pixel; };
    const auto is = [&](double x, int k) { return std::abs(x - middle(k)) < 0.1 * pixel; };
    raster.height_at = [&](double x, double y) {
      const bool alone = is(x, 45) && is(y, 45);
      return static_cast<float>(is(x, 17) || is(y, 33) || alone ? kHeight : 0);
    };
    const Site site = site_of(raster, kResolution);
    ASSERT_TRUE(site.solid);
    const VoxelGrid grid(kResolution);
    const auto top = [&](double x, double y) {
      return site.solid->top(grid.index(x), grid.index(y));
    };
    for (double along = middle(2); along < middle(57); along += 0.07) {
      EXPECT_EQ(top(middle(17), along), grid.index(kHeight)) << pixel << " at y " << along;
      EXPECT_EQ(top(along, middle(33)), grid.index(kHeight)) << pixel << " at x " << along;
    }
    EXPECT_EQ(top(middle(45), middle(45)), grid.index(kHeight)) << pixel;
    // Not wider than the surface is: free again a pixel and a voxel away.
    const double beside = pixel + kResolution;
    EXPECT_EQ(top(middle(45) + 1.01 * beside, middle(45)), grid.index(0.0)) << pixel;
    EXPECT_EQ(top(middle(45), middle(45) - 1.01 * beside), grid.index(0.0)) << pixel;
  }
}

// Columns with a corner without data stay unknown, whatever the pixels within them say.
TEST_F(SiteTerrain, WhatHasNoDataStaysUnknown) {
  if (!rasters_available()) GTEST_SKIP() << "Lapwing was built without libgdal-dev";
  MadeRaster raster{.width = 80, .height = 80, .left = 0, .upper = 20, .pixel = 0.25};
  raster.height_at = [](double x, double) {
    return x > 10 ? std::numeric_limits<float>::quiet_NaN() : 3.0f;
  };
  const Site site = site_of(raster, 1.0);
  const VoxelGrid grid(1.0);
  EXPECT_EQ(site.solid->top(grid.index(8.5), grid.index(5.5)), grid.index(3.0));
  EXPECT_EQ(site.solid->top(grid.index(9.9), grid.index(5.5)), SkyColumns::kUnknown);
  EXPECT_EQ(site.solid->top(grid.index(12.5), grid.index(5.5)), SkyColumns::kUnknown);
}

}  // namespace
}  // namespace lapwing
