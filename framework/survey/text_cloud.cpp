// SPDX-License-Identifier: Apache-2.0
// Texts of one point a line: x y z, or what a line of names or the caller says.
//
// Between numbers are blanks, tabs, commas or semicolons. A comma within a number is a decimal one
// where semicolons or blanks part the numbers. Lines that are empty or begin with # or // are
// passed over; so is a first line with nothing but the number of points (.pts).
#include <algorithm>
#include <cctype>

#include "framework/survey/cloud_reader.h"

namespace lapwing {
namespace {

using Words = std::vector<std::string>;

constexpr std::size_t kMostColumns = 1000;

Words split_at(std::string_view line, std::string_view separators) {
  Words words;
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t end = std::min(line.find_first_of(separators, at), line.size());
    if (end > at) words.emplace_back(line.substr(at, end - at));
    at = end + 1;
  }
  return words;
}

// What parts the numbers of a file, as its first line of numbers tells.
struct Separators {
  std::string between = " \t,;";
  bool decimal_comma = false;
};

Separators separators_of(std::string_view line) {
  if (line.find(',') == line.npos) return {};
  if (line.find(';') != line.npos) return {" \t;", true};
  const Words words = split_at(line, " \t");
  const bool inside =
      words.size() >= 3 && std::all_of(words.begin(), words.end(), [](const auto& w) {
        return std::count(w.begin(), w.end(), ',') <= 1 && !w.ends_with(',') && !w.starts_with(',');
      });
  if (inside) return {" \t", true};
  return {};
}

class TextCloud final : public CloudReader {
 public:
  TextCloud(StreamBytes bytes, const std::string& columns) : bytes_(std::move(bytes)) {
    header_.format = "text";
    if (!columns.empty()) set_columns(split_at(columns, " \t,;"), "columns");
    find_numbers();
    if (fields_.empty()) fields_ = {CloudField::x, CloudField::y, CloudField::z};
    const auto has = [&](CloudField field) {
      return std::find(fields_.begin(), fields_.end(), field) != fields_.end();
    };
    header_.normals = has(CloudField::nx) && has(CloudField::ny) && has(CloudField::nz);
    header_.classes = has(CloudField::classification);
  }

  std::size_t read(std::span<CloudPoint> points) override {
    std::size_t count = 0;
    while (count < points.size() && has_line_) {
      points[count] = {};
      read_point(points[count++]);
      has_line_ = next_line();
    }
    return count;
  }

 private:
  [[noreturn]] void fail_line(const std::string& why) const {
    bytes_.fail("line " + std::to_string(number_) + ": " + why);
  }

  // The next line that is neither empty nor a comment.
  bool next_line() {
    std::string_view text;
    while (bytes_.line(text)) {
      ++number_;
      const std::size_t begin = text.find_first_not_of(" \t\r\v\f");
      if (begin == text.npos) continue;
      text.remove_prefix(begin);
      if (text.starts_with('#') || text.starts_with("//")) continue;
      line_ = std::string(text);
      return true;
    }
    return false;
  }

  static bool all_numbers(const Words& words, bool decimal_comma) {
    double value = 0;
    return std::all_of(words.begin(), words.end(), [&](std::string word) {
      if (decimal_comma) std::replace(word.begin(), word.end(), ',', '.');
      return number_in(word, value);
    });
  }

  // Passes over what stands before the first line of numbers.
  void find_numbers() {
    bool headed = false, counted = false;
    while ((has_line_ = next_line())) {
      separators_ = separators_of(line_);
      const Words words = split_at(line_, separators_.between);
      const bool numbers = all_numbers(words, separators_.decimal_comma);
      if (numbers && (words.size() > 1 || counted)) return;
      if (numbers) {
        counted = true;
        continue;
      }
      if (headed) fail_line("'" + line_.substr(0, 40) + "' is not a line of numbers");
      headed = true;
      if (fields_.empty()) set_columns(split_at(line_, " \t,;"), "its first line");
    }
  }

  void set_columns(const Words& names, const std::string& where) {
    if (names.size() > kMostColumns) bytes_.fail(where + " names more than 1000 columns");
    for (const std::string& name : names) {
      std::string plain = name;
      std::erase_if(plain, [](unsigned char c) { return c == '"' || c == '\''; });
      fields_.push_back(cloud_field_named(plain));
    }
    for (const CloudField axis : {CloudField::x, CloudField::y, CloudField::z})
      if (std::count(fields_.begin(), fields_.end(), axis) != 1)
        bytes_.fail(where +
                    " names no columns x, y and z, each once: state columns = \"x y z\", "
                    "with - for others");
  }

  void read_point(CloudPoint& point) const {
    std::size_t column = 0;
    for (std::size_t at = 0; at <= line_.size() && column < fields_.size();) {
      const std::size_t end = std::min(line_.find_first_of(separators_.between, at), line_.size());
      if (end > at) {
        if (fields_[column] != CloudField::none)
          set_cloud_field(point, fields_[column], number_of(line_.substr(at, end - at)));
        ++column;
      }
      at = end + 1;
    }
    const auto last = std::find_if(fields_.rbegin(), fields_.rend(),
                                   [](CloudField f) { return f != CloudField::none; });
    const auto needed = static_cast<std::size_t>(fields_.rend() - last);
    if (column < needed)
      fail_line("it has " + std::to_string(column) + " columns, and " + std::to_string(needed) +
                " are needed");
  }

  double number_of(std::string word) const {
    if (separators_.decimal_comma) std::replace(word.begin(), word.end(), ',', '.');
    double value = 0;
    if (!number_in(word, value)) fail_line("'" + word.substr(0, 40) + "' is not a number");
    return value;
  }

  StreamBytes bytes_;
  std::vector<CloudField> fields_;  // of the columns
  Separators separators_;
  std::string line_;  // the next one to be read
  bool has_line_ = false;
  std::uint64_t number_ = 0;  // of that line, from 1
};

}  // namespace

std::unique_ptr<CloudReader> open_text_cloud(StreamBytes bytes, const std::string& columns) {
  return std::make_unique<TextCloud>(std::move(bytes), columns);
}

}  // namespace lapwing
