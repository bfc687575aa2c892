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

std::vector<std::string> words_of(const char* what, const RasterWindow& window) {
  return {what, std::to_string(window.column), std::to_string(window.row),
          std::to_string(window.width), std::to_string(window.height)};
}

void read_frame(const fs::path& file, const Value& told, RasterFrame& frame) {
  frame.format = told.at("format").as_text();
  frame.width = static_cast<int>(told.at("width").as_integer());
  frame.height = static_cast<int>(told.at("height").as_integer());
  const Value::List& numbers = told.at("transform").as_list();
  Eigen::Matrix<double, 2, 3> matrix;
  for (int row = 0; row < 2; ++row)
    for (int column = 0; column < 3; ++column)
      matrix(row, column) = numbers[static_cast<std::size_t>(3 * row + column)].as_number();
  frame.to_coordinates.linear() = matrix.rightCols<2>();
  frame.to_coordinates.translation() = matrix.col(0);
  if (!(std::abs(frame.to_coordinates.linear().determinant()) > 0))
    fail_raster(file, "its pixels have no area: its georeferencing is damaged");
  frame.system = told.at("system").as_text();
}

}  // namespace

bool rasters_available() {
  return raster_reader().is_installed();
}

RasterInfo raster_info(const fs::path& file) {
  const Value told = from_json(asked(file, {"info"}), "lapwing_raster");
  RasterInfo info;
  read_frame(file, told, info);
  info.height_unit = told.at("height_unit").as_number();
  info.lowest = told.at("lowest").as_number();
  return info;
}

RasterLook raster_look(const fs::path& file) {
  const Value told = from_json(asked(file, {"look"}), "lapwing_raster");
  RasterLook look;
  read_frame(file, told, look);
  look.heights = told.at("heights").as_boolean();
  look.colours = told.at("colours").as_boolean();
  return look;
}

std::vector<float> raster_values(const fs::path& file, const RasterWindow& window) {
  const std::string bytes = asked(file, words_of("read", window));
  std::vector<float> values(static_cast<std::size_t>(window.width) *
                            static_cast<std::size_t>(window.height));
  if (bytes.size() != values.size() * sizeof(float))
    fail_raster(file, "GDAL read " + std::to_string(bytes.size()) + " bytes of " +
                          std::to_string(values.size() * sizeof(float)));
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

std::vector<std::uint8_t> raster_colours(const fs::path& file, const RasterWindow& window,
                                         int columns, int rows) {
  std::vector<std::string> words = words_of("colours", window);
  words.push_back(std::to_string(columns));
  words.push_back(std::to_string(rows));
  const std::string bytes = asked(file, words);
  const std::size_t expected =
      4 * static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  if (bytes.size() != expected)
    fail_raster(file, "GDAL read " + std::to_string(bytes.size()) + " bytes of " +
                          std::to_string(expected));
  return {bytes.begin(), bytes.end()};
}

}  // namespace lapwing
