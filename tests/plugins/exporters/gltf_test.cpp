// SPDX-License-Identifier: Apache-2.0
// The bytes of a .glb file, read by code of this test. scripts/judge.sh has others judge them.
#include <gtest/gtest.h>

#include <cstring>

#include "framework/core/error.h"
#include "framework/core/json.h"
#include "framework/export/film_view.h"
#include "framework/trajectory/interpolate.h"
#include "tests/plugins/exporters/planned_camera.h"

namespace lapwing {
namespace {

struct Glb {
  Value json;
  std::string buffer;

  explicit Glb(const std::string& file) {
    EXPECT_EQ(file.substr(0, 4), "glTF");
    EXPECT_EQ(number(file, 4), 2u);
    EXPECT_EQ(number(file, 8), file.size());
    EXPECT_EQ(file.substr(16, 4), "JSON");
    const std::size_t size = number(file, 12);
    EXPECT_EQ(size % 4, 0u);
    EXPECT_EQ(file.substr(24 + size, 4), std::string("BIN\0", 4));
    json = from_json(file.substr(20, size), "glb");
    buffer = file.substr(28 + size);
  }
  static std::uint32_t number(const std::string& bytes, std::size_t at) {
    std::uint32_t n = 0;
    std::memcpy(&n, bytes.data() + at, 4);
    return n;
  }
  float float_at(int accessor, std::size_t i) const {
    const Value& view = json.at("bufferViews")
                            .as_list()[json.at("accessors")
                                           .as_list()[static_cast<std::size_t>(accessor)]
                                           .at("bufferView")
                                           .as_integer()];
    float f = 0;
    std::memcpy(&f, buffer.data() + view.at("byteOffset").as_integer() + 4 * i, 4);
    return f;
  }
  const Value& node(const std::string& name) const {
    for (const Value& node : json.at("nodes").as_list())
      if (node.at("name").as_text() == name) return node;
    throw Error("no node " + name);
  }
};

// With everything that a file can hold and names that JSON must escape.
Plan crowded() {
  Plan plan = planned_camera();
  Subject walker;
  walker.name = "\"Jos\u00e9\" \\ </script>\n";
  walker.times = {-1, 1, 5};
  walker.positions = {{0, 0, 1}, {2, 0, 1}, {2, 8, 1}};
  walker.height = 2;
  Subject nameless;
  nameless.times = {0};
  nameless.positions = {{5, 6, 7}};
  plan.environment.subjects = {walker, nameless};
  Obstacle block;
  block.name = "\xff broken";
  block.type = "own";
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->vertices = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
  mesh->triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  block.triangles = mesh;
  block.times = {0, 2};
  block.moves = {{0, 0, 0}, {1, 0, 0}};
  Obstacle unknown;
  unknown.name = "cave";
  unknown.type = "map";
  plan.environment.obstacles = {block, unknown};
  GateTask gate;
  gate.position = {1, 2, 3};
  gate.direction = {1, 0, 0};
  gate.corners = {{-1, -1}, {1, -1}, {1, 1}};
  GateTask ball;
  ball.name = "ball";
  ball.radius = 2;
  plan.task.gates = {gate, ball};
  plan.task.strokes = {{{0, 0, 0}, {1, 0, 1}, {2, 0, 0}}};
  return plan;
}

// A camera of glTF: looks along -z of its node, y up; rotation matrix from the textbook.
TEST(Gltf, PointsFallWhereThePlansCameraSeesThem) {
  const Plan plan = planned_camera();
  const Glb glb(exporter_named("gltf")->write(plan));
  const Value& perspective = glb.json.at("cameras").as_list()[0].at("perspective");
  const double scale = 240 / std::tan(perspective.at("yfov").as_number() / 2);
  EXPECT_NEAR(perspective.at("aspectRatio").as_number(), 640.0 / 480, 1e-12);
  const Value& animation = glb.json.at("animations").as_list()[0];
  const auto sampler = [&](std::size_t i) -> const Value& {
    return animation.at("samplers").as_list()[i];
  };
  ASSERT_EQ(animation.at("channels").as_list().size(), 2u);
  const int times = static_cast<int>(sampler(0).at("input").as_integer());
  const int places = static_cast<int>(sampler(0).at("output").as_integer());
  const int turns = static_cast<int>(sampler(1).at("output").as_integer());
  const auto count = static_cast<std::size_t>(
      glb.json.at("accessors").as_list()[static_cast<std::size_t>(times)].at("count").as_integer());
  ASSERT_EQ(count, 123u);  // 121 of 60 a second, and the end at 2.03 s
  EXPECT_FLOAT_EQ(glb.float_at(times, count - 1), 2.03f);
  for (std::size_t i = 0; i < count; ++i) {
    const CameraView view =
        view_of(sample_at(plan.trajectory, std::min<double>(glb.float_at(times, i), 2.03)),
                filming_drone().camera.pinhole());
    const double x = glb.float_at(turns, 4 * i), y = glb.float_at(turns, 4 * i + 1),
                 z = glb.float_at(turns, 4 * i + 2), w = glb.float_at(turns, 4 * i + 3);
    EXPECT_NEAR(x * x + y * y + z * z + w * w, 1, 1e-6);
    Eigen::Matrix3d r;
    r << 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 2 * (x * y + w * z),
        1 - 2 * (x * x + z * z), 2 * (y * z - w * x), 2 * (x * z - w * y), 2 * (y * z + w * x),
        1 - 2 * (x * x + y * y);
    for (const double across : {10.0, 600.0}) {
      const Eigen::Vector3d p = view.position + 5 * view.ray(across, 100);
      const Eigen::Vector3d local =
          r.transpose() *
          (Eigen::Vector3d(p.x(), p.z(), -p.y()) -
           Eigen::Vector3d(glb.float_at(places, 3 * i), glb.float_at(places, 3 * i + 1),
                           glb.float_at(places, 3 * i + 2)));
      EXPECT_NEAR(319.5 + scale * local.x() / -local.z(), across, 1e-3);
      EXPECT_NEAR(239.5 - scale * local.y() / -local.z(), 100, 1e-3);
    }
    if (i > 0) {
      double dot = 0;
      for (std::size_t k = 0; k < 4; ++k)
        dot += glb.float_at(turns, 4 * i + k) * glb.float_at(turns, 4 * i - 4 + k);
      EXPECT_GT(dot, 0) << "players would turn the long way";
    }
  }
}

TEST(Gltf, HoldsSubjectsObstaclesGatesAndStrokes) {
  const Glb glb(exporter_named("gltf")->write(crowded()));
  const auto& nodes = glb.json.at("nodes").as_list();
  ASSERT_EQ(nodes.size(), 8u);
  EXPECT_EQ(glb.json.at("scenes").as_list()[0].at("nodes").as_list().size(), 8u);
  const Value& nameless = glb.node("subject 2").at("translation");
  EXPECT_EQ(nameless.as_list()[0].as_number(), 5);
  EXPECT_EQ(nameless.as_list()[1].as_number(), 7);
  EXPECT_EQ(nameless.as_list()[2].as_number(), -6);
  for (const char* name :
       {"\"Jos\u00e9\" \\ </script>\n", "\ufffd broken", "gate 1", "ball", "strokes", "path"})
    EXPECT_TRUE(glb.node(name).find("mesh")) << name;
  // Camera twice, walker and block; the walker begins amid its track.
  const Value& animation = glb.json.at("animations").as_list()[0];
  ASSERT_EQ(animation.at("channels").as_list().size(), 4u);
  const Value& walk = animation.at("samplers").as_list()[2];
  const int times = static_cast<int>(walk.at("input").as_integer());
  const int places = static_cast<int>(walk.at("output").as_integer());
  EXPECT_EQ(glb.float_at(times, 0), 0);
  EXPECT_EQ(glb.float_at(times, 2), 5);
  EXPECT_EQ(glb.float_at(places, 0), 1);
  EXPECT_EQ(glb.float_at(places, 8), -8);
}

TEST(Gltf, StatesItsLossAndWhatIsLeftOut) {
  const Plan plan = crowded();
  const auto gltf = exporter_named("gltf", with_frame_rate(30));
  const std::string file = gltf->write(plan);
  // The sagitta of a chord of 1/30 rad on a circle of 10 m is 1.39 mm.
  EXPECT_TRUE(says(gltf->losses(plan, file), "at most 1.39 mm")) << gltf->losses(plan, file)[1];
  EXPECT_TRUE(says(gltf->losses(plan, file), "cave"));
  Plan moved = plan;
  for (Sample& s : moved.trajectory.samples) s.position.z() += 1;
  EXPECT_TRUE(says(gltf->losses(moved, file), "at most 1e+03 mm"));
  EXPECT_THROW(gltf->losses(plan, file.substr(0, 5000)), Error);
}

TEST(Gltf, AFlightWithoutACameraHasAVehicle) {
  Plan race = planned_camera();
  race.trajectory.has_gimbal = false;
  race.vehicle = Value();
  const auto gltf = exporter_named("gltf");
  const Glb glb(gltf->write(race));
  EXPECT_FALSE(glb.json.find("cameras"));
  EXPECT_TRUE(glb.node("vehicle").find("name"));
  EXPECT_TRUE(says(gltf->losses(race, gltf->write(race)), "no gimbal"));
  const std::string scene = glb.json.at("scenes").as_list()[0].at("name").as_text();
  EXPECT_EQ(scene, race.mission + " (not certified)");
  race.trajectory.samples.clear();
  EXPECT_THROW(gltf->write(race), InputError);
  for (const double rate : {0.0, -1.0, 23.0, 1e9})
    EXPECT_THROW(exporter_named("gltf", with_frame_rate(rate)), InputError);
}

}  // namespace
}  // namespace lapwing
