// SPDX-License-Identifier: Apache-2.0
// lapwing_raster: tells Lapwing what GDAL reads of a raster, from a process of its own.
//   lapwing_raster info FILE                          one JSON object
//   lapwing_raster read FILE COLUMN ROW WIDTH HEIGHT  floats row by row, NaN where there are no
//   data
//   lapwing_raster look FILE                          one JSON object, also of a picture
//   lapwing_raster colours FILE COLUMN ROW WIDTH HEIGHT COLUMNS ROWS  four bytes a pixel (red,
//   green, blue, opacity) row by row, of a window made smaller to so many columns and rows
// Exit status 2 with one sentence on standard error for a file that holds no heights, or no
// picture.
#include <cpl_conv.h>
#include <cpl_error.h>
#include <gdal.h>
#include <gdal_frmts.h>
#include <ogr_srs_api.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
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

Raster with_band(const char* file) {
  Raster raster;
  raster.set = GDALOpenEx(file, GDAL_OF_RASTER | GDAL_OF_READONLY, nullptr, nullptr, nullptr);
  if (!raster.set)
    refuse("it is no raster that can be read; expected a GeoTIFF or an Arc/Info grid (.asc)");
  if (GDALGetRasterCount(raster.set) < 1) refuse("it has no raster band");
  raster.band = GDALGetRasterBand(raster.set, 1);
  if (GDALDataTypeIsComplex(GDALGetRasterDataType(raster.band)))
    refuse("its values are complex numbers, and heights or colours are expected");
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

Raster opened(const char* file) {
  const Raster raster = with_band(file);
  const int bands = GDALGetRasterCount(raster.set);
  if (bands >= 3 && GDALGetRasterDataType(raster.band) == GDT_Byte)
    refuse("it has " + std::to_string(bands) +
           " bands of bytes: it is a picture, and heights are expected");
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

// Where its pixels lie, and in which system.
nlohmann::json frame_of(const Raster& raster) {
  std::array<double, 6> transform{};
  if (GDALGetGeoTransform(raster.set, transform.data()) != CE_None)
    refuse(
        "it has no georeferencing: it does not state where its pixels lie. Write it with one, as "
        "gdal_translate -a_srs EPSG:... -a_ullr LEFT UPPER RIGHT LOWER does");
  const std::string driver = GDALGetDriverShortName(GDALGetDatasetDriver(raster.set));
  nlohmann::json told;
  told["format"] = driver == "GTiff" ? "GeoTIFF" : "ASCII grid";
  told["width"] = raster.width;
  told["height"] = raster.height;
  told["transform"] = transform;
  told["system"] = system_of(raster);
  return told;
}

void tell(const Raster& raster) {
  nlohmann::json told = frame_of(raster);
  const int columns = std::min(raster.width, kSamples), rows = std::min(raster.height, kSamples);
  float lowest = std::numeric_limits<float>::infinity();
  for (const float value : values_of(raster, 0, 0, raster.width, raster.height, columns, rows))
    if (value < lowest) lowest = value;
  if (std::isinf(lowest)) refuse("none of its pixels has data");
  const char* unit = GDALGetRasterUnitType(raster.band);
  told["height_unit"] = metres_of(unit ? unit : "");
  told["lowest"] = lowest;
  std::printf("%s\n", told.dump().c_str());
}

// -- pictures ------------------------------------------------------------------------------------

constexpr double kMostRead = 0x1p30;                  // pixels of the level that is read
constexpr double kDarkest = 0.02, kBrightest = 0.98;  // of all values, where they are no bytes

// What is shown of a raster, and how.
struct Shown {
  std::vector<GDALRasterBandH> bands;  // three of colours, or one
  bool heights = false;                // drawn as a hill in the light
  GDALColorTableH table = nullptr;     // of colours, of bytes
  bool bytes = true;
};

// Red, green and blue by their names, else the first three bands; else the first one. A single band
// of bytes or of unsigned numbers is a photograph, of other numbers it holds heights.
Shown shown_of(const Raster& raster) {
  Shown shown;
  const int count = GDALGetRasterCount(raster.set);
  std::array<GDALRasterBandH, 3> named{};
  std::vector<GDALRasterBandH> plain;
  for (int k = 1; k <= count; ++k) {
    const GDALRasterBandH band = GDALGetRasterBand(raster.set, k);
    const GDALColorInterp meant = GDALGetRasterColorInterpretation(band);
    if (meant == GCI_RedBand) named[0] = band;
    if (meant == GCI_GreenBand) named[1] = band;
    if (meant == GCI_BlueBand) named[2] = band;
    if (meant != GCI_AlphaBand) plain.push_back(band);
  }
  if (plain.empty()) refuse("it has no band but that of its opacity");
  if (named[0] && named[1] && named[2])
    shown.bands.assign(named.begin(), named.end());
  else if (plain.size() >= 3)
    shown.bands.assign(plain.begin(), plain.begin() + 3);
  else
    shown.bands = {plain.front()};
  for (const GDALRasterBandH band : shown.bands)
    if (GDALGetRasterDataType(band) != GDT_Byte) shown.bytes = false;
  const GDALDataType type = GDALGetRasterDataType(shown.bands.front());
  if (shown.bands.size() == 1) {
    shown.heights = type != GDT_Byte && type != GDT_UInt16;
    if (type == GDT_Byte) shown.table = GDALGetRasterColorTable(shown.bands.front());
  }
  return shown;
}

void tell_look(const Raster& raster) {
  nlohmann::json told = frame_of(raster);
  const Shown shown = shown_of(raster);
  told["heights"] = shown.heights;
  told["colours"] = shown.bands.size() == 3 || shown.table;
  std::printf("%s\n", told.dump().c_str());
}

struct PictureWindow {
  int column = 0, row = 0, width = 0, height = 0;  // of the raster
  int columns = 0, rows = 0;                       // that it is made smaller to
};

// Some rows of what the window is made smaller to.
template <class Number>
std::vector<Number> read_rows(GDALRasterBandH band, GDALDataType type, const PictureWindow& window,
                              int first, int rows, GDALRIOResampleAlg algorithm) {
  GDALRasterIOExtraArg how;
  INIT_RASTERIO_EXTRA_ARG(how);
  how.eResampleAlg = algorithm;
  const double scale = static_cast<double>(window.height) / window.rows;
  how.bFloatingPointWindowValidity = TRUE;
  how.dfXOff = window.column;
  how.dfXSize = window.width;
  how.dfYOff = window.row + scale * first;
  how.dfYSize = scale * rows;
  const int top = std::max(0, static_cast<int>(std::floor(how.dfYOff)));
  const int below =
      std::min(GDALGetRasterBandYSize(band), static_cast<int>(std::ceil(how.dfYOff + how.dfYSize)));
  std::vector<Number> values(static_cast<std::size_t>(window.columns) *
                             static_cast<std::size_t>(rows));
  if (GDALRasterIOEx(band, GF_Read, window.column, top, window.width, below - top, values.data(),
                     window.columns, rows, type, 0, 0, &how) != CE_None)
    refuse("it is damaged or cut short: " + std::string(CPLGetLastErrorMsg()));
  return values;
}

// A file of many pixels without smaller copies of itself is not read to its end.
void check_effort(const Raster& raster, const PictureWindow& window) {
  const double smaller = std::min(static_cast<double>(window.width) / window.columns,
                                  static_cast<double>(window.height) / window.rows);
  double reached = 1;  // of the copies, the smallest that is fine enough
  for (int k = 0; k < GDALGetOverviewCount(raster.band); ++k) {
    const double level =
        static_cast<double>(raster.width) / GDALGetRasterBandXSize(GDALGetOverview(raster.band, k));
    if (level <= 1.2 * smaller) reached = std::max(reached, level);
  }
  const double count = static_cast<double>(window.width) * window.height / (reached * reached);
  if (count > kMostRead)
    refuse("too large to be read at once: " + std::to_string(static_cast<long long>(count)) +
           " of its pixels are there, and at most " +
           std::to_string(static_cast<long long>(kMostRead)) +
           " are possible. Give it smaller copies of itself: gdaladdo -r average FILE");
}

// Of numbers that are no bytes: those that become black and white.
std::array<float, 2> ends_of(const Shown& shown, const PictureWindow& window) {
  PictureWindow some = window;
  some.columns = std::min(window.width, kSamples);
  some.rows = std::min(window.height, kSamples);
  std::vector<float> values;
  for (const GDALRasterBandH band : shown.bands) {
    const auto here =
        read_rows<float>(band, GDT_Float32, some, 0, some.rows, GRIORA_NearestNeighbour);
    const auto mask = read_rows<std::uint8_t>(GDALGetMaskBand(band), GDT_Byte, some, 0, some.rows,
                                              GRIORA_NearestNeighbour);
    for (std::size_t k = 0; k < here.size(); ++k)
      if (mask[k] > 0 && std::isfinite(here[k])) values.push_back(here[k]);
  }
  if (values.empty()) return {0, 1};
  const auto at = [&](double share) {
    const auto place = values.begin() +
                       static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), place, values.end());
    return *place;
  };
  const float low = at(kDarkest), high = at(kBrightest);
  return {low, high > low ? high : low + 1};
}

