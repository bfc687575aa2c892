// A plan as a file for something else to read: the plugin kind `exporter`.
#pragma once

#include <string>

#include "framework/trajectory/plan.h"

namespace lapwing {

class Exporter {
 public:
  using Interface = Exporter;
  static constexpr const char* kKind = "exporter";

  virtual ~Exporter() = default;

  // With its dot: ".csv".
  virtual std::string file_extension() const = 0;

  // The file's contents; the caller writes them, whole or not at all. Equal plans give equal bytes.
  // Throws InputError when this format cannot hold the plan, saying what it lacks. Thread-safe.
  virtual std::string write(const Plan& plan) const = 0;
};

}  // namespace lapwing
