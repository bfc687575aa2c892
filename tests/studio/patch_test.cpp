// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/patch.h"

#include <random>

#include "framework/core/json.h"

namespace lapwing {
namespace {

Value read(const std::string& json) {
  return without_origins(from_json(json, "test"));
}

Patch patch_of(const std::string& json) {
  return patch_from(read(json), "patch");
}

TEST(OptionPaths, AreThoseOfSet) {
  EXPECT_EQ(to_text(option_path("keyframes[2].position")), "keyframes[2].position");
  EXPECT_EQ(to_text(option_path("a[1][2].b-c_3")), "a[1][2].b-c_3");
  for (const char* bad : {"", ".", "a.", "a..b", "a[0]", "a[", "a[x]", "a[1", "a b", "[1]", "a[1]b",
                          "a[-1]", "a[99999999999999999999]", "..", "../a", "a/b"})
    EXPECT_THROW(option_path(bad), InputError) << bad;
  std::string deep = "a";
  for (int i = 0; i < 40; ++i) deep += ".a";
  EXPECT_THROW(option_path(deep), InputError);
}

TEST(OptionPaths, OverlapWhereOneIsWithinTheOther) {
  const auto both = [](const char* a, const char* b) {
    return overlap(option_path(a), option_path(b));
  };
  EXPECT_TRUE(both("keyframes", "keyframes[2].position"));
  EXPECT_TRUE(both("keyframes[2].time", "keyframes[2].time"));
  EXPECT_FALSE(both("keyframes[1].time", "keyframes[2].time"));
  EXPECT_FALSE(both("keyframes[2].time", "keyframes[2].position"));
  EXPECT_FALSE(both("weights", "weight"));
}

TEST(Patches, ApplyTogetherAndAreTakenBack) {
  const Value before = read(R"({"a": {"b": 1}, "list": [{"t": 1}, {"t": 2}], "w": 3})");
  Value document = before;
  const Patch inverse = apply_patch(
      document, patch_of(R"([{"path": "a.b", "value": 2}, {"path": "a.c", "value": "new"},
                             {"path": "list[2].t", "value": 5}, {"path": "w", "remove": true}])"));
  EXPECT_TRUE(
      same_options(document, read(R"({"a": {"b": 2, "c": "new"}, "list": [{"t": 1}, {"t": 5}]})")));
  apply_patch(document, inverse);
  EXPECT_TRUE(same_options(document, before));
}

TEST(Patches, AreRefusedWholeWithTheReason) {
  const Value before = read(R"({"a": {"b": 1}, "list": [{"t": 1}], "w": 3})");
  const auto why = [&](const std::string& json) -> std::string {
    Value document = before;
    try {
      apply_patch(document, patch_of(json));
    } catch (const InputError& error) {
      EXPECT_TRUE(document == before);
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(why(R"([{"path": "w", "value": 1}, {"path": "x.y", "value": 1}])"), "there is no x");
  EXPECT_NE(why(R"([{"path": "list[2]", "value": 1}])").find("is set whole to gain one"),
            std::string::npos);
  EXPECT_NE(why(R"([{"path": "list[1]", "remove": true}])").find("set whole to lose"),
            std::string::npos);
  EXPECT_EQ(why(R"([{"path": "z", "remove": true}])"), "there is no z to remove");
  EXPECT_NE(why(R"([{"path": "w.x", "value": 1}])").find("w is an integer"), std::string::npos);
  EXPECT_NE(why(R"([{"path": "a[1]", "value": 1}])").find("not a list"), std::string::npos);
  for (const char* bad :
       {R"({})", R"([1])", R"([{"path": "a"}])", R"([{"path": 3, "value": 1}])",
        R"([{"path": "a", "value": 1, "x": 2}])", R"([{"path": "a", "remove": false}])"})
    EXPECT_THROW(patch_of(bad), InputError) << bad;
}

// Whatever two documents are, the difference leads from one to the other and back.
class RandomValues {
 public:
  explicit RandomValues(unsigned seed) : random_(seed) {}
  int below(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }
  Value any(int depth) {
    switch (below(depth > 0 ? 6 : 4)) {
      case 0:
        return Value(below(5));
      case 1:
        return Value(below(100) / 8.0);
      case 2:
        return Value(below(2) == 0);
      case 3:
        return Value("text " + std::to_string(below(9)));
      case 4: {
        Value list = Value::list();
        for (int i = below(4); i > 0; --i) list.push_back(any(depth - 1));
        return list;
      }
      default:
        return map(depth - 1);
    }
  }
  Value map(int depth) {
    Value made = Value::map();
    for (const char* key : {"a", "b", "c", "not a key of a path", "type"})
      if (below(2) == 0) made.set(key, any(depth));
    return made;
  }

 private:
  std::mt19937 random_;
};

TEST(Patches, DifferencesLeadThereAndBack) {
  RandomValues random(7);
  for (int k = 0; k < 2000; ++k) {
    const Value from = random.map(3), to = random.map(3);
    if (from.find("not a key of a path") || to.find("not a key of a path")) continue;
    Value document = from;
    const Patch patch = difference(from, to);
    const Patch read_back = patch_from(to_value(patch), "patch");
    const Patch inverse = apply_patch(document, read_back);
    ASSERT_TRUE(same_options(document, to)) << to_json(from) << to_json(to);
    apply_patch(document, inverse);
    ASSERT_TRUE(same_options(document, from)) << to_json(from) << to_json(to);
  }
  EXPECT_TRUE(difference(read("{\"a\": 1}"), read("{\"a\": 1.0}")).empty());
}

TEST(Patches, DifferencesAreSmall) {
  const Value from = read(R"({"keyframes": [{"time": 1, "position": [0, 0, 2]}, {"time": 3}]})");
  const Value moved = read(R"({"keyframes": [{"time": 1, "position": [0, 1, 2]}, {"time": 3}]})");
  ASSERT_EQ(difference(from, moved).size(), 1u);
  EXPECT_EQ(to_text(difference(from, moved)[0].path), "keyframes[1].position");
  const Value more = read(R"({"keyframes": [{"time": 1, "position": [0, 0, 2]}]})");
  EXPECT_EQ(to_text(difference(from, more)[0].path), "keyframes");
}

TEST(Layers, MakeTheDocumentOfTheScript) {
  const Value script = read(R"({"margin": 0.5, "solver": {"type": "iqp", "steps": 300},
                                "weights": {"yaw": 1, "camera": 2}, "keyframes": [{"time": 1}],
                                "vehicle": "vehicles/solo"})");
  const auto layer = [&](const char* path, const char* value) {
    Value document = script;
    apply_patch(document,
                {{option_path(path), read(std::string("{\"v\": ") + value + "}").at("v")}});
    const Value made = layer_of(script, document);
    Value laid = script;
    merge(laid, made);
    EXPECT_TRUE(same_options(laid, document)) << path;
    return to_json(made, -1);
  };
  EXPECT_EQ(layer("margin", "0.75"), R"({"margin":0.75})");
  EXPECT_EQ(layer("margin", "0.5"), "{}");
  EXPECT_EQ(layer("weights.yaw", "3"), R"({"weights":{"yaw":3}})");
  EXPECT_EQ(layer("keyframes[1].time", "2"), R"({"keyframes":[{"time":2}]})");
  EXPECT_EQ(layer("solver.steps", "10"), R"({"solver":{"steps":10}})");
  EXPECT_EQ(layer("solver", R"({"type": "ipopt", "limit": 3})"),
            R"({"solver":{"type":"ipopt","limit":3}})");
  EXPECT_EQ(layer("vehicle", "\"vehicles/phantom\""), R"({"vehicle":"vehicles/phantom"})");
}

}  // namespace
}  // namespace lapwing
