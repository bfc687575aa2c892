// SPDX-License-Identifier: Apache-2.0
#include "plugins/flight_logs/dataflash/dataflash_log.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <vector>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/core/units.h"
#include "framework/flight_log/log_builder.h"
#include "plugins/flight_logs/dataflash/dataflash_file.h"

namespace lapwing::dataflash {
namespace {

constexpr double kGpsEpoch = 315964800;  // s since 1970
constexpr double kWeek = 604800;         // s
constexpr double kLeapSeconds = 18;      // of GPS time ahead of UTC since 2017

// A message whose numbers give samples of one quantity. `take` gets the columns' numbers, not a
// number where the log lacks a column, and angles in rad. The first message of a quantity that the
// log has is taken.
struct Source {
  const char* quantity;
  const char* message;
  std::vector<const char*> columns;
  void (*take)(LogBuilder& builder, double time, const double* v);
};

void add_ekf_position(LogBuilder& b, double t, const double* v) {
  b.add("position", t, {v[1], v[0], -v[2]});
}
void add_ekf_velocity(LogBuilder& b, double t, const double* v) {
  b.add("velocity", t, {v[1], v[0], -v[2]});
}
void add_rates(LogBuilder& b, double t, const double* v) {
  b.add("body_rates", t, {v[0], -v[1], -v[2]});
}

const std::vector<Source>& sources() {
  static const std::vector<Source> all{
      {"position", "XKF1", {"PN", "PE", "PD"}, add_ekf_position},
      {"position", "NKF1", {"PN", "PE", "PD"}, add_ekf_position},
      {"velocity", "XKF1", {"VN", "VE", "VD"}, add_ekf_velocity},
      {"velocity", "NKF1", {"VN", "VE", "VD"}, add_ekf_velocity},
      {"place",
       "POS",
       {"Lat", "Lng", "Alt"},
       [](LogBuilder& b, double t, const double* v) {
         if (v[0] != 0 || v[1] != 0) b.add("place", t, {v[0], v[1], v[2]});
       }},
      {"gps",
       "GPS",
       {"Lat", "Lng", "Alt", "Status", "GMS", "GWk"},
       [](LogBuilder& b, double t, const double* v) {
         if (v[3] < 3) return;  // no fix in three dimensions
         b.add("gps", t, {v[0], v[1], v[2]});
         if (v[5] > 0 && !b.log.utc)
           b.log.utc = kGpsEpoch + kWeek * v[5] + 1e-3 * v[4] - kLeapSeconds - t;
       }},
      {"orientation",
       "ATT",
       {"Roll", "Pitch", "Yaw"},
       [](LogBuilder& b, double t, const double* v) {
         const Eigen::Vector4d q = orientation_of_euler(v[0], v[1], v[2]);
         b.add("orientation", t, {q.data(), 4});
       }},
      {"yaw_setpoint",
       "ATT",
       {"DesYaw"},
       [](LogBuilder& b, double t, const double* v) {
         b.add("yaw_setpoint", t, {yaw_of_heading(v[0])});
       }},
      {"body_rates", "IMU", {"GyrX", "GyrY", "GyrZ"}, add_rates},
      {"body_rates", "RATE", {"R", "P", "Y"}, add_rates},
      {"specific_force",
       "IMU",
       {"AccX", "AccY", "AccZ"},
       [](LogBuilder& b, double t, const double* v) {
         b.add("specific_force", t, {v[0], -v[1], -v[2]});
       }},
      {"rates_setpoint",
       "RATE",
       {"RDes", "PDes", "YDes"},
       [](LogBuilder& b, double t, const double* v) {
         b.add("rates_setpoint", t, {v[0], -v[1], -v[2]});
       }},
      {"throttle",
       "RATE",
       {"AOut"},
       [](LogBuilder& b, double t, const double* v) { b.add("throttle", t, {v[0]}); }},
      {"throttle",
       "CTUN",
       {"ThO"},
       [](LogBuilder& b, double t, const double* v) { b.add("throttle", t, {v[0]}); }},
      {"actuators",
       "RCOU",
       {"C1", "C2", "C3", "C4"},
       [](LogBuilder& b, double t, const double* v) {
         b.add("actuators", t,
               {1e-3 * (v[0] - 1000), 1e-3 * (v[1] - 1000), 1e-3 * (v[2] - 1000),
                1e-3 * (v[3] - 1000)});
       }},
      {"camera",
       "MNT",
       {"YawE", "Pitch"},
       [](LogBuilder& b, double t, const double* v) {
         b.add("camera", t, {yaw_of_heading(v[0]), v[1]});
       }},
      {"battery",
       "BAT",
       {"Volt", "Curr", "RemPct"},
       [](LogBuilder& b, double t, const double* v) {
         b.add("battery", t, {v[0], v[1], 0.01 * v[2]});
       }},
  };
  return all;
}

// Columns in degrees or degrees per second, unless the log states another unit.
bool is_angle(const std::string& message, std::string_view label) {
  static const std::map<std::string, std::set<std::string, std::less<>>> angles{
      {"ATT", {"Roll", "Pitch", "Yaw", "DesYaw"}},
      {"RATE", {"R", "P", "Y", "RDes", "PDes", "YDes"}},
      {"MNT", {"YawE", "Pitch", "YawB", "Yaw"}}};
  const auto found = angles.find(message);
  return found != angles.end() && found->second.count(label) > 0;
}

// Units of FMTU that are radians already: rad (r), rad/s (E).
bool in_radians(char unit) {
  return unit == 'r' || unit == 'E';
}

class Mapping {
 public:
  explicit Mapping(std::string_view bytes) : bytes_(bytes), builder_("dataflash", bytes.size()) {}

