// SPDX-License-Identifier: Apache-2.0
// lapwing_city: tells Lapwing what libcitygml reads of a city model, from a process of its own.
//   lapwing_city read FILE   a line of JSON; then x, y and z of each corner as doubles, and three
//                            numbers of corners of each triangle as 32-bit integers
// Exit status 2 with one sentence on standard error for a file that holds no surface.
#include <citygml/citygml.h>
#include <citygml/citygmllogger.h>
#include <citygml/citymodel.h>
#include <citygml/cityobject.h>
#include <citygml/geometry.h>
#include <citygml/polygon.h>
#include <sys/resource.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace {

using Type = citygml::CityObject::CityObjectsType;

constexpr rlim_t kMemory = rlim_t{8} << 30;  // bytes of address space

[[noreturn]] void refuse(const std::string& why) {
  std::fprintf(stderr, "%s\n", why.c_str());
  std::exit(2);
}

// Keeps the first error, and prints nothing.
class Listener final : public citygml::CityGMLLogger {
 public:
  Listener() : CityGMLLogger(LOGLEVEL::LL_ERROR) {}
  void log(LOGLEVEL level, const std::string& message, const char*, int) const override {
    if (level >= LOGLEVEL::LL_ERROR && first_.empty()) first_ = message;
  }
  const std::string& first() const { return first_; }

 private:
  mutable std::string first_;
};

// Surface of an object's parts has its own levels of detail.
bool is_part(Type type) {
  return type == Type::COT_BuildingPart || type == Type::COT_BridgePart;
}

// What is inside of buildings, and surface that is not there.
bool is_left_out(Type type) {
  switch (type) {
    case Type::COT_Room:
    case Type::COT_BuildingFurniture:
    case Type::COT_IntBuildingInstallation:
    case Type::COT_InteriorWallSurface:
    case Type::COT_CeilingSurface:
    case Type::COT_FloorSurface:
    case Type::COT_ClosureSurface:
      return true;
    default:
      return false;
  }
}

using Polygons = std::vector<std::shared_ptr<const citygml::Polygon>>;

class Collector {
 public:
  void add(const citygml::CityObject& object) {
    if (is_left_out(object.getType())) return;
    std::map<unsigned, Polygons> levels;
    gather(object, levels);
    std::erase_if(levels, [](const auto& level) { return level.second.empty(); });
    if (levels.empty()) return;
    // Of several levels of detail of one object the finest; they show the same.
    const auto& [level, polygons] = *levels.rbegin();
    ++objects_[level];
    for (const auto& polygon : polygons) take(*polygon);
  }

  void tell(const std::string& system) const {
    nlohmann::json told;
    told["system"] = system;
    told["corners"] = corners_.size() / 3;
    told["triangles"] = triangles_.size() / 3;
    told["prototypes"] = prototypes_;
    told["flat"] = flat_;
    for (const auto& [level, count] : objects_) told["objects"][std::to_string(level)] = count;
    const std::string line = told.dump() + "\n";
    const auto put = [](const void* data, std::size_t size, std::size_t count) {
      if (std::fwrite(data, size, count, stdout) != count) std::exit(1);
    };
    put(line.data(), 1, line.size());
    put(corners_.data(), sizeof(double), corners_.size());
    put(triangles_.data(), sizeof(std::int32_t), triangles_.size());
  }
  bool empty() const { return triangles_.empty(); }
  std::size_t prototypes() const { return prototypes_; }

 private:
  void gather(const citygml::CityObject& object, std::map<unsigned, Polygons>& levels) {
    prototypes_ += object.getImplicitGeometryCount();
    for (unsigned i = 0; i < object.getGeometriesCount(); ++i)
      gather(object.getGeometry(i), levels);
    for (unsigned i = 0; i < object.getChildCityObjectsCount(); ++i) {
      const citygml::CityObject& child = object.getChildCityObject(i);
      if (is_part(child.getType()))
        add(child);
      else if (!is_left_out(child.getType()))
        gather(child, levels);
    }
  }

  static void gather(const citygml::Geometry& geometry, std::map<unsigned, Polygons>& levels) {
    for (unsigned i = 0; i < geometry.getPolygonsCount(); ++i)
      levels[geometry.getLOD()].push_back(geometry.getPolygon(i));
    for (unsigned i = 0; i < geometry.getGeometriesCount(); ++i)
      gather(geometry.getGeometry(i), levels);
  }

  void take(const citygml::Polygon& polygon) {
    const auto& corners = polygon.getVertices();
    const auto& indices = polygon.getIndices();
    if (indices.size() < 3) ++flat_;
    const auto first = static_cast<std::int32_t>(corners_.size() / 3);
    for (const TVec3d& p : corners) {
      if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
        refuse("a corner of it is not a finite number");
      corners_.insert(corners_.end(), {p.x, p.y, p.z});
    }
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3)
      for (std::size_t k = i; k < i + 3; ++k) {
        if (indices[k] >= corners.size()) refuse("it is damaged: a triangle names no corner");
        triangles_.push_back(first + static_cast<std::int32_t>(indices[k]));
      }
  }

  std::vector<double> corners_;
  std::vector<std::int32_t> triangles_;
  std::map<unsigned, std::size_t> objects_;  // by their level of detail
  std::size_t prototypes_ = 0, flat_ = 0;
};

}  // namespace

int main(int count, char** words) {
  const rlimit most{kMemory, kMemory};
  ::setrlimit(RLIMIT_AS, &most);
  if (count != 3 || std::string(words[1]) != "read") {
    std::fprintf(stderr, "usage: lapwing_city read FILE\n");
    return 64;
  }
  const auto listener = std::make_shared<Listener>();
  std::shared_ptr<const citygml::CityModel> model;
  try {
    model = citygml::load(std::string(words[2]), citygml::ParserParams(), listener);
  } catch (const std::exception& error) {
    refuse(std::string("it is no CityGML that can be read: ") + error.what());
  } catch (...) {  // of the XML parser, whose exceptions are no std::exception
    refuse("it is no CityGML that can be read: its XML is damaged or cut short");
  }
  if (!model)
    refuse("it is no CityGML that can be read" +
           (listener->first().empty() ? "" : ": " + listener->first()));
  if (!listener->first().empty()) refuse("it is damaged: " + listener->first());
  Collector collector;
  for (const citygml::CityObject* object : model->getRootCityObjects()) collector.add(*object);
  if (collector.empty())
    refuse(
        "it has no surface: expected buildings or other objects with polygons, in CityGML 1.0 "
        "or 2.0" +
        std::string(collector.prototypes() > 0 ? "; prototypes of objects are not read" : ""));
  std::string system = model->getSRSName();
  if (system.empty()) system = model->getEnvelope().srsName();
  collector.tell(system);
  return std::fflush(stdout) == 0 ? 0 : 1;
}
