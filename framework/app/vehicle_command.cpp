// SPDX-License-Identifier: Apache-2.0
// lapwing vehicle: a vehicle file from a log.
#include <cmath>
#include <cstdio>

#include "framework/app/flight_log_commands.h"
#include "framework/app/log_reading.h"
#include "framework/app/output_target.h"
#include "framework/config/lookup.h"
#include "framework/config/shipped.h"
#include "framework/config/yaml.h"
#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/number_text.h"
#include "framework/core/visible_text.h"
#include "framework/flight_review/shown_limits.h"
#include "framework/mission/vehicle_source.h"

namespace lapwing {
namespace {

// Four digits, so that the file does not claim more than a flight shows.
std::string four_digits(double value) {
  return plain_number(value, 4);
}

std::string one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 32) c = ' ';
  return text;
}

// The unit that a key takes, where its name does not say it.
std::string unit_of(const std::string& key) {
  if (key == "drag") return " N s/m";
  if (key == "flight_time" || key == "rotors.lag") return " s";
  if (key.ends_with("_speed") || key == "limits.speed_across") return " m/s";
  if (key.starts_with("limits.acceleration")) return " m/s^2";
  return "";
}

// Writes the base's keys, with what the log showed in the place of theirs.
class VehicleText {
 public:
  VehicleText(const ShownLimits& shown, std::string base) : shown_(shown), base_(std::move(base)) {}

  std::string of(const Value& vehicle, const std::string& log) {
    text_ = "# The limits that a flight showed: " + one_line(log) + ".\n# " +
            plain_number(shown_.airborne, 4) + " s in the air, positions from " +
            one_line(shown_.source) + ".\n";
    for (const std::string& remark : shown_.remarks) text_ += "# * " + one_line(remark) + "\n";
    text_ += "\n";
    write(vehicle, "", 0);
    return text_;
  }

 private:
  void write(const Value& table, const std::string& prefix, int indent) {
    for (const auto& [key, value] : table.as_map()) {
      const std::string whole = prefix + key;
      if (value.is_map()) {
        text_ += std::string(static_cast<std::size_t>(indent), ' ') + key + ":\n";
        write(value, whole + ".", indent + 2);
        add_missing(value, whole, indent + 2);
      } else if (const ShownFigure* figure = shown_.find(whole)) {
        shown_line(key, *figure, value, indent);
      } else {
        line(key + ": " + (value.is_text() ? quoted(value.as_text()) : to_json(value, -1)),
             "of " + base_, indent);
      }
    }
    if (prefix.empty()) add_top(table);
  }

  // A text that YAML would read as something else has quotes.
  static std::string quoted(const std::string& text) {
    const bool plain = !text.empty() && text.find_first_of(":#{}[]&*!|>'\"%@`,") == text.npos;
    return plain ? text : to_json(Value(text), -1);
  }

  void line(const std::string& text, const std::string& comment, int indent) {
    std::string whole = std::string(static_cast<std::size_t>(indent), ' ') + text;
    whole.resize(std::max<std::size_t>(whole.size() + 1, 36), ' ');
    text_ += whole + "# " + one_line(comment) + "\n";
  }

  void shown_line(const std::string& key, const ShownFigure& figure, const Value& base,
                  int indent) {
    std::string value = four_digits(figure.value) + unit_of(figure.key);
    if (figure.key == "rotors.thrust") {
      const double least =
          base.is_list() && !base.as_list().empty() ? base.as_list()[0].as_number() : 0;
      value = "[" + four_digits(least) + ", " + four_digits(figure.value) + "]";
    }
    line(key + ": " + value, "shown, " + figure.evidence, indent);
  }

  // Limits that the base does not state.
  void add_missing(const Value& table, const std::string& name, int indent) {
    for (const ShownFigure& figure : shown_.figures) {
      const std::size_t dot = figure.key.find('.');
      if (dot == figure.key.npos || figure.key.substr(0, dot) != name) continue;
      const std::string key = figure.key.substr(dot + 1);
      if (!table.find(key)) shown_line(key, figure, Value(), indent);
    }
  }

  void add_top(const Value& table) {
    for (const ShownFigure& figure : shown_.figures)
      if (figure.key.find('.') == figure.key.npos && !table.find(figure.key))
        shown_line(figure.key, figure, Value(), 0);
  }

  const ShownLimits& shown_;
  std::string base_, text_;
};

Value to_value(const ShownLimits& shown) {
  Value value = Value::map();
  value.set("airborne", shown.airborne);
  value.set("positions", shown.source);
  Value& figures = value.set("figures", Value::map());
  for (const ShownFigure& figure : shown.figures) {
    Value one = Value::map();
    one.set("value", figure.value);
    if (figure.low) one.set("low", *figure.low);
    if (figure.high) one.set("high", *figure.high);
    one.set("evidence", figure.evidence);
    figures.set(figure.key, std::move(one));
  }
  Value& remarks = value.set("remarks", Value::list());
  for (const std::string& remark : shown.remarks) remarks.push_back(remark);
  return value;
}

}  // namespace

ExitStatus vehicle_from_log(const FlightLogRequest& asked, const Invocation& invocation) {
  if (!asked.target.empty()) require_output(asked.target, {asked.log});
  const std::string name = asked.base.empty() ? "vehicles/solo" : asked.base;
  ConfigSearch search;
  search.folders = {shipped_folder("configs")};
  Value stated;
  Vehicle base;
  std::vector<std::filesystem::path> folders = search.folders;
  try {
    stated = read_config(name, search);
    folders.insert(folders.begin(), find_config(name, search).parent_path());
    base = load_vehicle(stated, folders);
  } catch (const InputError& error) {
    throw InputError(std::string("--base: ") + error.what());
  }
  const FlightLog log = read_flight_log(asked.log, asked.format, invocation.registry());
  ShownLimits shown;
  try {
    shown = shown_limits(log, base);
  } catch (const InputError& error) {
    throw InputError("'" + asked.log.string() + "': " + error.what());
  }
  if (!log.damage.empty()) shown.remarks.push_back("the log is damaged: " + log.damage);
  const std::string text =
      VehicleText(shown, name).of(stated, asked.log.filename().string() + ", " + log.recorder);
  try {
    load_vehicle(from_yaml(text, "the vehicle file"), folders);
  } catch (const InputError& error) {
    throw InputError("'" + asked.log.string() + "': what the flight shows and '" + name +
                     "' contradict each other; choose another --base: " + error.what());
  }
  if (!asked.target.empty()) write_file_atomically(asked.target, text);
  if (invocation.json) {
    Value object = to_value(shown);
    object.set("file", asked.target.string());
    print_json(object);
  } else if (asked.target.empty()) {
    std::fputs(text.c_str(), stdout);
  } else {
    for (const ShownFigure& figure : shown.figures)
      std::printf("%-26s %10s  %s\n", figure.key.c_str(), four_digits(figure.value).c_str(),
                  visible_line(figure.evidence).c_str());
    for (const std::string& remark : shown.remarks)
      std::printf("%s\n", visible_line(remark).c_str());
    std::printf("wrote %s\n", asked.target.string().c_str());
  }
  return ExitStatus::done;
}

}  // namespace lapwing
