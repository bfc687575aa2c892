// SPDX-License-Identifier: Apache-2.0
// Tables for terminals.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace lapwing {

struct TextTable {
  std::vector<std::vector<std::string>> rows = {};  // of one length; the first holds the titles
  std::size_t keys = 1;                             // columns at the left that every block repeats
  // A cell in its colours; null: as it is. Row 0 holds the titles.
  std::function<std::string(std::size_t row, std::size_t column, const std::string& cell)> paint =
      {};
};

// Columns beside each other, at most `width` characters a line: what does not fit follows in
// further blocks, each with the keys again. A column by itself may be wider. Cells are shown on one
// line, their control characters as text. Ends with a line break.
std::string text_of(const TextTable& table, std::size_t width);

// Characters of UTF-8.
std::size_t shown_width(const std::string& text);

// Columns of the terminal at standard output; 100 where there is none.
std::size_t columns_of_stdout();

}  // namespace lapwing
