// SPDX-License-Identifier: Apache-2.0
// What the bindings of one mission share: settings, files, effective options, and what was planned.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "framework/core/progress.h"
#include "framework/export/report.h"
#include "framework/mission/binding.h"
#include "framework/mission/data_files.h"
#include "framework/mission/obstacle_files.h"
#include "framework/mission/sandbox.h"
#include "framework/plugin/registry.h"
#include "framework/problem/trajectory_problem.h"
#include "framework/solve/trajectory_solver.h"
#include "framework/trajectory/plan.h"
#include "framework/vehicle/race_flight.h"

struct lua_State;

namespace lapwing {

struct ScriptTerm;  // script_terms.h

struct ExplorationRecord;  // export/exploration_report.h
struct TakenImage;         // likewise
class EpisodeReplay;       // explore/episode_replay.h
struct ScanRecord;         // export/scan_report.h
struct KeptTour;           // scan_look.h
struct ScanWork;           // scan_objects.h
struct TourDefinition;
class MeshScene;

// Graphs of views of the last scans that were planned, for a program that plans again and again. Of
// large ones the last alone.
struct ScanMemory {
  struct Entry {
    std::string key;   // what it was made from, as text
    std::string near;  // likewise, without what an estimate may differ in
    std::shared_ptr<const ScanWork> work;
  };
  std::deque<Entry> entries;  // the newest first
};

struct MissionSettings {
  SandboxLimits limits;
  std::uint64_t seed = 1;
  int threads = 1;                          // of maps and renderings; results are the same
  std::filesystem::path scripts;            // shipped; holds mission/film.lua
  std::filesystem::path configs;            // shipped; holds vehicles/solo.yaml
  std::vector<std::filesystem::path> data;  // --data and LAPWING_DATA
  const Registry* registry = nullptr;       // outlives the mission
  const CancellationToken* cancellation = nullptr;
  Progress* progress = nullptr;
  // Of explorations, for a viewer: when each voxel became occupied, and what each view was chosen
  // by.
  bool record_steps = false;
  // Of explorations, with `record_steps`: hears of each image, and may wait. May be null.
  std::function<void(const TakenImage&)> observe_image = nullptr;
  // Hears of what repeats the maps of an episode before it begins; it learns of each image before
  // `observe_image` does. With `episode_alone` the plan then ends with Cancelled. May be null.
  std::function<void(std::shared_ptr<EpisodeReplay>)> observe_episode = nullptr;
  bool episode_alone = false;
  bool keep_tours = false;  // of scans: what each tour was chosen from, for a viewer
  std::function<void(const std::string&)> print = [](const std::string&) {};
  // Hears of the script and of every module that it requires before they are read; may be null.
  std::function<void(const std::filesystem::path&)> observe_script;
  // A plan that scripts may begin from, as `run.start`; null for none.
  std::shared_ptr<const Plan> start;
  // A problem stated before, whose sparsity later ones may have (TrajectoryProblem::finish).
  std::shared_ptr<const TrajectoryProblem> like;
  // Sees every problem before it is solved, so that a study of solvers can keep it; may be null.
  std::function<void(std::shared_ptr<const TrajectoryProblem>)> observe_problem;
  // Sees the surfaces that depth images are taken of, which planning never does, and every tour
  // problem before it is solved; for studies of scans. What they throw ends the plan. May be null.
  std::function<void(std::shared_ptr<const MeshScene>)> observe_surface;
  std::function<void(const ScanWork&, const TourDefinition&)> observe_tour;
  // Hears what a scan comes to, once its tours are solved; the plan then ends with Cancelled, and
  // where a graph would have to be made it ends before. For estimates; may be null.
  std::function<void(const Value&)> observe_estimate = nullptr;
  // Hears where a scan's first flight takes its images and what they show of the ground; with
  // `first_flight_alone` the plan then ends with Cancelled. For viewers; may be null.
  std::function<void(const Value&)> observe_first_flight = nullptr;
  bool first_flight_alone = false;
  // Where scans keep their graph and find it again; null: nowhere. Whoever keeps it clears it when
  // the script, or a file that a mission has read, changes.
  std::shared_ptr<ScanMemory> scan_memory = nullptr;
};

// A problem being stated, then solved; Lua holds one or more references to it.
struct ProblemObject {
  std::shared_ptr<TrajectoryProblem> problem;
  bool finished = false;
  // Written in the script, recorded when the problem is finished.
  std::shared_ptr<std::vector<ScriptTerm>> terms = nullptr;
  std::vector<StatedConstraint> listed = {};  // constraints of plugins that plans name
};

struct SolutionObject {
  std::shared_ptr<TrajectoryProblem> problem;
  std::string solver;
  SolveResult result;
  std::vector<StatedConstraint> constraints = {};  // of the script, as they were solved with
  Value started_from = {};  // the plan that it began from: {mission, sha256}; null for none
};

// What several functions take beside plain data.
inline constexpr BoundField kVehicleObject[] = {{"vehicle", "lapwing.vehicle", "vehicle"}};

// What a mission asks for, before anything is solved.
struct MissionStatement {
  std::shared_ptr<const TrajectoryProblem> problem;
  std::shared_ptr<const TrajectorySolver> solver;
  std::string solver_name;
  std::optional<WarmStart> start;  // of the plan that the mission begins from
  Plan plan;                       // what would be judged; its motion is the first guess
  std::filesystem::path obstacle_folder = {};  // as of MissionResult
};

// What `plan` returns, beside what the plan document holds.
struct PlanObject {
  Plan plan;
  SolveReport report = {};
  std::string solver = {};
  std::vector<std::string> notes = {};    // sentences for the user
  std::vector<std::string> details = {};  // likewise, of what was tried and came to nothing
  Value block = {};                       // the kind's own figures; null or a map
  std::string block_name = {};            // of them in the answer; "": the kind
  std::vector<Pilot> pilots = {};         // who fly it by hand
  std::vector<std::string> told = {};     // likewise, that stand in no plan
  // As of MissionResult.
  std::vector<Section> sections = {};
  std::function<std::vector<Section>(const Plan&)> late_sections = {};
  std::shared_ptr<const ScanRecord> scan = {};                // of a scan: what it was planned on
  std::shared_ptr<const KeptTour> kept = {};                  // of a scan, where it is asked for
  std::shared_ptr<const ExplorationRecord> exploration = {};  // of an exploration: how it went
};

struct MissionRun {
  MissionSettings settings;
  DataFiles files;
  std::string name, kind;
  Value configuration = Value::map();
  double solve_seconds = 0;
  ObstacleFiles obstacles = {};
  bool takes_start = false;                   // the mission begins from a plan where one is given
  bool judging = false;                       // the plan function ends where planning would begin
  bool planning_began = false;                // since the plan function was called
  MissionStatement* stating = nullptr;        // the plan function ends where its first plan is made
  std::optional<GeodeticOrigin> origin = {};  // of the world frame, where the mission states it
  std::optional<Home> home = {};              // likewise, the take-off place
};

// Ends the plan function of a mission that is only judged; no error of anybody.
class PlanningBegins : public Error {
 public:
  PlanningBegins() : Error("planning begins") {}
};

// Likewise of one that is only stated, once it is.
class StatementMade : public Error {
 public:
  StatementMade() : Error("the mission is stated") {}
};

// Called first by every function that computes what a mission asks for, once its arguments are
// checked. Throws PlanningBegins where the mission is only judged.
void begin_planning(MissionRun& run);

// The run that a state belongs to.
MissionRun& run_of(lua_State* state);

// The place of an option's value, or of the script where nobody wrote it.
Origin place_of_option(lua_State* state, const std::string& path);

// Type names as error messages show them.
inline constexpr const char* kRunType = "run";
inline constexpr const char* kVehicleType = "vehicle";
inline constexpr const char* kProblemType = "problem";
inline constexpr const char* kSolutionType = "solution";
inline constexpr const char* kPlanType = "plan";
inline constexpr const char* kOptionsType = "lapwing.options";
inline constexpr const char* kDataFileType = "data_file";

// What a mission script returns.
inline constexpr BoundField kMissionParts[] = {
    {"kind", "string", "kind of the mission: film, race, ..."},
    {"name?", "string", "name of the mission; absent: the file name of the script"},
    {"options?", "lapwing.options|table", "declared options"},
    {"takes_start?", "boolean", "whether it begins from `run.start`, the plan of --from"},
    {"plan", "fun(run: lapwing.run): lapwing.plan|lapwing.map|lapwing.fleet",
     "called once the options are known"}};

// All that scripts are given.
void open_script_libraries(lua_State* state, MissionRun& run);
// Each adds its part: the table `lapwing`, and the types above.
void open_lapwing_library(lua_State* state, MissionRun& run);  // calls the next one
void open_data_library(lua_State* state);
void open_problem_library(lua_State* state);
void open_solve_library(lua_State* state);
void open_plan_library(lua_State* state);
void open_run_library(lua_State* state);
// Pushes the object `run` that the plan function receives.
void push_run(lua_State* state);
// The methods of `run`, for the type's table.
std::span<const Binding> problem_methods_of_run();   // vehicle, problem
std::span<const Binding> solving_methods_of_run();   // solve
std::span<const Binding> planning_methods_of_run();  // plan, certify

// Sections of a report from the key `sections` of the table at `index`; none where it lacks.
// InputError naming what is wrong in them, beginning with `what`.
inline constexpr BoundField kStatedSections = {
    "sections?", "table[]",
    "sections of the report: text, facts, tables, charts, drawings, images"};
std::vector<Section> stated_sections(lua_State* state, int index, const std::string& what);

// "iqp" or {type = "iqp", ...}, as options that choose a plugin are given.
struct PluginChoice {
  std::string type;
  Value parameters = Value::map();
};
PluginChoice plugin_choice(lua_State* state, int index, const std::string& what);

// The table argument at `index`, checked; keys in `without` are the caller's. The script's position
// is the origin of every value.
Parameters table_argument(lua_State* state, int index, const ParameterTable& table,
                          const std::string& what, std::span<const std::string_view> without = {});

}  // namespace lapwing
