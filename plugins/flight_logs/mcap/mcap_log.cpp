// SPDX-License-Identifier: Apache-2.0
#include "plugins/flight_logs/mcap/mcap_log.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <Eigen/Geometry>

#include "framework/core/error.h"
#include "framework/core/json.h"
#include "framework/flight_log/log_builder.h"
#include "plugins/flight_logs/mcap/mcap_file.h"

namespace lapwing::mcap_log {
namespace {

const std::set<std::string, std::less<>>& vehicle_frames() {
  static const std::set<std::string, std::less<>> names{"vehicle", "base_link", "body", "drone"};
  return names;
}

const std::set<std::string, std::less<>>& camera_frames() {
  static const std::set<std::string, std::less<>> names{"camera", "camera_link", "camera_optical",
                                                        "gimbal"};
  return names;
}

// Throws InputError where a number is missing; so does everything below.
Eigen::Vector3d vector_of(const Value& value) {
  return {value.at("x").as_number(), value.at("y").as_number(), value.at("z").as_number()};
}

Eigen::Quaterniond turn_of(const Value& value) {
  return {value.at("w").as_number(), value.at("x").as_number(), value.at("y").as_number(),
          value.at("z").as_number()};
}

class Recording {
 public:
  Recording(std::string_view bytes, const std::string& vehicle, const std::string& camera)
      : bytes_(bytes), vehicle_(vehicle), camera_(camera), builder_("mcap", bytes.size()) {}

  FlightLog run() {
    std::string seen;
    const Outcome outcome = read_messages(
        bytes_, [&](const Message& message) { take(message); },
        [&](const Channel& channel) {
          builder_.log.records.push_back({channel.topic, channel.messages});
          seen += (seen.empty() ? "" : ", ") + channel.topic + " (" + channel.schema + ", " +
                  channel.encoding + ")";
        });
    FlightLog& log = builder_.log;
    log.bytes_read = outcome.read;
    log.damage = outcome.damage;
    log.recorder = own_ ? "Lapwing" : outcome.library;
    log.clock = own_ ? "the start of the plan" : "the first message";
    if (first_ > 1000000000000000000) log.utc = 1e-9 * static_cast<double>(first_);
    if (other_ > 0)
      log.remarks.push_back(std::to_string(other_) +
                            " messages are in other encodings than JSON, and not read");
    if (malformed_ > 0)
      log.remarks.push_back(std::to_string(malformed_) +
                            " messages lack what their schema asks, "
                            "the first: " +
                            malformed_text_);
    FlightLog made = builder_.finish();
    if (made.series.empty())
      throw InputError("no channel of it gives a sample of a flight; it has " +
                       (seen.empty() ? std::string("none") : seen.substr(0, 400)) +
                       "; expected foxglove.FrameTransform, FrameTransforms, PoseInFrame or "
                       "LocationFix as JSON" +
                       (made.damage.empty() ? "" : "; " + made.damage));
    return made;
  }

 private:
  void take(const Message& message) {
    const Channel& channel = *message.channel;
    const bool own = channel.schema == "lapwing.Command";
    own_ = own_ || own;
    const bool known = own || channel.schema.starts_with("foxglove.");
    if (!known) return;
    if (channel.encoding != "json") {
      ++other_;
      return;
    }
    if (!begun_) first_ = message.time;
    begun_ = true;
    // Times of recordings count from 1970, or from 0 on.
    const double time =
        1e-9 * (message.time >= first_ ? static_cast<double>(message.time - first_)
                                       : -static_cast<double>(first_ - message.time));
    try {
      add(channel.schema, time,
          from_json(std::string(message.data), "a message of " + channel.topic));
    } catch (const InputError& error) {
      if (malformed_++ == 0) malformed_text_ = error.what();
    }
  }

  void add(const std::string& schema, double time, const Value& value) {
    if (schema == "foxglove.FrameTransform") return add_transform(time, value);
    if (schema == "foxglove.FrameTransforms") {
      for (const Value& one : value.at("transforms").as_list()) add_transform(time, one);
    } else if (schema == "foxglove.PoseInFrame") {
      const Value& pose = value.at("pose");
      add_pose(time, vector_of(pose.at("position")), turn_of(pose.at("orientation")),
               "foxglove.PoseInFrame");
    } else if (schema == "foxglove.LocationFix") {
      builder_.add("place", time,
                   {value.at("latitude").as_number(), value.at("longitude").as_number(),
                    value.at("altitude").as_number()});
      builder_.log.heights = HeightOf::ellipsoid;
      builder_.name_source("place", schema);
    } else if (schema == "lapwing.Command") {
      add_command(time, value);
    }
  }