  FlightLog run() {
    look();
    choose();
    collect();
    FlightLog log = builder_.finish();
    add_targets(log);
    if (log.series.empty())
      throw InputError("no message of it gives a sample of a flight; expected POS, XKF1 or GPS" +
                       (log.damage.empty() ? std::string() : "; " + log.damage));
    return log;
  }

 private:
  void look() {
    std::map<std::string, std::size_t> counts;
    const Outcome outcome =
        read_messages(bytes_, [&](int, const Kind& kind, std::string_view body) {
          ++counts[kind.name];
          for (const auto& column : kind.columns) labels_[kind.name].insert(column.label);
          if (kind.name == "MSG" && builder_.log.recorder.empty()) {
            const int text = kind.column("Message");
            if (text >= 0)
              builder_.log.recorder = text_of(kind.columns[static_cast<std::size_t>(text)], body);
          }
        });
    FlightLog& log = builder_.log;
    log.bytes_read = outcome.read;
    log.damage = outcome.damage;
    log.clock = "the autopilot's boot";
    log.heights = HeightOf::sea;
    if (log.recorder.empty()) log.recorder = "ArduPilot";
    for (const auto& [name, count] : counts) log.records.push_back({name, count});
  }

  void choose() {
    std::set<std::string> given;
    for (const Source& source : sources()) {
      const auto labels = labels_.find(source.message);
      if (labels == labels_.end() || given.count(source.quantity) ||
          !labels->second.count(source.columns[0]))
        continue;
      given.insert(source.quantity);
      chosen_[source.message].push_back(&source);
      builder_.name_source(source.quantity, source.message);
    }
  }

  void collect() {
    read_messages(bytes_, [&](int, const Kind& kind, std::string_view body) {
      const double time = time_of(kind, body);
      const auto chosen = chosen_.find(kind.name);
      if (chosen != chosen_.end() && first_instance(kind, body))
        for (const Source* source : chosen->second) {
          double values[8] = {};
          for (std::size_t k = 0; k < source->columns.size(); ++k)
            values[k] = number(kind, source->columns[k], body);
          source->take(builder_, time, values);
        }
      note(kind, time, body);
    });
  }

  static double time_of(const Kind& kind, std::string_view body) {
    const int micro = kind.column("TimeUS"), milli = kind.column("TimeMS");
    if (micro < 0 && milli < 0) return NAN;
    Column column = kind.columns[static_cast<std::size_t>(micro < 0 ? milli : micro)];
    column.factor = micro < 0 ? 1e-3 : 1e-6;
    return value_of(column, body);
  }

  static double number(const Kind& kind, const char* label, std::string_view body) {
    const int at = kind.column(label);
    if (at < 0) return NAN;
    const Column& column = kind.columns[static_cast<std::size_t>(at)];
    const double value = value_of(column, body);
    return is_angle(kind.name, label) && !in_radians(column.unit) ? radians(value) : value;
  }