// m along x and y of its coordinates, where `y` is one of them.
std::array<double, 2> metres_per_unit(const Raster& raster, double y) {
  const OGRSpatialReferenceH system = GDALGetSpatialRef(raster.set);
  if (!system) return {1, 1};
  if (OSRIsGeographic(system)) {
    constexpr double kDegree = 111320;  // m, of latitude
    const double radian = OSRGetAngularUnits(system, nullptr);
    const double unit = kDegree * radian * 180 / M_PI;
    return {unit * std::cos(y * radian), unit};
  }
  const double unit = OSRGetLinearUnits(system, nullptr);
  return {unit, unit};
}

// Rows of heights in the light of the north-west, 45 degrees high; one row more above and below.
class HillLight {
 public:
  HillLight(const Raster& raster, const PictureWindow& window) {
    std::array<double, 6> t{};
    GDALGetGeoTransform(raster.set, t.data());
    const double right = static_cast<double>(window.width) / window.columns;
    const double down = static_cast<double>(window.height) / window.rows;
    const auto [x_unit, y_unit] =
        metres_per_unit(raster, t[3] + t[4] * (window.column + 0.5 * window.width) +
                                    t[5] * (window.row + 0.5 * window.height));
    // The rows of the inverse of the pixels' matrix, transposed: from slopes along columns and rows
    // to slopes along x and y.
    const double a = t[1] * x_unit * right, b = t[2] * x_unit * down;
    const double c = t[4] * y_unit * right, d = t[5] * y_unit * down;
    const double determinant = a * d - b * c;
    if (determinant != 0)
      to_x_ = {d / determinant, -c / determinant}, to_y_ = {-b / determinant, a / determinant};
    const char* text = GDALGetRasterUnitType(raster.band);
    const double height_unit = metres_of(text ? text : "");
    height_ = raster.scale * (height_unit > 0 ? height_unit : 1);
  }
  std::uint8_t shade(double along_column, double along_row) const {
    const double x = height_ * (to_x_[0] * along_column + to_x_[1] * along_row);
    const double y = height_ * (to_y_[0] * along_column + to_y_[1] * along_row);
    const double light = (0.5 * x - 0.5 * y + std::sqrt(0.5)) / std::sqrt(1 + x * x + y * y);
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(light, 0.0, 1.0)));
  }

 private:
  std::array<double, 2> to_x_{}, to_y_{};
  double height_ = 1;
};

