// SPDX-License-Identifier: Apache-2.0
#include "plugins/flight_logs/csv/csv_log.h"

#include <array>
#include <cmath>
#include <functional>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/flight_log/log_builder.h"
#include "plugins/flight_logs/csv/csv_table.h"

namespace lapwing::csv_log {
namespace {

// What a column of an app holds, and the names that apps have for it, the best first.
enum Field {
  kTime,
  kUtc,
  kLatitude,
  kLongitude,
  kHeight,    // above the take-off
  kAltitude,  // above the sea
  kNorthSpeed,
  kEastSpeed,
  kDownSpeed,
  kRoll,
  kPitch,
  kHeading,
  kCameraHeading,
  kCameraPitch,
  kPhoto,
  kVoltage,
  kCurrent,
  kCharge,
  kMode,
  kMessage,
  kFields
};

struct App {
  const char* name;
  std::array<std::vector<const char*>, kFields> columns;
  // Columns without a unit, in SI: raw angles in tenths of degrees.
  double angle = M_PI / 180, camera_angle = M_PI / 180, charge = 0.01;
};

// Headings as the apps write them, in lower case and without units.
const std::vector<App>& apps() {
  static const std::vector<App> all{
      {"Airdata",
       {{{"time"},
         {"datetime"},
         {"latitude"},
         {"longitude"},
         {"height_above_takeoff"},
         {"altitude_above_sealevel"},
         {"xspeed"},
         {"yspeed"},
         {"zspeed"},
         {"roll"},
         {"pitch"},
         {"compass_heading"},
         {"gimbal_heading"},
         {"gimbal_pitch"},
         {"isphoto"},
         {"voltage"},
         {"current"},
         {"battery_percent"},
         {"flycstate"},
         {"message"}}}},
      {"Litchi",
       {{{"time"},
         {"datetime"},
         {"latitude"},
         {"longitude"},
         {"altitude"},
         {},
         {"velocityx"},
         {"velocityy"},
         {"velocityz"},
         {"roll"},
         {"pitch"},
         {"yaw"},
         {"gimbalyawraw"},
         {"gimbalpitchraw"},
         {"istakingphoto"},
         {"voltage"},
         {},
         {"remainpowerpercent"},
         {"flightmode"},
         {"app_warning"}}},
       M_PI / 180,
       M_PI / 1800},
      {"DJI flight record", {{{"osd.flytime"},     {},
                              {"osd.latitude"},    {"osd.longitude"},
                              {"osd.height"},      {"osd.altitude"},
                              {"osd.xspeed"},      {"osd.yspeed"},
                              {"osd.zspeed"},      {"osd.roll"},
                              {"osd.pitch"},       {"osd.yaw"},
                              {"gimbal.yaw"},      {"gimbal.pitch"},
                              {"camera.isphoto"},  {"battery.voltage"},
                              {"battery.current"}, {"battery.chargelevel"},
                              {"osd.flycstate"},   {"app.tip"}}}},
      {"DatCon",
       {{{"clock:offsettime", "offsettime"},
         {},
         {"imu_atti(0):latitude", "gps(0):lat", "gps:lat"},
         {"imu_atti(0):longitude", "gps(0):long", "gps:long"},
         {"imu_atti(0):relativeheight:c", "general:relativeheight"},
         {"gps(0):heightmsl", "gps:heightmsl"},
         {"imu_atti(0):veln", "gps(0):veln"},
         {"imu_atti(0):vele", "gps(0):vele"},
         {"imu_atti(0):veld", "gps(0):veld"},
         {"imu_atti(0):roll:c", "imu_atti(0):roll"},
         {"imu_atti(0):pitch:c", "imu_atti(0):pitch"},
         {"imu_atti(0):yaw:c", "imu_atti(0):yaw"},
         {"gimbal:yaw"},
         {"gimbal:pitch"},
         {},
         {"batteryinfo:vol:d"},
         {"batteryinfo:current:d"},
         {},
         {"flycstate"},
         {}}}},
  };
  return all;
}

int column_of(const Table& table, const App& app, Field field) {
  for (const char* name : app.columns[field]) {
    // "OSD.flyTime" stands before "OSD.flyTime [s]": text, then the number.
    int last = -1;
    for (std::size_t i = 0; i < table.headings.size(); ++i)
      if (table.headings[i].name == name && (last < 0 || !table.headings[i].unit.empty()))
        last = static_cast<int>(i);
    if (last >= 0) return last;
  }
  return -1;
}

// The app whose headings these are; null where there is none.
const App* app_of(const Table& table) {
  for (const App& app : apps()) {
    const auto has = [&](Field field) { return column_of(table, app, field) >= 0; };
    if (has(kTime) && has(kLatitude) && has(kLongitude) && (has(kHeight) || has(kAltitude)))
      return &app;
  }
  return nullptr;
}

bool own(const Table& table) {
  return table.column("time") >= 0 && table.column("position_x") >= 0 &&
         table.column("position_y") >= 0 && table.column("position_z") >= 0;
}

// Calls `take` with the numbers and fields of every row. Says what could not be read.
void for_each_row(std::string_view bytes, const Table& table, FlightLog& log,
                  const std::function<void(const std::vector<std::string>&)>& take) {
  std::size_t at = table.first_row, rows = 0, odd = 0;
  int line = table.line, first_odd = 0;
  while (at < bytes.size()) {
    const std::size_t from = at;
    const std::string_view text = next_line(bytes, at);
    ++line;
    if (text.find_first_not_of(" \t\r") == text.npos) continue;
    const std::vector<std::string> fields = fields_of(text, table.separator);
    const bool last = at >= bytes.size() && !bytes.ends_with('\n');
    if (last && fields.size() < table.headings.size()) {
      log.damage = "it is cut short in line " + std::to_string(line);
      log.bytes_read = from;
      break;
    }
    // Some apps end each row with one more separator.
    if (fields.size() < table.headings.size() || (fields.size() > table.headings.size() + 1)) {
      if (odd++ == 0) first_odd = line;
      continue;
    }
    ++rows;
    take(fields);
  }
  log.records.push_back({"rows", rows});
  if (odd > 0)
    log.remarks.push_back(std::to_string(odd) +
                          " lines have another number of fields than the "
                          "headings, the first of them line " +
                          std::to_string(first_odd));
}

// Numbers of one row in SI.
class Row {
 public:
  Row(const Table& table, const std::vector<std::string>& fields)
      : table_(table), fields_(fields) {}
  double number(int column) const {
    return column < 0 ? NAN
                      : table_.scale(column) * number_of(fields_[static_cast<std::size_t>(column)]);
  }
  double number(std::string_view name) const { return number(table_.column(name)); }
  const std::string& text(int column) const { return fields_[static_cast<std::size_t>(column)]; }
  bool has_unit(int column) const {
    return !table_.headings[static_cast<std::size_t>(column)].unit.empty();
  }

