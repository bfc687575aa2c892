// SPDX-License-Identifier: Apache-2.0
#include "framework/survey/city_model.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstring>

#include "framework/core/error.h"
#include "framework/core/json.h"
#include "framework/survey/reader_program.h"

namespace lapwing {
namespace {

const ReaderProgram& city_reader() {
  static const ReaderProgram program{"lapwing_city", "libcitygml", "city models", "libcitygml-dev"};
  return program;
}

}  // namespace

bool city_models_available() {
  return city_reader().is_installed();
}

bool is_city_model(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending == ".gml" || ending == ".citygml";
}

CityModel read_city_model(const std::filesystem::path& file) {
  const std::string bytes = answer_of_program(city_reader(), file, {"read"});
  const std::size_t line = bytes.find('\n');
  const Value told = from_json(bytes.substr(0, line), "lapwing_city");
  const auto corners = static_cast<std::size_t>(told.at("corners").as_integer());
  const auto triangles = static_cast<std::size_t>(told.at("triangles").as_integer());
  const std::size_t size = 3 * (corners * sizeof(double) + triangles * sizeof(std::int32_t));
  if (line == std::string::npos || bytes.size() != line + 1 + size)
    throw InputError("'" + file.string() + "': libcitygml does not read all of it");
  CityModel model;
  const char* at = bytes.data() + line + 1;
  model.mesh.vertices.resize(corners);
  for (Eigen::Vector3d& p : model.mesh.vertices) {
    std::memcpy(p.data(), at, 3 * sizeof(double));
    at += 3 * sizeof(double);
  }
  model.mesh.triangles.resize(triangles);
  std::memcpy(model.mesh.triangles.data(), at, 3 * triangles * sizeof(std::int32_t));
  model.system = told.at("system").as_text();
  for (const auto& [level, count] : told.at("objects").as_map()) {
    int number = 0;
    std::from_chars(level.data(), level.data() + level.size(), number);
    model.objects[number] = static_cast<std::size_t>(count.as_integer());
  }
  model.prototypes = static_cast<std::size_t>(told.at("prototypes").as_integer());
  model.flat = static_cast<std::size_t>(told.at("flat").as_integer());
  return model;
}

}  // namespace lapwing
