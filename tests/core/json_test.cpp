// SPDX-License-Identifier: Apache-2.0
#include "framework/core/json.h"

#include <bit>

#include "framework/core/random.h"

namespace lapwing {
namespace {

std::string refused(const std::string& text) {
  try {
    from_json(text, "plan.json");
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Json, KeepsTypesOrderAndLines) {
  const Value value = from_json(
      "{\n"
      "  \"z\": 1,\n"
      "  \"a\": [1.5,\n"
      "         2\n"
      "  ],\n"
      "  \"n\": 7\n"
      "}\n",
      "plan.json");
  EXPECT_EQ(value.as_map()[0].first, "z");
  EXPECT_EQ(value.at("z").type(), Value::Type::integer);
  EXPECT_EQ(value.origin(), (Origin{"plan.json", 1}));
  EXPECT_EQ(value.at("z").origin().line, 2);
  EXPECT_EQ(value.at("a").origin().line, 3);
  EXPECT_EQ(value.at("a").as_list()[1].origin().line, 4);
  EXPECT_EQ(value.at("n").origin().line, 6);  // the parser has already seen the next line
}

TEST(Json, WritesShortestNumbersThatReadBackEqual) {
  EXPECT_EQ(to_json(Value(0.1), -1), "0.1");
  EXPECT_EQ(to_json(Value(3.0), -1), "3.0");
  EXPECT_EQ(to_json(Value(3), -1), "3");
  EXPECT_EQ(to_json(Value(-0.0), -1), "-0.0");
  EXPECT_EQ(to_json(Value(1e300), -1), "1e+300");
  Random random(5);
  for (int i = 0; i < 20000; ++i) {
    const double number = std::bit_cast<double>(random.bits());
    if (!std::isfinite(number)) continue;
    const Value back = from_json(to_json(Value(number)), "test");
    ASSERT_EQ(back.type(), Value::Type::number);
    ASSERT_EQ(std::bit_cast<std::uint64_t>(back.as_number()), std::bit_cast<std::uint64_t>(number));
  }
}

TEST(Json, WritesTheSameLayoutEveryTime) {
  const char* text =
      "{\n"
      "  \"name\": \"castle \\\"flyover\\\"\\n\",\n"
      "  \"position\": [1.0, 2.5, -3],\n"
      "  \"empty\": [],\n"
      "  \"none\": {},\n"
      "  \"list\": [\n"
      "    {\n"
      "      \"ok\": true\n"
      "    },\n"
      "    null\n"
      "  ]\n"
      "}";
  EXPECT_EQ(to_json(from_json(text, "test")), text);
  EXPECT_EQ(to_json(from_json(R"({"a": [1, {"b": "ä"}]})", "test"), -1), R"({"a":[1,{"b":"ä"}]})");
}

TEST(Json, RefusesWhatItCannotHold) {
  Value value = Value::map();
  value.set("samples", Value(Value::List{Value(1.0), Value(std::nan(""))}));
  try {
    to_json(value);
    FAIL() << "NaN was written";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "samples[2]: JSON cannot hold NaN");
  }
  EXPECT_THROW(to_json(Value(std::numeric_limits<double>::infinity())), Error);
  EXPECT_THROW(to_json(Value("\xff\xfe")), Error);
}

TEST(Json, NamesLineAndColumnOfBadText) {
  EXPECT_EQ(refused("{\"a\": 1,\n \"a\": 2}"), "plan.json:2: repeated key 'a'");
  const std::string truncated = refused("{\n  \"samples\": [1, 2,");
  EXPECT_EQ(truncated.rfind("plan.json:2:20: invalid JSON: ", 0), 0u) << truncated;
  for (const char* text : {"",    " ",     "{",     "[1 2]", "{\"a\" 1}", "{a: 1}",     "[1,]",
                           "nan", "[NaN]", "'a'",   "{} {}", "\x80",      "\"\xc3\"",   "\"unended",
                           "01",  "1.",    "1e999", "tru",   "[1]]",      "\"\\ud800\""}) {
    EXPECT_EQ(refused(text).rfind("plan.json:", 0), 0u) << text << " -> " << refused(text);
  }
}

TEST(Json, RefusesDepthThatWouldExhaustTheStack) {
  const std::string deep(1000000, '[');
  EXPECT_NE(refused(deep).find("nested deeper than 200"), std::string::npos);
  const std::string allowed = std::string(200, '[') + std::string(200, ']');
  EXPECT_EQ(refused(allowed), "accepted");
}

TEST(Json, LargeIntegersBecomeNumbers) {
  EXPECT_EQ(from_json("9223372036854775807", "t").as_integer(), INT64_MAX);
  EXPECT_EQ(from_json("18446744073709551615", "t").as_number(), 18446744073709551615.0);
}

// Damaged text is read or refused; it never brings the program down.
TEST(Json, MutationsParseOrThrowInputError) {
  const std::string valid = R"({"mission": "castle", "samples": [{"time": 0.5, "position":
    [1, 2.5e-3, -3], "ok": true}, {"time": 1, "none": null, "text": "a\"b\u00e4"}]})";
  Random random(11);
  int accepted = 0;
  for (int i = 0; i < 500; ++i) {
    std::string text = valid;
    for (std::int64_t n = random.integer(1, 4); n > 0; --n) {
      const auto at =
          static_cast<std::size_t>(random.integer(0, static_cast<std::int64_t>(text.size()) - 1));
      switch (random.integer(0, 3)) {
        case 0:
          text[at] = static_cast<char>(random.integer(0, 255));
          break;
        case 1:
          text.erase(at, static_cast<std::size_t>(random.integer(1, 9)));
          break;
        case 2:
          text.insert(at, 1, "{}[]\",:\\0e-"[random.integer(0, 10)]);
          break;
        default:
          text.resize(at + 1);
          break;
      }
      if (text.empty()) break;
    }
    try {
      const Value value = from_json(text, "fuzz");
      EXPECT_EQ(from_json(to_json(value), "again"), value) << text;
      ++accepted;
    } catch (const InputError&) {
    }
  }
  EXPECT_GT(accepted, 5);  // else the mutations test nothing but the first byte
  EXPECT_LT(accepted, 400);
}

}  // namespace
}  // namespace lapwing
