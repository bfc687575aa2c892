// SPDX-License-Identifier: Apache-2.0
#include "plugins/flight_logs/ulog/ulog_log.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <set>
#include <vector>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/flight_log/byte_reader.h"
#include "framework/flight_log/log_builder.h"
#include "plugins/flight_logs/ulog/ulog_file.h"

namespace lapwing::ulog {
namespace {

// A topic whose messages give samples of one quantity. `take` gets the fields' numbers, not a
// number where a field is not in the file. Local frames of PX4 are north, east, down; bodies are
// forward, right, down.
struct Source {
  const char* quantity;
  const char* topic;
  std::vector<const char*> fields;
  void (*take)(LogBuilder& builder, double time, const double* v);
};

// A flag that a file lacks counts as set.
bool good(double flag) {
  return !(flag == 0);
}

void add_gps(LogBuilder& builder, double time, const double* v) {
  if (v[3] < 3) return;  // no fix in three dimensions
  builder.add("gps", time, {v[0], v[1], v[2]});
  if (v[4] > 1e15 && !builder.log.utc) builder.log.utc = 1e-6 * v[4] - time;
}

// The first topic of a quantity that the file has is taken.
const std::vector<Source>& sources() {
  static const std::vector<Source> all{
      {"position",
       "vehicle_local_position",
       {"x", "y", "z", "xy_valid", "z_valid"},
       [](LogBuilder& b, double t, const double* v) {
         if (good(v[3]) && good(v[4])) b.add("position", t, {v[1], v[0], -v[2]});
       }},
      {"velocity",
       "vehicle_local_position",
       {"vx", "vy", "vz", "v_xy_valid", "v_z_valid"},
       [](LogBuilder& b, double t, const double* v) {
         if (good(v[3]) && good(v[4])) b.add("velocity", t, {v[1], v[0], -v[2]});
       }},
      {"acceleration",
       "vehicle_local_position",
       {"ax", "ay", "az"},
       [](LogBuilder& b, double t, const double* v) {
         b.add("acceleration", t, {v[1], v[0], -v[2]});
       }},
      {"place",
       "vehicle_global_position",
       {"lat", "lon", "alt"},
       [](LogBuilder& b, double t, const double* v) {
         b.add("place", t, {v[0], v[1], v[2]});
       }},
      {"gps",
       "vehicle_gps_position",
       {"latitude_deg", "longitude_deg", "altitude_msl_m", "fix_type", "time_utc_usec"},
       add_gps},
      {"gps",
       "sensor_gps",
       {"latitude_deg", "longitude_deg", "altitude_msl_m", "fix_type", "time_utc_usec"},
       add_gps},
      {"gps",
       "vehicle_gps_position",
       {"lat", "lon", "alt", "fix_type", "time_utc_usec"},
       [](LogBuilder& b, double t, const double* v) {
         const double scaled[] = {1e-7 * v[0], 1e-7 * v[1], 1e-3 * v[2], v[3], v[4]};
         add_gps(b, t, scaled);
       }},
      {"orientation",
       "vehicle_attitude",
       {"q[0]", "q[1]", "q[2]", "q[3]"},
       [](LogBuilder& b, double t, const double* v) {
         const Eigen::Vector4d q = orientation_of_ned(v[0], v[1], v[2], v[3]);
         b.add("orientation", t, {q.data(), 4});
       }},
      {"body_rates",
       "vehicle_angular_velocity",
       {"xyz[0]", "xyz[1]", "xyz[2]"},
       [](LogBuilder& b, double t, const double* v) {
         b.add("body_rates", t, {v[0], -v[1], -v[2]});
       }},
      {"body_rates",
       "sensor_combined",
       {"gyro_rad[0]", "gyro_rad[1]", "gyro_rad[2]"},
       [](LogBuilder& b, double t, const double* v) {
         b.add("body_rates", t, {v[0], -v[1], -v[2]});
       }},
      {"specific_force",
       "vehicle_acceleration",
       {"xyz[0]", "xyz[1]", "xyz[2]"},
       [](LogBuilder& b, double t, const double* v) {
         b.add("specific_force", t, {v[0], -v[1], -v[2]});
       }},
      {"specific_force",
       "sensor_combined",
       {"accelerometer_m_s2[0]", "accelerometer_m_s2[1]", "accelerometer_m_s2[2]"},
       [](LogBuilder& b, double t, const double* v) {
         b.add("specific_force", t, {v[0], -v[1], -v[2]});
       }},
      {"throttle",
       "vehicle_thrust_setpoint",
       {"xyz[2]"},
       [](LogBuilder& b, double t, const double* v) { b.add("throttle", t, {-v[0]}); }},
      {"throttle",
       "actuator_controls_0",
       {"control[3]"},
       [](LogBuilder& b, double t, const double* v) { b.add("throttle", t, {v[0]}); }},
      {"throttle",
       "vehicle_rates_setpoint",
       {"thrust_body[2]"},
       [](LogBuilder& b, double t, const double* v) { b.add("throttle", t, {-v[0]}); }},
      {"actuators",
       "actuator_motors",
       {"control[0]", "control[1]", "control[2]", "control[3]"},
       [](LogBuilder& b, double t, const double* v) {
         b.add("actuators", t, {v, 4});
       }},
      {"battery",
       "battery_status",
       {"voltage_v", "current_a", "remaining"},
       [](LogBuilder& b, double t, const double* v) {
         b.add("battery", t, {v, 3});
       }},
      {"position_setpoint",
       "trajectory_setpoint",
       {"position[0]", "position[1]", "position[2]"},
       [](LogBuilder& b, double t, const double* v) {
         b.add("position_setpoint", t, {v[1], v[0], -v[2]});
       }},
      {"position_setpoint",
       "trajectory_setpoint",
       {"x", "y", "z"},
       [](LogBuilder& b, double t, const double* v) {
         b.add("position_setpoint", t, {v[1], v[0], -v[2]});
       }},
      {"position_setpoint",
       "vehicle_local_position_setpoint",
       {"x", "y", "z"},
       [](LogBuilder& b, double t, const double* v) {
         b.add("position_setpoint", t, {v[1], v[0], -v[2]});
       }},
      {"velocity_setpoint",
       "trajectory_setpoint",
       {"velocity[0]", "velocity[1]", "velocity[2]"},
       [](LogBuilder& b, double t, const double* v) {
         b.add("velocity_setpoint", t, {v[1], v[0], -v[2]});
       }},
      {"velocity_setpoint",
       "vehicle_local_position_setpoint",
       {"vx", "vy", "vz"},
       [](LogBuilder& b, double t, const double* v) {
         b.add("velocity_setpoint", t, {v[1], v[0], -v[2]});
       }},
      {"yaw_setpoint",
       "trajectory_setpoint",
       {"yaw"},
       [](LogBuilder& b, double t, const double* v) {
         b.add("yaw_setpoint", t, {yaw_of_heading(v[0])});
       }},
      {"yaw_setpoint",
       "vehicle_local_position_setpoint",
       {"yaw"},
       [](LogBuilder& b, double t, const double* v) {
         b.add("yaw_setpoint", t, {yaw_of_heading(v[0])});
       }},
      {"rates_setpoint",
       "vehicle_rates_setpoint",
       {"roll", "pitch", "yaw"},
       [](LogBuilder& b, double t, const double* v) {
         b.add("rates_setpoint", t, {v[0], -v[1], -v[2]});
       }},
      {"yaw",
       "vehicle_local_position",
       {"heading"},
       [](LogBuilder& b, double t, const double* v) { b.add("yaw", t, {yaw_of_heading(v[0])}); }},
  };
  return all;
}

// The number of a topic's first instance, and what the file holds of it.
struct Held {
  int instance = 0;
  const Format* format = nullptr;
};

// A gimbal's attitude, whose yaw counts from the vehicle's heading or from north.
struct Gimbal {
  double time = 0, yaw = 0, pitch = 0;  // s, rad
  bool from_north = false;
};

class Mapping {
 public:
  explicit Mapping(std::string_view bytes) : bytes_(bytes), builder_("ulog", bytes.size()) {}

