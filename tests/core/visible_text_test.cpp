// SPDX-License-Identifier: Apache-2.0
// What a terminal would obey is shown as text.
#include "framework/core/visible_text.h"

#include <gtest/gtest.h>

#include "framework/core/log.h"

namespace lapwing {
namespace {

TEST(VisibleText, ShowsWhatATerminalWouldObey) {
  EXPECT_EQ(visible_text("\x1b[2Jhop\x07"), "\\x1b[2Jhop\\x07");
  EXPECT_EQ(visible_text(std::string("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(visible_text("a\rb\x7f"), "a\\x0db\\x7f");
  EXPECT_EQ(visible_text("\xc2\x9b"
                         "2J"),
            "\\x9b2J");  // a control sequence in one character
  EXPECT_EQ(visible_text("a\u202e"
                         "b\u2066"),
            "a\\u202eb\\u2066");
}

TEST(VisibleText, KeepsWhatIsMeantToBeRead) {
  const std::string text = "S\u00fcd, \u6771\u4eac, \U0001f681\n\tsecond line";
  EXPECT_EQ(visible_text(text), text);
  EXPECT_EQ(visible_line("a\n\tb"), "a\\n\\tb");
  EXPECT_EQ(visible_line("a\\x1b"), "a\\x1b");
}

TEST(VisibleText, ShowsBytesThatAreNoUtf8) {
  for (const auto& [bytes, shown] :
       {std::pair("\xff", "\\xff"), std::pair("\xc3", "\\xc3"), std::pair("\xc0\x9b", "\\xc0\\x9b"),
        std::pair("\xed\xa0\x80", "\\xed\\xa0\\x80"), std::pair("\xe0\x80\x9b", "\\xe0\\x80\\x9b"),
        std::pair("\xf4\x90\x80\x80", "\\xf4\\x90\\x80\\x80")})
    EXPECT_EQ(visible_text(bytes), shown);
}

TEST(VisibleText, IsWhatTheLogKeeps) {
  const logging::Capture capture;
  logging::info("a\x1b[31mb");
  EXPECT_EQ(capture.text(), "info: a\\x1b[31mb\n");
}

}  // namespace
}  // namespace lapwing
