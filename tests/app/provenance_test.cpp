// SPDX-License-Identifier: Apache-2.0
// Whose limits and obstacles a certificate is about, and what an edited plan is told.
#include <gmock/gmock.h>

#include "framework/core/json.h"
#include "framework/trajectory/plan_digest.h"
#include "tests/app/program_fixture.h"

namespace lapwing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class ProvenanceTest : public CommandLine {
 protected:
  void SetUp() override {
    write("shot.lua", film("obstacles = { { type = 'sphere', name = 'tree', center = {2, 4, 2}, "
                           "radius = 1 } }, name = 'shot'"));
    const Finished made = run({"run", "shot.lua"});
    ASSERT_EQ(made.status, 0) << made.err << made.out;
    plan_ = folder_ / "out" / "shot" / "plan.json";
  }

  Value document() const { return from_json(read_file(plan_), "plan.json"); }

  // As somebody would who knows of the digest, or who does not.
  void save(Value document, bool with_a_new_digest) {
    if (with_a_new_digest) document.set("digest", digest_of(document));
    write_file_atomically(plan_, to_json(document) + "\n");
  }

  Value answer(const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{"verify", plan_.string(), "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return from_json(run(words).out, "answer");
  }

  static std::vector<std::string> failures_in(const Value& answer) {
    std::vector<std::string> names;
    for (const Value& check : answer.at("certificate").at("checks").as_list())
      if (const Value* pass = check.find("pass");
          pass && !pass->as_boolean() && check.at("required").as_boolean())
        names.push_back(check.at("name").as_text());
    return names;
  }
  static std::string detail_of(const Value& answer) {
    return answer.at("certificate").at("checks").as_list()[1].at("detail").as_text();
  }

  fs::path plan_;
};

const std::vector<std::string> kProvenanceAlone{"provenance"};

TEST_F(ProvenanceTest, RunAndVerifySayTheSame) {
  const Value now = answer();
  EXPECT_EQ(now.at("certificate"), document().at("certificate"));
  EXPECT_THAT(detail_of(now), HasSubstr("compared with configs/vehicles/solo.yaml"));
  EXPECT_THAT(detail_of(now), HasSubstr("1 sphere, margin 0.5 m"));
  EXPECT_THAT(detail_of(now), HasSubstr("film: 2 keyframes"));
  EXPECT_EQ(now.at("provenance").at("vehicle").at("name").as_text(), "vehicles/solo");
  EXPECT_EQ(now.at("provenance").at("environment").at("sphere").as_integer(), 1);
  EXPECT_EQ(now.at("provenance").at("tolerances").at("keyframe").as_number(), 0.5);
  const Finished shown = run({"verify", plan_.string()});
  for (const char* line :
       {"  vehicle     vehicles/solo, compared with configs/vehicles/solo.yaml",
        "  obstacles   1 sphere, margin 0.5 m", "  task        film: 2 keyframes",
        "  tolerances  keyframes 0.5 m, 0.1 s, 10 deg", "as it was written"})
    EXPECT_THAT(shown.out, HasSubstr(line));
}

TEST_F(ProvenanceTest, PlansStayByteIdentical) {
  const std::string before = read_file(plan_);
  EXPECT_EQ(run({"run", "shot.lua"}).status, 0);
  EXPECT_EQ(read_file(plan_), before);
}

// Each was certified before; with a digest made anew, too, where a source can be compared.
TEST_F(ProvenanceTest, EveryEditIsToldAndNamed) {
  struct Edit {
    const char* section;  // that is named
    std::function<void(Value&)> change;
    bool compared;  // told even with a new digest
  };
  const auto limits = [](Value& d) -> Value& { return *d.find("vehicle")->find("limits"); };
  const Edit edits[] = {
      {"vehicle.limits", [&](Value& d) { limits(d).set("speed_across", 20.0); }, true},
      {"vehicle.flight_time", [](Value& d) { d.find("vehicle")->set("flight_time", 9e3); }, true},
      {"environment.margin", [](Value& d) { d.find("environment")->set("margin", 0.1); }, true},
      {"environment.obstacles",
       [](Value& d) { d.find("environment")->set("obstacles", Value::list()); }, true},
      {"environment.obstacles",
       [](Value& d) {
         Value& first = d.find("environment")->find("obstacles")->as_list()[0];
         first.find("parameters")->set("radius", 0.5);
       },
       true},
      {"task.keyframes",
       [](Value& d) { d.find("task")->find("keyframes")->as_list()[0].set("tolerance", 0.7); },
       true},
      {"task.keyframes", [](Value& d) { d.find("task")->find("keyframes")->as_list().pop_back(); },
       true},
      {"task.closed_loop_required (added)",
       [](Value& d) { d.find("task")->set("closed_loop_required", false); }, true},
      {"mission", [](Value& d) { d.set("mission", "another"); }, false},
      {"configuration.margin", [](Value& d) { d.find("configuration")->set("margin", 0.2); },
       false},
      {"certificate.feasible", [](Value& d) { d.find("certificate")->set("feasible", false); },
       false},
  };
  const Value whole = document();
  for (const Edit& edit : edits) {
    Value changed = whole;
    edit.change(changed);
    save(changed, false);
    Value judged = answer();
    EXPECT_EQ(failures_in(judged), kProvenanceAlone) << edit.section;
    EXPECT_THAT(detail_of(judged), HasSubstr(edit.section));
    EXPECT_THAT(detail_of(judged), HasSubstr("changed after writing"));
    save(changed, true);
    judged = answer();
    EXPECT_EQ(failures_in(judged), edit.compared ? kProvenanceAlone : std::vector<std::string>{})
        << edit.section << ": " << detail_of(judged);
  }
}

// What makes a plan no plan stands right below the verdict, and is not buried by what follows.
TEST_F(ProvenanceTest, TheCauseComesFirst) {
  Value broken = document();
  broken.set("environment", Value(broken.at("environment"))).set("margin", -1.0);
  save(std::move(broken), true);
  const Finished damaged = run({"verify", plan_.string()});
  EXPECT_EQ(damaged.status, 1);
  EXPECT_THAT(damaged.out, testing::StartsWith("shot: not certified\n  FAIL     document "));
  EXPECT_THAT(damaged.out, HasSubstr("checks were not made: they need a consistent document"));
  EXPECT_LT(std::count(damaged.out.begin(), damaged.out.end(), '\n'), 15) << damaged.out;
  EXPECT_GT(answer().at("certificate").at("checks").as_list().size(), 20u) << "--json has them all";
}

TEST_F(ProvenanceTest, LayoutIsNoChange) {
  write_file_atomically(plan_, to_json(document(), -1));
  EXPECT_TRUE(failures_in(answer()).empty());
}

TEST_F(ProvenanceTest, ADocumentWithoutDigestIsNotTrusted) {
  Value bare = Value::map();
  const Value whole = document();
  for (const auto& [key, value] : whole.as_map())
    if (key != "digest") bare.set(key, value);
  save(bare, false);
  EXPECT_EQ(failures_in(answer()), kProvenanceAlone);
  EXPECT_THAT(detail_of(answer()), HasSubstr("states no digest"));
}

TEST_F(ProvenanceTest, AStrongerVehicleUnderTheNameOfAnotherIsTold) {
  const Finished made = run({"run", "shot.lua", "--set", "vehicle=vehicles/racer", "-o", "racer"});
  plan_ = folder_ / "racer" / "plan.json";
  Value renamed = document();
  renamed.find("vehicle")->set("name", "vehicles/solo");
  renamed.find("configuration")->set("vehicle", "vehicles/solo");
  save(renamed, true);
  const Value judged = answer();
  const std::vector<std::string> failures = failures_in(judged);
  EXPECT_EQ(std::count(failures.begin(), failures.end(), "provenance"), 1) << made.out;
  EXPECT_THAT(detail_of(judged), HasSubstr("in the plan and"));
  EXPECT_THAT(detail_of(judged), HasSubstr("in configs/vehicles/solo.yaml"));
  EXPECT_EQ(run({"verify", plan_.string()}).status, 1);
}

// With a digest made anew, and what the plan says of its source made vague.
TEST_F(ProvenanceTest, TheNameOfAShippedVehicleBindsWhateverElseIsStated) {
  Value stronger = document();
  stronger.find("vehicle")->find("limits")->set("speed_across", 20.0);
  Value table = Value::map();
  table.set("mass", 1.5);
  for (const Value& stated : {table, Value(), Value("mine"), Value(3)}) {
    stronger.find("configuration")->set("vehicle", stated);
    save(stronger, true);
    EXPECT_EQ(failures_in(answer()), kProvenanceAlone) << to_json(stated);
    EXPECT_THAT(detail_of(answer()), HasSubstr("speed_across is 20 in the plan and 10 in configs"));
  }
  // A table that is no vehicle, and a shipped file that is none.
  stronger.find("vehicle")->set("name", "vehicle");
  stronger.find("configuration")->set("vehicle", table);
  save(stronger, true);
  EXPECT_EQ(failures_in(answer()), kProvenanceAlone);
  for (const char* name : {"cameras/action", "../vehicles/solo", "/etc/passwd"}) {
    stronger.find("vehicle")->set("name", name);
    save(stronger, true);
    EXPECT_EQ(failures_in(answer()), kProvenanceAlone) << name;
  }
}

TEST_F(ProvenanceTest, ATableInTheScriptIsComparedWithTheConfiguration) {
  write("own.lua", film("name = 'own', vehicle = { mass = 1.5, inertia = {0.015, 0.015, 0.025}, "
                        "rotors = { thrust = {0.2, 8}, torque_coefficient = 0.016, "
                        "arm_length = 0.23 }, limits = { speed_across = 10, climb_speed = 2.5, "
                        "descent_speed = 2, acceleration_across = 4, yaw_rate_deg = 90 }, "
                        "flight_time = 1200, camera = 'cameras/action' }"));
  const Finished made = run({"run", "own.lua"});
  ASSERT_EQ(made.status, 0) << made.err << made.out;
  plan_ = folder_ / "out" / "own" / "plan.json";
  EXPECT_EQ(answer().at("certificate"), document().at("certificate"));
  EXPECT_THAT(detail_of(answer()), HasSubstr("compared with the plan's configuration"));
  Value stronger = document();
  stronger.find("vehicle")->find("limits")->set("speed_across", 20.0);
  save(stronger, true);
  EXPECT_EQ(failures_in(answer()), kProvenanceAlone);
}

TEST_F(ProvenanceTest, AVehicleOfTheScriptsOwnSaysSo) {
  const std::string solo = read_file(fs::path(LAPWING_SOURCE_DIR) / "configs/vehicles/solo.yaml");
  write("mine.yaml", solo);
  write("own.lua", film("name = 'own', vehicle = 'mine'"));
  const Finished made = run({"run", "own.lua"});
  ASSERT_EQ(made.status, 0) << made.err << made.out;
  plan_ = folder_ / "out" / "own" / "plan.json";
  EXPECT_EQ(answer().at("certificate"), document().at("certificate"));
  EXPECT_THAT(detail_of(answer()), HasSubstr("mine, stated by the script, compared with no file"));
  // The same vehicle has the same digest under any name.
  const Value own = answer().at("provenance").at("vehicle");
  plan_ = folder_ / "out" / "shot" / "plan.json";
  EXPECT_EQ(own.at("sha256"), answer().at("provenance").at("vehicle").at("sha256"));
}

TEST_F(ProvenanceTest, OnesOwnVehicleAndObstaclesJudge) {
  std::string slow = read_file(fs::path(LAPWING_SOURCE_DIR) / "configs/vehicles/solo.yaml");
  const std::size_t at = slow.find("speed_across:");
  slow.replace(at, slow.find('\n', at) - at, "speed_across: 1");
  write("slow.yaml", slow);
  Value judged = answer({"--vehicle", (folder_ / "slow.yaml").string()});
  EXPECT_EQ(failures_in(judged), std::vector<std::string>{"speed_across"});
  EXPECT_THAT(to_json(judged.at("provenance").at("remarks")),
              HasSubstr("vehicle.limits.speed_across is 10 in the plan and 1 in"));

  write("own.yaml", "boxes: [{name: wall, lower: [2, -1, 0], upper: [3, 1, 5]}]\n");
  judged = answer({"--environment", "own.yaml"});
  EXPECT_EQ(failures_in(judged), std::vector<std::string>{"clearance"});
  write("own.yaml", "spheres: [{center: [2, 4, 2], radius: 1}]\nmargin: 0.25\n");
  EXPECT_TRUE(failures_in(answer({"--environment", "own.yaml"})).empty());
  write("own.yaml", "spheres: [{center: [2, 4, 2], radus: 1}]\n");
  const Finished wrong = run({"verify", plan_.string(), "--environment", "own.yaml"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.err, HasSubstr("did you mean 'radius'"));
  EXPECT_EQ(run({"verify", plan_.string(), "--vehicle", "nobody"}).status, 2);
}

// A plan names its meshes below its own folder: wherever that is moved, it is judged the same.
TEST_F(ProvenanceTest, AMovedFolderWithAMeshIsJudgedAsBefore) {
  write("tower.obj", "v 2 4 0\nv 3 4 0\nv 3 4 5\nv 2 4 5\nf 1 2 3 4\n");
  write("mesh.lua", film("obstacles = { { type = 'mesh', name = 'tower', file = 'tower.obj' } }, "
                         "name = 'mesh'"));
  const Finished made = run({"run", "mesh.lua"});
  ASSERT_EQ(made.status, 0) << made.err << made.out;
  plan_ = folder_ / "out" / "mesh" / "plan.json";
  const Value before = answer();
  EXPECT_TRUE(failures_in(before).empty()) << to_json(before);
  const Value obstacles = document().at("environment").at("obstacles");
  ASSERT_EQ(obstacles.as_list().size(), 1u);
  EXPECT_EQ(obstacles.as_list()[0].at("type").as_text(), "mesh");
  fs::create_directories(folder_ / "elsewhere");
  fs::rename(folder_ / "out" / "mesh", folder_ / "elsewhere" / "kept");
  fs::remove(folder_ / "tower.obj");
  plan_ = folder_ / "elsewhere" / "kept" / "plan.json";
  EXPECT_EQ(answer().at("certificate"), before.at("certificate"));
}

// Meshes and maps of the judge's are read where the judge's file says they are.
TEST_F(ProvenanceTest, OnesOwnMeshAndMapJudge) {
  fs::create_directories(folder_ / "site" / "data");
  // A wall across the flight.
  const auto wall = [&](double x, double scale = 1) {
    std::string text;
    for (const auto& [y, z] : {std::pair{-3, 0}, {3, 0}, {3, 8}, {-3, 8}})
      text += "v " + std::to_string(scale * x) + " " + std::to_string(scale * y) + " " +
              std::to_string(scale * z) + "\n";
    write("site/data/wall.obj", text + "f 1 2 3 4\n");
  };
  write("site/own.yaml", "meshes: [{name: wall, file: data/wall.obj}]\n");
  wall(2.5);
  Value judged = answer({"--environment", "site/own.yaml"});
  EXPECT_EQ(failures_in(judged), std::vector<std::string>{"clearance"});
  EXPECT_THAT(to_json(judged.at("certificate")), HasSubstr("mesh 'wall'"));
  wall(30);
  judged = answer({"--environment", "site/own.yaml"});
  EXPECT_TRUE(failures_in(judged).empty()) << to_json(judged.at("certificate"));
  EXPECT_EQ(judged.at("provenance").at("remarks").as_list().size(), 0u);
  // An absolute path, and one that leaves the folder of the judge's file, are the judge's to name.
  write("site/own.yaml", "meshes: [{file: " + (folder_ / "site/data/wall.obj").string() +
                             "}, {file: ../site/data/wall.obj}]\n");
  EXPECT_TRUE(failures_in(answer({"--environment", "site/own.yaml"})).empty());
  // What is probably in centimetres is told, what lies in a grid of the land is refused.
  wall(30, 100);
  EXPECT_THAT(to_json(answer({"--environment", "site/own.yaml"}).at("provenance").at("remarks")),
              HasSubstr("state its unit (unit = 0.01)"));
  wall(500000);
  judged = answer({"--environment", "site/own.yaml"});
  EXPECT_EQ(failures_in(judged), std::vector<std::string>{"document"});
  EXPECT_THAT(to_json(judged.at("certificate")), HasSubstr("Subtract a corner"));
}

TEST_F(ProvenanceTest, WhatAnotherCertificateSaidIsToldWhereTheVerdictStays) {
  Value changed = document();
  changed.find("task")->find("keyframes")->as_list()[0].set("tolerance", 0.7);
  changed.find("task")->find("keyframes")->as_list()[1].set("tolerance", 0.7);
  save(changed, true);
  const Finished judged = run({"verify", plan_.string()});
  EXPECT_EQ(judged.status, 1);
  EXPECT_THAT(judged.out, HasSubstr("the tolerance of keyframe 1 is 0.7 m in the plan and 0.5 m"));
  EXPECT_THAT(judged.err, HasSubstr("keyframe_miss was judged by a limit of 0.5 at planning, "
                                    "and is now by 0.7 m"));
}

TEST_F(ProvenanceTest, AnUncertifiedPlanIsExportedOnlyWhenAskedFor) {
  const std::vector<std::string> words{"export", plan_.string(), "--format", "csv", "-o", "x.csv"};
  EXPECT_EQ(run(words).status, 0);
  fs::remove(folder_ / "x.csv");
  Value changed = document();
  changed.find("vehicle")->find("limits")->set("speed_across", 1.0);
  save(changed, true);
  Finished refused = run(words);
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.err, HasSubstr("is not certified"));
  EXPECT_THAT(refused.err, HasSubstr("speed_across"));
  EXPECT_THAT(refused.err, HasSubstr("--uncertified"));
  EXPECT_FALSE(fs::exists(folder_ / "x.csv"));
  std::vector<std::string> all_the_same = words;
  all_the_same.push_back("--uncertified");
  refused = run(all_the_same);
  EXPECT_EQ(refused.status, 0);
  EXPECT_THAT(refused.err, HasSubstr("is not certified, and exported on request"));
  EXPECT_TRUE(fs::exists(folder_ / "x.csv"));
}

}  // namespace
}  // namespace lapwing
