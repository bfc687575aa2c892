// SPDX-License-Identifier: Apache-2.0
#include "framework/config/overrides.h"

#include "framework/config/annotated.h"
#include "framework/config/yaml.h"

namespace lapwing {
namespace {

Value parsed(const std::string& text, const char* source = "a.yaml") {
  return from_yaml(text, source);
}

Value overridden(const std::string& base, const std::string& text) {
  Value value = parsed(base);
  apply_override(value, text);
  return value;
}

std::string refusal(const std::string& base, const std::string& text) {
  Value value = parsed(base);
  try {
    apply_override(value, text);
  } catch (const InputError& error) {
    EXPECT_EQ(value, parsed(base)) << "a refused override left its mark";
    return error.what();
  }
  return "accepted";
}

TEST(Override, SetsAnyKindOfValue) {
  EXPECT_EQ(overridden("{}", "a=1"), parsed("a: 1"));
  EXPECT_EQ(overridden("a: {b: 1, c: 2}", "a.b=2.5"), parsed("a: {b: 2.5, c: 2}"));
  EXPECT_EQ(overridden("a: 1", "b.c.d=true"), parsed("{a: 1, b: {c: {d: true}}}"));
  EXPECT_EQ(overridden("{}", "speed=36 km/h"), parsed("speed: 36 km/h"));
  EXPECT_EQ(overridden("{}", "v=[1, 0, 0]"), parsed("v: [1, 0, 0]"));
  EXPECT_EQ(overridden("{}", "v={x: 1}"), parsed("v: {x: 1}"));
  EXPECT_EQ(overridden("{}", "n='4'"), parsed("n: '4'"));
  EXPECT_EQ(overridden("{}", "n=''"), parsed("n: ''"));
  EXPECT_EQ(overridden("n: 1", "n=null"), parsed("n: ~"));
  EXPECT_EQ(overridden("{}", "path=a=b.lua"), parsed("path: a=b.lua"));
}

TEST(Override, NamesListEntriesFromOne) {
  const char* base = "k: [{t: 1}, {t: 2, p: [1, 2, 3]}]";
  EXPECT_EQ(overridden(base, "k[2].t=5"), parsed("k: [{t: 1}, {t: 5, p: [1, 2, 3]}]"));
  EXPECT_EQ(overridden(base, "k[2].p[3]=9"), parsed("k: [{t: 1}, {t: 2, p: [1, 2, 9]}]"));
  EXPECT_EQ(overridden(base, "k[1]={u: 3}"), parsed("k: [{t: 1, u: 3}, {t: 2, p: [1, 2, 3]}]"));
  EXPECT_EQ(overridden("m: [[1, 2], [3]]", "m[1][2]=7"), parsed("m: [[1, 7], [3]]"));
}

TEST(Override, FollowsTheRulesForPluginNames) {
  EXPECT_EQ(overridden("solver: iqp", "solver.steps=3"), parsed("solver: {type: iqp, steps: 3}"));
  EXPECT_EQ(overridden("solver: {type: iqp, steps: 3}", "solver=ipopt"), parsed("solver: ipopt"));
  EXPECT_EQ(overridden("solver: {type: iqp, steps: 3}", "solver.type=ipopt"),
            parsed("solver: {type: ipopt}"));
}

TEST(Override, SaysWhatIsMalformed) {
  EXPECT_EQ(refusal("{}", "a"), "--set a: '=' is missing; expected key.path=value");
  EXPECT_EQ(refusal("{}", "=1"), "--set =1: a key is missing; expected key.path=value");
  EXPECT_EQ(refusal("{}", "a..b=1"), "--set a..b=1: a key is missing; expected key.path=value");
  EXPECT_EQ(refusal("{}", "a.=1"), "--set a.=1: a key is missing; expected key.path=value");
  EXPECT_EQ(refusal("{}", "a b=1"), "--set a b=1: ' ' cannot be part of a key");
  EXPECT_EQ(refusal("{}", "a="),
            "--set a=: the value is missing; write '' for an empty text, null for nothing");
  EXPECT_NE(refusal("{}", "a=[1, 2").find("invalid YAML"), std::string::npos)
      << refusal("{}", "a=[1, 2");
  EXPECT_NE(refusal("{}", "a=x: 1").find("invalid YAML"), std::string::npos);
  EXPECT_NE(refusal("{}", "a=.nan").find("not a finite number"), std::string::npos);
  EXPECT_NE(refusal("{}", "a=1\nb: 2").find("one value"), std::string::npos);
  EXPECT_NE(refusal("k: [1]", "k[0]=1").find("counted from 1"), std::string::npos);
  EXPECT_NE(refusal("k: [1]", "k[x]=1").find("counted from 1"), std::string::npos);
  EXPECT_NE(refusal("k: [1]", "k[-1]=1").find("counted from 1"), std::string::npos);
  EXPECT_NE(refusal("k: [1]", "k[1=1").find("never closed"), std::string::npos);
  EXPECT_EQ(refusal("k: [1]", "k[2]=1"), "--set k[2]=1: there is no k[2]; the list has 1 entry");
  EXPECT_EQ(refusal("k: 1", "k[1]=1"), "--set k[1]=1: k is an integer, not a list");
  EXPECT_EQ(refusal("{}", "k[1].t=1"), "--set k[1].t=1: there is no k");
}

TEST(Layers, TheHighestWinsAndKeepsItsOrigin) {
  const Value low = parsed("duration: 20\nsolver: iqp\nweights: {snap: 1, yaw: 2}\n", "shot.lua");
  const std::vector<Value> files{parsed("weights:\n  snap: 5\n", "one.yaml"),
                                 parsed("weights:\n  yaw: 6\n  snap: 7\n", "two.yaml")};
  const std::vector<std::string> sets{"weights.yaw=8", "weights.yaw=9"};
  const Value value = layered(low, files, sets);
  EXPECT_EQ(value, parsed("duration: 20\nsolver: iqp\nweights: {snap: 7, yaw: 9}\n"));
  EXPECT_EQ(value.at("duration").origin(), (Origin{"shot.lua", 1}));
  EXPECT_EQ(value.at("weights").at("snap").origin(), (Origin{"two.yaml", 3}));
  EXPECT_EQ(value.at("weights").at("yaw").origin(), (Origin{"--set weights.yaw=9", 0}));
}

TEST(Annotated, SaysWhereEveryLeafCameFrom) {
  Value value = parsed(
      "name: castle flyover\n"
      "solver: {type: iqp, tolerance: 1e-8}\n"
      "keyframes:\n"
      "  - position: [0, 0, 2]\n"
      "    time: 0\n"
      "  - position: [5, 0, 2]\n"
      "none: []\n",
      "shot.lua");
  value.find("solver")->set("steps", Value(9).with_origin({"default", 0}));
  apply_override(value, "keyframes[2].position[1]=7.5");
  value.set("made", "by code");
  EXPECT_EQ(annotated_yaml(value),
            "name: \"castle flyover\"     # from shot.lua:1\n"
            "solver:\n"
            "  type: iqp                # from shot.lua:2\n"
            "  tolerance: 1e-08         # from shot.lua:2\n"
            "  steps: 9                 # default\n"
            "keyframes:\n"
            "  - position: [0, 0, 2]    # from shot.lua:4\n"
            "    time: 0                # from shot.lua:5\n"
            "  - position: [7.5, 0, 2]  # from shot.lua:6, --set\n"
            "none: []                   # from shot.lua:7\n"
            "made: \"by code\"\n");
}

TEST(Annotated, ReadsBackEqual) {
  const Value value = parsed(
      "plain: iqp\nnumber_text: '3'\nbool_text: 'true'\nnull_text: 'null'\nempty: ''\n"
      "odd: \"a: b # c \\\"d\\\" \\n ä\"\ndash: '-'\n'3 keys': 1\n'true': 2\n"
      "numbers: [1, 2.0, -3.5e-7, 1.0e+300]\nnested: [[1, [2]], []]\nmap: {}\nnone: ~\n"
      "deep: [[{a: 1, b: [x, {c: 2}]}], 3]\nyes: no\nfile: configs/a.yaml\nversion: 1.2.3\n");
  EXPECT_EQ(parsed(annotated_yaml(value)), value) << annotated_yaml(value);
  EXPECT_EQ(parsed(annotated_yaml(Value::map())), Value::map());
}

TEST(Annotated, ALongTrackIsItsEnds) {
  Value track = Value::list();
  for (int i = 0; i < 101; ++i) {
    Value entry = Value::map();
    entry.set("time", i);
    entry.set("position", parsed("[0, 1.5, 2]"));
    track.push_back(entry);
  }
  Value subject = parsed("name: walker");
  subject.set("track", track);
  Value value = Value::map(), subjects = Value::list();
  subjects.push_back(subject);
  value.set("subjects", subjects);
  value.set("step", 1);
  const std::string text = annotated_yaml(value, LongLists::shortened);
  EXPECT_NE(text.find("    # track: 101 entries, from {time: 0, position: [0, 1.5, 2]} to {time: "
                      "100, position: [0, 1.5, 2]}; all of it in a file: > FILE.yaml\n"),
            std::string::npos)
      << text;
  EXPECT_LT(std::count(text.begin(), text.end(), '\n'), 6) << text;
  EXPECT_EQ(parsed(text), parsed("subjects: [{name: walker}]\nstep: 1"));
  // Text that is used as a configuration loses nothing.
  EXPECT_EQ(parsed(annotated_yaml(value)), value);
}

}  // namespace
}  // namespace lapwing