  FlightLog run() {
    look();
    choose();
    collect();
    for (const Bound& bound : bound_)
      if (builder_.has(bound.source->quantity))
        builder_.name_source(bound.source->quantity, bound.source->topic);
    if (builder_.has("orientation")) builder_.log.series.erase("yaw");
    FlightLog log = builder_.finish();
    // Simulated autopilots have no boot.
    if (log.start() > 1e9) log.clock = "1970, in UTC", log.utc = 0;
    add_camera(log);
    if (log.series.empty())
      throw InputError("no topic of it gives a sample of a flight" +
                       (log.damage.empty() ? "" : "; " + log.damage) +
                       "; expected vehicle_local_position or vehicle_global_position");
    return log;
  }

 private:
  struct Bound {
    const Source* source;
    std::vector<std::optional<Number>> numbers;
  };

  // Which topics there are, and what of the file is sound.
  void look() {
    Listener listener;
    std::map<std::string, std::size_t> counts;
    listener.data = [&](const Topic& topic, std::string_view) {
      ++counts[topic.instance == 0 ? topic.name
                                   : topic.name + "#" + std::to_string(topic.instance)];
      held_.try_emplace(topic.name, Held{topic.instance, topic.format});
    };
    listener.message = [&](double time, std::string_view text) {
      builder_.log.messages.push_back({time, std::string(text)});
    };
    listener.dropout = [&](double time, double duration) {
      builder_.log.gaps.push_back({time, duration});
    };
    listener.information = [&](std::string_view key, std::string_view value) {
      inform(key, value);
    };
    const Outcome outcome = read_records(bytes_, formats_, listener);
    FlightLog& log = builder_.log;
    log.bytes_read = outcome.read;
    log.damage = outcome.damage;
    if (!log.damage.empty() && outcome.skipped > 0)
      log.damage += "; " + std::to_string(outcome.skipped) + " bytes were skipped";
    log.clock = "the autopilot's boot";
    log.heights = HeightOf::sea;
    log.recorder = system_ + (version_.empty() ? "" : " " + version_);
    for (const auto& [name, count] : counts) log.records.push_back({name, count});
  }

