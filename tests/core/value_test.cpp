// SPDX-License-Identifier: Apache-2.0
#include "framework/core/value.h"

#include "framework/core/json.h"

namespace lapwing {
namespace {

Value parsed(const char* json) {
  return from_json(json, "test.json");
}

Value merged(const char* base, const char* over) {
  Value value = parsed(base);
  merge(value, parsed(over));
  return value;
}

TEST(Value, ReadsItsOwnTypeOnly) {
  EXPECT_EQ(Value(3).as_number(), 3.0);
  EXPECT_THROW(Value(3.0).as_integer(), InputError);
  EXPECT_THROW(Value("3").as_number(), InputError);
  EXPECT_THROW(Value(1).as_boolean(), InputError);
  Value text("x");
  text.with_origin({"shot.lua", 12});
  try {
    text.as_list();
    FAIL() << "a text was read as a list";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "shot.lua:12: expected a list, got a text");
  }
}

TEST(Value, MapsKeepTheOrderWritten) {
  Value map;
  map.set("b", 1);
  map.set("a", 2);
  map.set("b", 3);
  ASSERT_EQ(map.as_map().size(), 2u);
  EXPECT_EQ(map.as_map()[0].first, "b");
  EXPECT_EQ(map.at("b").as_integer(), 3);
  EXPECT_EQ(map.find("c"), nullptr);
  EXPECT_EQ(Value(3).find("c"), nullptr);
  EXPECT_THROW(map.at("c"), InputError);
}

TEST(Merge, MapsByKeyAndTheRestWhole) {
  EXPECT_EQ(merged(R"({"a": {"x": 1, "y": 2}, "b": [1, 2]})", R"({"a": {"y": 3}, "b": [4]})"),
            parsed(R"({"a": {"x": 1, "y": 3}, "b": [4]})"));
  EXPECT_EQ(merged(R"({"a": {"x": 1}})", R"({"a": 5})"), parsed(R"({"a": 5})"));
  EXPECT_EQ(merged(R"({"a": 5})", R"({"a": {"x": 1}})"), parsed(R"({"a": {"x": 1}})"));
}

TEST(Merge, AnotherTypeBringsNoneOfTheOldParameters) {
  EXPECT_EQ(merged(R"({"type": "iqp", "steps": 9})", R"({"type": "ipopt"})"),
            parsed(R"({"type": "ipopt"})"));
  EXPECT_EQ(merged(R"({"type": "iqp", "steps": 9})", R"({"type": "iqp", "x": 1})"),
            parsed(R"({"type": "iqp", "steps": 9, "x": 1})"));
  EXPECT_EQ(merged(R"({"type": "iqp", "steps": 9})", R"({"steps": 3})"),
            parsed(R"({"type": "iqp", "steps": 3})"));
}

TEST(Merge, ANameIsShortForAMapWithThatType) {
  EXPECT_EQ(merged(R"({"type": "iqp", "steps": 9})", R"("ipopt")"), parsed(R"("ipopt")"));
  EXPECT_EQ(merged(R"({"type": "iqp", "steps": 9})", R"("iqp")"),
            parsed(R"({"type": "iqp", "steps": 9})"));
  EXPECT_EQ(merged(R"("iqp")", R"({"steps": 3})"), parsed(R"({"type": "iqp", "steps": 3})"));
  EXPECT_EQ(merged(R"("iqp")", R"({"type": "ipopt", "steps": 3})"),
            parsed(R"({"type": "ipopt", "steps": 3})"));
}

TEST(Merge, KeepsTheOriginOfEveryLeaf) {
  Value base = from_json("{\"a\": 1,\n \"b\": 2}", "low.json");
  merge(base, from_json("{\n\n\"b\": 3}", "high.json"));
  EXPECT_EQ(base.at("a").origin(), (Origin{"low.json", 1}));
  EXPECT_EQ(base.at("b").origin(), (Origin{"high.json", 3}));
}

TEST(Diagnostics, CollectsEveryErrorInOneException) {
  Diagnostics errors;
  errors.throw_if_any();
  errors.add({"a.yaml", 3}, "weights.snap", "too low");
  errors.add({"--set", 0}, "", "no such key");
  errors.add({}, "x", "no origin");
  EXPECT_EQ(errors.to_string(),
            "a.yaml:3: weights.snap: too low\n--set: no such key\nx: no origin");
  EXPECT_THROW(errors.throw_if_any(), InputError);
}

}  // namespace
}  // namespace lapwing
