// SPDX-License-Identifier: Apache-2.0
// lapwing_raster: tells Lapwing what GDAL reads of a raster, from a process of its own.
//   lapwing_raster info FILE                          one JSON object
//   lapwing_raster read FILE COLUMN ROW WIDTH HEIGHT  floats row by row, NaN where there are no
//   data
// Exit status 2 with one sentence on standard error for a file that holds no heights.
#include <cpl_conv.h>
#include <cpl_error.h>
#include <gdal.h>
#include <gdal_frmts.h>
#include <ogr_srs_api.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace {

constexpr rlim_t kMemory = rlim_t{6} << 30;  // bytes of address space
constexpr int kSamples = 256;                // along each side, for the lowest value

[[noreturn]] void refuse(const std::string& why) {
  std::fprintf(stderr, "%s\n", why.c_str());
  std::exit(2);
}

struct Raster {
  GDALDatasetH set = nullptr;
  GDALRasterBandH band = nullptr;
  int width = 0, height = 0;
  bool has_empty = false;
  double empty = 0, scale = 1, offset = 0;
};

// Without the tag of another unit a height in feet would pass as metres.
double metres_of(const std::string& unit) {
  if (unit == "m" || unit == "metre" || unit == "meter" || unit == "metres" || unit == "meters")
    return 1;
  if (unit == "ft" || unit == "foot" || unit == "feet") return 0.3048;
  if (unit == "us-ft" || unit == "ftUS" || unit == "US survey foot") return 1200.0 / 3937;
  return 0;
}

Raster opened(const char* file) {
  Raster raster;
  raster.set = GDALOpenEx(file, GDAL_OF_RASTER | GDAL_OF_READONLY, nullptr, nullptr, nullptr);
  if (!raster.set)
    refuse("it is no raster that can be read; expected a GeoTIFF or an Arc/Info grid (.asc)");
  const int bands = GDALGetRasterCount(raster.set);
  if (bands < 1) refuse("it has no raster band");
  raster.band = GDALGetRasterBand(raster.set, 1);
  const GDALDataType type = GDALGetRasterDataType(raster.band);
  if (GDALDataTypeIsComplex(type))
    refuse("its values are complex numbers, and heights are expected");
  if (bands >= 3 && type == GDT_Byte)
    refuse("it has " + std::to_string(bands) +
           " bands of bytes: it is a picture, and heights are expected");
  raster.width = GDALGetRasterXSize(raster.set);
  raster.height = GDALGetRasterYSize(raster.set);
  int has = 0;
  raster.empty = GDALGetRasterNoDataValue(raster.band, &has);
  raster.has_empty = has;
  raster.scale = GDALGetRasterScale(raster.band, &has);
  if (!has) raster.scale = 1;
  raster.offset = GDALGetRasterOffset(raster.band, &has);
  if (!has) raster.offset = 0;
  return raster;
}

// A window, made smaller to so many columns and rows.
std::vector<float> values_of(const Raster& raster, int column, int row, int width, int height,
                             int columns, int rows) {
  std::vector<float> values(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  if (GDALRasterIO(raster.band, GF_Read, column, row, width, height, values.data(), columns, rows,
                   GDT_Float32, 0, 0) != CE_None)
    refuse("it is damaged or cut short: " + std::string(CPLGetLastErrorMsg()));
  const auto empty = static_cast<float>(raster.empty);
  for (float& value : values) {
    if ((raster.has_empty && value == empty) || !std::isfinite(value))
      value = std::numeric_limits<float>::quiet_NaN();
    else
      value = static_cast<float>(value * raster.scale + raster.offset);
  }
  return values;
}

// By its EPSG code, where it has one: PROJ knows more of systems than their WKT says.
std::string system_of(const Raster& raster) {
  const OGRSpatialReferenceH system = GDALGetSpatialRef(raster.set);
  if (!system) return "";
  const char* authority = OSRGetAuthorityName(system, nullptr);
  const char* code = OSRGetAuthorityCode(system, nullptr);
  if (authority && code && std::string(authority) == "EPSG") return "EPSG:" + std::string(code);
  char* text = nullptr;
  const char* const options[] = {"FORMAT=WKT2_2019", nullptr};
  if (OSRExportToWktEx(system, &text, options) != OGRERR_NONE || !text) return "";
  const std::string wkt = text;
  CPLFree(text);
  return wkt;
}

void tell(const Raster& raster) {
  std::array<double, 6> transform{};
  if (GDALGetGeoTransform(raster.set, transform.data()) != CE_None)
    refuse(
        "it has no georeferencing: it does not state where its pixels lie. Write it with one, as "
        "gdal_translate -a_srs EPSG:... -a_ullr LEFT UPPER RIGHT LOWER does");
  const int columns = std::min(raster.width, kSamples), rows = std::min(raster.height, kSamples);
  float lowest = std::numeric_limits<float>::infinity();
  for (const float value : values_of(raster, 0, 0, raster.width, raster.height, columns, rows))
    if (value < lowest) lowest = value;
  if (std::isinf(lowest)) refuse("none of its pixels has data");
  const char* unit = GDALGetRasterUnitType(raster.band);
  const std::string driver = GDALGetDriverShortName(GDALGetDatasetDriver(raster.set));
  nlohmann::json told;
  told["format"] = driver == "GTiff" ? "GeoTIFF" : "ASCII grid";
  told["width"] = raster.width;
  told["height"] = raster.height;
  told["transform"] = transform;
  told["system"] = system_of(raster);
  told["height_unit"] = metres_of(unit ? unit : "");
  told["lowest"] = lowest;
  std::printf("%s\n", told.dump().c_str());
}

}  // namespace

int main(int count, char** words) {
  const rlimit most{kMemory, kMemory};
  ::setrlimit(RLIMIT_AS, &most);
  const std::string what = count > 1 ? words[1] : "";
  if (!(what == "info" && count == 3) && !(what == "read" && count == 7)) {
    std::fprintf(stderr, "usage: lapwing_raster info FILE | read FILE COLUMN ROW WIDTH HEIGHT\n");
    return 64;
  }
  CPLSetErrorHandler(CPLQuietErrorHandler);
  CPLSetConfigOption("GDAL_DISABLE_READDIR_ON_OPEN", "EMPTY_DIR");
  GDALRegister_GTiff();
  GDALRegister_AAIGrid();
  const Raster raster = opened(words[2]);
  if (what == "info") {
    tell(raster);
    return 0;
  }
  const int column = std::atoi(words[3]), row = std::atoi(words[4]);
  const int width = std::atoi(words[5]), height = std::atoi(words[6]);
  if (column < 0 || row < 0 || width < 1 || height < 1 || width > raster.width - column ||
      height > raster.height - row)
    refuse("the window lies outside of it");
  constexpr int kRows = 256;  // at once
  for (int done = 0; done < height; done += kRows) {
    const int rows = std::min(kRows, height - done);
    const auto values = values_of(raster, column, row + done, width, rows, width, rows);
    if (std::fwrite(values.data(), sizeof(float), values.size(), stdout) != values.size()) return 1;
  }
  return std::fflush(stdout) == 0 ? 0 : 1;
}
