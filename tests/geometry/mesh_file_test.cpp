// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/geometry/mesh_builder.h"
#include "framework/geometry/mesh_file.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;
namespace fs = std::filesystem;

class MeshFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              ("mesh_files_" + std::to_string(::getpid()) + "_" +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return folder_ / name;
  }
  // What is said of a file that cannot be read; "" if it can.
  std::string refusal(const std::string& name, const std::string& text) const {
    try {
      read_mesh(write(name, text));
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
      return error.what();
    }
    return "";
  }

  fs::path folder_;
};

constexpr const char* kObj =
    "# a wall\nv 0 0 0\nv 4 0 0\nv 4 0 3\nv 0 0 3\nvn 0 -1 0\nf 1//1 2//1 3//1 4//1\n";

std::string ply(const std::string& vertices = "4", const std::string& faces = "2") {
  return "ply\nformat ascii 1.0\nelement vertex " + vertices +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " + faces +
         "\nproperty list uchar int vertex_indices\nend_header\n"
         "0 0 0\n4 0 0\n4 0 3\n0 0 3\n3 0 1 2\n3 0 2 3\n";
}

std::string stl_text() {
  return "solid wall\nfacet normal 0 -1 0\nouter loop\nvertex 0 0 0\nvertex 4 0 0\n"
         "vertex 4 0 3\nendloop\nendfacet\nfacet normal 0 -1 0\nouter loop\nvertex 0 0 0\n"
         "vertex 4 0 3\nvertex 0 0 3\nendloop\nendfacet\nendsolid wall\n";
}

std::string stl_binary(std::uint32_t claimed = 2) {
  std::string bytes(80, ' ');
  bytes.append(reinterpret_cast<const char*>(&claimed), 4);
  const float numbers[2][12] = {{0, -1, 0, 0, 0, 0, 4, 0, 0, 4, 0, 3},
                                {0, -1, 0, 0, 0, 0, 4, 0, 3, 0, 0, 3}};
  for (const auto& triangle : numbers) {
    bytes.append(reinterpret_cast<const char*>(triangle), 48);
    bytes.append(2, '\0');
  }
  return bytes;
}

// A wall in the plane of x and the up axis, in units of the file.
std::string collada(const std::string& asset, const std::string& up) {
  const std::string points = up == "Z"   ? "0 0 0 4 0 0 4 0 3 0 0 3"
                             : up == "Y" ? "0 0 0 4 0 0 4 3 0 0 3 0"
                                         : "0 0 0 0 4 0 3 4 0 3 0 0";
  return "<?xml version=\"1.0\"?>\n<COLLADA "
         "xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\"><asset>" +
         asset +
         "</asset><library_geometries><geometry id=\"g\"><mesh><source id=\"p\">"
         "<float_array id=\"a\" count=\"12\">" +
         points +
         "</float_array><technique_common><accessor source=\"#a\" count=\"4\" stride=\"3\">"
         "<param name=\"X\" type=\"float\"/><param name=\"Y\" type=\"float\"/>"
         "<param name=\"Z\" type=\"float\"/></accessor></technique_common></source>"
         "<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>"
         "<triangles count=\"2\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>"
         "<p>0 1 2 0 2 3</p></triangles></mesh></geometry></library_geometries>"
         "<library_visual_scenes><visual_scene id=\"s\"><node id=\"n\">"
         "<instance_geometry url=\"#g\"/></node></visual_scene></library_visual_scenes>"
         "<scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>\n";
}

std::string gltf() {
  // Three corners of a triangle, y up: (0,0,0), (4,0,0), (4,3,0), as base64 of nine floats.
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3",
"min":[0,0,0],"max":[4,3,0]}],"bufferViews":[{"buffer":0,"byteLength":36}],
"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,)"
         "AAAAAAAAAAAAAAAAAACAQAAAAAAAAAAAAACAQAAAQEAAAAAA\"}]}";
}

void expect_wall(const MeshFile& file, double width, double height, std::size_t triangles = 2) {
  EXPECT_EQ(file.mesh.triangles.size(), triangles);
  EXPECT_EQ(file.mesh.vertices.size(), triangles + 2);
  EXPECT_LT((file.mesh.bounds().min() - Vector3d(0, 0, 0)).norm(), 1e-6) << file.description();
  EXPECT_LT((file.mesh.bounds().max() - Vector3d(width, 0, height)).norm(), 1e-5 * width)
      << file.description() << " " << file.mesh.bounds().max().transpose();
  EXPECT_LT((file.mesh.normal(0) - Vector3d(0, -1, 0)).norm(), 1e-5) << file.description();
}

