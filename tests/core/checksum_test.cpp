// SPDX-License-Identifier: Apache-2.0
#include "framework/core/checksum.h"

#include <gtest/gtest.h>

namespace lapwing {
namespace {

TEST(Checksum, EqualsThePublishedExamples) {
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  // Where the length fits behind the text, and where it takes a block of its own.
  EXPECT_EQ(sha256(std::string(55, 'x')),
            "d5e285683cd4efc02d021a5c62014694958901005d6f71e89e0989fac77e4072");
  EXPECT_EQ(sha256(std::string(56, 'x')),
            "04c26261370ee7541549d16dee320c723e3fd14671e66a099afe0a377c16888e");
  EXPECT_EQ(sha256(std::string(63, 'x')),
            "75220b47218278e656f2013bb8f0c455a25eaf01e86c64924e9d48d89776d6f2");
  EXPECT_EQ(sha256(std::string(1'000'000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Checksum, EveryLengthHasItsOwn) {
  std::string last;
  for (std::size_t size = 50; size < 140; ++size) {
    const std::string sum = sha256(std::string(size, 'x'));
    EXPECT_EQ(sum.size(), 64u);
    EXPECT_NE(sum, last);
    last = sum;
  }
}

}  // namespace
}  // namespace lapwing