void write_bytes(const std::vector<std::uint8_t>& bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), stdout) != bytes.size()) std::exit(1);
}

void write_colours(const Raster& raster, const PictureWindow& window) {
  const Shown shown = shown_of(raster);
  check_effort(raster, window);
  const bool smaller = window.columns < window.width || window.rows < window.height;
  const GDALRIOResampleAlg algorithm =
      smaller && !shown.table ? GRIORA_Average : GRIORA_NearestNeighbour;
  const auto ends =
      shown.bytes || shown.heights ? std::array<float, 2>{0, 255} : ends_of(shown, window);
  const HillLight light(raster, window);
  const auto columns = static_cast<std::size_t>(window.columns);
  constexpr int kRows = 128;  // at once
  for (int done = 0; done < window.rows; done += kRows) {
    const int rows = std::min(kRows, window.rows - done);
    // Slopes need the rows beside.
    const int above = shown.heights && done > 0 ? 1 : 0;
    const int below = shown.heights && done + rows < window.rows ? 1 : 0;
    std::vector<std::vector<float>> values;
    std::vector<std::vector<std::uint8_t>> masks;
    for (const GDALRasterBandH band : shown.bands) {
      values.push_back(read_rows<float>(band, GDT_Float32, window, done - above,
                                        rows + above + below, algorithm));
      masks.push_back(read_rows<std::uint8_t>(GDALGetMaskBand(band), GDT_Byte, window, done - above,
                                              rows + above + below,
                                              smaller ? GRIORA_Average : GRIORA_NearestNeighbour));
    }
    std::vector<std::uint8_t> bytes(4 * columns * static_cast<std::size_t>(rows));
    const auto place = [&](int row, std::size_t column) {
      return static_cast<std::size_t>(row + above) * columns + column;
    };
    const auto holds = [&](std::size_t at) {
      return masks[0][at] > 0 && std::isfinite(values[0][at]);
    };
    // Between the neighbours that there are.
    const auto slope = [&](std::size_t here, bool has_before, std::size_t before, bool has_after,
                           std::size_t after) {
      const std::size_t from = has_before && holds(before) ? before : here;
      const std::size_t to = has_after && holds(after) ? after : here;
      const int steps = (from != here) + (to != here);
      return steps == 0 ? 0.0 : static_cast<double>(values[0][to] - values[0][from]) / steps;
    };
    for (int row = 0; row < rows; ++row)
      for (std::size_t column = 0; column < columns; ++column) {
        const std::size_t at = place(row, column);
        std::uint8_t* out = &bytes[4 * (static_cast<std::size_t>(row) * columns + column)];
        for (const auto& mask : masks) out[3] = std::max(out[3], mask[at]);
        if (shown.heights) {
          if (!holds(at)) out[3] = 0;
          const double along_column = slope(at, column > 0, at - 1, column + 1 < columns, at + 1);
          const double along_row =
              slope(at, row + above > 0, at - columns, row < rows - 1 + below, at + columns);
          out[0] = out[1] = out[2] = light.shade(along_column, along_row);
        } else if (shown.table) {
          const GDALColorEntry* entry =
              GDALGetColorEntry(shown.table, static_cast<int>(values[0][at]));
          if (!entry || entry->c4 == 0) out[3] = 0;
          if (!entry) continue;
          out[0] = static_cast<std::uint8_t>(entry->c1);
          out[1] = static_cast<std::uint8_t>(entry->c2);
          out[2] = static_cast<std::uint8_t>(entry->c3);
        } else {
          for (std::size_t k = 0; k < 3; ++k) {
            const float value = values[std::min(k, values.size() - 1)][at];
            const float share = std::isfinite(value) ? (value - ends[0]) / (ends[1] - ends[0]) : 0;
            out[k] = static_cast<std::uint8_t>(std::lround(255 * std::clamp(share, 0.0f, 1.0f)));
          }
        }
      }
    write_bytes(bytes);
  }
}

