// SPDX-License-Identifier: Apache-2.0
// Comma-separated values read back as what was written, by a reader that follows RFC 4180.
#include "framework/study/csv.h"

#include <gtest/gtest.h>

#include <charconv>
#include <cmath>
#include <limits>

#include "framework/core/random.h"

namespace lapwing {
namespace {

// Records of fields; a text that breaks the RFC's grammar ends with a field "BROKEN".
std::vector<std::vector<std::string>> read_csv(const std::string& text) {
  std::vector<std::vector<std::string>> records;
  std::vector<std::string> record;
  std::size_t at = 0;
  while (at < text.size()) {
    std::string field;
    if (text[at] == '"') {
      for (++at;; ++at) {
        if (at >= text.size()) return {{"BROKEN"}};
        if (text[at] == '"' && (at + 1 >= text.size() || text[at + 1] != '"')) break;
        if (text[at] == '"') ++at;
        field += text[at];
      }
      ++at;
    } else {
      while (at < text.size() && text[at] != ',' && text[at] != '\n') {
        if (text[at] == '"' || text[at] == '\r') return {{"BROKEN"}};
        field += text[at++];
      }
    }
    record.push_back(field);
    if (at >= text.size() || (text[at] != ',' && text[at] != '\n')) return {{"BROKEN"}};
    if (text[at++] == ',') {
      if (at < text.size() && text[at] == '\n')
        record.push_back(""), ++at;
      else
        continue;
    }
    records.push_back(std::move(record));
    record.clear();
  }
  return records;
}

TEST(Csv, NumbersReadBackAsTheSame) {
  Random random(8);
  std::vector<double> numbers{
      0.1, 1.0 / 3, -2.5, 1e300,         5e-324,
      1,   0,       -0.0, 123456789.125, std::numeric_limits<double>::max()};
  for (int i = 0; i < 200; ++i)
    numbers.push_back(std::ldexp(random.uniform(-1, 1), static_cast<int>(random.integer(-60, 60))));
  for (const double number : numbers) {
    const std::string text = csv_number(number);
    double back = std::nan("");
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), back);
    EXPECT_EQ(error, std::errc()) << text;
    EXPECT_EQ(end, text.data() + text.size()) << text;
    EXPECT_EQ(back, number);
    EXPECT_EQ(std::signbit(back), std::signbit(number));
  }
  EXPECT_EQ(csv_number(0.1), "0.1");
  EXPECT_EQ(csv_number(100), "100");
  EXPECT_EQ(csv_number(std::nan("")), "");
  EXPECT_EQ(csv_number(HUGE_VAL), "");
  EXPECT_EQ(csv_number(-HUGE_VAL), "");
}

TEST(Csv, TextsAreQuotedWhereTheyMustBe) {
  EXPECT_EQ(csv_text("plain text; with 'marks'"), "plain text; with 'marks'");
  EXPECT_EQ(csv_text("a,b"), "\"a,b\"");
  EXPECT_EQ(csv_text("say \"so\""), "\"say \"\"so\"\"\"");
  EXPECT_EQ(csv_text("a\nb"), "\"a\nb\"");
  EXPECT_EQ(csv_text("a\rb"), "\"a\rb\"");
  EXPECT_EQ(csv_line({}), "\n");
  EXPECT_EQ(csv_line({"a", "", "c"}), "a,,c\n");
}

TEST(Csv, AnyFieldsReadBack) {
  Random random(3);
  const std::string letters = "ab ,\"\n\r\"";
  std::string text;
  std::vector<std::vector<std::string>> written;
  for (int row = 0; row < 300; ++row) {
    std::vector<std::string> fields(2 + static_cast<std::size_t>(random.integer(0, 3)));
    for (std::string& field : fields)
      for (std::int64_t n = random.integer(0, 6); n > 0; --n)
        field += letters[static_cast<std::size_t>(random.integer(0, 7))];
    text += csv_line(fields);
    written.push_back(std::move(fields));
  }
  EXPECT_EQ(read_csv(text), written);
}

}  // namespace
}  // namespace lapwing
