// SPDX-License-Identifier: Apache-2.0
// A flight as an MCAP recording for Foxglove and ROS tools: JSON messages of Foxglove's schemas.
//
//   lapwing export out/hello/plan.json --format mcap:rate=50 -o hello.mcap
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/json.h"
#include "framework/core/number_text.h"
#include "framework/export/camera_track.h"
#include "framework/export/earth_frame.h"
#include "framework/export/exporter.h"
#include "framework/plugin/plugin.h"
#include "framework/trajectory/interpolate.h"
#include "plugins/exporters/mcap/records.h"

namespace lapwing {
namespace {

constexpr const char* kTransforms = "/tf";

std::uint64_t nanoseconds(double seconds) {
  return static_cast<std::uint64_t>(std::llround(seconds * 1e9));
}

Value made(std::initializer_list<std::pair<const char*, Value>> entries) {
  Value value = Value::map();
  for (const auto& [key, entry] : entries) value.set(key, entry);
  return value;
}

Value stamp(std::uint64_t time) {
  return made({{"sec", static_cast<std::int64_t>(time / 1000000000)},
               {"nsec", static_cast<std::int64_t>(time % 1000000000)}});
}

Value vector_value(const Eigen::Vector3d& v) {
  return made({{"x", v.x()}, {"y", v.y()}, {"z", v.z()}});
}

Value turn_value(const Eigen::Quaterniond& q) {
  return made({{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}});
}

// JSON Schemas of properties {name, type}; an object of numbers by their names.
Value typed(const char* type) {
  return made({{"type", type}});
}
Value object_of(std::initializer_list<std::pair<const char*, Value>> properties) {
  return made({{"type", "object"}, {"properties", made(properties)}});
}
Value vector_schema() {
  return object_of({{"x", typed("number")}, {"y", typed("number")}, {"z", typed("number")}});
}
Value turn_schema() {
  return object_of({{"x", typed("number")},
                    {"y", typed("number")},
                    {"z", typed("number")},
                    {"w", typed("number")}});
}
Value stamp_schema() {
  return object_of({{"sec", typed("integer")}, {"nsec", typed("integer")}});
}
Value list_of(Value items) {
  return made({{"type", "array"}, {"items", std::move(items)}});
}

std::string schema_text(const char* title, Value schema) {
  schema.set("title", title);
  return to_json(schema);
}

class Mcap final : public Exporter {
 public:
  static constexpr PluginText kText{"mcap", "1.0.0",
                                    "recording for Foxglove and robotics tools (.mcap)",
                                    "https://mcap.dev/spec"};
  static ParameterTable parameters() {
    return ParameterTable{}.number("rate", 50, "1/s", "transforms and commands per second",
                                   between(1, 1000));
  }
  explicit Mcap(const Parameters& parameters) : rate_(parameters.number("rate")) {}

  std::string file_extension() const override { return ".mcap"; }

  std::string write(const Plan& plan) const override {
    const std::vector<double> times = frame_times(plan.trajectory, rate_, "mcap");
    path_at(plan, times, "mcap");  // which has a length
    for (const Sample& s : plan.trajectory.samples)
      if (!s.position.allFinite() || !std::isfinite(s.time + s.yaw + s.gimbal_yaw + s.gimbal_pitch))
        throw InputError("mcap: a number of the plan is not finite");
    mcap_file::Writer writer("Lapwing");
    add_once(writer, plan, times);
    const std::uint16_t transforms = writer.add_channel(
        kTransforms, "foxglove.FrameTransform",
        schema_text("foxglove.FrameTransform", object_of({{"timestamp", stamp_schema()},
                                                          {"parent_frame_id", typed("string")},
                                                          {"child_frame_id", typed("string")},
                                                          {"translation", vector_schema()},
                                                          {"rotation", turn_schema()}})));
    const std::uint16_t commands = writer.add_channel(
        "/commands", "lapwing.Command",
        schema_text("lapwing.Command", object_of({{"timestamp", stamp_schema()},
                                                  {"position", vector_schema()},
                                                  {"velocity", vector_schema()},
                                                  {"acceleration", vector_schema()},
                                                  {"yaw", typed("number")},
                                                  {"yaw_rate", typed("number")},
                                                  {"gimbal_yaw", typed("number")},
                                                  {"gimbal_pitch", typed("number")}})));
    for (const double time : times) {
      const Sample s = sample_at(plan.trajectory, time);
      const std::uint64_t at = nanoseconds(time - times.front());
      const Eigen::Quaterniond heading(Eigen::AngleAxisd(s.yaw, Eigen::Vector3d::UnitZ()));
      writer.add_message(transforms, at, transform(at, "vehicle", {s.position, heading}));
      if (plan.trajectory.has_gimbal)
        writer.add_message(transforms, at, transform(at, "camera", filming_pose(plan, time)));
      writer.add_message(commands, at,
                         to_json(made({{"timestamp", stamp(at)},
                                       {"position", vector_value(s.position)},
                                       {"velocity", vector_value(s.velocity)},
                                       {"acceleration", vector_value(s.acceleration)},
                                       {"yaw", s.yaw},
                                       {"yaw_rate", s.yaw_rate},
                                       {"gimbal_yaw", s.gimbal_yaw},
                                       {"gimbal_pitch", s.gimbal_pitch}})));
    }
    return writer.finish();
  }