 private:
  const Table& table_;
  const std::vector<std::string>& fields_;
};

FlightLog read_own(std::string_view bytes, const Table& table) {
  LogBuilder builder("csv", bytes.size());
  builder.log.recorder = "Lapwing";
  builder.log.clock = "the start of the plan";
  const auto has = [&](const char* name) { return table.column(name) >= 0; };
  for_each_row(bytes, table, builder.log, [&](const std::vector<std::string>& fields) {
    const Row row(table, fields);
    const double time = row.number("time");
    const auto three = [&](const char* quantity, const std::string& name) {
      if (has((name + "_x").c_str()))
        builder.add(quantity, time,
                    {row.number(name + "_x"), row.number(name + "_y"), row.number(name + "_z")});
    };
    three("position", "position");
    three("velocity", "velocity");
    three("acceleration", "acceleration");
    three("body_rates", "body_rates");
    if (has("yaw")) builder.add("yaw", time, {row.number("yaw")});
    if (has("orientation_w"))
      builder.add("orientation", time,
                  {row.number("orientation_w"), row.number("orientation_x"),
                   row.number("orientation_y"), row.number("orientation_z")});
    if (has("yaw") && has("gimbal_yaw") && has("gimbal_pitch"))
      builder.add("camera", time,
                  {row.number("yaw") + row.number("gimbal_yaw"), row.number("gimbal_pitch")});
  });
  return builder.finish();
}

// "Yes", "1", "true".
bool is_set(const std::string& text) {
  return !text.empty() && (text[0] == 'Y' || text[0] == 'y' || text[0] == 'T' || text[0] == 't' ||
                           number_of(text) > 0);
}

// Adds the rows of an app's record.
class AppReader {
 public:
  AppReader(const Table& table, const App& app, bool from_sea, LogBuilder& builder)
      : app_(app), builder_(builder) {
    for (int field = 0; field < kFields; ++field)
      columns_[field] = column_of(table, app, static_cast<Field>(field));
    const bool sea = columns_[kAltitude] >= 0 && (from_sea || columns_[kHeight] < 0);
    height_ = sea ? columns_[kAltitude] : columns_[kHeight];
    builder.log.heights = sea ? HeightOf::sea : HeightOf::ground;
  }

