// SPDX-License-Identifier: Apache-2.0
// A flight as a glTF scene: an animated camera, its path, and what surrounds it.
//
//   lapwing export out/hello/plan.json --format gltf -o hello.glb
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/export/camera_track.h"
#include "framework/export/exporter.h"
#include "framework/export/gltf_document.h"
#include "framework/export/surroundings.h"
#include "framework/geometry/depth_camera.h"
#include "framework/plugin/plugin.h"
#include "framework/shape/surfaces.h"
#include "framework/trajectory/interpolate.h"
#include "plugins/exporters/gltf/playback.h"

namespace lapwing {
namespace {

const Eigen::Vector4d kPath{0.05, 0.2, 0.8, 1}, kSubject{0.8, 0.2, 0.05, 1},
    kObstacle{0.4, 0.35, 0.3, 0.6}, kGate{0.9, 0.6, 0.02, 1}, kStroke{1, 0.9, 0.3, 1};
constexpr double kTolerance = 0.02;  // m, chords of subjects and balls

class Gltf final : public Exporter {
 public:
  static constexpr PluginText kText{
      "gltf", "1.0.0", "animated camera, path and surroundings as a glTF 2.0 scene (.glb), y up",
      "https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html"};
  static ParameterTable parameters() {
    return ParameterTable{}.number("frame_rate", 60, "1/s", "keys per second", between(24, 1000));
  }
  explicit Gltf(const Parameters& parameters) : rate_(parameters.number("frame_rate")) {}

  std::string file_extension() const override { return ".glb"; }

  bool shows_surroundings() const override { return true; }

  std::string write(const Plan& plan) const override {
    GltfDocument document;
    add_flight(document, plan);
    add_path(document, plan);
    add_subjects(document, plan);
    for (const Obstacle& obstacle : plan.environment.obstacles)
      add_obstacle(document, plan, obstacle);
    add_task(document, plan);
    return document.binary(plan.mission + (states_certified(plan) ? "" : " (not certified)"));
  }

  std::vector<std::string> losses(const Plan& plan, const std::string& written) const override {
    const gltf_file::AnimatedNode node = gltf_file::animated_node(written);
    const double start = plan.trajectory.samples.front().time;
    const int steps = 4 * static_cast<int>(node.times.size());
    std::vector<std::string> said{
        std::to_string(node.times.size()) + " keys, " + plain_number(rate_) +
        " a second and one at the end, y up (x east, y up, z south), in metres"};
    Plan compared = plan;
    if (!plan.trajectory.has_gimbal) {
      said.push_back("no gimbal turns a camera: the node 'vehicle' has place and heading");
      for (Sample& s : compared.trajectory.samples) s.gimbal_yaw = s.gimbal_pitch = 0;
    }
    said.push_back(
        sentence_of(deviation_of(compared, start, plan.trajectory.samples.back().time, steps,
                                 [&](double time) { return node.at(time - start); })) +
        ", between keys included");
    if (!plan.cuts.empty()) said.push_back("cuts are not marked: they are in the animation");
    std::string unseen;
    for (std::size_t i = 0; i < plan.environment.obstacles.size(); ++i)
      if (drawn_surface(plan.environment.obstacles[i], plan, {}).triangles.empty())
        unseen += (unseen.empty() ? "" : ", ") + plan.environment.obstacles[i].label(i + 1);
    if (!unseen.empty()) said.push_back("without a surface here, and left out: " + unseen);
    return said;
  }

 private:
  std::vector<double> key_times(const Plan& plan) const {
    std::vector<double> times = frame_times(plan.trajectory, rate_, "gltf");
    const double end = plan.trajectory.samples.back().time;
    if (end - times.back() > 1e-3) times.push_back(end);
    return times;
  }

  // The first node: what `losses` reads back.
  void add_flight(GltfDocument& document, const Plan& plan) const {
    const bool films = plan.trajectory.has_gimbal;
    const std::vector<double> times = key_times(plan);
    std::vector<double> seconds;
    std::vector<Eigen::Vector3d> places;
    std::vector<Eigen::Quaterniond> turns;
    for (const double time : times) {
      const Sample s = sample_at(plan.trajectory, time);
      seconds.push_back(time - times.front());
      places.push_back(s.position);
      turns.push_back(in_y_up(
          camera_pose(s.position, s.yaw + (films ? s.gimbal_yaw : 0), films ? s.gimbal_pitch : 0)));
    }
    Value node = Value::map();
    if (films) node.set("camera", document.add_camera(optics(filming_camera(plan, "gltf"))));
    const int number = document.add_node(films ? "camera" : "vehicle", "", node);
    document.animate(number, seconds, places, turns);
  }

  // From the axes of the camera of glTF (x right, y up, z back) to its world.
  static Eigen::Quaterniond in_y_up(const Pose& pose) {
    const Eigen::Matrix3d axes = pose.orientation.toRotationMatrix();
    Eigen::Matrix3d turned;
    turned.col(0) = y_up(axes.col(0));
    turned.col(1) = -y_up(axes.col(1));
    turned.col(2) = -y_up(axes.col(2));
    return Eigen::Quaterniond(turned).normalized();
  }