  std::vector<std::string> losses(const Plan& plan, const std::string& written) const override {
    std::vector<double> times;
    std::vector<Pose> poses;
    const std::string frame = plan.trajectory.has_gimbal ? "camera" : "vehicle";
    std::size_t count = 0;
    for (const mcap_file::Message& message : mcap_file::messages_of(written, kTransforms)) {
      const Value value = from_json(message.json, "mcap");
      ++count;
      if (value.at("child_frame_id").as_text() != frame) continue;
      const auto number = [&](const char* part, const char* axis) {
        return value.at(part).at(axis).as_number();
      };
      times.push_back(static_cast<double>(message.time) / 1e9);
      poses.push_back(
          {{number("translation", "x"), number("translation", "y"), number("translation", "z")},
           {number("rotation", "w"), number("rotation", "x"), number("rotation", "y"),
            number("rotation", "z")}});
    }
    const double start = plan.trajectory.samples.front().time;
    std::vector<std::string> said{std::to_string(count) +
                                  " transforms; frame `world`: x east, y "
                                  "north, z up, in metres; time 0 is the start of the flight"};
    if (plan.trajectory.has_gimbal) {
      const auto played = [&](double time) {
        const auto next = std::upper_bound(times.begin(), times.end(), time - start);
        const std::size_t j = std::clamp<std::size_t>(
            static_cast<std::size_t>(next - times.begin()), 1, times.size() - 1);
        const double share =
            std::clamp((time - start - times[j - 1]) / (times[j] - times[j - 1]), 0.0, 1.0);
        return Pose{poses[j - 1].position + share * (poses[j].position - poses[j - 1].position),
                    poses[j - 1].orientation.slerp(share, poses[j].orientation)};
      };
      said.push_back(sentence_of(deviation_of(plan, start, start + times.back(),
                                              4 * static_cast<int>(times.size()), played)));
    } else {
      std::vector<Eigen::Vector3d> places;
      for (const Pose& pose : poses) places.push_back(pose.position);
      for (double& time : times) time += start;
      const PathDeviation worst = deviation_of_path(plan, times, places);
      said.push_back("joined by straight lines, the transforms are at most " +
                     plain_number(1000 * worst.distance, 3) + " mm from the plan (at " +
                     plain_number(worst.time, 4) + " s)");
    }
    said.emplace_back("cuts, lights, obstacles and subjects are not in it");
    return said;
  }

 private:
  static std::string transform(std::uint64_t at, const char* child, const Pose& pose) {
    return to_json(made({{"timestamp", stamp(at)},
                         {"parent_frame_id", "world"},
                         {"child_frame_id", child},
                         {"translation", vector_value(pose.position)},
                         {"rotation", turn_value(pose.orientation.normalized())}}));
  }

  // What holds for the whole flight: the path, the camera, what the file is.
  static void add_once(mcap_file::Writer& writer, const Plan& plan,
                       const std::vector<double>& times) {
    writer.add_metadata("lapwing", {{"mission", as_utf8(plan.mission)},
                                    {"kind", as_utf8(plan.kind)},
                                    {"certified", states_certified(plan) ? "true" : "false"}});
    Value poses = Value::list();
    for (const double time : times) {
      const Sample s = sample_at(plan.trajectory, time);
      const Eigen::Quaterniond heading(Eigen::AngleAxisd(s.yaw, Eigen::Vector3d::UnitZ()));
      poses.push_back(
          made({{"position", vector_value(s.position)}, {"orientation", turn_value(heading)}}));
    }
    const std::uint16_t path = writer.add_channel(
        "/path", "foxglove.PosesInFrame",
        schema_text("foxglove.PosesInFrame",
                    object_of({{"timestamp", stamp_schema()},
                               {"frame_id", typed("string")},
                               {"poses", list_of(object_of({{"position", vector_schema()},
                                                            {"orientation", turn_schema()}}))}})));
    writer.add_message(
        path, 0, to_json(made({{"timestamp", stamp(0)}, {"frame_id", "world"}, {"poses", poses}})));
    if (plan.trajectory.has_gimbal) add_calibration(writer, filming_camera(plan, "mcap"));
  }

  static void add_calibration(mcap_file::Writer& writer, const Pinhole& camera) {
    const std::uint16_t channel = writer.add_channel(
        "/camera/calibration", "foxglove.CameraCalibration",
        schema_text("foxglove.CameraCalibration", object_of({{"timestamp", stamp_schema()},
                                                             {"frame_id", typed("string")},
                                                             {"width", typed("integer")},
                                                             {"height", typed("integer")},
                                                             {"distortion_model", typed("string")},
                                                             {"D", list_of(typed("number"))},
                                                             {"K", list_of(typed("number"))},
                                                             {"R", list_of(typed("number"))},
                                                             {"P", list_of(typed("number"))}})));
    const double fx = camera.focal_x, fy = camera.focal_y;
    const double cx = camera.principal_x, cy = camera.principal_y;
    writer.add_message(
        channel, 0,
        to_json(made(
            {{"timestamp", stamp(0)},
             {"frame_id", "camera"},
             {"width", camera.width},
             {"height", camera.height},
             {"distortion_model", ""},
             {"D", Value::list()},
             {"K", Value(Value::List{fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0})},
             {"R", Value(Value::List{1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0})},
             {"P", Value(Value::List{fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0})}})));
  }

  double rate_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Mcap)
