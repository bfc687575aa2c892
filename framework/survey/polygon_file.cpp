// SPDX-License-Identifier: Apache-2.0
#include "framework/survey/polygon_file.h"

#include <algorithm>
#include <cctype>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/number_text.h"
#include "framework/survey/polygon_builder.h"

namespace lapwing {
namespace {

constexpr std::size_t kLargestFile = std::size_t{64} << 20;  // bytes

std::optional<double>* property_of(SurveyPolygon& polygon, const std::string& key) {
  if (key == "from" || key == "floor") return &polygon.from;
  if (key == "to" || key == "ceiling") return &polygon.to;
  if (key == "weight") return &polygon.weight;
  return nullptr;
}

}  // namespace

std::vector<Eigen::Vector2d> open_ring(std::vector<Eigen::Vector2d> ring,
                                       const std::string& place) {
  if (ring.size() < 4 || ring.front() != ring.back())
    throw InputError(place +
                     ": a ring has at least four positions, and the last one is the first "
                     "one again; this one has " +
                     std::to_string(ring.size()) +
                     (ring.size() > 1 && ring.front() != ring.back() ? " and is not closed" : ""));
  ring.pop_back();
  return ring;
}

bool is_polygon_property(const std::string& key) {
  SurveyPolygon any;
  return property_of(any, key) != nullptr;
}

bool set_property(SurveyPolygon& polygon, const std::string& key, double number) {
  std::optional<double>* property = property_of(polygon, key);
  if (!property) return false;
  if (*property)
    throw InputError(polygon.place + ": '" + key +
                     "' is stated twice; from and floor, to and ceiling are the same");
  *property = number;
  return true;
}

void refuse_heights(const std::string& place, double height, std::size_t corner,
                    const std::string& above) {
  throw InputError(place + ": its coordinates have heights (" + plain_number(height) +
                   " m at its corner " + std::to_string(corner) + "), " + above +
                   ". A polygon is flat: remove them, and state its lower and upper end and what "
                   "they are above (heights)");
}

void require_polygons(const PolygonFile& file, const std::string& named, const std::string& what,
                      const std::vector<std::string>& names) {
  if (!file.polygons.empty()) return;
  if (named.empty()) throw InputError(what + ": it has no polygon");
  std::string known;
  for (std::size_t i = 0; i < std::min<std::size_t>(names.size(), 8); ++i)
    known += (i ? ", '" : "'") + names[i] + "'";
  throw InputError(what + ": nothing in it is named '" + named + "'" +
                   (known.empty() ? "; nothing has a name" : "; it has " + known));
}

PolygonFile read_polygon_file(const std::filesystem::path& path, const std::string& named,
                              const std::string& what) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == ".kmz")
    throw InputError(what + ": a KMZ file is a packed KML file: unpack it by `unzip " +
                     path.filename().string() + "` and name the .kml file in it");
  if (ending == ".kml") return read_kml(read_file(path, kLargestFile), named, what);
  if (ending == ".geojson" || ending == ".json")
    return read_geojson(read_file(path, kLargestFile), named, what);
  throw InputError(what + ": expected a file .geojson, .json or .kml");
}

}  // namespace lapwing
