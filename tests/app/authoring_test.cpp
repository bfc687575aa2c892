// SPDX-License-Identifier: Apache-2.0
// `plugins check` on what is right and on what has one mistake each, and runs with such plugins.
#include "framework/core/json.h"
#include "tests/app/program_fixture.h"

namespace lapwing {
namespace {

const std::string kFixtures = std::string(LAPWING_BUILD_DIR) + "/tests/plugin_fixtures";

class Authoring : public CommandLine {
 protected:
  // The outcome of every test, by name, of one plugin of the library of broken terms.
  std::map<std::string, std::string> outcomes(const std::string& mistake,
                                              const std::vector<std::string>& only,
                                              const std::string& limit = "60") {
    return outcomes_of("cost_term/broken_" + mistake, "broken_terms", only, limit);
  }
  std::map<std::string, std::string> outcomes_of(const std::string& plugin,
                                                 const std::string& folder,
                                                 const std::vector<std::string>& only,
                                                 const std::string& limit = "60") {
    std::vector<std::string> arguments{
        "plugins", "check", plugin,          "--json",
        "--limit", limit,   "--plugin-path", kFixtures + "/" + folder};
    for (const std::string& test : only) arguments.insert(arguments.end(), {"--only", test});
    const Finished finished = run(arguments);
    std::map<std::string, std::string> result;
    const Value answer = from_json(finished.out, "answer");
    message_.clear();
    for (const Value& test : answer.at("plugins").as_list()[0].at("tests").as_list()) {
      result[test.at("name").as_text()] = test.at("outcome").as_text();
      if (const Value* message = test.find("message")) message_ += message->as_text() + "\n";
    }
    EXPECT_EQ(answer.at("passed").as_boolean(), finished.status == 0);
    status_ = finished.status;
    return result;
  }

