// SPDX-License-Identifier: Apache-2.0
#include "framework/core/base64.h"

#include <gtest/gtest.h>

namespace lapwing {
namespace {

// RFC 4648, section 10.
TEST(Base64, HasTheValuesOfItsStandard) {
  const std::pair<const char*, const char*> kValues[] = {{"", ""},
                                                         {"f", "Zg=="},
                                                         {"fo", "Zm8="},
                                                         {"foo", "Zm9v"},
                                                         {"foob", "Zm9vYg=="},
                                                         {"fooba", "Zm9vYmE="},
                                                         {"foobar", "Zm9vYmFy"}};
  for (const auto& [bytes, text] : kValues) {
    EXPECT_EQ(base64(bytes), text);
    EXPECT_EQ(bytes_of_base64(text), bytes);
  }
}

TEST(Base64, EveryByteComesBack) {
  std::string bytes;
  for (int k = 0; k < 256; ++k) bytes += static_cast<char>(k);
  for (int length = 0; length < 256; ++length)
    EXPECT_EQ(bytes_of_base64(base64(bytes.substr(0, length))), bytes.substr(0, length));
}

TEST(Base64, OtherTextsAreRefused) {
  for (const char* text : {"Z", "Zg", "Zg=", "====", "Z===", "Zm9v\n", "Zm 9", "Zg==Zg=="})
    EXPECT_FALSE(bytes_of_base64(text)) << text;
}

}  // namespace
}  // namespace lapwing
