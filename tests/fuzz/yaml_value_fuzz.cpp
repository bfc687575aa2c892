// SPDX-License-Identifier: Apache-2.0
// Configurations in YAML: whatever the bytes, a value or an InputError.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "framework/config/yaml.h"
#include "framework/core/error.h"

namespace {

// Every node knows its line, for the errors that are found later.
void check(const lapwing::Value& value) {
  if (value.is_list())
    for (const lapwing::Value& item : value.as_list()) check(item);
  if (value.is_map())
    for (const auto& [key, item] : value.as_map()) check(item);
  if (value.type() == lapwing::Value::Type::number && value.as_number() != value.as_number())
    std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    check(lapwing::from_yaml({reinterpret_cast<const char*>(data), size}, "input"));
  } catch (const lapwing::InputError&) {
  }
  return 0;
}