TEST_F(MeshFiles, EveryFormatGivesTheSameWall) {
  expect_wall(read_mesh(write("wall.obj", kObj)), 4, 3);
  expect_wall(read_mesh(write("wall.ply", ply())), 4, 3);
  expect_wall(read_mesh(write("wall.stl", stl_text())), 4, 3);
  expect_wall(read_mesh(write("WALL.STL", stl_binary())), 4, 3);
  for (const std::string up : {"Y", "Z"}) {
    const std::string axis = "<up_axis>" + up + "_UP</up_axis>";
    expect_wall(read_mesh(write("wall.dae", collada(axis, up))), 4, 3);
  }
  expect_wall(read_mesh(write("wall.gltf", gltf())), 4, 3, 1);
}

TEST_F(MeshFiles, UnitAndUpAxisAreAppliedAndReported) {
  const MeshFile inches = read_mesh(write(
      "inch.dae", collada("<unit name=\"inch\" meter=\"0.0254\"/><up_axis>Z_UP</up_axis>", "Z")));
  expect_wall(inches, 4 * 0.0254, 3 * 0.0254);
  EXPECT_EQ(inches.unit, 0.0254);
  EXPECT_EQ(inches.unit_from, StatedBy::file);
  EXPECT_EQ(inches.up, UpAxis::z);
  EXPECT_EQ(inches.description(),
            "Collada, 0.0254 m a unit (stated by the file), z up (stated by the file), 2 "
            "triangles");

  const MeshFile silent = read_mesh(write("silent.dae", collada("", "Y")));
  expect_wall(silent, 4, 3);
  EXPECT_EQ(silent.up_from, StatedBy::standard);
  EXPECT_EQ(silent.unit_from, StatedBy::standard);

  const MeshFile millimetres = read_mesh(write("wall.obj", kObj), {.unit = 0.001});
  expect_wall(millimetres, 0.004, 0.003);
  EXPECT_EQ(millimetres.unit_from, StatedBy::caller);
  EXPECT_EQ(millimetres.up_from, StatedBy::assumption);

  // The same numbers taken for other axes: rotated, never mirrored.
  const MeshFile y_up = read_mesh(write("wall.obj", kObj), {.up = UpAxis::y});
  EXPECT_LT((y_up.mesh.normal(0) - Vector3d(0, 0, -1)).norm(), 1e-9);
  EXPECT_LT((y_up.mesh.bounds().min() - Vector3d(0, -3, 0)).norm(), 1e-6);
  const MeshFile x_up = read_mesh(write("wall.obj", kObj), {.up = UpAxis::x});
  EXPECT_LT((x_up.mesh.bounds().max() - Vector3d(0, 0, 4)).norm(), 1e-6);
  const MeshFile overridden = read_mesh(folder_ / "inch.dae", {.unit = 1.0});
  expect_wall(overridden, 4, 3);
  EXPECT_THROW(read_mesh(folder_ / "wall.obj", {.unit = 0.0}), InputError);

  EXPECT_EQ(read_mesh(write("wall.gltf", gltf())).up, UpAxis::y);
}

