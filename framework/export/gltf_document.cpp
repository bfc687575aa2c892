// SPDX-License-Identifier: Apache-2.0
#include "framework/export/gltf_document.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "framework/core/json.h"

namespace lapwing {
namespace {

static_assert(std::endian::native == std::endian::little, "buffers of glTF are little endian");

constexpr int kFloat = 5126, kUnsigned = 5125, kByte = 5121;       // component types
constexpr int kVertices = 34962, kIndices = 34963, kNoTarget = 0;  // targets of buffer views
constexpr int kLineStrip = 3;

Value json_map(std::initializer_list<std::pair<const char*, Value>> entries) {
  Value value = Value::map();
  for (const auto& [key, entry] : entries) value.set(key, entry);
  return value;
}

int last_of(Value& list, Value entry) {
  list.push_back(std::move(entry));
  return static_cast<int>(list.as_list().size()) - 1;
}

void put_word(std::string& out, std::size_t number) {
  for (int i = 0; i < 4; ++i) out += static_cast<char>((number >> (8 * i)) & 0xff);
}

void put_chunk(std::string& out, const char* type, std::string bytes, char filler) {
  while (bytes.size() % 4 != 0) bytes += filler;
  put_word(out, bytes.size());
  out.append(type, 4);
  out += bytes;
}

std::vector<float> flat(const std::vector<Eigen::Vector3d>& points) {
  std::vector<float> numbers;
  numbers.reserve(3 * points.size());
  for (const Eigen::Vector3d& world : points) {
    const Eigen::Vector3d p = y_up(world);
    for (int axis = 0; axis < 3; ++axis) numbers.push_back(static_cast<float>(p[axis] + 0.0));
  }
  return numbers;
}

// The linear part of a colour, from its sRGB part (IEC 61966-2-1); both of 255.
std::uint8_t linear_shade(std::uint8_t part) {
  const double shade = part / 255.0;
  const double linear = shade <= 0.04045 ? shade / 12.92 : std::pow((shade + 0.055) / 1.055, 2.4);
  return static_cast<std::uint8_t>(std::lround(255 * linear));
}

}  // namespace

Eigen::Vector3d y_up(const Eigen::Vector3d& world) {
  return {world.x(), world.z(), -world.y()};
}

GltfDocument::GltfDocument() = default;

int GltfDocument::add_view(const void* bytes, std::size_t size, int target) {
  Value view = json_map({{"buffer", 0},
                         {"byteOffset", static_cast<std::int64_t>(buffer_.size())},
                         {"byteLength", static_cast<std::int64_t>(size)}});
  if (target != kNoTarget) view.set("target", target);
  buffer_.append(static_cast<const char*>(bytes), size);
  return last_of(views_, view);
}

int GltfDocument::add_accessor(const std::vector<float>& numbers, int width, bool bounds,
                               int target) {
  const char* type = width == 1 ? "SCALAR" : width == 3 ? "VEC3" : "VEC4";
  const std::size_t count = numbers.size() / static_cast<std::size_t>(width);
  Value accessor =
      json_map({{"bufferView", add_view(numbers.data(), numbers.size() * sizeof(float), target)},
                {"componentType", kFloat},
                {"count", static_cast<std::int64_t>(count)},
                {"type", type}});
  if (bounds) {
    Value lowest = Value::list(), highest = Value::list();
    for (std::size_t k = 0; k < static_cast<std::size_t>(width); ++k) {
      float low = numbers[k], high = numbers[k];
      for (std::size_t i = k; i < numbers.size(); i += static_cast<std::size_t>(width)) {
        low = std::min(low, numbers[i]);
        high = std::max(high, numbers[i]);
      }
      lowest.push_back(static_cast<double>(low));
      highest.push_back(static_cast<double>(high));
    }
    accessor.set("min", lowest);
    accessor.set("max", highest);
  }
  return last_of(accessors_, accessor);
}

int GltfDocument::add_colors(const std::vector<std::uint8_t>& colors) {
  return last_of(accessors_,
                 json_map({{"bufferView", add_view(colors.data(), colors.size(), kVertices)},
                           {"componentType", kByte},
                           {"normalized", true},
                           {"count", static_cast<std::int64_t>(colors.size() / 4)},
                           {"type", "VEC4"}}));
}

int GltfDocument::add_indices(const std::vector<std::uint32_t>& numbers) {
  return last_of(accessors_,
                 json_map({{"bufferView", add_view(numbers.data(), 4 * numbers.size(), kIndices)},
                           {"componentType", kUnsigned},
                           {"count", static_cast<std::int64_t>(numbers.size())},
                           {"type", "SCALAR"}}));
}

int GltfDocument::add_material(const Eigen::Vector4d& color) {
  Value material = json_map(
      {{"pbrMetallicRoughness",
        json_map({{"baseColorFactor", Value(Value::List{color[0], color[1], color[2], color[3]})},
                  {"metallicFactor", 0.0},
                  {"roughnessFactor", 1.0}})},
       {"doubleSided", true}});
  if (color[3] < 1) material.set("alphaMode", "BLEND");
  return last_of(materials_, material);
}

int GltfDocument::add_node(const std::string& name, const std::string& fallback, Value node) {
  node.set("name", as_utf8(name.empty() ? fallback : name));
  return last_of(nodes_, std::move(node));
}

int GltfDocument::add_camera(Value camera) {
  return last_of(cameras_, std::move(camera));
}

int GltfDocument::add_lines(const std::vector<std::vector<Eigen::Vector3d>>& lines,
                            const Eigen::Vector4d& color) {
  const int material = add_material(color);
  Value primitives = Value::list();
  for (const auto& line : lines)
    primitives.push_back(json_map(
        {{"attributes", json_map({{"POSITION", add_accessor(flat(line), 3, true, kVertices)}})},
         {"material", material},
         {"mode", kLineStrip}}));
  return last_of(meshes_, json_map({{"primitives", primitives}}));
}

int GltfDocument::add_triangles(const TriangleMesh& mesh, const Eigen::Vector4d& color) {
  const int points = add_accessor(flat(mesh.vertices), 3, true, kVertices);
  std::vector<std::uint32_t> corners;
  for (const auto& triangle : mesh.triangles)
    for (const std::int32_t corner : triangle)
      corners.push_back(static_cast<std::uint32_t>(corner));
  return last_of(
      meshes_,
      json_map({{"primitives",
                 Value(Value::List{json_map({{"attributes", json_map({{"POSITION", points}})},
                                             {"indices", add_indices(corners)},
                                             {"material", add_material(color)}})})}}));
}

int GltfDocument::add_colored_triangles(const TriangleMesh& mesh, const std::vector<Rgb>& colors,
                                        const std::vector<TriangleNumbers>& numbers) {
  // Corners are not shared: they have the colour and the numbers of their triangle.
  std::vector<Eigen::Vector3d> corners;
  std::vector<std::uint8_t> shades;  // four a corner, so that each begins at a multiple of 4 bytes
  corners.reserve(3 * mesh.triangles.size());
  shades.reserve(12 * mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int corner = 0; corner < 3; ++corner) {
      corners.push_back(mesh.corner(t, corner));
      for (const std::uint8_t part : colors[t]) shades.push_back(linear_shade(part));
      shades.push_back(255);
    }
  Value attributes = json_map({{"POSITION", add_accessor(flat(corners), 3, true, kVertices)},
                               {"COLOR_0", add_colors(shades)}});
  for (const TriangleNumbers& one : numbers) {
    std::vector<float> repeated;
    repeated.reserve(3 * one.values.size());
    for (const float value : one.values) repeated.insert(repeated.end(), 3, value);
    attributes.set(one.name, add_accessor(repeated, 1, false, kVertices));
  }
  return last_of(
      meshes_,
      json_map({{"primitives",
                 Value(Value::List{json_map(
                     {{"attributes", attributes}, {"material", add_material({1, 1, 1, 1})}})})}}));
}

void GltfDocument::animate(int node, const std::vector<double>& times,
                           const std::vector<Eigen::Vector3d>& places,
                           const std::vector<Eigen::Quaterniond>& orientations) {
  const int input = add_accessor({times.begin(), times.end()}, 1, true, kNoTarget);
  const auto add = [&](const char* path, int output) {
    const int sampler = last_of(
        samplers_, json_map({{"input", input}, {"interpolation", "LINEAR"}, {"output", output}}));
    channels_.push_back(
        json_map({{"sampler", sampler}, {"target", json_map({{"node", node}, {"path", path}})}}));
  };
  add("translation", add_accessor(flat(places), 3, false, kNoTarget));
  if (orientations.empty()) return;
  std::vector<float> turns;
  Eigen::Quaterniond before = orientations.front();
  for (Eigen::Quaterniond q : orientations) {
    // Both signs are one orientation; players turn the shorter way between equal signs.
    if (q.dot(before) < 0) q.coeffs() *= -1;
    before = q;
    for (int k = 0; k < 4; ++k) turns.push_back(static_cast<float>(q.coeffs()[k] + 0.0));
  }
  add("rotation", add_accessor(turns, 4, false, kNoTarget));
}

std::string GltfDocument::binary(const std::string& scene) const {
  Value roots = Value::list();
  for (std::size_t i = 0; i < nodes_.as_list().size(); ++i)
    roots.push_back(static_cast<std::int64_t>(i));
  Value document = json_map(
      {{"asset", json_map({{"version", "2.0"}, {"generator", "Lapwing"}})},
       {"scene", 0},
       {"scenes", Value(Value::List{json_map({{"name", as_utf8(scene)}, {"nodes", roots}})})},
       {"nodes", nodes_}});
  for (const auto& [key, list] :
       {std::pair{"cameras", &cameras_}, std::pair{"meshes", &meshes_},
        std::pair{"materials", &materials_}, std::pair{"accessors", &accessors_},
        std::pair{"bufferViews", &views_}})
    if (!list->as_list().empty()) document.set(key, *list);
  if (!channels_.as_list().empty())
    document.set("animations",
                 Value(Value::List{json_map(
                     {{"name", "flight"}, {"channels", channels_}, {"samplers", samplers_}})}));
  document.set(
      "buffers",
      Value(Value::List{json_map({{"byteLength", static_cast<std::int64_t>(buffer_.size())}})}));
  std::string chunks;
  put_chunk(chunks, "JSON", to_json(document, -1), ' ');
  put_chunk(chunks, std::string("BIN\0", 4).c_str(), buffer_, '\0');
  std::string out = "glTF";
  put_word(out, 2);
  put_word(out, 12 + chunks.size());
  return out + chunks;
}

}  // namespace lapwing