  void add(const Row& row) {
    const double time = row.number(columns_[kTime]);
    const double latitude = row.number(columns_[kLatitude]);
    const double longitude = row.number(columns_[kLongitude]);
    set_utc(row, time);
    // Zeros are what the apps write before there is a position.
    const bool located = latitude != 0 || longitude != 0;
    builder_.add("place", time, {located ? latitude : NAN, longitude, row.number(height_)});
    if (columns_[kNorthSpeed] >= 0)
      builder_.add("velocity", time,
                   {row.number(columns_[kEastSpeed]), row.number(columns_[kNorthSpeed]),
                    -row.number(columns_[kDownSpeed])});
    add_angles(row, time);
    if (columns_[kVoltage] >= 0 && columns_[kCharge] >= 0)
      builder_.add("battery", time,
                   {row.number(columns_[kVoltage]),
                    columns_[kCurrent] < 0 ? 0 : row.number(columns_[kCurrent]),
                    in_si(row, kCharge, app_.charge)});
    add_events(row, time);
  }

 private:
  // Of a column whose unit may be left out.
  double in_si(const Row& row, Field field, double factor) const {
    if (columns_[field] < 0) return NAN;
    return row.number(columns_[field]) * (row.has_unit(columns_[field]) ? 1 : factor);
  }

  void set_utc(const Row& row, double time) {
    if (columns_[kUtc] < 0 || builder_.log.utc) return;
    const double utc = utc_of(row.text(columns_[kUtc]));
    if (std::isfinite(utc - time)) builder_.log.utc = utc - time;
  }

  void add_angles(const Row& row, double time) {
    const double heading = in_si(row, kHeading, app_.angle);
    if (columns_[kHeading] >= 0) builder_.add("yaw", time, {yaw_of_heading(heading)});
    if (columns_[kHeading] >= 0 && columns_[kRoll] >= 0 && columns_[kPitch] >= 0) {
      const Eigen::Vector4d q = orientation_of_euler(in_si(row, kRoll, app_.angle),
                                                     in_si(row, kPitch, app_.angle), heading);
      builder_.add("orientation", time, {q.data(), 4});
    }
    if (columns_[kCameraHeading] >= 0 && columns_[kCameraPitch] >= 0)
      builder_.add("camera", time,
                   {yaw_of_heading(in_si(row, kCameraHeading, app_.camera_angle)),
                    in_si(row, kCameraPitch, app_.camera_angle)});
  }

  void add_events(const Row& row, double time) {
    if (!std::isfinite(time)) return;
    if (columns_[kPhoto] >= 0) {
      const bool set = is_set(row.text(columns_[kPhoto]));
      if (set && !photo_) builder_.log.photographs.push_back(time);
      photo_ = set;
    }
    for (const Field field : {kMode, kMessage}) {
      if (columns_[field] < 0) continue;
      const std::string& text = row.text(columns_[field]);
      if (!text.empty() && text != said_[field == kMode])
        builder_.log.messages.push_back({time, text});
      said_[field == kMode] = text;
    }
  }

  const App& app_;
  LogBuilder& builder_;
  int columns_[kFields] = {};
  int height_ = -1;
  bool photo_ = false;
  std::string said_[2];
};

FlightLog read_app(std::string_view bytes, const Table& table, const App& app, bool from_sea) {
  LogBuilder builder("csv", bytes.size());
  builder.log.recorder = app.name;
  builder.log.clock = "the clock of the record";
  AppReader reader(table, app, from_sea, builder);
  for_each_row(bytes, table, builder.log,
               [&](const std::vector<std::string>& fields) { reader.add(Row(table, fields)); });
  return builder.finish();
}

}  // namespace

bool recognizes(std::string_view bytes) {
  const Table table = table_of(bytes);
  return own(table) || app_of(table) != nullptr;
}

FlightLog read(std::string_view bytes, bool from_sea) {
  const Table table = table_of(bytes);
  const App* app = app_of(table);
  if (!own(table) && !app)
    throw InputError(
        "line " + std::to_string(table.line) +
        ": the headings are not those of a flight record: expected `time [s],position_x [m],...` "
        "of Lapwing, or those of Airdata, Litchi, a DJI flight record or DatCon, with time, "
        "latitude, longitude and height");
  for (std::size_t i = 0; app && i < kFields; ++i)  // unknown units are errors before any row
    if (const int column = column_of(table, *app, static_cast<Field>(i)); column >= 0)
      table.scale(column);
  FlightLog log = own(table) ? read_own(bytes, table) : read_app(bytes, table, *app, from_sea);
  if (log.series.empty())
    throw InputError("line " + std::to_string(table.line + 1) +
                     ": no row holds a time and a position");
  return log;
}

}  // namespace lapwing::csv_log
