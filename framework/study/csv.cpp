// SPDX-License-Identifier: Apache-2.0
#include "framework/study/csv.h"

#include <charconv>
#include <cmath>

namespace lapwing {

std::string csv_number(double number) {
  if (!std::isfinite(number)) return "";
  char buffer[32];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, number).ptr};
}

std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == text.npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string csv_line(const std::vector<std::string>& fields) {
  std::string line;
  for (std::size_t i = 0; i < fields.size(); ++i) line += (i > 0 ? "," : "") + csv_text(fields[i]);
  return line + "\n";
}

}  // namespace lapwing
