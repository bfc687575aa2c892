// SPDX-License-Identifier: Apache-2.0
// Text from outside within HTML and XML.
#include "framework/core/markup.h"

#include <gtest/gtest.h>

namespace lapwing {
namespace {

constexpr const char* kReplaced = "\xef\xbf\xbd";

TEST(Markup, WhatMeansSomethingBecomesAReference) {
  EXPECT_EQ(markup_text("a<b> & \"c\" 'd'"), "a&lt;b&gt; &amp; &quot;c&quot; &#39;d&#39;");
  EXPECT_EQ(markup_text("&amp;"), "&amp;amp;");
  EXPECT_EQ(markup_text(""), "");
  EXPECT_EQ(markup_text("\xc3\x9c \xf0\x9f\x9a\x81\n\t"), "\xc3\x9c \xf0\x9f\x9a\x81\n\t");
}

TEST(Markup, WhatItMayNotHoldIsReplaced) {
  const std::string r = kReplaced;
  EXPECT_EQ(markup_text(std::string("x\0y\x1bz\x7f", 6)), "x" + r + "y" + r + "z" + r);
  EXPECT_EQ(markup_text("a\rb"), "a" + r + "b");
  EXPECT_EQ(markup_text("\xc2\x85|\xc2\xa0"), r + "|\xc2\xa0");
  EXPECT_EQ(markup_text("\xef\xbf\xbe|\xef\xbf\xbf|\xef\xbf\xbd"), r + "|" + r + "|" + r);
  for (const char* broken : {"\xff", "\xc3", "\xed\xa0\x80"})  // the last is a surrogate
    EXPECT_NE(markup_text(broken).find(r), std::string::npos);
}

}  // namespace
}  // namespace lapwing