// Whole numbers from word number `first` on.
std::vector<int> numbers_in(char** words, int first, int count) {
  std::vector<int> numbers;
  for (int k = first; k < count; ++k) numbers.push_back(std::atoi(words[k]));
  return numbers;
}

// A window that lies within.
void check_window(const Raster& raster, const std::vector<int>& window) {
  if (window[0] < 0 || window[1] < 0 || window[2] < 1 || window[3] < 1 ||
      window[2] > raster.width - window[0] || window[3] > raster.height - window[1])
    refuse("the window lies outside of it");
}

}  // namespace

int main(int count, char** words) {
  const rlimit most{kMemory, kMemory};
  ::setrlimit(RLIMIT_AS, &most);
  const std::string what = count > 1 ? words[1] : "";
  if (!((what == "info" || what == "look") && count == 3) && !(what == "read" && count == 7) &&
      !(what == "colours" && count == 9)) {
    std::fprintf(
        stderr,
        "usage: lapwing_raster info FILE | read FILE COLUMN ROW WIDTH HEIGHT | look FILE | "
        "colours FILE COLUMN ROW WIDTH HEIGHT COLUMNS ROWS\n");
    return 64;
  }
  CPLSetErrorHandler(CPLQuietErrorHandler);
  CPLSetConfigOption("GDAL_DISABLE_READDIR_ON_OPEN", "EMPTY_DIR");
  GDALRegister_GTiff();
  GDALRegister_AAIGrid();
  const bool picture = what == "look" || what == "colours";
  const Raster raster = picture ? with_band(words[2]) : opened(words[2]);
  if (what == "info") tell(raster);
  if (what == "look") tell_look(raster);
  if (count == 3) return 0;
  const std::vector<int> window = numbers_in(words, 3, count);
  check_window(raster, window);
  const int column = window[0], row = window[1], width = window[2], height = window[3];
  if (picture) {
    if (window[4] < 1 || window[5] < 1 || window[4] > width || window[5] > height)
      refuse("it is made smaller, not larger");
    write_colours(raster, {column, row, width, height, window[4], window[5]});
    return std::fflush(stdout) == 0 ? 0 : 1;
  }
  constexpr int kRows = 256;  // at once
  for (int done = 0; done < height; done += kRows) {
    const int rows = std::min(kRows, height - done);
    const auto values = values_of(raster, column, row + done, width, rows, width, rows);
    if (std::fwrite(values.data(), sizeof(float), values.size(), stdout) != values.size()) return 1;
  }
  return std::fflush(stdout) == 0 ? 0 : 1;
}
