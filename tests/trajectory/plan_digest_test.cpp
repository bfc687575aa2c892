// SPDX-License-Identifier: Apache-2.0
// A digest tells of every change, and of nothing else.
#include "framework/trajectory/plan_digest.h"

#include "framework/core/json.h"

namespace lapwing {
namespace {

Value signed_document(const std::string& text) {
  Value document = from_json(text, "test");
  document.set("digest", digest_of(document));
  return document;
}

using Names = std::vector<std::string>;

TEST(PlanDigest, DoesNotDependOnLayout) {
  const Value document =
      signed_document(R"({"a": {"x": 10.0, "y": [1, 2.5]}, "b": "text", "c": {}})");
  const Value other = signed_document(R"({"c":{},"b":"text","a":{"y":[1.0,2.5],"x":10}})");
  EXPECT_EQ(*document.find("digest"), *other.find("digest"));
  EXPECT_TRUE(check_digest(from_json(to_json(document, -1), "test")).changed.empty());
  EXPECT_TRUE(check_digest(document).stated);
  EXPECT_EQ(check_digest(document).sha256.size(), 64u);
}

TEST(PlanDigest, NamesWhatWasChangedAddedOrRemoved) {
  const Value document =
      signed_document(R"({"a": {"x": 10.0, "y": [1, 2.5]}, "b": "text", "s": [{"t": 0.1}]})");
  const auto changed = [&](const std::function<void(Value&)>& edit) {
    Value copy = document;
    edit(copy);
    return check_digest(copy).changed;
  };
  EXPECT_EQ(changed([](Value& d) { d.find("a")->set("x", std::nextafter(10.0, 11.0)); }),
            Names{"a.x"});
  EXPECT_EQ(changed([](Value& d) { d.find("a")->find("y")->as_list().pop_back(); }), Names{"a.y"});
  EXPECT_EQ(changed([](Value& d) { d.set("b", "Text"); }), Names{"b"});
  EXPECT_EQ(changed([](Value& d) { d.find("s")->as_list()[0].set("t", 0.2); }), Names{"s"});
  EXPECT_EQ(changed([](Value& d) { d.set("z", 1); }), Names{"z (added)"});
  EXPECT_EQ(changed([](Value& d) { d.find("a")->as_map().pop_back(); }), Names{"a.y (removed)"});
  EXPECT_EQ(changed([](Value& d) { d.find("digest")->set("sha256", "0"); }), Names{"digest"});
  EXPECT_EQ(changed([](Value& d) { d.set("digest", 3); }), Names{"digest"});
  Value bare = document;
  bare.as_map().pop_back();
  EXPECT_FALSE(check_digest(bare).stated);
}

TEST(PlanDigest, HoldsNumbersThatAreNotWholeOrLarge) {
  for (const char* text : {"1e300", "-0.1", "9007199254740993", "0.30000000000000004", "-0.0"}) {
    const Value document = signed_document(std::string("{\"x\": ") + text + "}");
    EXPECT_TRUE(check_digest(from_json(to_json(document), "test")).changed.empty()) << text;
  }
}

}  // namespace
}  // namespace lapwing