  void inform(std::string_view key, std::string_view value) {
    if (key.ends_with(" sys_name")) system_ = value;
    const auto release = number_in<std::uint32_t>(value, 0);
    if (key == "uint32_t ver_sw_release" && release)
      version_ = std::to_string(*release >> 24) + "." + std::to_string(*release >> 16 & 255) + "." +
                 std::to_string(*release >> 8 & 255);
  }

  void choose() {
    std::set<std::string> given;
    for (const Source& source : sources()) {
      const auto held = held_.find(source.topic);
      if (held == held_.end() || given.count(source.quantity)) continue;
      Bound bound{&source, {}};
      for (const char* field : source.fields)
        bound.numbers.push_back(held->second.format->number(field));
      if (!bound.numbers[0]) continue;
      given.insert(source.quantity);
      bound_.push_back(std::move(bound));
    }
  }

  void collect() {
    Listener listener;
    std::map<std::string, std::vector<const Bound*>> of_topic;
    for (const Bound& bound : bound_) of_topic[bound.source->topic].push_back(&bound);
    const bool captures = held_.count("camera_capture") > 0;
    listener.data = [&](const Topic& topic, std::string_view bytes) {
      if (topic.instance != held_.at(topic.name).instance) return;
      const double time = time_of(*topic.format, bytes);
      const auto bounds = of_topic.find(topic.name);
      if (bounds != of_topic.end())
        for (const Bound* bound : bounds->second) take(*bound, time, bytes);
      if (topic.name == "vehicle_local_position") set_reference(topic, bytes);
      if (topic.name == "vehicle_local_position") note_resets(topic, time, bytes);
      if (topic.name == "vehicle_status") note_mode(topic, time, bytes);
      if (topic.name == "gimbal_device_attitude_status") add_gimbal(topic, time, bytes);
      if (topic.name == "mount_orientation") add_mount(topic, time, bytes);
      if (topic.name == (captures ? "camera_capture" : "camera_trigger"))
        builder_.log.photographs.push_back(time);
    };
    listener.message = [](double, std::string_view) {};
    listener.dropout = [](double, double) {};
    listener.information = [](std::string_view, std::string_view) {};
    Formats again;  // definitions count in their order, as the first time
    read_records(bytes_, again, listener);
    if (resets_ > 0)
      builder_.log.remarks.push_back("the estimated position was reset " + std::to_string(resets_) +
                                     " times, last at " + plain_number(last_reset_, 6) + " s");
    if (moved_) builder_.log.remarks.emplace_back("the local frame's place on the earth changed");
  }

  static double number(const Topic& topic, const char* name, std::string_view bytes) {
    const auto found = topic.format->number(name);
    return found ? value_of(*found, bytes) : NAN;
  }

  // When the state was, not when it was told.
  static double time_of(const Format& format, std::string_view bytes) {
    const auto sampled = format.number("timestamp_sample");
    const double time = sampled ? value_of(*sampled, bytes) : 0;
    if (time > 0) return 1e-6 * time;
    const auto told = format.number("timestamp");
    return told ? 1e-6 * value_of(*told, bytes) : NAN;
  }

  void take(const Bound& bound, double time, std::string_view bytes) {
    double values[8] = {};
    for (std::size_t k = 0; k < bound.numbers.size(); ++k)
      values[k] = bound.numbers[k] ? value_of(*bound.numbers[k], bytes) : NAN;
    bound.source->take(builder_, time, values);
  }

