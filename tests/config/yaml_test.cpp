// SPDX-License-Identifier: Apache-2.0
#include "framework/config/yaml.h"

#include "framework/core/json.h"
#include "framework/core/random.h"

namespace lapwing {
namespace {

Value parsed_yaml(const std::string& text) {
  return from_yaml(text, "a.yaml");
}

std::string refusal(const std::string& text) {
  try {
    parsed_yaml(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Yaml, TypesPlainScalarsAndLeavesQuotedOnesText) {
  const Value value = parsed_yaml(
      "i: -7\np: +3\nx: 0.25\ne: 1e-3\nd: .5\nt: 2.\nb: true\nn: ~\nempty:\n"
      "text: hover here\nquoted: '3'\ndouble: \"1.5\"\nyes: yes\nversion: 1.2.3\n"
      "speed: 36 km/h\nbig: 18446744073709551615\nblock: |\n  one\n  two\n");
  EXPECT_EQ(value.at("i"), Value(-7));
  EXPECT_EQ(value.at("p"), Value(3));
  EXPECT_EQ(value.at("x"), Value(0.25));
  EXPECT_EQ(value.at("e"), Value(1e-3));
  EXPECT_EQ(value.at("d"), Value(0.5));
  EXPECT_EQ(value.at("t"), Value(2.0));
  EXPECT_EQ(value.at("b"), Value(true));
  EXPECT_TRUE(value.at("n").is_null());
  EXPECT_TRUE(value.at("empty").is_null());
  EXPECT_EQ(value.at("text"), Value("hover here"));
  EXPECT_EQ(value.at("quoted"), Value("3"));
  EXPECT_EQ(value.at("double"), Value("1.5"));
  EXPECT_EQ(value.at("yes"), Value("yes"));  // YAML 1.2: only true and false are booleans
  EXPECT_EQ(value.at("version"), Value("1.2.3"));
  EXPECT_EQ(value.at("speed"), Value("36 km/h"));
  EXPECT_EQ(value.at("big"), Value(18446744073709551615.0));
  EXPECT_EQ(value.at("block"), Value("one\ntwo\n"));
}

TEST(Yaml, RemembersTheLineOfEveryNode) {
  const Value value = parsed_yaml(
      "# a comment\n"
      "solver:\n"
      "  type: iqp\n"
      "\n"
      "  steps: 9\n"
      "keyframes:\n"
      "  - position: [1,\n"
      "               2, 3]\n"
      "  - {time: 2}\n"
      "nothing:\n");
  EXPECT_EQ(value.origin(), (Origin{"a.yaml", 2}));
  EXPECT_EQ(value.at("solver").origin().line, 2);
  EXPECT_EQ(value.at("solver").at("steps").origin().line, 5);
  EXPECT_EQ(value.at("keyframes").origin().line, 6);
  const Value& first = value.at("keyframes").as_list()[0];
  EXPECT_EQ(first.at("position").as_list()[1].origin(), (Origin{"a.yaml", 8}));
  EXPECT_EQ(value.at("keyframes").as_list()[1].at("time").origin().line, 9);
  EXPECT_EQ(value.at("nothing").origin().line, 10);
}

TEST(Yaml, AnEmptyTextIsAnEmptyMap) {
  for (const char* text : {"", "\n\n", "# only a comment\n", "---\n", "~"}) {
    EXPECT_EQ(parsed_yaml(text), Value::map()) << text;
  }
}

TEST(Yaml, CollectsWhatItRefuses) {
  EXPECT_EQ(refusal("a: 1\nb: .nan\na: 2\nc: -.inf\nd: 1e999\n"),
            "a.yaml:2: '.nan' is not a finite number\n"
            "a.yaml:3: repeated key 'a', first on line 1\n"
            "a.yaml:4: '-.inf' is not a finite number\n"
            "a.yaml:5: '1e999' is not a finite number");
  EXPECT_EQ(parsed_yaml("a: 1e-999").at("a"), Value(0.0));
}

TEST(Yaml, RefusesWhatNobodyShouldExpandInTheirHead) {
  const std::string anchors = refusal("a: &x {b: 1}\nc: *x\nd:\n  <<: *x\n");
  EXPECT_NE(anchors.find("a.yaml:1: anchor '&x' is not supported"), std::string::npos) << anchors;
  EXPECT_NE(anchors.find("a.yaml:2: an alias"), std::string::npos) << anchors;
  EXPECT_NE(anchors.find("a.yaml:4: the merge key '<<'"), std::string::npos) << anchors;
  EXPECT_EQ(refusal("a: !!str 3"), "a.yaml:1: tag 'tag:yaml.org,2002:str' is not supported");
  EXPECT_EQ(refusal("a: 1\n---\nb: 2\n"), "a.yaml: a second document ('---') is not supported");
  EXPECT_EQ(refusal("? [1, 2]\n: 3\n"), "a.yaml:1: a key must be a text, not a list or a map");
  EXPECT_EQ(refusal(": 3"), "a.yaml:1: a key is missing before ':'");
}

TEST(Yaml, NamesLineAndColumnOfBadSyntax) {
  EXPECT_EQ(refusal("a: 1\nb: [1, 2\nc: 3\n").rfind("a.yaml:3:", 0), 0u)
      << refusal("a: 1\nb: [1, 2\nc: 3\n");
  EXPECT_EQ(refusal("a: \"open").rfind("a.yaml:1:", 0), 0u) << refusal("a: \"open");
  EXPECT_EQ(refusal("a:\n\t- 1\n").rfind("a.yaml:2:", 0), 0u) << refusal("a:\n\t- 1\n");
  EXPECT_EQ(refusal("a: b: c").rfind("a.yaml:1:", 0), 0u) << refusal("a: b: c");
}

TEST(Yaml, RefusesOtherEncodingsSizeAndDepth) {
  EXPECT_EQ(refusal("a: 1\nb: \xff\n"), "a.yaml:2: not UTF-8 text");
  EXPECT_EQ(refusal(std::string("a\0: 1", 5)), "a.yaml:1: not UTF-8 text");
  EXPECT_EQ(refusal("a: \xc0\xaf"), "a.yaml:1: not UTF-8 text");
  EXPECT_EQ(parsed_yaml("a: \"ä\u20ac\"").at("a"), Value("ä\u20ac"));
  EXPECT_NE(refusal(std::string(kMaximumYamlBytes + 1, ' ')).find("larger than"),
            std::string::npos);
  const auto nested = [](std::size_t depth) {
    return std::string(depth, '[') + std::string(depth, ']');
  };
  EXPECT_EQ(refusal(nested(kMaximumYamlDepth)), "accepted");
  EXPECT_NE(refusal(nested(kMaximumYamlDepth + 1)).find("nested deeper"), std::string::npos);
  EXPECT_NE(refusal(std::string(100000, '[')), "accepted");
  EXPECT_NE(refusal(std::string(100000, '{')), "accepted");
  EXPECT_THROW(read_yaml("/no/such/file.yaml"), InputError);
}

// Damaged text is read or refused; it never brings the program down.
TEST(Yaml, MutationsParseOrThrowInputError) {
  const std::string valid =
      "solver: {type: iqp, tolerance: 1e-8}\n"
      "weights:\n  snap: 1.5\n  camera: [1, 2, \"three\"]\n"
      "keyframes:\n  - position: [0, 0, 2]\n    time: 0\n  - position: [5, 0, 2]\n"
      "text: |\n  block\nname: 'it''s'  # end\n";
  Random random(12);
  int accepted = 0;
  for (int i = 0; i < 500; ++i) {
    std::string text = valid;
    for (std::int64_t n = random.integer(1, 4); n > 0 && !text.empty(); --n) {
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
          text.insert(at, 1, "{}[]\",:'-\n \t&*!|>%@#?"[random.integer(0, 21)]);
          break;
        default:
          text.resize(at + 1);
          break;
      }
    }
    try {
      to_json(from_yaml(text, "fuzz"));
      ++accepted;
    } catch (const InputError&) {
    }
  }
  EXPECT_GT(accepted, 20);
  EXPECT_LT(accepted, 450);
}

}  // namespace
}  // namespace lapwing
