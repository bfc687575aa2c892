// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "framework/core/error.h"
#include "framework/geometry/mesh_builder.h"
#include "framework/geometry/mesh_readers.h"

namespace lapwing {
namespace {

[[noreturn]] void fail(const std::string& name, const std::string& why) {
  throw InputError("'" + name + "': " + why);
}

// By ears, seen along the normal; empty where the polygon does not allow it.
std::vector<std::array<std::int32_t, 3>> cut(const std::vector<std::int32_t>& corners,
                                             const TriangleMesh& mesh) {
  constexpr std::size_t kMostCorners = 1000;  // beyond, ears take too long
  const auto count = static_cast<std::int64_t>(mesh.vertices.size());
  std::vector<Eigen::Vector3d> points;
  for (const std::int32_t i : corners) {
    if (i < 0 || i >= count || corners.size() > kMostCorners) return {};
    points.push_back(mesh.vertices[static_cast<std::size_t>(i)]);
    if (!points.back().allFinite()) return {};
  }
  try {
    auto pieces = triangulate_face(points);
    for (auto& piece : pieces) {
      for (std::int32_t& i : piece) i = corners[static_cast<std::size_t>(i)];
    }
    return pieces;
  } catch (const InputError&) {
    return {};
  }
}

}  // namespace

void append_polygon(const std::vector<std::int32_t>& corners, const Rgb& color,
                    TriangleMesh& mesh) {
  if (corners.size() < 3) return;
  std::vector<std::array<std::int32_t, 3>> pieces;
  if (corners.size() > 3) pieces = cut(corners, mesh);
  if (pieces.empty()) {
    for (std::size_t k = 2; k < corners.size(); ++k) {
      pieces.push_back({corners[0], corners[k - 1], corners[k]});
    }
  }
  mesh.triangles.insert(mesh.triangles.end(), pieces.begin(), pieces.end());
  mesh.colors.insert(mesh.colors.end(), pieces.size(), color);
}

void check_stl(std::string_view bytes, const std::string& name) {
  const bool text =
      bytes.starts_with("solid") && bytes.substr(0, 4096).find("facet") != std::string_view::npos;
  if (text) {
    if (bytes.find("endsolid") == std::string_view::npos) fail(name, "it ends before 'endsolid'");
    return;
  }
  constexpr std::size_t kHeader = 84, kTriangle = 50;
  if (bytes.size() < kHeader) fail(name, "it is too short for a binary STL");
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof count);
  const std::size_t held = (bytes.size() - kHeader) / kTriangle;
  if (count > held) {
    fail(name, "its header claims " + std::to_string(count) + " triangles, but it holds " +
                   std::to_string(held));
  }
}

namespace {

// The text of every element of that name: <name ...>text</name>.
template <class See>
void for_each_text(std::string_view text, std::string_view element, See see) {
  const std::string open = "<" + std::string(element), close = "</" + std::string(element);
  for (std::size_t at = text.find(open); at != std::string_view::npos; at = text.find(open, at)) {
    at += open.size();
    if (at >= text.size() || (text[at] != '>' && text[at] != ' ' && text[at] != '\n')) continue;
    const std::size_t begin = text.find('>', at);
    const std::size_t end = text.find(close, at);
    if (begin == std::string_view::npos || end == std::string_view::npos || end < begin) continue;
    if (text[begin - 1] == '/') continue;
    see(text.substr(begin + 1, end - begin - 1));
  }
}

}  // namespace

void check_gltf(std::string_view bytes, const std::string& name) {
  if (bytes.starts_with("glTF")) return;  // the binary form
  std::string_view text = bytes;
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first != std::string_view::npos && text[first] == '{') return;
  fail(name, "it is not glTF, which begins with '{', or with 'glTF' if it is binary");
}

void check_collada(std::string_view text, const std::string& name) {
  const auto only = [&](std::string_view element, std::string_view allowed) {
    for_each_text(text, element, [&](std::string_view body) {
      const std::size_t bad = body.find_first_not_of(allowed);
      if (bad == std::string_view::npos) return;
      fail(name, "<" + std::string(element) + "> holds '" + std::string(body.substr(bad, 1)) +
                     "' among its numbers");
    });
  };
  for (const char* element : {"p", "vcount", "h", "v", "ph"}) {
    only(element, "0123456789 \t\r\n");
  }
  for (const char* element :
       {"float_array", "int_array", "matrix", "translate", "rotate", "scale", "skew", "lookat"}) {
    only(element, "0123456789+-.eE \t\r\n");
  }
  for (const char* attribute : {"count=", "stride=", "offset="}) {
    for (std::size_t at = text.find(attribute); at != std::string_view::npos;
         at = text.find(attribute, at + 1)) {
      const std::size_t digits = at + std::strlen(attribute) + 1;
      double value = 0;
      if (digits >= text.size()) continue;
      const auto [end, error] =
          std::from_chars(text.data() + digits, text.data() + text.size(), value);
      const bool whole = error == std::errc{} && value == std::floor(value) && value >= 0 &&
                         (*end == '"' || *end == '\'');
      if (!whole || value > static_cast<double>(text.size())) {
        fail(name, "'" + std::string(text.substr(at, std::min<std::size_t>(30, text.size() - at))) +
                       "' claims more than the file has");
      }
    }
  }
}

ColladaFrame collada_frame(const std::string& text) {
  ColladaFrame frame;
  const std::size_t unit = text.find("<unit");
  if (unit != std::string::npos) {
    const std::size_t close = text.find('>', unit);
    const std::string tag = text.substr(unit, std::min<std::size_t>(close, unit + 1024) - unit);
    const std::size_t key = tag.find("meter=");
    if (key != std::string::npos && key + 7 < tag.size()) {
      double value = 0;
      const char* first = tag.data() + key + 7;
      const auto [end, error] = std::from_chars(first, tag.data() + tag.size(), value);
      if (error == std::errc{} && end != first && value > 0 && std::isfinite(value)) {
        frame.unit = value;
      }
    }
  }
  const std::size_t up = text.find("<up_axis>");
  if (up != std::string::npos) {
    const std::string axis = text.substr(up + 9, 1);
    if (axis == "X") frame.up = UpAxis::x;
    if (axis == "Y") frame.up = UpAxis::y;
    if (axis == "Z") frame.up = UpAxis::z;
  }
  return frame;
}

}  // namespace lapwing
