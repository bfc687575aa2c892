// SPDX-License-Identifier: Apache-2.0
#include "framework/core/named_parameters.h"

#include <charconv>
#include <sstream>

namespace lapwing {

namespace {

// "true", "0.3" or a word.
Value value_of(const std::string& text) {
  if (text == "true" || text == "false") return Value(text == "true");
  double number = 0;
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, number);
  return error == std::errc{} && stopped == end ? Value(number) : Value(text);
}

// "position=0.05,velocity=0.3"; nothing for what is none.
std::optional<Value> parameters_of(const std::string& text) {
  if (text.empty() || text.back() == ',') return std::nullopt;
  Value parameters = Value::map();
  std::istringstream rest(text);
  for (std::string part; std::getline(rest, part, ',');) {
    const std::size_t equal = part.find('=');
    if (equal == std::string::npos || equal == 0 || equal + 1 == part.size()) return std::nullopt;
    const std::string name = part.substr(0, equal);
    if (parameters.find(name)) return std::nullopt;
    parameters.set(name, value_of(part.substr(equal + 1)));
  }
  return parameters;
}

}  // namespace

std::optional<NamedParameters> named_parameters_from(const std::string& text) {
  const std::size_t colon = text.find(':');
  NamedParameters named{text.substr(0, colon), {}};
  if (colon == std::string::npos) return named;
  const std::optional<Value> parameters = parameters_of(text.substr(colon + 1));
  if (!parameters) return std::nullopt;
  named.parameters = *parameters;
  return named;
}

}  // namespace lapwing
