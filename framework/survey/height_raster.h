// SPDX-License-Identifier: Apache-2.0
// Rasters of heights from files: GeoTIFF, and Arc/Info ASCII grids (.asc). By GDAL, where Lapwing
// was built with it.
//
// GDAL runs in the program `lapwing_raster`, a process of its own: libgdal and what it links would
// double the time that every command takes to start, and damaged files end that process alone.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace lapwing {

struct RasterInfo {
  std::string format;  // "GeoTIFF"
  int width = 0, height = 0;
  // From pixels to the raster's coordinates: the middle of pixel (column, row) is the transform of
  // (column + 0.5, row + 0.5).
  Eigen::Affine2d to_coordinates = Eigen::Affine2d::Identity();
  std::string system;      // WKT; "" without
  double height_unit = 0;  // m; 0 where it is not stated
  double lowest = 0;       // of some 64 thousand of its values, evenly
};

// Pixels of a raster.
struct RasterWindow {
  int column = 0, row = 0, width = 0, height = 0;
};

// Whether GDAL is built in.
bool rasters_available();

// InputError, naming the file: GDAL is not built in (with the package and the commands that cure
// it), no raster, a picture in place of heights, no georeferencing, nothing but no-data pixels.
RasterInfo raster_info(const std::filesystem::path& file);

// The values of a window row by row, NaN where there are no data; scale and offset of the file are
// applied. The window lies within the raster.
std::vector<float> raster_values(const std::filesystem::path& file, const RasterWindow& window);

}  // namespace lapwing