  // Several receivers, cores and batteries have numbers: the first is read.
  static bool first_instance(const Kind& kind, std::string_view body) {
    for (const char* label : {"I", "C", "Inst", "Instance"})
      if (const int at = kind.column(label); at >= 0 && (kind.name != "RCOU"))
        return value_of(kind.columns[static_cast<std::size_t>(at)], body) == 0;
    return true;
  }

  void note(const Kind& kind, double time, std::string_view body) {
    if (!std::isfinite(time)) return;
    if (kind.name == "ORGN") set_reference(kind, body);
    if (kind.name == "CAM") photographs_.push_back(time);
    if (kind.name == "TRIG") triggers_.push_back(time);
    if (kind.name == "MSG")
      if (const int text = kind.column("Message"); text >= 0)
        builder_.log.messages.push_back(
            {time, text_of(kind.columns[static_cast<std::size_t>(text)], body)});
    if (kind.name == "MODE")
      if (const double mode = number(kind, kind.column("ModeNum") < 0 ? "Mode" : "ModeNum", body);
          std::isfinite(mode))
        builder_.log.messages.push_back({time, "mode " + plain_number(mode)});
    for (const auto& [axis, name] : {std::pair{0, "PSCE"}, {1, "PSCN"}, {2, "PSCD"}})
      if (kind.name == name) add_target(kind, axis, time, body);
  }

  // Type 0 is the origin of the estimator.
  void set_reference(const Kind& kind, std::string_view body) {
    if (number(kind, "Type", body) != 0) return;
    const GeodeticPoint point{number(kind, "Lat", body), number(kind, "Lng", body),
                              number(kind, "Alt", body)};
    if (std::abs(point.latitude_deg) <= 90 && std::abs(point.longitude_deg) <= 180 &&
        std::isfinite(point.altitude) && (point.latitude_deg != 0 || point.longitude_deg != 0))
      builder_.log.reference = point;
  }

  // The position controller tells its target axis by axis.
  void add_target(const Kind& kind, int axis, double time, std::string_view body) {
    const char* labels[] = {"TPE", "TPN", "TPD"};
    const double value = number(kind, labels[axis], body);
    if (std::isfinite(value)) targets_[axis][time] = axis == 2 ? -value : value;
  }

  void add_targets(FlightLog& log) {
    LogBuilder targets("dataflash", 0);
    for (const auto& [time, east] : targets_[0]) {
      const auto near = [time = time](const std::map<double, double>& axis) {
        auto found = axis.lower_bound(time - 0.05);
        return found != axis.end() && found->first < time + 0.05 ? found->second : NAN;
      };
      const double north = near(targets_[1]), up = near(targets_[2]);
      if (std::isfinite(north + up)) targets.add("position_setpoint", time, {east, north, up});
    }
    FlightLog made = targets.finish();
    if (const auto found = made.series.find("position_setpoint"); found != made.series.end()) {
      found->second.source = "PSCN, PSCE, PSCD";
      log.series["position_setpoint"] = std::move(found->second);
    }
    log.photographs = photographs_.empty() ? triggers_ : photographs_;
    std::sort(log.photographs.begin(), log.photographs.end());
  }

  std::string_view bytes_;
  LogBuilder builder_;
  std::map<std::string, std::set<std::string, std::less<>>> labels_;
  std::map<std::string, std::vector<const Source*>> chosen_;
  std::map<double, double> targets_[3];
  std::vector<double> photographs_, triggers_;
};

template <class T>
void append(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string padded(std::string text, std::size_t size) {
  text.resize(size, '\0');
  return text;
}

std::string description(int number, int size, const char* name, const char* types,
                        const char* labels) {
  std::string out("\xa3\x95\x80", 3);
  out += static_cast<char>(number);
  out += static_cast<char>(size);
  return out + padded(name, 4) + padded(types, 16) + padded(labels, 64);
}

}  // namespace

FlightLog read(std::string_view bytes) {
  return Mapping(bytes).run();
}

std::string example() {
  std::string out = description(128, 89, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns") +
                    description(10, 23, "POS", "QLLf", "TimeUS,Lat,Lng,Alt");
  for (int k = 0; k <= 10; ++k) {
    out += std::string("\xa3\x95\x0a", 3);
    append(out, std::uint64_t{1000000} + std::uint64_t{100000} * static_cast<std::uint64_t>(k));
    append(out, std::int32_t{465191000 + 10 * k});
    append(out, std::int32_t{65668000});
    append(out, 400.0f);
  }
  return out;
}

}  // namespace lapwing::dataflash
