// SPDX-License-Identifier: Apache-2.0
#include "framework/core/parameters.h"

#include "framework/core/json.h"

namespace lapwing {
namespace {

ParameterTable film() {
  return ParameterTable{}
      .number("weight", 1.0, "", "weight of the term", at_least(0))
      .number("speed", 5.0, "m/s", "speed", above(0))
      .integer("order", 4, "order of the derivative", between(1, 4))
      .boolean("closed", false, "back to the start")
      .text("name", "shot", "its name")
      .choice("stretch", "none", {"none", "auto"}, "slow down when needed")
      .optional_number("yaw_deg", "deg", "where to look")
      .table("start", ParameterTable{}.numbers("velocity", {0, 0, 0}, "m/s", "at the start"),
             "the start")
      .tables("keyframes",
              ParameterTable{}
                  .required_numbers("position", 3, "m", "where")
                  .optional_number("time", "s", "when"),
              "what to pass");
}

Value parsed(const std::string& json) {
  return from_json(json, "shot.yaml");
}

std::string why_not(const ParameterTable& table, const Value& given) {
  Diagnostics errors;
  check(table, given, "", errors);
  return errors.to_string();
}
std::string why_not(const std::string& json) {
  return why_not(film(), parsed(json));
}

TEST(Parameters, FillsInDefaultsAndSaysSo) {
  const Parameters p = check(film(), Value());
  EXPECT_EQ(p.number("weight"), 1.0);
  EXPECT_EQ(p.integer("order"), 4);
  EXPECT_FALSE(p.boolean("closed"));
  EXPECT_EQ(p.text("stretch"), "none");
  EXPECT_FALSE(p.has("yaw_deg"));
  EXPECT_EQ(p.table("start").numbers("velocity").size(), 3u);
  EXPECT_TRUE(p.tables("keyframes").empty());
  EXPECT_EQ(p.origin("weight").to_string(), "default");
  EXPECT_EQ(p.table("start").origin("velocity").to_string(), "default");
}

TEST(Parameters, ReadsWhatIsGivenWithItsOrigin) {
  const Parameters p = check(film(), parsed(R"({"speed": "36 km/h", "order": 2.0,
"yaw_deg": "1 rad", "start": {"velocity": ["1 m/s", 2, "3600 m/h"]},
"keyframes": [{"position": [1, 2, 3]}, {"position": [4, 5, 6], "time": "250 ms"}]})"));
  EXPECT_EQ(p.number("speed"), 10.0);
  EXPECT_EQ(p.integer("order"), 2);  // Lua divides into floats
  EXPECT_NEAR(p.number("yaw_deg"), 57.29577951308232, 1e-12);
  EXPECT_EQ(p.table("start").numbers("velocity")[2], 1.0);
  ASSERT_EQ(p.tables("keyframes").size(), 2u);
  EXPECT_FALSE(p.tables("keyframes")[0].has("time"));
  EXPECT_EQ(p.tables("keyframes")[1].number("time"), 0.25);
  EXPECT_EQ(p.origin("speed").to_string(), "shot.yaml:1");
  EXPECT_EQ(p.tables("keyframes")[1].origin("time").to_string(), "shot.yaml:3");
  EXPECT_EQ(p.value().at("speed").as_number(), 10.0);
  const Parameters copy = p;  // owns what it shows
  EXPECT_EQ(copy.tables("keyframes")[1].numbers("position")[0], 4.0);
}

TEST(Parameters, CollectsEveryError) {
  EXPECT_EQ(
      why_not("{\"wieght\": 1,\n\"speed\": \"3 kg\",\n\"order\": 5,\n\"stretch\": \"atuo\"}"),
      "shot.yaml:1: wieght: unknown key; did you mean 'weight'?\n"
      "shot.yaml:2: speed: '3 kg' is not a quantity in m/s; expected a number in m/s, or a text "
      "with a unit of that kind\n"
      "shot.yaml:3: order: expected between 1 and 4, got 5\n"
      "shot.yaml:4: stretch: expected one of none, auto, got 'atuo'; did you mean 'auto'?");
}

TEST(Parameters, RefusesEachMistakeInItsPlace) {
  EXPECT_EQ(why_not(R"({"zzzzzz": 1})"),
            "shot.yaml:1: zzzzzz: unknown key; known: weight, speed, order, closed, name, stretch, "
            "yaw_deg, start, keyframes");
  EXPECT_EQ(why_not(R"({"keyframes": [{"position": [1, 2, 3]}, {"position": [1, 2]}]})"),
            "shot.yaml:1: keyframes[2].position: expected a list of 3 numbers in m, got 2");
  EXPECT_EQ(
      why_not(R"({"keyframes": [{"position": [1, "x", 3]}]})"),
      "shot.yaml:1: keyframes[1].position[2]: 'x' is not a quantity in m; expected a number in "
      "m, or a text with a unit of that kind");
  EXPECT_EQ(why_not(R"({"keyframes": [{}]})"),
            "shot.yaml:1: keyframes[1].position: missing; expected a list of 3 numbers in m");
  EXPECT_EQ(why_not(R"({"start": {"velocity": {"x": 1}}})"),
            "shot.yaml:1: start.velocity: expected a list of 3 numbers in m/s, got a map");
  EXPECT_EQ(why_not(R"({"weight": -1})"), "shot.yaml:1: weight: expected at least 0, got -1");
  EXPECT_EQ(why_not(R"({"speed": 0})"), "shot.yaml:1: speed: expected above 0 m/s, got 0");
  EXPECT_EQ(why_not(R"({"weight": "1"})"), "shot.yaml:1: weight: expected a number, got '1'");
  EXPECT_EQ(why_not(R"({"weight": null})"), "shot.yaml:1: weight: expected a number, got nothing");
  EXPECT_EQ(why_not(R"({"order": 2.5})"), "shot.yaml:1: order: expected an integer, got 2.5");
  EXPECT_EQ(why_not(R"({"closed": 1})"), "shot.yaml:1: closed: expected true or false, got 1");
  EXPECT_EQ(why_not(R"({"name": 3})"), "shot.yaml:1: name: expected a text, got 3");
  EXPECT_EQ(why_not(R"({"start": 3})"), "shot.yaml:1: start: expected a table, got 3");
  EXPECT_EQ(why_not(R"({"keyframes": 3})"),
            "shot.yaml:1: keyframes: expected a list of tables, got 3");
  EXPECT_EQ(why_not("[1]"), "shot.yaml:1: expected a table, got a list");
  EXPECT_EQ(why_not(ParameterTable{}, parsed(R"({"a": 1})")),
            "shot.yaml:1: a: unknown key; no key is accepted here");
}

TEST(Parameters, RefusesNumbersThatAreNone) {
  for (const double number : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    Value given = Value::map();
    given.set("weight", number);
    EXPECT_NE(why_not(film(), given).find("expected a finite number"), std::string::npos);
    Value order = Value::map();
    order.set("order", number);
    EXPECT_NE(why_not(film(), order).find("expected an integer"), std::string::npos);
  }
}

TEST(Parameters, AnEmptyLuaTableIsListAndMap) {
  EXPECT_EQ(why_not(R"({"keyframes": {}, "start": []})"), "");
  EXPECT_EQ(why_not("[]"), "");
}

TEST(Parameters, ReadingAnUndeclaredNameIsADefect) {
  const Parameters p = check(film(), Value());
  EXPECT_THROW(p.number("wieght"), Error);
  EXPECT_THROW(p.has("wieght"), Error);
  EXPECT_THROW(p.number("yaw_deg"), Error);  // optional, and not given
  EXPECT_THROW(p.numbers("weight"), Error);
  EXPECT_THROW(p.table("weight"), Error);
  EXPECT_THROW(ParameterTable{}.text("a", "", "x").text("a", "", "y"), Error);
}

TEST(Parameters, TablesSurviveTheWayThroughJson) {
  const Value written = film().to_value();
  const ParameterTable back = ParameterTable::from_value(from_json(to_json(written), "sidecar"));
  EXPECT_EQ(back.to_value(), written);
  EXPECT_EQ(why_not(back, parsed(R"({"speed": 0, "keyframes": [{}]})")),
            why_not(R"({"speed": 0, "keyframes": [{}]})"));
  EXPECT_EQ(check(back, Value()).value(), check(film(), Value()).value());
  Value broken = written;
  broken.as_list()[0].set("type", "nubmer");
  EXPECT_THROW(ParameterTable::from_value(broken), InputError);
}

TEST(Range, SpeaksForItself) {
  EXPECT_EQ(at_least(0.25).to_string(), "at least 0.25");
  EXPECT_EQ(Range{}.to_string(), "");
  EXPECT_EQ((Range{.maximum = 3}.to_string()), "at most 3");
  EXPECT_EQ((Range{.minimum = 0, .maximum = 1, .minimum_excluded = true}.to_string()),
            "above 0 and at most 1");
  EXPECT_FALSE(above(0).contains(0));
  EXPECT_FALSE(at_least(0).contains(std::nan("")));
}

TEST(NearestName, FindsSlipsAndNothingElse) {
  const std::vector<std::string> names{"keyframe", "derivative", "input_limits", "snap"};
  EXPECT_EQ(nearest_name("kayframe", names), "keyframe");
  EXPECT_EQ(nearest_name("keyfarme", names), "keyframe");
  EXPECT_EQ(nearest_name("input_limit", names), "input_limits");
  EXPECT_EQ(nearest_name("derivativ", names), "derivative");
  EXPECT_EQ(nearest_name("KEYFRAME", names), "keyframe");
  EXPECT_EQ(nearest_name("camera", names), "");
  EXPECT_EQ(nearest_name("x", names), "");
  EXPECT_EQ(nearest_name("", names), "");
  EXPECT_EQ(nearest_name("x", {}), "");
}

}  // namespace
}  // namespace lapwing