  std::string message_;
  int status_ = 0;
};

TEST_F(Authoring, EveryTestBites) {
  struct Case {
    const char* mistake;
    const char* test;
    const char* says;
  };
  for (const Case& a : {Case{"derivatives", "derivatives", "d row 0 / d position[0] of stage 0"},
                        {"curvature", "curvature", "d2 / d position[0] of stage 0"},
                        {"values", "values", "when derivatives are asked too"},
                        {"ranges", "ranges", "alone differs from the same in a range"},
                        {"affine", "affine", "declared affine, but its Jacobian changes"},
                        {"degenerate", "degenerate input", "not finite with all inputs zero"},
                        {"repeatable", "repeatable", "the same inputs give two answers"},
                        {"threads", "threads", "four threads at once get other answers"},
                        {"allocations", "allocations", "heap allocations in calls"},
                        {"throws", "values", "throws: no"},
                        {"refuses", "creation", "not even its own defaults will do"},
                        {"creates", "creation", "not made"},
                        {"tiny", "derivatives", "says 0, differences give"},
                        {"masked", "derivatives", "says 0, differences give 0.5 "},
                        {"late", "derivatives", "a flight of 600 s"},
                        {"high", "values", "is nan"},
                        {"narrow", "derivatives", "d row 0 / d position[0] of stage 0"},
                        {"remembers", "allocations", "inputs that it was not asked before"},
                        {"single", "allocations", "one instance alone"},
                        {"overwrites", "curvature", "must add to what is there"}}) {
    const auto found = outcomes(a.mistake, {a.test, "description"});
    EXPECT_EQ(status_, 1) << a.mistake;
    EXPECT_EQ(found.at(a.test), "failed") << a.mistake << ": " << message_;
    EXPECT_EQ(found.at("description"), "passed") << a.mistake << ": " << message_;
    EXPECT_NE(message_.find(a.says), std::string::npos) << a.mistake << ": " << message_;
  }
}

TEST_F(Authoring, EveryTestOfConstraintsAndDeclarationsBites) {
  struct Case {
    const char* plugin;
    const char* test;
    const char* says;
  };
  for (const Case& a :
       {Case{"constraint/broken_constraint_bounds", "bounds", "lies between 2 and 1"},
        {"constraint/broken_constraint_alone", "bounds", "has other bounds alone than in a range"},
        {"constraint/broken_constraint_identity", "identity", "but returns other numbers"},
        {"cost_term/broken_invariance_translation", "invariance",
         "declares invariant_to_translation, but the length of its residuals changes from"},
        {"cost_term/broken_invariance_rotation", "invariance",
         "declares invariant_to_rotation_about_z, but the length of its residuals changes"},
        {"cost_term/broken_invariance_time", "invariance", "declares invariant_to_time, but"}}) {
    const auto found = outcomes_of(a.plugin, "broken_terms", {});
    EXPECT_EQ(status_, 1) << a.plugin;
    for (const auto& [test, outcome] : found)
      EXPECT_EQ(outcome == "failed", test == a.test) << a.plugin << " " << test << ": " << message_;
    EXPECT_NE(message_.find(a.says), std::string::npos) << a.plugin << ": " << message_;
  }
  for (const char* sound : {"constraint/broken_constraint", "cost_term/broken_invariance"}) {
    const auto found = outcomes_of(sound, "broken_terms", {});
    EXPECT_EQ(status_, 0) << sound << message_;
  }
  EXPECT_EQ(outcomes_of("cost_term/broken_invariance", "broken_terms", {}).at("invariance"),
            "passed");
}

// What is likely a slip and no mistake.
TEST_F(Authoring, WhatIsReadAndNeverUsedIsWarnedOf) {
  const auto found = outcomes("idle", {});
  EXPECT_EQ(status_, 0) << message_;
  EXPECT_EQ(found.at("pattern"), "warned");
  EXPECT_NE(message_.find("it reads position[1], and no result depends on it"), std::string::npos)
      << message_;
}

// All tests of a plugin with one mistake: none fails but what the mistake is meant for.
TEST_F(Authoring, OnlyWhatIsMeantFails) {
  using Names = std::set<std::string>;
  const auto failed = [](const std::map<std::string, std::string>& found) {
    Names names;
    for (const auto& [test, outcome] : found)
      if (outcome == "failed" || outcome == "crashed") names.insert(test);
    return names;
  };
  // A wrong derivative is at odds with the second ones as well.
  for (const auto& [mistake, tests] : {std::pair<const char*, Names>{"values", {"values"}},
                                       {"curvature", {"curvature"}},
                                       {"derivatives", {"curvature", "derivatives"}},
                                       {"tiny", {"derivatives"}},
                                       {"late", {"curvature", "derivatives"}},
                                       {"ranges", {"ranges"}},
                                       {"remembers", {"allocations"}},
                                       {"single", {"allocations"}},
                                       {"degenerate", {"degenerate input"}}})
    EXPECT_EQ(failed(outcomes(mistake, {})), tests) << mistake << ": " << message_;
  for (const auto& [plugin, tests] :
       {std::pair<const char*, Names>{"solver_cost", {"reported cost"}},
        {"solver_work", {"work limit"}},
        {"model_samples", {"samples"}},
        {"planner_messages", {"messages"}},
        {"tours_silent", {"work"}},
        {"tours_bound", {"upper bound"}},
        {"information_crowd", {"alone", "submodular"}},
        {"utility_many", {"alone"}},
        {"utility_submodular", {"submodular"}},
        {"exporter_extension", {"extension"}}})
    EXPECT_EQ(failed(outcomes_of("broken_" + std::string(plugin), "broken_kinds", {})), tests)
        << plugin << ": " << message_;
}

class SlowAuthoring : public Authoring {};

// The other kinds: every mistake is found by the test that is meant for it.
TEST_F(SlowAuthoring, EveryTestOfEveryKindBites) {
  struct Case {
    const char* plugin;
    const char* test;
    const char* says;
  };
  for (const Case& a : {
           Case{"solver_point", "point", "returns no whole, finite point"},
           {"solver_cost", "reported cost", "its point costs"},
           {"solver_violations", "reported violations", "its point violates by"},
           {"solver_status", "status", "says optimal, violates by"},
           {"solver_optimum", "optimum", "says iteration_limit: gave up"},
           {"solver_infeasible", "infeasible", "says iteration_limit: gave up"},
           {"solver_warm", "warm start", "from its own optimum 9 iterations"},
           {"solver_repeatable", "repeatable", "two runs end differently"},
           {"solver_work", "work limit", "5 iterations where one was allowed"},
           {"solver_cancellation", "cancellation", "cancelled before it began, says optimal"},
           {"solver_overworks", "work limit", "it reports 1 iterations of a solve with"},
           {"solver_deaf", "cancellation", "cancelled after 3 evaluations, it makes"},
           {"solver_clock", "wall clock", "without any time, it makes"},
           {"solver_refuses", "creation", "not even its own defaults will do"},
           {"model_blocks", "blocks", "states come first, then inputs"},
           {"model_bounds", "bounds", "bounds without anything between them"},
           {"model_flow", "flow", "a step of no length moves the state"},
           {"model_degenerate", "degenerate input", "not finite at zero"},
           {"model_derivatives", "derivatives", "rate"},
           {"model_curvature", "curvature", "rate"},
           {"model_halves", "halves", "one step and two of half its length end"},
           {"model_samples", "samples", "a sample read back differs by"},
           {"model_motion", "motion", "the motion 'sledge' has no integrator in this version"},
           {"model_columns", "motion", "samples lack the column 'force' of 3 numbers"},
           {"model_ranges", "ranges", "alone differs from the same in a range"},
           {"model_repeatable", "repeatable", "the same inputs give two answers"},
           {"model_threads", "threads", "four threads at once get other answers"},
           {"model_allocations", "allocations", "heap allocations in calls"},
           {"model_remembers", "allocations", "inputs that it was not asked before"},
           {"model_affine", "affine", "declared affine, but its Jacobian changes"},
           {"planner_answers", "answers", "says iteration_limit (did not look), not found"},
           {"planner_honest", "honest", "segment 1 of the planner's path is blocked"},
           {"planner_honest", "paths", "segment 1 runs through a block"},
           {"planner_deaf", "cancellation", "cancelled within its search, it asks the space"},
           {"planner_late", "wall clock", "without any time it takes 0.3"},
           {"planner_throws", "honest", "no"},
           {"planner_messages", "messages", "gives no reason"},
           {"planner_work", "work limit", "took 6001 iterations of 6000"},
           {"planner_repeatable", "repeatable", "another answer the second time"},
           {"planner_cancellation", "cancellation", "cancelled before it began, says"},
           {"planner_clock", "wall clock", "out of time, says"},
           {"tours_answers", "answers", "finds no tour"},
           {"tours_honest", "honest", "the solver returned no tour"},
           {"tours_tours", "honest", "the result of the solver is not a tour"},
           {"tours_tours", "tours", "its walk does not go from the start to the end"},
           {"tours_budget", "tours", "of a budget of"},
           {"tours_silent", "work", "reports no evaluation of a tour of"},
           {"tours_teams", "teams", "two loops over motions: bound 0 below the best tours'"},
           {"tours_deaf", "work", "in none of its searches it asks whether the work has to end"},
           {"tours_late", "wall clock", "without any time it takes 0.3"},
           {"tours_throws", "honest", "no"},
           {"tours_messages", "messages", "gives no reason"},
           {"tours_bound", "upper bound", "below the best tour's"},
           {"tours_repeatable", "repeatable", "another answer the second time"},
           {"tours_cancellation", "cancellation", "cancelled before it began, says optimal"},
           {"tours_clock", "wall clock", "out of time, says iteration_limit"},
           {"information_finite", "finite", "at 0 m it tells inf"},
           {"information_negative", "at least 0", "it tells -0."},
           {"information_negative", "submodular", "reduces the information of the others"},
           {"information_repeats", "repeats", "something else when asked again"},
           {"information_alone", "alone", "something else when asked alone"},
           {"information_far", "finite", "it tells nan"},
           {"information_without_normal", "finite", "it tells nan"},
           {"information_crowd", "submodular", "to fewer"},
           {"information_throws", "finite", "its contributions throws: no"},
           {"utility_finite", "finite", "which is not a finite number"},
           {"utility_somewhere", "finite", "which is not a finite number"},
           {"utility_many", "alone", "has another value when asked alone"},
           {"utility_monotone", "monotone", "less than nothing"},
           {"utility_submodular", "submodular", "with less known"},
           {"utility_repeatable", "repeatable", "other values when asked again"},
           {"utility_threads", "threads", "other values with four threads"},
           {"utility_alone", "alone", "has another value when asked alone"},
           {"utility_truth", "truth", "answers otherwise without it"},
           {"exporter_extension", "extension", "does not begin with a dot"},
           {"exporter_repeatable", "repeatable", "equal plans give other bytes"},
           {"exporter_contents", "contents", "an empty file for a plan that has samples"},
           {"exporter_silent", "contents", "refuses a plan without a reason"},
           {"exporter_throws", "contents", "writing a plan throws: no"},
           {"log_example", "example", "does not recognize its own example"},
           {"log_moment", "example", "shorter than a second"},
           {"log_repeatable", "repeatable", "equal bytes give another log"},
           {"log_greedy", "refusals", "it takes no bytes for a log of its format"},
           {"log_silent", "refusals", "does not refuse no bytes with a reason"},
           {"log_cut", "cut short", "reading a log throws: too short"},
           {"log_damage", "damage", "a number that is not finite"},
           {"log_throws", "example", "reading a log throws: no"},
           {"executor_place", "exchange", "it is process 1 of 1"},
           {"executor_exchange", "exchange", "comes back as another one"},
           {"executor_lost", "items", "is made 0 times"},
           {"executor_twice", "items", "item 1 is made 2 times"},
           {"executor_silent", "items", "is reported 0 times"},
           {"executor_times", "items", "it reports other times than `make` returned"},
           {"executor_order", "order", "in the order of the queue"},
           {"executor_crowd", "threads", "it makes 4 items at once"},
           {"executor_swallows", "failure", "does not throw the exception of an item"},
           {"executor_goes_on", "failure", "it begins items after one has failed"},
           {"executor_deaf", "cancellation", "it does not throw Cancelled"},
           {"executor_throws", "exchange", "making items throws: no"},
           {"executor_refuses", "creation", "not even its own defaults will do"},
           {"map_empty", "empty", "a new map knows voxels"},
           {"map_integration", "integration", "has log odds"},
           {"map_casts", "ray casts", " meets "},
           {"map_boxes", "boxes", "free in one map and not in the other"},
           {"map_touching", "touching", "a box that touches what is unknown is not free"},
           {"map_import", "import", "observations"},
           {"map_means", "means", "level "},
           {"map_repeatable", "repeatable", "the same scans give two maps"},
           {"map_threads", "threads", "four threads give another map than one"},
           {"map_round", "round trip", "make another map"},
           {"map_memory", "memory", "says that it takes 0 bytes"},
           {"map_refusals", "refusals", "but changes the map"},
           {"map_refuses", "creation", "not even its own defaults will do"},
       }) {
    const auto found =
        outcomes_of("broken_" + std::string(a.plugin), "broken_kinds", {a.test, "description"});
    EXPECT_EQ(status_, 1) << a.plugin;
    EXPECT_EQ(found.at(a.test), "failed") << a.plugin << ": " << message_;
    EXPECT_EQ(found.at("description"), "passed") << a.plugin << ": " << message_;
    EXPECT_NE(message_.find(a.says), std::string::npos) << a.plugin << ": " << message_;
  }
}

// (A sound map is among the shipped plugins.)
TEST_F(Authoring, WithoutAMistakeEveryKindPasses) {
  for (const char* plugin : {"solver", "model", "planner", "tours", "information", "utility",
                             "exporter", "log", "executor"}) {
    const auto found = outcomes_of("broken_" + std::string(plugin), "broken_kinds", {});
    EXPECT_EQ(status_, 0) << plugin << ": " << message_;
    EXPECT_EQ(found.at("sidecar"), "passed");
    EXPECT_EQ(found.at("rubbish"), "passed");
    EXPECT_GE(found.size(), 6u);
  }
}

// Tests that share a process are repeated each in its own where that process ends early.
TEST_F(Authoring, ACrashOfAnyKindIsAResult) {
  for (const char* plugin : {"solver", "model", "planner", "tours", "information", "utility",
                             "exporter", "log", "map"}) {
    const auto found =
        outcomes_of("broken_" + std::string(plugin) + "_crashes", "broken_kinds", {});
    EXPECT_EQ(status_, 1) << plugin;
    EXPECT_EQ(found.at("creation"), "passed") << plugin << message_;
    EXPECT_EQ(found.at("sidecar"), "passed") << plugin << message_;
    int crashed = 0;
    for (const auto& [test, outcome] : found) crashed += outcome == "crashed";
    EXPECT_GE(crashed, 2) << plugin << message_;
    EXPECT_NE(message_.find("Segmentation fault"), std::string::npos) << plugin << message_;
  }
}

TEST_F(Authoring, ACrashIsAResult) {
  auto found = outcomes("crashes", {"creation", "values", "rubbish"});
  EXPECT_EQ(found.at("values"), "crashed");
  EXPECT_EQ(found.at("rubbish"), "passed");
  EXPECT_NE(message_.find("Segmentation fault"), std::string::npos) << message_;
  EXPECT_EQ(status_, 1);
  found = outcomes("exits", {"values"});
  EXPECT_EQ(found.at("values"), "crashed");
  EXPECT_NE(message_.find("ended without an answer"), std::string::npos) << message_;
  found = outcomes("hangs", {"values"}, "0.5");
  EXPECT_EQ(found.at("values"), "crashed");
  EXPECT_NE(message_.find("it did not return: it takes longer than 0.5 s"), std::string::npos)
      << message_;
}

TEST_F(Authoring, ATermWithoutAMistakePasses) {
  const auto found = outcomes("term", {});
  EXPECT_EQ(status_, 0) << message_;
  EXPECT_GE(found.size(), 12u);
  EXPECT_EQ(found.at("allocations"), "passed");
  EXPECT_EQ(found.at("affine"), "skipped");
}

TEST_F(Authoring, ALibraryThatDoesNotOpenSaysWhy) {
  for (const auto& [name, says] : {std::pair{"other_abi", "rebuild"},
                                   {"no_symbol", "lapwing_plugin_library"},
                                   {"undefined_symbol", "undefined symbol"},
                                   {"throwing_library", "throw"}}) {
    const Finished finished =
        run({"plugins", "check", kFixtures + "/broken/" + std::string(name) + ".so"});
    EXPECT_EQ(finished.status, 1) << finished.out;
    EXPECT_NE(finished.out.find("failed   opens"), std::string::npos) << finished.out;
    EXPECT_NE(finished.out.find(says), std::string::npos) << finished.out;
  }
  refused({"plugins", "check", "nothing.so"}, {"there is no library 'nothing.so'"});
  refused({"plugins", "check", "keyfarme"}, {"did you mean 'keyframe'?"});
  refused(
      {"plugins", "check", "cost_term/keyframe", "--only", "derivative"},
      {"there is no test 'derivative' for it; there are description, sidecar, rubbish, creation"});
}

TEST_F(Authoring, ShippedPluginsPass) {
  for (const char* name : {"cost_term/input_effort", "constraint/obstacle", "map/brick"}) {
    const Finished finished = run({"plugins", "check", name});
    EXPECT_EQ(finished.status, 0) << finished.out << finished.err;
  }
}

// A flight with a broken plugin ends with the plugin's name and the right status.
TEST_F(Authoring, ABrokenPluginIsNamedByTheRun) {
  struct Case {
    const char* mistake;
    int status;
    const char* says;
  };
  ::setenv("LAPWING_CALL_LIMIT", "0.5", 1);
  for (const Case& a :
       {Case{"throws", 3, "plugin 'broken_throws' failed in evaluate: no"},
        {"creates", 3, "plugin 'broken_creates' failed in create: not made"},
        {"refuses", 2, "not even its own defaults will do"},
        {"degenerate", 3, "a value of broken_degenerate.0 at 0 s is not a finite number"},
        {"crashes", 3, "plugin 'broken_crashes' crashed in evaluate (segmentation fault)"},
        {"hangs", 3, "plugin 'broken_hangs' does not return from evaluate"}}) {
    write("shot.lua", film("costs = { { type = 'broken_" + std::string(a.mistake) + "' } },"));
    const Finished finished =
        run({"--plugin-path", kFixtures + "/broken_terms", "run", "shot.lua", "--quiet"});
    EXPECT_EQ(finished.status, a.status) << a.mistake << ": " << finished.err;
    EXPECT_NE(finished.err.find(a.says), std::string::npos) << a.mistake << ": " << finished.err;
  }
  ::unsetenv("LAPWING_CALL_LIMIT");
}

}  // namespace
}  // namespace lapwing
