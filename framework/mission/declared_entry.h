// SPDX-License-Identifier: Apache-2.0
// Reads declarations of options (framework/mission/options.h) as data: what annotations, schemas
// and tables of READMEs are written from.
#pragma once

#include <string>

#include "framework/core/parameters.h"
#include "framework/core/value.h"

namespace lapwing {

// The text of a key; "" if there is none.
inline std::string declared_text(const Value& entry, const char* key) {
  const Value* value = entry.find(key);
  return value && value->is_text() ? value->as_text() : "";
}

inline bool declared_required(const Value& entry) {
  const Value* value = entry.find("required");
  return value && value->as_boolean();
}

inline Range declared_range(const Value& entry) {
  Range range;
  if (const Value* bound = entry.find("minimum")) range.minimum = bound->as_number();
  if (const Value* bound = entry.find("maximum")) range.maximum = bound->as_number();
  if (const Value* bound = entry.find("above")) {
    range.minimum = bound->as_number();
    range.minimum_excluded = true;
  }
  return range;
}

}  // namespace lapwing