TEST_F(MeshFiles, HostileFilesAreRefusedByName) {
  const std::string nan_obj = "v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n";
  EXPECT_NE(refusal("nan.obj", nan_obj), "");
  EXPECT_NE(refusal("nan.ply",
                    [] {
                      std::string text = ply();
                      return text.replace(text.find("4 0 3"), 5, "4 0 nan");
                    }()),
            "");
  std::string nan_stl = stl_binary();
  const float nan = std::nanf("");
  std::memcpy(nan_stl.data() + 84 + 12, &nan, 4);
  EXPECT_NE(refusal("nan.stl", nan_stl), "");

  EXPECT_NE(refusal("empty.obj", ""), "");
  EXPECT_NE(refusal("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"), "");
  EXPECT_NE(refusal("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"), "");
  EXPECT_NE(refusal("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"), "");
  EXPECT_NE(refusal("points.ply", ply("4", "0")), "");
  EXPECT_NE(refusal("words.ply", "this is not a mesh"), "");
  EXPECT_NE(refusal("words.stl", "this is not a mesh"), "");
  EXPECT_NE(refusal("words.dae", "this is not a mesh"), "");
  EXPECT_THAT(refusal("words.gltf", "this is not a mesh"), testing::HasSubstr("begins with '{'"));
  EXPECT_NE(refusal("words.glb", "this is not a mesh"), "");
  EXPECT_NE(refusal("wall.step", "x").find("expected .obj"), std::string::npos);

  EXPECT_NE(refusal("claim.ply", ply("1000000000")).find("claims 1000000000 vertex"),
            std::string::npos);
  EXPECT_NE(refusal("claim2.ply", ply("4", "4000000000")), "");
  EXPECT_NE(refusal("claim3.ply", ply("-1")), "");
  EXPECT_NE(refusal("claim.stl", stl_binary(0xfffffff0u)).find("claims 4294967280 triangles"),
            std::string::npos);
  // Documents that crash assimp itself.
  for (const auto& [good, bad] : {std::pair{"count=\"12\"", "bount=\"12\""},
                                  {"stride=\"3\"", "stride=\"0\""},
                                  {"semantic=\"VERTEX\"", "semantic=\"ERTEX\""}}) {
    std::string text = collada("", "Y");
    text.replace(text.find(good), std::strlen(good), bad);
    EXPECT_NE(refusal("crash.dae", text), "") << bad;
  }
  // Numbers that are none, where assimp would wait for ever.
  std::string bad_list = collada("", "Y");
  bad_list.replace(bad_list.find("0 1 2 0 2 3"), 11, "0 1 2 u 2 3");
  EXPECT_NE(refusal("list.dae", bad_list).find("<p> holds 'u'"), std::string::npos);
  std::string bad_count = collada("", "Y");
  bad_count.replace(bad_count.find("count=\"12\""), 10, "count=\"4000000000\"");
  EXPECT_NE(refusal("count.dae", bad_count).find("claims more than the file has"),
            std::string::npos);
  std::string bad_index = ply();
  bad_index.replace(bad_index.find("3 0 2 3"), 7, "3 0 2 9");
  EXPECT_NE(refusal("index.ply", bad_index), "");
  EXPECT_THROW(read_mesh(folder_ / "absent.obj"), InputError);
  EXPECT_THROW(read_mesh(folder_), InputError);
}

TEST_F(MeshFiles, TruncatedFilesNeverCrashAndBinaryOnesAreRefused) {
  MeshBuilder builder;
  builder.ball({0, 0, 0}, {1, 1, 1}, 1);
  const std::string binary_ply = ply_bytes(builder.mesh());
  for (const auto& [name, whole] :
       {std::pair<std::string, std::string>{"cut.ply", binary_ply}, {"cut.stl", stl_binary()}}) {
    for (std::size_t size = 0; size < whole.size(); size += 1 + size / 23) {
      EXPECT_NE(refusal(name, whole.substr(0, size)), "") << name << " of " << size << " bytes";
    }
  }
  for (const auto& [name, whole] :
       {std::pair<std::string, std::string>{"cut.dae", collada("", "Y")}, {"cut.gltf", gltf()}}) {
    for (std::size_t size = 0; size + 5 < whole.size(); size += 41) {
      EXPECT_NE(refusal(name, whole.substr(0, size)), "") << name << " of " << size << " bytes";
    }
  }
  // A text format without an end cannot tell; it must not crash.
  for (const std::string& whole : {std::string(kObj), ply(), stl_text()}) {
    for (std::size_t size = 0; size < whole.size(); size += 3) {
      const std::string name = whole[0] == '#' ? "cut.obj" : whole[0] == 'p' ? "t.ply" : "t.stl";
      refusal(name, whole.substr(0, size));
    }
  }
}

TEST_F(MeshFiles, WhatIsWrittenIsReadBack) {
  MeshBuilder builder;
  builder.set_color({200, 10, 20});
  builder.push({100.25, -50.5, 7}, 0.3);
  builder.box({0, 0, 0}, {1, 2, 3});
  builder.ball({4, 4, 4}, {1, 1, 2}, 2);
  TriangleMesh mesh = builder.take();
  weld(mesh, 0);
  write_ply(mesh, folder_ / "sub" / "out.ply");
  const MeshFile back = read_mesh(folder_ / "sub" / "out.ply");
  ASSERT_EQ(back.mesh.vertices.size(), mesh.vertices.size());
  ASSERT_EQ(back.mesh.triangles.size(), mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_LT((back.mesh.corner(i, k) - mesh.corner(i, k)).norm(), 1e-5);
    }
  }
  ASSERT_EQ(back.mesh.colors.size(), mesh.triangles.size());
  EXPECT_EQ(back.mesh.colors[0], (Rgb{200, 10, 20}));
  // Single precision is exact the second time.
  TriangleMesh plain = back.mesh;
  plain.colors.clear();
  write_ply(plain, folder_ / "again.ply");
  const MeshFile twice = read_mesh(folder_ / "again.ply");
  EXPECT_EQ(twice.mesh.vertices, back.mesh.vertices);
  EXPECT_THROW(write_ply({}, folder_ / "none.ply"), InputError);
  EXPECT_FALSE(fs::exists(folder_ / "none.ply"));
}

