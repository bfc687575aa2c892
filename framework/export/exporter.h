// SPDX-License-Identifier: Apache-2.0
// A plan as a file for something else to read: the plugin kind `exporter`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/core/folders.h"
#include "framework/core/plugin_object.h"
#include "framework/trajectory/plan.h"

namespace lapwing {

// What a vehicle makes of a file: the flight that it would fly, without take-off and landing.
struct FlownFile {
  // Of the motion `path`, world of the plan, from time 0 on. Without a gimbal, where the file does
  // not hold the camera: it is not compared then.
  Trajectory trajectory;
  double start = 0, finish = 0;          // s of the plan, the part that the file is of
  std::vector<double> photographs = {};  // s of the flight, when images are taken
  std::vector<double> reached = {};      // s of the flight, when each of its waypoints is
};

class Exporter : public PluginObject {
 public:
  using Interface = Exporter;
  static constexpr const char* kKind = "exporter";

  virtual ~Exporter() = default;

  // With its dot: ".csv"; empty for a format of several files, which make a folder.
  virtual std::string file_extension() const = 0;

  // The file's contents; the caller writes them, whole or not at all. Equal plans give equal bytes.
  // Throws InputError when this format cannot hold the plan, saying what it lacks. Thread-safe.
  virtual std::string write(const Plan& plan) const = 0;

  // Of a format of several files: those, for one folder, and `write` is the first of them. Errors
  // likewise.
  virtual NamedContents write_folder(const Plan&) const { return {}; }

  // Whether the file holds obstacles too: then the plan that it is given has their shapes open,
  // maps excepted.
  virtual bool shows_surroundings() const { return false; }

  // What the format loses: sentences for the user. Of a format of one file: `written` is what
  // `write` gave for this plan. It is read as a program would that plays it back, by other code
  // than that which wrote it, and compared with the plan.
  virtual std::vector<std::string> losses(const Plan&, const std::string& /*written*/) const {
    return {};
  }

  // Of a format that vehicles fly: the flight, read from the bytes as a vehicle would. The caller
  // compares it with the plan (flown_comparison.h), says how far it is from it, and refuses a file
  // that would break what the plan keeps.
  virtual std::optional<FlownFile> flown(const Plan&, const std::string& /*written*/) const {
    return std::nullopt;
  }

  // Sentences for the user on what the file is not good for, though it can be written.
  virtual std::vector<std::string> remarks(const Plan&) const { return {}; }
};

}  // namespace lapwing
