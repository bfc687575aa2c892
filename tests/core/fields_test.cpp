// SPDX-License-Identifier: Apache-2.0
// Strict reading of maps: what is right is read, and all that is wrong is reported at once, by key
// and line.
#include "framework/core/fields.h"

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/core/json.h"

namespace lapwing {
namespace {

// What reading a JSON text complains of, one line each.
template <class Read>
std::string complaints(const std::string& json, const Read& read) {
  const Value value = from_json(json, "plan.json");
  Diagnostics errors;
  Fields fields(value, "plan", errors);
  read(fields);
  return errors.to_string();
}

TEST(Fields, ReadWhatIsThere) {
  const std::string json = R"({"n": 2.5, "i": -3, "b": true, "t": "text", "v": [1, 2, 3],
      "list": [1, 2.5], "rows": [[1, 2], [3, 4]], "table": {"n": 7}, "tables": [{"n": 1}, {"n": 2}],
      "choice": "b", "opaque": [null, {"x": 1}]})";
  EXPECT_EQ(
      complaints(json,
                 [](Fields& f) {
                   EXPECT_EQ(f.number("n"), 2.5);
                   EXPECT_EQ(f.optional_number("n"), 2.5);
                   EXPECT_EQ(f.optional_number("none"), std::nullopt);
                   EXPECT_EQ(f.number("i"), -3) << "an integer is a number";
                   EXPECT_EQ(f.integer("i"), -3);
                   EXPECT_EQ(f.integer("i", -3, 3), -3);
                   EXPECT_TRUE(f.boolean("b"));
                   EXPECT_EQ(f.text("t"), "text");
                   EXPECT_EQ(f.optional_text("none"), "");
                   EXPECT_EQ(f.vector3("v"), Eigen::Vector3d(1, 2, 3));
                   EXPECT_EQ(f.numbers("list"), (std::vector<double>{1, 2.5}));
                   EXPECT_EQ(f.numbers("list", 2), (std::vector<double>{1, 2.5}));
                   EXPECT_EQ(f.rows("rows", 2), (std::vector<std::vector<double>>{{1, 2}, {3, 4}}));
                   EXPECT_EQ(f.table("table").number("n"), 7);
                   std::vector<Fields> tables = f.tables("tables");
                   ASSERT_EQ(tables.size(), 2u);
                   EXPECT_EQ(tables[1].number("n"), 2);
                   EXPECT_TRUE(f.optional_tables("none").empty());
                   EXPECT_EQ(f.choice("choice", {"a", "b"}), 1);
                   EXPECT_EQ(to_json(f.opaque("opaque"), -1), R"([null,{"x":1}])");
                   EXPECT_TRUE(f.opaque("none").is_null());
                   f.finish();
                 }),
      "");
}

// One reading reports everything, each with its line and its path.
TEST(Fields, AllErrorsAreReportedTogether) {
  const std::string found = complaints(
      "{\n\"n\": \"2\",\n\"v\": [1, 2],\n\"rows\": [[1], [2, 3]],\n"
      "\"t\": 5,\n\"i\": 1.5,\n\"b\": 0,\n\"choice\": \"c\"}",
      [](Fields& f) {
        EXPECT_EQ(f.number("n"), 0);
        EXPECT_EQ(f.vector3("v"), Eigen::Vector3d(0, 0, 0));
        f.rows("rows", 2);
        EXPECT_EQ(f.text("t"), "");
        EXPECT_EQ(f.integer("i"), 0);
        EXPECT_FALSE(f.boolean("b"));
        EXPECT_EQ(f.choice("choice", {"a", "b"}), 0);
        EXPECT_EQ(f.number("gone"), 0);
      });
  EXPECT_EQ(found,
            "plan.json:2: plan.n: expected a number, got a text\n"
            "plan.json:3: plan.v: expected a list of 3 finite numbers\n"
            "plan.json:4: plan.rows: expected a list of lists of 2 finite numbers\n"
            "plan.json:5: plan.t: expected a text, got an integer\n"
            "plan.json:6: plan.i: expected an integer, got a number\n"
            "plan.json:7: plan.b: expected true or false, got an integer\n"
            "plan.json:8: plan.choice: expected one of: a, b\n"
            "plan.json:1: plan.gone: missing");
}

