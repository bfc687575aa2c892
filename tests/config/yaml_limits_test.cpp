// SPDX-License-Identifier: Apache-2.0
// Large and dense YAML: read in time that grows with it, or refused before it takes memory.
#include <gtest/gtest.h>

#include <chrono>

#include "framework/config/yaml.h"
#include "framework/core/json.h"

namespace lapwing {
namespace {

std::string error_of(const std::string& text) {
  try {
    from_yaml(text, "big.yaml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(YamlLimits, ManyKeysTakeTimeInProportion) {
  std::string text;
  for (int i = 0; text.size() < 3'000'000; ++i) text += "key" + std::to_string(i) + ": 1\n";
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_GT(from_yaml(text, "big.yaml").as_map().size(), 200'000u);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
}

TEST(YamlLimits, DenseFlowStyleIsRefusedBeforehand) {
  const std::size_t many = 1u << 20;
  for (const char letter : {'[', '{', ']', ','})
    EXPECT_NE(error_of(std::string(many, letter)).find("too many entries for YAML"),
              std::string::npos);
  std::string list = "[0";
  for (int i = 0; i < 50'000; ++i) list += ", 1.5";
  EXPECT_EQ(error_of("a: " + list + "]"), "accepted");
  EXPECT_NE(error_of(std::string("a: 'x\0y'", 8)).find("big.yaml:1: not UTF-8"), std::string::npos);
}

TEST(JsonLimits, WhoeverReadsHearsWhatIsHeld) {
  std::string text = "[1";
  for (int i = 0; i < 100'000; ++i) text += ",1";
  std::size_t most = 0;
  from_json(text + "]", "big.json", [&](std::size_t bytes) { most = bytes; });
  EXPECT_GT(most, 100'000 * sizeof(Value) / 2);
  EXPECT_THROW(from_json(text + "]", "big.json",
                         [](std::size_t bytes) {
                           if (bytes > 2'000'000) throw InputError("enough");
                         }),
               InputError);
}

TEST(JsonLimits, Utf8IsToldFromWhatLooksLikeIt) {
  for (const char* good : {"", "plain", "\xc3\xa9", "\xe2\x82\xac", "\xf0\x9f\x9a\x81"})
    EXPECT_TRUE(is_utf8(good)) << good;
  for (const char* bad : {"\x80", "\xc0\xaf", "\xe0\x80\x80", "\xed\xa0\x80", "\xf0\x80\x80\x80",
                          "\xf4\x90\x80\x80", "\xff", "\xe2\x82", "a\xc3"})
    EXPECT_FALSE(is_utf8(bad)) << bad;
}

}  // namespace
}  // namespace lapwing
