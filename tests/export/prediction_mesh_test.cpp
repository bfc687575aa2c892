// SPDX-License-Identifier: Apache-2.0
// The meshes of what a scan will show, read back from their bytes.
#include "framework/export/prediction_mesh.h"

#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/core/json.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

// A square of two triangles and a third one beside it: of one image, of four, outside the region.
ScanPrediction three_triangles() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 1}, {2, 0, 1}, {2, 2, 1}, {0, 2, 1}, {4, 0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {1, 4, 2}};
  ScanPrediction p;
  p.surface = std::make_shared<MeshScene>(std::move(mesh));
  p.counted = {1, 1, 0};
  p.triangles.resize(3);
  p.triangles[0] = {1, 0.5f, 0.004f, 0, std::numeric_limits<float>::infinity()};
  p.triangles[1] = {4, 0.25f, 0.003f, 0.5f, 0.012f};
  p.pixel_error = 0.5;
  return p;
}

struct Glb {
  Value document;
  std::string buffer;

  explicit Glb(const std::string& bytes) {
    EXPECT_EQ(bytes.substr(0, 4), "glTF");
    EXPECT_EQ(word(bytes, 4), 2u);
    EXPECT_EQ(word(bytes, 8), bytes.size());
    const std::size_t length = word(bytes, 12);
    EXPECT_EQ(bytes.substr(16, 4), "JSON");
    document = from_json(bytes.substr(20, length), "glb");
    EXPECT_EQ(bytes.substr(24 + length, 3), "BIN");
    buffer = bytes.substr(28 + length);
    EXPECT_EQ(document.at("buffers").as_list()[0].at("byteLength").as_integer(),
              static_cast<std::int64_t>(buffer.size()));
  }

  static std::uint32_t word(const std::string& bytes, std::size_t at) {
    std::uint32_t number = 0;
    std::memcpy(&number, bytes.data() + at, 4);
    return number;
  }

  template <typename Number = float>
  std::vector<Number> attribute(const char* name, std::size_t width) const {
    const auto entry = [&](const char* list, const Value& index) -> const Value& {
      return document.at(list).as_list()[static_cast<std::size_t>(index.as_integer())];
    };
    const Value& primitive = document.at("meshes").as_list()[0].at("primitives").as_list()[0];
    const Value& accessor = entry("accessors", primitive.at("attributes").at(name));
    EXPECT_EQ(accessor.at("componentType").as_integer(), sizeof(Number) == 4 ? 5126 : 5121);
    EXPECT_EQ(accessor.at("count").as_integer(), 9) << name << ": three corners of each triangle";
    const Value& view = entry("bufferViews", accessor.at("bufferView"));
    std::vector<Number> numbers(9 * width);
    std::memcpy(numbers.data(), buffer.data() + view.at("byteOffset").as_integer(),
                sizeof(Number) * numbers.size());
    return numbers;
  }
};

TEST(PredictionMesh, TheGlbHoldsColoursAndFigures) {
  const ScanPrediction p = three_triangles();
  const Glb glb(prediction_glb(p));
  const std::vector<float> places = glb.attribute("POSITION", 3);
  // Corner 2 of triangle 0, (2, 2, 1) in the world: y up.
  EXPECT_EQ((std::vector<float>{places[6], places[7], places[8]}), (std::vector<float>{2, 1, -2}));
  const std::vector<float> images = glb.attribute("_IMAGES", 1);
  EXPECT_EQ(images, (std::vector<float>{1, 1, 1, 4, 4, 4, -1, -1, -1}));
  const std::vector<float> accuracy = glb.attribute("_ACCURACY_MM", 1);
  EXPECT_EQ(accuracy[0], -1) << "one image";
  EXPECT_NEAR(accuracy[3], 12, 1e-4);
  EXPECT_NEAR(glb.attribute("_MM_PER_PIXEL", 1)[0], 4, 1e-4);
  EXPECT_NEAR(glb.attribute("_INCIDENCE_DEG", 1)[3], 0.25 * 180 / M_PI, 1e-4);
  EXPECT_NEAR(glb.attribute("_PARALLAX_DEG", 1)[5], 0.5 * 180 / M_PI, 1e-4);
  // Colours are linear: those of the picture brought from sRGB.
  const std::vector<Rgb> colors = triangle_colors(p, prediction_colors(p));
  const std::vector<std::uint8_t> shades = glb.attribute<std::uint8_t>("COLOR_0", 4);
  for (std::size_t t = 0; t < 3; ++t) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double linear = std::pow((colors[t][c] / 255.0 + 0.055) / 1.055, 2.4);
      EXPECT_NEAR(shades[12 * t + c],
                  255 * (colors[t][c] > 10 ? linear : colors[t][c] / 255.0 / 12.92), 0.5 + 1e-6);
    }
    EXPECT_EQ(shades[12 * t + 3], 255) << "opaque";
  }
  EXPECT_NE(colors[0], colors[1]);
}

TEST(PredictionMesh, ThePlyHoldsTheSame) {
  const std::string ply = prediction_ply(three_triangles());
  const std::size_t head = ply.find("end_header\n") + 11;
  constexpr std::size_t kFace = 1 + 3 * 4 + 3 + 4 + 4 * 4;
  ASSERT_EQ(ply.size(), head + 5 * 12 + 3 * kFace);
  const auto number = [&](std::size_t face, std::size_t at) {
    float value = 0;
    std::memcpy(&value, ply.data() + head + 5 * 12 + face * kFace + at, 4);
    return value;
  };
  EXPECT_NEAR(number(1, kFace - 4), 12, 1e-4);
  EXPECT_EQ(number(0, kFace - 4), -1);
  std::int32_t images = 0;
  std::memcpy(&images, ply.data() + head + 5 * 12 + 2 * kFace + 16, 4);
  EXPECT_EQ(images, -1);
}

// Of as many triangles as it may have, the surface itself; with fewer, some of them, each with the
// figures of one.
TEST(PredictionMesh, ACoarseSurfaceKeepsFiguresAndIsSmall) {
  const std::string bytes = coarse_prediction(three_triangles(), 1000);
  ASSERT_EQ(bytes.substr(0, 4), "WLP1");
  ASSERT_EQ(Glb::word(bytes, 4), 5u);
  ASSERT_EQ(Glb::word(bytes, 8), 3u);
  ASSERT_EQ(bytes.size(), 36 + 5 * 6 + 3 * 24u);
  const auto figure = [&](std::size_t triangle, std::size_t which) {
    std::string raw(1, '\0');
    raw += bytes.substr(36 + 5 * 6 + 24 * triangle + 12 + 3 * which, 3);
    float number = 0;
    std::memcpy(&number, raw.data(), sizeof number);
    return number;
  };
  const auto images = [&](std::size_t triangle) {
    std::int16_t number = 0;
    std::memcpy(&number, bytes.data() + 36 + 5 * 6 + 24 * triangle + 6, sizeof number);
    return number;
  };
  EXPECT_EQ(images(0), 1);
  EXPECT_EQ(images(1), 4);
  EXPECT_EQ(images(2), -1);              // outside the region
  EXPECT_NEAR(figure(1, 3), 12, 12e-4);  // mm
  EXPECT_EQ(figure(0, 3), -1);
  const std::string small = coarse_prediction(three_triangles(), 1);
  EXPECT_LE(Glb::word(small, 8), 1u);
  EXPECT_THROW(coarse_prediction(three_triangles(), 0), InputError);
  EXPECT_THROW(coarse_prediction(three_triangles(), kMostCoarse + 1), InputError);
}

}  // namespace
}  // namespace lapwing