  void set_reference(const Topic& topic, std::string_view bytes) {
    if (!good(number(topic, "xy_global", bytes)) || !good(number(topic, "z_global", bytes))) return;
    const GeodeticPoint point{number(topic, "ref_lat", bytes), number(topic, "ref_lon", bytes),
                              number(topic, "ref_alt", bytes)};
    const bool there = std::isfinite(point.latitude_deg + point.longitude_deg + point.altitude) &&
                       (point.latitude_deg != 0 || point.longitude_deg != 0) &&
                       std::abs(point.latitude_deg) <= 90 && std::abs(point.longitude_deg) <= 180;
    if (!there) return;
    if (builder_.log.reference && !(*builder_.log.reference == point)) moved_ = true;
    builder_.log.reference = point;
  }

  void note_resets(const Topic& topic, double time, std::string_view bytes) {
    double sum = 0;
    for (const char* counter : {"xy_reset_counter", "z_reset_counter"})
      if (const double count = number(topic, counter, bytes); count >= 0) sum += count;
    if (counted_ && sum != counter_) ++resets_, last_reset_ = time;
    counter_ = sum;
    counted_ = true;
  }

  void note_mode(const Topic& topic, double time, std::string_view bytes) {
    const double mode = number(topic, "nav_state", bytes);
    if (mode == mode_ || !std::isfinite(mode) || !std::isfinite(time)) return;
    mode_ = mode;
    builder_.log.messages.push_back({time, "navigation state " + plain_number(mode)});
  }

  void add_gimbal(const Topic& topic, double time, std::string_view bytes) {
    const double w = number(topic, "q[0]", bytes), x = number(topic, "q[1]", bytes);
    const double y = number(topic, "q[2]", bytes), z = number(topic, "q[3]", bytes);
    const double flags = number(topic, "device_flags", bytes);
    if (!std::isfinite(time + w + x + y + z)) return;
    // Yaw lock (16) or a yaw that says that it is of the earth (64).
    const bool north = std::isfinite(flags) && (static_cast<int>(flags) & (16 | 64)) != 0;
    gimbal_.push_back({time, std::atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)),
                       std::asin(std::clamp(2 * (w * y - z * x), -1.0, 1.0)), north});
    gimbal_source_ = topic.name;
  }

  void add_mount(const Topic& topic, double time, std::string_view bytes) {
    if (gimbal_source_ == "gimbal_device_attitude_status") return;
    const double pitch = number(topic, "attitude_euler_angle[1]", bytes);
    const double yaw = number(topic, "attitude_euler_angle[2]", bytes);
    if (!std::isfinite(time + pitch + yaw)) return;
    gimbal_.push_back({time, yaw, pitch, false});
    gimbal_source_ = topic.name;
  }

  // Of a gimbal that turns with the vehicle, where the heading is known.
  void add_camera(FlightLog& log) const {
    if (gimbal_.empty()) return;
    LogBuilder camera("ulog", 0);
    for (const Gimbal& g : gimbal_) {
      const auto yaw = value_at(log, "yaw", g.time);
      if (g.from_north) camera.add("camera", g.time, {yaw_of_heading(g.yaw), g.pitch});
      if (!g.from_north && yaw)
        camera.add("camera", g.time, {std::remainder((*yaw)[0] - g.yaw, 2 * M_PI), g.pitch});
    }
    FlightLog made = camera.finish();
    if (const auto found = made.series.find("camera"); found != made.series.end()) {
      found->second.source = gimbal_source_;
      log.series["camera"] = std::move(found->second);
    }
  }

  std::string_view bytes_;
  LogBuilder builder_;
  Formats formats_;
  std::map<std::string, Held> held_;
  std::vector<Bound> bound_;
  std::vector<Gimbal> gimbal_;
  std::string gimbal_source_, system_ = "PX4", version_;
  double counter_ = 0, last_reset_ = 0, mode_ = NAN;
  std::size_t resets_ = 0;
  bool counted_ = false, moved_ = false;
};

template <class T>
void append(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void append_record(std::string& out, char type, const std::string& body) {
  append(out, static_cast<std::uint16_t>(body.size()));
  out += type;
  out += body;
}

}  // namespace

FlightLog read(std::string_view bytes) {
  return Mapping(bytes).run();
}

std::string example() {
  std::string out("ULog\x01\x12\x35\x01", 8);
  append(out, std::uint64_t{0});
  append_record(out, 'B', std::string(40, '\0'));
  append_record(out, 'F', "vehicle_local_position:uint64_t timestamp;float x;float y;float z;");
  append_record(out, 'A', std::string("\0\1\0", 3) + "vehicle_local_position");
  for (int k = 0; k <= 10; ++k) {
    std::string body("\1\0", 2);
    append(body, std::uint64_t{100000} * static_cast<std::uint64_t>(k + 10));
    for (const float value : {0.1f * static_cast<float>(k), 1.0f, -2.0f}) append(body, value);
    append_record(out, 'D', body);
  }
  return out;
}

}  // namespace lapwing::ulog
