// SPDX-License-Identifier: Apache-2.0
// Fields of comma-separated files (RFC 4180).
#pragma once

#include <string>
#include <vector>

namespace lapwing {

// The shortest text that reads back as the same number; empty where it is not finite.
std::string csv_number(double number);

// Quoted where it must be.
std::string csv_text(const std::string& text);

// Fields that are not quoted yet, and a line break.
std::string csv_line(const std::vector<std::string>& fields);

}  // namespace lapwing
