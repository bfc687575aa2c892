// SPDX-License-Identifier: Apache-2.0
// Comma-separated values with a line of headings, as flight records have them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lapwing::csv_log {

struct Heading {
  std::string name;   // in lower case, without its unit
  std::string unit;   // "m/s" of "speed(m/s)" and of "speed [m/s]"; "" where there is none
  double factor = 1;  // of the unit to SI; not a number for an unknown unit
};

// The fields of one line, quotes taken off.
std::vector<std::string> fields_of(std::string_view line, char separator);

// The next line of `text` from `at` on, without its end; moves `at` behind it. A line break within
// quotes does not end a line.
std::string_view next_line(std::string_view text, std::size_t& at);

struct Table {
  std::vector<Heading> headings;
  char separator = ',';
  std::size_t first_row = 0;  // byte behind the line of headings
  int line = 1;               // of the headings

  // The column of that name; -1 where there is none.
  int column(std::string_view name) const;
  // Factor of that column's unit to SI; 1 without a unit. InputError for an unknown unit.
  double scale(int column) const;
};

// The headings of a file: a byte order mark and a line `sep=,` may come before them. A table
// without headings for bytes that have no such line in their first 64 kB.
Table table_of(std::string_view text);

// The number in a field; not a number where it is empty or holds something else.
double number_of(std::string_view field);

// s since 1970 of "2024-05-12 09:30:01.25", also with T and Z; not a number for anything else.
double utc_of(std::string_view text);

}  // namespace lapwing::csv_log