TEST(Fields, NumbersAreFinite) {
  Value value = Value::map();
  value.set("n", std::nan(""));
  value.set("v", Value(Value::List{1.0, HUGE_VAL, 2.0}));
  value.set("rows", Value(Value::List{Value(Value::List{-HUGE_VAL})}));
  Diagnostics errors;
  Fields fields(value, "", errors);
  fields.number("n");
  fields.numbers("v", 3);
  fields.numbers("v");
  fields.rows("rows", 1);
  EXPECT_EQ(errors.to_string(),
            "n: expected a finite number\nv: expected a list of 3 finite numbers\n"
            "v: expected a list of finite numbers\n"
            "rows: expected a list of lists of 1 finite numbers");
}

TEST(Fields, IntegersKeepTheirBounds) {
  for (const auto& [json, said] : std::initializer_list<std::pair<const char*, const char*>>{
           {"1", ""},
           {"4", ""},
           {"0", "plan.json:1: plan.i: expected an integer from 1 to 4, got 0"},
           {"5", "plan.json:1: plan.i: expected an integer from 1 to 4, got 5"},
           {"9223372036854775807",
            "plan.json:1: plan.i: expected an integer from 1 to 4, got 9223372036854775807"},
           {"2.0", "plan.json:1: plan.i: expected an integer from 1 to 4, got a number"},
           {"[2]", "plan.json:1: plan.i: expected an integer from 1 to 4, got a list"}})
    EXPECT_EQ(complaints(std::string("{\"i\": ") + json + "}",
                         [](Fields& f) {
                           const int read = f.integer("i", 1, 4);
                           EXPECT_TRUE(read >= 1 && read <= 4) << read;
                         }),
              said);
}

// A key that nobody asked for is an error, with the nearest one that was asked for.
TEST(Fields, NothingUnknownIsIgnored) {
  EXPECT_EQ(complaints(R"({"durration": 1, "duration": 2, "xyz": 3})",
                       [](Fields& f) {
                         f.number("duration");
                         f.finish();
                       }),
            "plan.json:1: plan.durration: unknown; did you mean 'duration'?\n"
            "plan.json:1: plan.xyz: unknown");
  // What was looked for and is absent is known as well.
  EXPECT_EQ(complaints(R"({"bugdet": 1})",
                       [](Fields& f) {
                         f.optional_number("budget");
                         f.optional_text("note");
                         f.optional_tables("legs");
                         f.opaque("extra");
                         f.finish();
                       }),
            "plan.json:1: plan.bugdet: unknown; did you mean 'budget'?");
  EXPECT_EQ(complaints(R"({"note": "", "legs": [], "extra": 1})",
                       [](Fields& f) {
                         f.optional_text("note");
                         f.optional_tables("legs");
                         f.opaque("extra");
                         f.finish();
                       }),
            "");
}

// A table that is missing is one error; what would be in it is none.
TEST(Fields, AMissingTableIsReportedOnce) {
  EXPECT_EQ(complaints("{}",
                       [](Fields& f) {
                         Fields table = f.table("limits");
                         EXPECT_EQ(table.number("speed"), 0);
                         table.table("deeper").text("name");
                         table.add_error("speed", "never said");
                         table.finish();
                       }),
            "plan.json:1: plan.limits: missing");
  EXPECT_EQ(complaints(R"({"limits": 3})",
                       [](Fields& f) {
                         Fields table = f.table("limits");
                         table.number("speed");
                         table.finish();
                       }),
            "plan.json:1: plan.limits: expected a map, got an integer");
  EXPECT_EQ(complaints("[1]", [](Fields& f) { f.number("n"); }),
            "plan.json:1: plan: expected a map, got a list");
}

TEST(Fields, EntriesOfListsAreNumberedFromOne) {
  EXPECT_EQ(complaints("{\"legs\": [{\"n\": 1},\n{\"n\": true},\n5]}",
                       [](Fields& f) {
                         for (Fields& leg : f.tables("legs")) {
                           leg.number("n");
                           leg.finish();
                         }
                       }),
            "plan.json:3: plan.legs[3]: expected a map, got an integer\n"
            "plan.json:2: plan.legs[2].n: expected a number, got a boolean");
  EXPECT_EQ(complaints(R"({"legs": {"n": 1}})", [](Fields& f) { f.tables("legs"); }),
            "plan.json:1: plan.legs: expected a list, got a map");
}

TEST(Fields, OwnErrorsHaveThePathOfTheirField) {
  EXPECT_EQ(complaints("{\n\"n\": 1}",
                       [](Fields& f) {
                         f.add_error("n", "too small");
                         f.add_error("", "does not hold together");
                         f.add_error("absent", "is needed here");
                       }),
            "plan.json:2: plan.n: too small\nplan.json:1: plan: does not hold together\n"
            "plan.json:1: plan.absent: is needed here");
}

}  // namespace
}  // namespace lapwing
