// SPDX-License-Identifier: Apache-2.0
// City models in CityGML 2.0 whose surface is known.
#pragma once

#include <sstream>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace lapwing {

using CityRing = std::vector<Eigen::Vector3d>;

inline std::string gml_ring(const CityRing& ring) {
  std::ostringstream text;
  text.precision(12);
  text << "<gml:LinearRing><gml:posList srsDimension=\"3\">";
  for (const Eigen::Vector3d& p : ring) text << p.x() << ' ' << p.y() << ' ' << p.z() << ' ';
  text << ring.front().x() << ' ' << ring.front().y() << ' ' << ring.front().z()
       << "</gml:posList></gml:LinearRing>";
  return text.str();
}

// A polygon with holes.
inline std::string gml_surface(const std::vector<CityRing>& rings) {
  std::string text =
      "<gml:surfaceMember><gml:Polygon><gml:exterior>" + gml_ring(rings[0]) + "</gml:exterior>";
  for (std::size_t i = 1; i < rings.size(); ++i)
    text += "<gml:interior>" + gml_ring(rings[i]) + "</gml:interior>";
  return text + "</gml:Polygon></gml:surfaceMember>";
}

// The six sides of a box, outwards.
inline std::string gml_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  const auto at = [&](int x, int y, int z) {
    return Eigen::Vector3d(x ? high.x() : low.x(), y ? high.y() : low.y(), z ? high.z() : low.z());
  };
  const int sides[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                           {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  std::string text;
  for (const auto& side : sides) {
    CityRing ring;
    for (const int corner : side) ring.push_back(at(corner & 1, corner >> 1 & 1, corner >> 2));
    text += gml_surface({ring});
  }
  return text;
}

inline std::string gml_solid(int level, const std::string& surfaces) {
  const std::string lod = "bldg:lod" + std::to_string(level) + "Solid";
  return "<" + lod + "><gml:Solid><gml:exterior><gml:CompositeSurface>" + surfaces +
         "</gml:CompositeSurface></gml:exterior></gml:Solid></" + lod + ">";
}

// A boundary surface of level 2: `kind` is WallSurface, RoofSurface, ...
inline std::string gml_boundary(const std::string& kind, const std::string& surfaces) {
  return "<bldg:boundedBy><bldg:" + kind + "><bldg:lod2MultiSurface><gml:MultiSurface>" + surfaces +
         "</gml:MultiSurface></bldg:lod2MultiSurface></bldg:" + kind + "></bldg:boundedBy>";
}

inline std::string gml_building(const std::string& content) {
  return "<core:cityObjectMember><bldg:Building>" + content +
         "</bldg:Building></core:cityObjectMember>";
}

inline std::string city_gml(const std::string& members, const std::string& system = "") {
  const std::string srs = system.empty() ? "" : " srsName=\"" + system + "\" srsDimension=\"3\"";
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<core:CityModel "
         "xmlns:core=\"http://www.opengis.net/citygml/2.0\" "
         "xmlns:bldg=\"http://www.opengis.net/citygml/building/2.0\" "
         "xmlns:gml=\"http://www.opengis.net/gml\"><gml:boundedBy><gml:Envelope" +
         srs +
         "><gml:lowerCorner>0 0 0</gml:lowerCorner><gml:upperCorner>9 9 9</gml:upperCorner>"
         "</gml:Envelope></gml:boundedBy>" +
         members + "</core:CityModel>\n";
}

}  // namespace lapwing
