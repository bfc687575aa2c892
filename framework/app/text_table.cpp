// SPDX-License-Identifier: Apache-2.0
#include "framework/app/text_table.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>

#include "framework/core/visible_text.h"

namespace lapwing {

namespace {

constexpr std::size_t kGap = 2;

std::string block_of(const TextTable& table, const std::vector<std::size_t>& columns,
                     const std::vector<std::size_t>& widths) {
  std::string text;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    std::size_t gap = 0;
    for (const std::size_t column : columns) {
      const std::string& cell = table.rows[i][column];
      if (cell.empty()) {
        gap += widths[column] + kGap;
        continue;
      }
      text.append(gap, ' ');
      text += table.paint ? table.paint(i, column, cell) : cell;
      gap = widths[column] - shown_width(cell) + kGap;
    }
    text += "\n";
  }
  return text;
}

}  // namespace

std::size_t shown_width(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xc0) != 0x80;
  }));
}

std::string text_of(const TextTable& given, std::size_t width) {
  TextTable table = given;
  std::vector<std::vector<std::string>>& rows = table.rows;
  if (rows.empty()) return "";
  std::vector<std::size_t> widths(rows[0].size(), 0);
  for (std::vector<std::string>& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) {
      row[i] = visible_line(row[i]);
      widths[i] = std::max(widths[i], shown_width(row[i]));
    }
  std::string text;
  std::size_t next = std::min(table.keys, rows[0].size());
  do {
    std::vector<std::size_t> columns;
    std::size_t used = 0;
    for (std::size_t i = 0; i < std::min(table.keys, rows[0].size()); ++i) {
      columns.push_back(i);
      used += widths[i] + kGap;
    }
    const std::size_t first = next;
    while (next < rows[0].size() && (next == first || used + widths[next] <= width)) {
      columns.push_back(next);
      used += widths[next++] + kGap;
    }
    text += (text.empty() ? "" : "\n") + block_of(table, columns, widths);
  } while (next < rows[0].size());
  return text;
}

std::size_t columns_of_stdout() {
  constexpr std::size_t kUnknown = 100;
  winsize size{};
  return ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : kUnknown;
}

}  // namespace lapwing
