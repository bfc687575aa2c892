// SPDX-License-Identifier: Apache-2.0
#include "plugins/flight_logs/csv/csv_table.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>

#include "framework/core/error.h"

namespace lapwing::csv_log {
namespace {

constexpr std::size_t kLongestHeadings = 65536;  // bytes

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

struct Unit {
  const char* name;
  double factor;
};
constexpr std::array kUnits{
    Unit{"m", 1},
    Unit{"meters", 1},
    Unit{"metres", 1},
    Unit{"feet", 0.3048},
    Unit{"ft", 0.3048},
    Unit{"m/s", 1},
    Unit{"mps", 1},
    Unit{"meters/sec", 1},
    Unit{"m/sec", 1},
    Unit{"mph", 0.44704},
    Unit{"km/h", 1 / 3.6},
    Unit{"kph", 1 / 3.6},
    Unit{"fps", 0.3048},
    Unit{"ft/s", 0.3048},
    Unit{"s", 1},
    Unit{"sec", 1},
    Unit{"ms", 1e-3},
    Unit{"millisecond", 1e-3},
    Unit{"deg", M_PI / 180},
    Unit{"degrees", M_PI / 180},
    Unit{"360", M_PI / 180},
    Unit{"rad", 1},
    Unit{"v", 1},
    Unit{"volts", 1},
    Unit{"mv", 1e-3},
    Unit{"a", 1},
    Unit{"amps", 1},
    Unit{"ma", 1e-3},
    Unit{"%", 0.01},
    Unit{"percent", 0.01},
    Unit{"rad/s", 1},
    Unit{"m/s^2", 1},
    Unit{"1", 1},
    Unit{"deg/s", M_PI / 180},
    Unit{"utc", 1},
    Unit{"local", 1},
    Unit{"n", 1},
    Unit{"n m", 1},
    Unit{"m/s^3", 1},
};

const Unit* unit_named(std::string_view name) {
  const auto found = std::find_if(kUnits.begin(), kUnits.end(),
                                  [&](const Unit& unit) { return name == unit.name; });
  return found == kUnits.end() ? nullptr : &*found;
}

// A bracket at the end holds the unit, if it is one: "IMU_ATTI(0)" has none.
Heading heading_of(std::string_view field) {
  const std::string text = lower(trimmed(field));
  const char last = text.empty() ? ' ' : text.back();
  const std::size_t open = last == ')'   ? text.rfind('(')
                           : last == ']' ? text.rfind('[')
                                         : text.npos;
  if (open == text.npos) return {text, "", 1};
  const std::string inside(
      trimmed(std::string_view(text).substr(open + 1, text.size() - open - 2)));
  const bool square = last == ']';
  const Unit* unit = unit_named(inside);
  if (!square && !unit) return {text, "", 1};
  return {std::string(trimmed(std::string_view(text).substr(0, open))), inside,
          unit ? unit->factor : NAN};
}

}  // namespace

std::vector<std::string> fields_of(std::string_view line, char separator) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"') {
      if (quoted && i + 1 < line.size() && line[i + 1] == '"')
        fields.back() += line[++i];
      else
        quoted = !quoted;
    } else if (c == separator && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

std::string_view next_line(std::string_view text, std::size_t& at) {
  const std::size_t from = at;
  bool quoted = false;
  for (; at < text.size(); ++at) {
    if (text[at] == '"') quoted = !quoted;
    if (text[at] == '\n' && !quoted) {
      const std::string_view line = text.substr(from, at - from);
      ++at;
      return line.ends_with('\r') ? line.substr(0, line.size() - 1) : line;
    }
  }
  return text.substr(from);
}

int Table::column(std::string_view name) const {
  const auto found = std::find_if(headings.begin(), headings.end(),
                                  [&](const Heading& heading) { return heading.name == name; });
  return found == headings.end() ? -1 : static_cast<int>(found - headings.begin());
}

double Table::scale(int column) const {
  const Heading& heading = headings[static_cast<std::size_t>(column)];
  if (std::isnan(heading.factor))
    throw InputError("line " + std::to_string(line) + ": column '" + heading.name +
                     "' has the unit '" + heading.unit +
                     "'; known are m, feet, m/s, mph, km/h, s, ms, deg, rad, V, A, %");
  return heading.factor;
}

Table table_of(std::string_view text) {
  Table table;
  std::size_t at = text.starts_with("\xef\xbb\xbf") ? 3 : 0;
  text = text.substr(0, std::max(at, kLongestHeadings));
  std::string_view line = trimmed(next_line(text, at));
  if (lower(line).starts_with("sep=") && line.size() == 5) {
    table.separator = line[4];
    line = trimmed(next_line(text, at));
    ++table.line;
  } else if (std::count(line.begin(), line.end(), ';') >
             std::count(line.begin(), line.end(), ',')) {
    table.separator = ';';
  }
  if (at >= text.size() && text.size() >= kLongestHeadings) return table;
  for (const char c : line)
    if (static_cast<unsigned char>(c) < 32 && c != '\t') return table;  // not a text
  for (const std::string& field : fields_of(line, table.separator))
    table.headings.push_back(heading_of(field));
  table.first_row = at;
  return table;
}

double number_of(std::string_view field) {
  field = trimmed(field);
  if (field.starts_with('+')) field.remove_prefix(1);
  double value = NAN;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  return error == std::errc{} && end == field.data() + field.size() ? value : NAN;
}

double utc_of(std::string_view text) {
  text = trimmed(text);
  if (text.ends_with('Z')) text.remove_suffix(1);
  if (text.size() < 19 || text[4] != '-' || text[7] != '-' || text[13] != ':' || text[16] != ':' ||
      (text[10] != ' ' && text[10] != 'T'))
    return NAN;
  const auto part = [&](std::size_t from, std::size_t count) {
    return number_of(text.substr(from, count));
  };
  const double year = part(0, 4), month = part(5, 2), day = part(8, 2);
  const double clock = 3600 * part(11, 2) + 60 * part(14, 2) + number_of(text.substr(17));
  if (!std::isfinite(year + month + day + clock)) return NAN;
  if (!(year >= 1970 && year <= 9999 && month >= 1 && month <= 12 && day >= 1 && day <= 31))
    return NAN;
  const std::chrono::year_month_day date{std::chrono::year(static_cast<int>(year)),
                                         std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  if (!date.ok()) return NAN;
  return 86400.0 * static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count()) +
         clock;
}

}  // namespace lapwing::csv_log
