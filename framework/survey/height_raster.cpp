// SPDX-License-Identifier: Apache-2.0
#include "framework/survey/height_raster.h"

#include <cmath>
#include <cstring>

#include "framework/core/error.h"
#include "framework/core/json.h"
#include "framework/survey/reader_program.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail_raster(const fs::path& file, const std::string& why) {
  throw InputError("'" + file.string() + "': " + why);
}

const ReaderProgram& raster_reader() {
  static const ReaderProgram program{"lapwing_raster", "GDAL", "rasters", "libgdal-dev"};
  return program;
}

// What the program prints of the file.
std::string asked(const fs::path& file, const std::vector<std::string>& question) {
  return answer_of_program(raster_reader(), file, question);
}

}  // namespace

bool rasters_available() {
  return raster_reader().is_installed();
}

RasterInfo raster_info(const fs::path& file) {
  const Value told = from_json(asked(file, {"info"}), "lapwing_raster");
  RasterInfo info;
  info.format = told.at("format").as_text();
  info.width = static_cast<int>(told.at("width").as_integer());
  info.height = static_cast<int>(told.at("height").as_integer());
  const Value::List& numbers = told.at("transform").as_list();
  Eigen::Matrix<double, 2, 3> matrix;
  for (int row = 0; row < 2; ++row)
    for (int column = 0; column < 3; ++column)
      matrix(row, column) = numbers[static_cast<std::size_t>(3 * row + column)].as_number();
  info.to_coordinates.linear() = matrix.rightCols<2>();
  info.to_coordinates.translation() = matrix.col(0);
  if (!(std::abs(info.to_coordinates.linear().determinant()) > 0))
    fail_raster(file, "its pixels have no area: its georeferencing is damaged");
  info.system = told.at("system").as_text();
  info.height_unit = told.at("height_unit").as_number();
  info.lowest = told.at("lowest").as_number();
  return info;
}

std::vector<float> raster_values(const fs::path& file, const RasterWindow& window) {
  const std::string bytes =
      asked(file, {"read", std::to_string(window.column), std::to_string(window.row),
                   std::to_string(window.width), std::to_string(window.height)});
  std::vector<float> values(static_cast<std::size_t>(window.width) *
                            static_cast<std::size_t>(window.height));
  if (bytes.size() != values.size() * sizeof(float))
    fail_raster(file, "GDAL read " + std::to_string(bytes.size()) + " bytes of " +
                          std::to_string(values.size() * sizeof(float)));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

}  // namespace lapwing