  static Value optics(const Pinhole& camera) {
    Value perspective = Value::map();
    perspective.set("aspectRatio",
                    camera.width * camera.focal_y / (camera.height * camera.focal_x));
    perspective.set("yfov", 2 * std::atan(camera.height / (2 * camera.focal_y)));
    perspective.set("znear", 0.05);
    Value value = Value::map();
    value.set("type", "perspective");
    value.set("perspective", perspective);
    return value;
  }

  void add_path(GltfDocument& document, const Plan& plan) const {
    std::vector<Eigen::Vector3d> path;
    for (const double time : key_times(plan))
      path.push_back(sample_at(plan.trajectory, time).position);
    if (path.size() > 1) add_mesh(document, "path", "", document.add_lines({path}, kPath));
  }

  static int add_mesh(GltfDocument& document, const std::string& name, const std::string& fallback,
                      int mesh) {
    Value node = Value::map();
    node.set("mesh", mesh);
    return document.add_node(name, fallback, node);
  }

  // Those without a size are drawn as persons, as in the report.
  static void add_subjects(GltfDocument& document, const Plan& plan) {
    int count = 0;
    for (const Subject& subject : plan.environment.subjects) {
      const double height = subject.height > 0 ? subject.height : 1.8;
      const double radius = (subject.width > 0 ? subject.width : height / 3.6) / 2;
      const Eigen::Vector3d middle = subject.positions.front();
      const TriangleMesh surface =
          turned_surface({{radius, -height / 2}, {radius, height / 2}},
                         chords_of(radius, kTolerance), Eigen::Vector3d::Zero());
      Value node = Value::map();
      node.set("mesh", document.add_triangles(surface, kSubject));
      const Eigen::Vector3d place = y_up(middle) + Eigen::Vector3d::Zero();
      node.set("translation", Value(Value::List{place.x(), place.y(), place.z()}));
      const int number =
          document.add_node(subject.name, "subject " + std::to_string(++count), node);
      move(document, plan, number, subject.times, subject.positions);
    }
  }

  static void add_obstacle(GltfDocument& document, const Plan& plan, const Obstacle& obstacle) {
    const TriangleMesh surface = drawn_surface(obstacle, plan, {});
    if (surface.triangles.empty()) return;
    Eigen::Vector4d color = kObstacle;
    if (obstacle.side == Side::keep_inside) color[3] = 0.15;
    Value node = Value::map();
    node.set("mesh", document.add_triangles(surface, color));
    const int number = document.add_node(obstacle.name, obstacle.type, node);
    if (!obstacle.still()) move(document, plan, number, obstacle.times, obstacle.moves);
  }

  // Keys of a track, its times counted from the start of the flight; glTF has none before 0.
  static void move(GltfDocument& document, const Plan& plan, int node,
                   const std::vector<double>& times, const std::vector<Eigen::Vector3d>& places) {
    if (times.size() < 2) return;
    const double start = plan.trajectory.samples.front().time;
    const auto at = [&](double time) { return Subject{"", times, places}.position(time); };
    std::vector<double> seconds{0};
    std::vector<Eigen::Vector3d> keys{at(start)};
    for (std::size_t i = 0; i < times.size(); ++i) {
      if (times[i] - start < seconds.back() + 1e-3) continue;
      seconds.push_back(times[i] - start);
      keys.push_back(places[i]);
    }
    document.animate(node, seconds, keys, {});
  }

  static void add_task(GltfDocument& document, const Plan& plan) {
    int count = 0;
    for (const GateTask& gate : plan.task.gates) {
      const std::string fallback = "gate " + std::to_string(++count);
      if (gate.ball()) {
        const int chords = chords_of(gate.radius, kTolerance);
        std::vector<Eigen::Vector2d> profile;
        for (int i = 0; i <= chords / 2; ++i) {
          const double angle = M_PI * (static_cast<double>(i) / (chords / 2) - 0.5);
          profile.emplace_back(gate.radius * std::max(0.0, std::cos(angle)),
                               gate.radius * std::sin(angle));
        }
        Eigen::Vector4d color = kGate;
        color[3] = 0.3;
        add_mesh(document, gate.name, fallback,
                 document.add_triangles(turned_surface(profile, chords, gate.position), color));
        continue;
      }
      std::vector<Eigen::Vector3d> outline;
      for (std::size_t i = 0; i <= gate.corners.size(); ++i) {
        const Eigen::Vector2d& c = gate.corners[i % gate.corners.size()];
        outline.push_back(gate.position + c.x() * gate.left() + c.y() * gate.up);
      }
      add_mesh(document, gate.name, fallback, document.add_lines({outline}, kGate));
    }
    std::vector<std::vector<Eigen::Vector3d>> strokes;
    for (const Points& stroke : plan.task.strokes)
      if (stroke.size() > 1) strokes.emplace_back(stroke.begin(), stroke.end());
    if (!strokes.empty()) add_mesh(document, "strokes", "", document.add_lines(strokes, kStroke));
  }

  double rate_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Gltf)