TEST_F(MeshFiles, PlyInAllItsKinds) {
  // Big-endian, with numbers and lists that mean nothing here, and a face of four corners.
  std::string big =
      "ply\r\nformat binary_big_endian 1.0\r\ncomment of the sea\r\nelement vertex 4\r\n"
      "property double x\r\nproperty double y\r\nproperty double z\r\nproperty ushort age\r\n"
      "element tag 1\r\nproperty list uchar short words\r\nelement face 1\r\n"
      "property list uint uchar vertex_index\r\nproperty char odd\r\nend_header\r\n";
  const auto append = [&](auto number) {
    char raw[sizeof number];
    std::memcpy(raw, &number, sizeof number);
    std::reverse(raw, raw + sizeof number);
    big.append(raw, sizeof number);
  };
  const double corners[4][3] = {{0, 0, 0}, {4, 0, 0}, {4, 0, 3}, {0, 0, 3}};
  for (const auto& corner : corners) {
    for (const double v : corner) append(v);
    append(std::uint16_t{7});
  }
  append(std::uint8_t{2}), append(std::int16_t{-1}), append(std::int16_t{300});
  append(std::uint32_t{4});
  for (std::uint8_t i = 0; i < 4; ++i) append(i);
  append(std::int8_t{-3});
  expect_wall(read_mesh(write("big.ply", big)), 4, 3);
  for (std::size_t size = 0; size < big.size(); ++size) {
    EXPECT_NE(refusal("big.ply", big.substr(0, size)), "") << size;
  }
  std::string words = ply();
  EXPECT_NE(refusal("words.ply", words.replace(words.find("4 0 3"), 5, "4 x 3")).find("'x'"),
            std::string::npos);
  EXPECT_NE(refusal("format.ply", "ply\nformat morse 1.0\nend_header\n").find("'morse'"),
            std::string::npos);
  std::string no_z = ply();
  no_z.replace(no_z.find("float z"), 7, "float w");
  EXPECT_NE(refusal("no_z.ply", no_z).find("lack x, y or z"), std::string::npos);
}

TEST(RealMeshes, AreReadInMetresWithZUp) {
  const char* data = std::getenv("LAPWING_DATA");
  if (!data) GTEST_SKIP() << "LAPWING_DATA is not set";
  const fs::path folder = fs::path(data) / "meshes";
  // It states z up, yet its galleries lie in the plane of x and z: a file may be wrong about
  // itself.
  EXPECT_EQ(read_mesh(folder / "edgar_mine.dae").up_from, StatedBy::file);
  EXPECT_NEAR(read_mesh(folder / "edgar_mine.dae").mesh.bounds().sizes().y(), 6.6, 0.1);
  const MeshFile mine = read_mesh(folder / "edgar_mine.dae", {.up = UpAxis::y});
  const Vector3d size = mine.mesh.bounds().sizes();
  EXPECT_NEAR(std::min(size.x(), size.y()), 288, 1);
  EXPECT_NEAR(std::max(size.x(), size.y()), 507, 1);
  EXPECT_NEAR(size.z(), 6.6, 0.1);
  EXPECT_EQ(mine.up_from, StatedBy::caller);
  // A house of three storeys is some metres high, not some hundreds of inches.
  const MeshFile house = read_mesh(folder / "gz_house_3.dae");
  EXPECT_EQ(house.unit, 0.0254);
  EXPECT_GT(house.mesh.bounds().sizes().z(), 3);
  EXPECT_LT(house.mesh.bounds().sizes().z(), 30);
  const MeshFile delft = read_mesh(folder / "delft_block.obj");
  EXPECT_NEAR(delft.mesh.bounds().sizes().x(), 150, 30);
  EXPECT_LT(delft.mesh.bounds().sizes().z(), 20);
  const MeshFile spot = read_mesh(folder / "spot.obj");
  EXPECT_NEAR(spot.mesh.bounds().sizes().maxCoeff(), 1.7, 0.2);
  for (const char* name : {"gz_apartment", "gz_fire_station", "gz_gas_station", "gz_powerplant"}) {
    const MeshFile file = read_mesh(folder / (std::string(name) + ".dae"));
    const Vector3d extent = file.mesh.bounds().sizes();
    EXPECT_GT(extent.z(), 2) << name << " " << file.description() << " " << extent.transpose();
    EXPECT_LT(extent.maxCoeff(), 300) << name << " " << file.description();
  }
}

}  // namespace
}  // namespace lapwing
