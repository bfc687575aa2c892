// SPDX-License-Identifier: Apache-2.0
// Rasters of heights, and pictures of the ground, from files: GeoTIFF, and Arc/Info ASCII grids
// (.asc). By GDAL, where Lapwing was built with it.
//
// GDAL runs in the program `lapwing_raster`, a process of its own: libgdal and what it links would
// double the time that every command takes to start, and damaged files end that process alone.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace lapwing {

// Where the pixels of a raster lie.
struct RasterFrame {
  std::string format;  // "GeoTIFF"
  int width = 0, height = 0;
  // From pixels to the raster's coordinates: the middle of pixel (column, row) is the transform of
  // (column + 0.5, row + 0.5).
  Eigen::Affine2d to_coordinates = Eigen::Affine2d::Identity();
  std::string system;  // EPSG code or WKT; "" without
};

struct RasterInfo : RasterFrame {
  double height_unit = 0;  // m; 0 where it is not stated
  double lowest = 0;       // of some 64 thousand of its values, evenly
};

// Pixels of a raster.
struct RasterWindow {
  int column = 0, row = 0, width = 0, height = 0;
};

// A raster that may as well be a picture.
struct RasterLook : RasterFrame {
  bool heights = false;  // it holds heights, which are drawn as hills in the light
  bool colours = false;  // else it is grey
};

// Whether GDAL is built in.
bool rasters_available();

// InputError, naming the file: GDAL is not built in (with the package and the commands that cure
// it), no raster, a picture in place of heights, no georeferencing, nothing but no-data pixels.
RasterInfo raster_info(const std::filesystem::path& file);

// The values of a window row by row, NaN where there are no data; scale and offset of the file are
// applied. The window lies within the raster.
std::vector<float> raster_values(const std::filesystem::path& file, const RasterWindow& window);

// Of a photograph, a hill shading or heights. InputError as raster_info, but not of pictures.
RasterLook raster_look(const std::filesystem::path& file);

// A window as a picture, made smaller to so many columns and rows (means of the pixels): four bytes
// a pixel, red, green, blue and opacity, rows from the top. Bands named red, green and blue, else
// the first three, are the colours, a single one is grey; heights (one band of signed or real
// numbers) are drawn as hills in the light of the north-west. What is no data by value, mask or
// opacity is transparent. Numbers that are no bytes are stretched: from black, the lowest 2 % of
// the window, to white, the highest 2 %. InputError also where more than 2^30 pixels would have to
// be read, because the file has no smaller copies of itself (overviews).
std::vector<std::uint8_t> raster_colours(const std::filesystem::path& file,
                                         const RasterWindow& window, int columns, int rows);

}  // namespace lapwing