  bool is_frame(const std::string& name, const std::string& stated,
                const std::set<std::string, std::less<>>& usual) const {
    const std::string bare = name.starts_with('/') ? name.substr(1) : name;
    return stated.empty() ? usual.count(bare) > 0 : bare == stated;
  }

  void add_transform(double time, const Value& value) {
    const std::string& child = value.at("child_frame_id").as_text();
    const Eigen::Vector3d place = vector_of(value.at("translation"));
    const Eigen::Quaterniond turn = turn_of(value.at("rotation"));
    if (is_frame(child, vehicle_, vehicle_frames()))
      add_pose(time, place, turn, "foxglove.FrameTransform");
    if (!is_frame(child, camera_, camera_frames()) || !(turn.norm() > 1e-6)) return;
    // A camera looks along its z axis.
    const Eigen::Vector3d axis = turn.normalized() * Eigen::Vector3d::UnitZ();
    builder_.add("camera", time,
                 {std::atan2(axis.y(), axis.x()), std::asin(std::clamp(axis.z(), -1.0, 1.0))});
    builder_.name_source("camera", "foxglove.FrameTransform");
  }

  void add_pose(double time, const Eigen::Vector3d& place, const Eigen::Quaterniond& turn,
                const char* source) {
    builder_.add("position", time, {place.x(), place.y(), place.z()});
    builder_.name_source("position", source);
    if (!(turn.norm() > 1e-6)) return;
    const Eigen::Quaterniond q = turn.normalized();
    builder_.add("orientation", time, {q.w(), q.x(), q.y(), q.z()});
  }

  void add_command(double time, const Value& value) {
    for (const char* name : {"velocity", "acceleration"}) {
      const Eigen::Vector3d v = vector_of(value.at(name));
      builder_.add(name, time, {v.x(), v.y(), v.z()});
    }
    builder_.name_source("velocity", "lapwing.Command");
  }

  std::string_view bytes_;
  std::string vehicle_, camera_;
  LogBuilder builder_;
  bool own_ = false, begun_ = false;
  std::uint64_t first_ = 0;
  std::size_t other_ = 0, malformed_ = 0;
  std::string malformed_text_;
};

template <class T>
void append(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void append_text(std::string& out, const std::string& text) {
  append(out, static_cast<std::uint32_t>(text.size()));
  out += text;
}

void append_record(std::string& out, char code, const std::string& body) {
  out += code;
  append(out, static_cast<std::uint64_t>(body.size()));
  out += body;
}

}  // namespace

FlightLog read(std::string_view bytes, const std::string& vehicle, const std::string& camera) {
  return Recording(bytes, vehicle, camera).run();
}

std::string example() {
  std::string out("\x89MCAP0\r\n", 8), header, schema, channel;
  append_text(header, "");
  append_text(header, "example");
  append_record(out, 1, header);
  append(schema, std::uint16_t{1});
  append_text(schema, "foxglove.PoseInFrame");
  append_text(schema, "jsonschema");
  append_text(schema, "{}");
  append_record(out, 3, schema);
  append(channel, std::uint16_t{1});
  append(channel, std::uint16_t{1});
  append_text(channel, "/pose");
  append_text(channel, "json");
  append(channel, std::uint32_t{0});
  append_record(out, 4, channel);
  for (int k = 0; k <= 5; ++k) {
    std::string message;
    append(message, std::uint16_t{1});
    append(message, static_cast<std::uint32_t>(k));
    append(message, std::uint64_t{200000000} * static_cast<std::uint64_t>(k));
    append(message, std::uint64_t{0});
    message += "{\"pose\":{\"position\":{\"x\":" + std::to_string(k) +
               ",\"y\":0,\"z\":2},\"orientation\":{\"x\":0,\"y\":0,\"z\":0,\"w\":1}}}";
    append_record(out, 5, message);
  }
  append_record(out, 15, std::string(4, '\0'));
  append_record(out, 2, std::string(20, '\0'));
  return out + std::string("\x89MCAP0\r\n", 8);
}

}  // namespace lapwing::mcap_log
