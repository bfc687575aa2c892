// SPDX-License-Identifier: Apache-2.0
// Plugins of every kind that crash, end the program, throw, answer NaN or do not come back in one
// of their calls: each is told by its name, with what to do about it.
#include <cmath>
#include <fstream>

#include "framework/app/plugin_guard.h"
#include "framework/conformance/tour_worlds.h"
#include "framework/explore/view_utility.h"
#include "framework/export/exporter.h"
#include "framework/geometry/mesh_builder.h"
#include "framework/path/path_planner.h"
#include "framework/plugin/registry.h"
#include "framework/solve/trajectory_solver.h"
#include "framework/view/scan_graph.h"
#include "framework/view/tour_solver.h"
#include "tests/app/program_fixture.h"

namespace lapwing {
namespace {

const std::string kRogues = std::string(LAPWING_BUILD_DIR) + "/tests/plugin_fixtures/rogue";

const Registry& rogues() {
  static const Registry registry({kRogues});
  return registry;
}

Value misdeed(const char* where, const char* how) {
  Value given = Value::map();
  given.set("where", where);
  given.set("how", how);
  return given;
}

// A problem of five stages with the rogues of a problem; all of its calls are made.
void state_problem(const Value& model, const Value& term, const Value& rule) {
  Vehicle vehicle;
  TrajectoryProblem problem(vehicle, {.stages = 5, .step = 0.5});
  problem.add_model("body", rogues().create<VehicleModel>("rogue_model", model));
  problem.add_cost("near", 1, rogues().create<CostTerm>("rogue_term", term));
  problem.add_constraint("inside", rogues().create<Constraint>("rogue_rule", rule));
  problem.set_path_guess({0, 2}, {{1, 1, 1}, {2, 2, 2}}, {0, 0});
  problem.finish();
  const Stages at = problem.initial_guess();
  LocalModel local;
  const Eigen::VectorXd multipliers = Eigen::VectorXd::Ones(problem.rows());
  problem.linearise(at, local, Curvature::exact, &multipliers);
  problem.trajectory(at);
}

void solve_with(const Value& solver, double seconds = 0) {
  TrajectoryProblem problem(Vehicle{}, {.stages = 5, .step = 0.5});
  problem.add_model("body", rogues().create<VehicleModel>("rogue_model"));
  problem.finish();
  const CancellationToken token;
  SolveRequest request;
  if (seconds > 0) request.cancellation = &token;
  solve_by(*rogues().create<TrajectorySolver>("rogue_solver", solver), problem, request);
}

PathReport plan_with(const Value& planner) {
  MeshBuilder wall;
  wall.box({-0.2, -6, 0}, {0.2, 6, 4});
  const auto space = free_space_of(std::make_shared<const MeshScene>(wall.take()));
  return rogues()
      .create<PathPlanner>("rogue_planner", planner)
      ->plan({space.get(),
              {-5, 0, 2},
              {5, 0, 2},
              {0.3, 0.3, 0.2},
              {Eigen::Vector3d(-6, -8, 0), Eigen::Vector3d(6, 8, 4)}})
      .report;
}

TourReport tour_with(const Value& solver) {
  return rogues()
      .create<TourSolver>("rogue_tours", solver)
      ->solve(TourProblem(random_tour(5, {})))
      .report;
}

void score_with(const Value& utility) {
  const auto map = rogues().create<Map>("rogue_map");
  const MapMeans means(*map);
  EpisodeView known;
  known.map = map.get();
  known.means = &means;
  double value = 0;
  rogues()
      .create<ViewUtility>("rogue_utility", utility)
      ->score(known, {{Viewpoint{}}}, {&value, 1});
}

void use_map(const Value& given) {
  const auto map = rogues().create<Map>("rogue_map", given);
  const Eigen::Vector3f point(1, 1, 1);
  map->integrate({&point, 1}, Eigen::Vector3f::Zero());
  const VoxelKey key = map->grid().key({1, 1, 1});
  map->import({{VoxelLeaf{.key = key, .level = 0, .log_odds = 1}}});
  MapRayHit hit;
  map->cast({{MapRay{.range = 3}}}, {&hit, 1});
  MeanReading mean;
  map->read_means(1, {&key, 1}, {&mean, 1});
  map->box_free({0, 0, 0}, {1, 1, 1});
}

struct Deed {
  const char* plugin;
  const char* where;
  std::function<void(const Value&)> call;
};

std::vector<Deed> deeds() {
  const Value good = Value::map();
  const auto model = [=](const Value& v) { state_problem(v, good, good); };
  const auto term = [=](const Value& v) { state_problem(good, v, good); };
  const auto rule = [=](const Value& v) { state_problem(good, good, v); };
  const auto solver = [](const Value& v) { solve_with(v); };
  const auto information = [](const Value& v) {
    contributions_of({SeenVoxel{}}, *rogues().create<ViewInformation>("rogue_information", v));
  };
  return {{"rogue_model", "create", model},
          {"rogue_model", "bind", model},
          {"rogue_model", "flow", model},
          {"rogue_model", "curvature", model},
          {"rogue_model", "to_sample", model},
          {"rogue_model", "describe", model},
          {"rogue_term", "bind", term},
          {"rogue_term", "evaluate", term},
          {"rogue_term", "curvature", term},
          {"rogue_rule", "bounds", rule},
          {"rogue_solver", "solve", solver},
          {"rogue_planner", "search", plan_with},
          {"rogue_tours", "search", tour_with},
          {"rogue_information", "contributions", information},
          {"rogue_utility", "values_of", score_with},
          {"rogue_map", "insert", use_map},
          {"rogue_map", "assign", use_map},
          {"rogue_map", "cast", use_map},
          {"rogue_map", "read_means", use_map},
          {"rogue_map", "swept_box_free", use_map}};
}

std::string cure(const std::string& plugin) {
  return "; try it alone: lapwing plugins check " + plugin + "\n";
}

TEST(RoguePlugins, OfEveryKindThatCrashOrExitAreNamed) {
  for (const Deed& deed : deeds()) {
    const std::string name = std::string("lapwing: plugin '") + deed.plugin + "' ";
    const auto when = [&](const char* how) {
      guard_plugin_calls(60);
      deed.call(misdeed(deed.where, how));
      std::_Exit(0);
    };
    EXPECT_EXIT(when("crashes"), ::testing::ExitedWithCode(3),
                name + "crashed in " + deed.where + " .segmentation fault." + cure(deed.plugin));
    EXPECT_EXIT(when("exits"), ::testing::ExitedWithCode(3),
                name + "ended the program in " + deed.where + cure(deed.plugin));
  }
}

TEST(SlowRoguePlugins, OfEveryKindThatHangAreNamed) {
  for (const Deed& deed : deeds()) {
    const auto when = [&] {
      guard_plugin_calls(0.1);
      deed.call(misdeed(deed.where, "hangs"));
    };
    EXPECT_EXIT(
        when(), ::testing::ExitedWithCode(3),
        std::string("lapwing: plugin '") + deed.plugin + "' does not return from " + deed.where);
  }
}

// A long solve is no hang as long as it asks whether it was cancelled.
TEST(RoguePlugins, WhoAsksWhetherItWasCancelledIsAtWork) {
  const auto when = [] {
    guard_plugin_calls(0.2);
    solve_with(misdeed("work", "asks"), 1);
    std::_Exit(7);
  };
  EXPECT_EXIT(when(), ::testing::ExitedWithCode(7), "");
}

// What no call is marked of: a map's reads are too quick, and a destructor is nobody's call.
TEST(RoguePlugins, AnUnmarkedCallIsFoundByItsLibrary) {
  const auto reads = [] {
    guard_plugin_calls(60);
    rogues().create<Map>("rogue_map", misdeed("read", "crashes"))->read(VoxelKey{});
  };
  const auto ends = [](const char* how) {
    guard_plugin_calls(60);
    rogues().create<Exporter>("rogue_exporter", misdeed("end", how)).reset();
  };
  const std::string name = "lapwing: plugin '.*/rogue.so' ";
  const std::string help = ".*; try it alone: lapwing plugins check .*/rogue.so\n";
  EXPECT_EXIT(reads(), ::testing::ExitedWithCode(3), name + "crashed" + help);
  EXPECT_EXIT(ends("aborts"), ::testing::ExitedWithCode(3), name + "crashed .aborted." + help);
  EXPECT_EXIT(ends("exits"), ::testing::ExitedWithCode(3), name + "ended the program" + help);
}

std::string failure(const std::function<void()>& call) {
  try {
    call();
  } catch (const PluginError& error) {
    return std::string(error.what()) + "\n";
  }
  return "";
}

TEST(RoguePlugins, OfEveryKindThatThrowAreNamed) {
  for (const Deed& deed : deeds()) {
    const std::string says = std::string("plugin '") + deed.plugin + "' failed in " + deed.where +
                             ": no" + cure(deed.plugin);
    const Value given = misdeed(deed.where, "throws");
    if (deed.plugin == std::string("rogue_planner")) {  // these report, they do not throw
      EXPECT_EQ(plan_with(given).message + "\n", says);
    } else if (deed.plugin == std::string("rogue_tours")) {
      EXPECT_EQ(tour_with(given).message + "\n", says);
    } else {
      EXPECT_EQ(failure([&] { deed.call(given); }), says);
    }
  }
}

TEST(RoguePlugins, AnswersThatAreNoneAreNamed) {
  const auto solver = [](const char* where) {
    return failure([&] { solve_with(misdeed(where, "nan")); });
  };
  const std::string failed = "plugin 'rogue_solver' failed in solve: it reports 'optimal', but ";
  EXPECT_EQ(solver("solve"),
            failed + "'position' of stage 1 is not a finite number" + cure("rogue_solver"));
  EXPECT_EQ(solver("cost"), failed + "its cost is not a finite number" + cure("rogue_solver"));
  EXPECT_EQ(solver("size"), failed + "its point is not the problem's" + cure("rogue_solver"));
  const std::string term =
      failure([&] { state_problem(Value::map(), misdeed("evaluate", "nan"), Value::map()); });
  EXPECT_EQ(term,
            "plugin 'rogue_term' failed in evaluate: a value of near at 0 s is not a finite "
            "number" +
                cure("rogue_term"));
  const std::string utility = failure([&] { score_with(misdeed("values_of", "nan")); });
  EXPECT_NE(
      utility.find("plugin 'rogue_utility' failed in values_of: the utility of the view from"),
      std::string::npos)
      << utility;
  const std::string information = failure([&] {
    contributions_of({SeenVoxel{}}, *rogues().create<ViewInformation>(
                                        "rogue_information", misdeed("contributions", "nan")));
  });
  EXPECT_EQ(
      information,
      "plugin 'rogue_information' failed in contributions: a voxel 0.000000 m away tells nan; "
      "expected a finite number of at least 0" +
          cure("rogue_information"));
  EXPECT_EQ(plan_with(Value::map()).message + "\n",
            "plugin 'rogue_planner' failed in search: segment 1 of the planner's path is blocked" +
                cure("rogue_planner"));
  EXPECT_NE(tour_with(Value::map())
                .message.find("plugin 'rogue_tours' failed in search: the result of the "
                              "solver is not a tour"),
            std::string::npos);
}

// The same by the commands that a user types.
class RogueCommands : public CommandLine {
 protected:
  // A hover of 1 s with a solver or a term that misbehaves.
  static std::string hover(const std::string& more, const std::string& solver = "'iqp'") {
    return "return { kind = 'film', name = 'hover', options = {}, plan = function(run)\n"
           "  local p = run:problem { vehicle = run:vehicle('vehicles/solo'), duration = 1 }\n"
           "  p:add_model { type = 'quadrotor' }\n  p:add_cost { type = 'input_effort' }\n" +
           more + "  p:finish()\n  return run:plan { solution = run:solve(p, " + solver +
           ") }\nend }\n";
  }
  void ends(const std::vector<std::string>& arguments, const std::string& says) {
    std::vector<std::string> all{"--plugin-path", kRogues};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const Finished finished = run(all);
    EXPECT_EQ(finished.status, 3) << finished.err;
    EXPECT_NE(finished.err.find(says), std::string::npos) << finished.err;
    EXPECT_EQ(std::count(finished.err.begin(), finished.err.end(), '\n'), 1) << finished.err;
  }
};

class SlowRogueCommands : public RogueCommands {};

TEST_F(SlowRogueCommands, EndWithTheNameOfThePlugin) {
  const auto solver = [](const char* how) {
    return hover("",
                 std::string("{ type = 'rogue_solver', where = 'solve', how = '") + how + "' }");
  };
  write("shot.lua", solver("exits"));
  ends({"run", "shot.lua", "--quiet"},
       "plugin 'rogue_solver' ended the program in solve" + cure("rogue_solver"));
  write("shot.lua", solver("nan"));
  ends({"run", "shot.lua", "--quiet"}, "plugin 'rogue_solver' failed in solve: it reports");
  write("shot.lua",
        hover("  p:add_cost { type = 'rogue_term', where = 'bind', how = 'crashes' }\n"));
  ends({"run", "shot.lua", "--quiet"},
       "plugin 'rogue_term' crashed in bind (segmentation fault)" + cure("rogue_term"));
  ::setenv("LAPWING_CALL_LIMIT", "0.5", 1);
  write("shot.lua", solver("hangs"));
  ends({"run", "shot.lua", "--quiet"},
       "plugin 'rogue_solver' does not return from solve: it neither evaluates nor asks whether it "
       "was cancelled" +
           cure("rogue_solver"));
  ::unsetenv("LAPWING_CALL_LIMIT");
}

// What reports instead of throwing: a planner and a tour solver that break their promise.
TEST_F(RogueCommands, ASearchThatBreaksItsPromiseEndsTheMission) {
  write("way.lua",
        "return { kind = 'film', name = 'way', options = {}, plan = function(run)\n"
        "  local p = run:problem { vehicle = run:vehicle('vehicles/solo'), duration = 1,\n"
        "    environment = { boxes = { { lower = {-0.2, -6, 0}, upper = {0.2, 6, 4} } } } }\n"
        "  p:plan_way { from = {-5, 0, 2}, to = {5, 0, 2}, planner = 'rogue_planner' }\nend }\n");
  ends({"run", "way.lua", "--quiet"},
       "plugin 'rogue_planner' failed in search: segment 1 of the planner's path is blocked");
  write("hut.obj",
        "v -3 -2.5 0\nv 3 -2.5 0\nv 3 2.5 0\nv -3 2.5 0\nv -3 -2.5 4\nv 3 -2.5 4\nv 3 2.5 4\n"
        "v -3 2.5 4\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\nf 5 6 7 8\nf 4 3 2 1\n");
  write("hut.lua", R"(local scan = require "mission.scan"
return scan.of_mesh {
  name = "hut", input = "hut.obj", ground = true, safe_height = 7, reach = 8, resolution = 0.4,
  region = { lower = {-4, -3.5, -0.5}, upper = {4, 3.5, 4.5} },
  flights = { { pattern = "circle", height = 9, views = 8, reach = 4 } },
  usable = { range = 30 },
  camera = { width = 120, height = 90, focal = 70 },
  surface = { spacing = 0.5, cell = 0.6, trim = 1.2 },
  candidates = { most = 40, step = 3, distance_apart = 2 },
  motions = { coarse = 40, alpha = 0.2 }, tour = { budget = 60 },
}
)");
  const auto with = [](const std::string& option) {
    return std::vector<std::string>{"run", "hut.lua", "--quiet", "--set", option};
  };
  ends(with("tour.solver=rogue_tours"),
       "plugin 'rogue_tours' failed in search: the result of the solver is not a tour: view ");
  std::vector<std::string> maps = with("map.type=rogue_map");
  maps.insert(maps.end(), {"--set", "map.where=insert", "--set", "map.how=exits"});
  ends(maps, "plugin 'rogue_map' ended the program in insert" + cure("rogue_map"));
}

TEST_F(RogueCommands, ExportIsGuardedAsWell) {
  write("shot.lua", hover(""));
  run({"run", "shot.lua", "--out", "hop", "--quiet"});
  const auto with = [](const char* how) {
    return std::vector<std::string>{"export",   "hop/plan.json",
                                    "--format", std::string("rogue_exporter_") + how,
                                    "-o",       "plan.txt"};
  };
  ends(with("throws"), "failed in write: no" + cure("rogue_exporter_throws"));
  ends(with("crashes"), "crashed in write (segmentation fault)" + cure("rogue_exporter_crashes"));
  ends(with("exits"), "ended the program in write" + cure("rogue_exporter_exits"));
  ::setenv("LAPWING_CALL_LIMIT", "0.5", 1);
  ends(with("hangs"), "does not return from write" + cure("rogue_exporter_hangs"));
  EXPECT_FALSE(fs::exists(folder_ / "plan.txt"));
  // 0.8 s in which the process does not work count as a third of that.
  std::vector<std::string> waits = with("waits");
  waits.insert(waits.begin(), {"--plugin-path", kRogues});
  EXPECT_EQ(run(waits).status, 0);
  EXPECT_TRUE(fs::exists(folder_ / "plan.txt"));
  ::unsetenv("LAPWING_CALL_LIMIT");
}

// A library that was cut off: the loader itself crashes on it.
TEST_F(RogueCommands, ALibraryThatWasCutOffIsNamed) {
  const fs::path library = fs::canonical(folder_) / "cut/rogue.so";
  fs::create_directories(library.parent_path());
  fs::copy_file(kRogues + "/rogue.so", library);
  fs::resize_file(library, fs::file_size(library) / 3);
  fs::copy_file(kRogues + "/rogue.json", folder_ / "cut/rogue.json");
  write("shot.lua", hover("  p:add_cost { type = 'rogue_term' }\n"));
  const Finished finished = run({"--plugin-path", "cut", "run", "shot.lua", "--quiet"});
  EXPECT_EQ(finished.status, 3) << finished.err;
  EXPECT_EQ(finished.err, "lapwing: plugin '" + library.string() +
                              "' crashed in dlopen (bus error)" + cure(library.string()));
}

}  // namespace
}  // namespace lapwing
