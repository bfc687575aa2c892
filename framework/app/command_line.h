// SPDX-License-Identifier: Apache-2.0
// The `lapwing` command line: what may be asked, and how every command ends.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/value.h"
#include "framework/geometry/depth_camera.h"
#include "framework/items/item_run.h"
#include "framework/plugin/registry.h"
#include "framework/vehicle/controller.h"
#include "framework/vehicle/race_score.h"

namespace lapwing {

enum class ExitStatus {
  done = 0,           // and certified, where there is something to certify
  not_certified = 1,  // finished, but infeasible or not certified
  bad_input = 2,
  defect = 3,  // an internal error, or output that could not be written
  interrupted = 130,
  reader_gone = 141,  // standard output was a pipe that nobody read to its end: 128 + SIGPIPE
};

// What several commands understand.
struct Invocation {
  std::vector<std::filesystem::path> plugin_path;
  std::vector<std::string> configs;    // names or paths, lowest first
  std::vector<std::string> overrides;  // "key.path=value", in order
  std::vector<std::filesystem::path> data;
  std::filesystem::path from;  // a plan to begin from; empty: none
  std::filesystem::path out;   // empty: out/<mission>
  std::uint64_t seed = 1;
  int threads = 0;  // 0: as many as there are cores
  bool json = false;
  bool quiet = false;
  bool verbose = false;      // what was tried and came to nothing is said, too
  bool keep = false;         // an older run in the folder is kept under another name
  bool report_data = false;  // a run writes its report as data, too

  // Whoever has one may call plugins: from now on they are guarded (app/plugin_guard.h).
  Registry registry() const;
};

// Parses, runs one command, reports errors on standard error (and with --json as the one object on
// standard output), and returns an ExitStatus.
// Opens the controllers of its plugins when asked for one.
ControllerSource controllers_of(const Invocation& invocation);

int run_command_line(int argc, const char* const* argv);

// The commands. Each throws InputError for bad input and writes its result to standard output.
// "0.1.0"
const char* program_version();

ExitStatus run_mission(const std::filesystem::path& script, const Invocation& invocation);
ExitStatus show_configuration(const std::filesystem::path& script, const Invocation& invocation);
struct Judges;  // app/provenance.h
ExitStatus verify_plan(const std::filesystem::path& plan, const Judges& judges,
                       const Invocation& invocation);
// Flies a plan by the whole quadrotor; writes a report page to `target` unless that is empty.
struct SimulationRequest;  // app/simulation_request.h
ExitStatus simulate_plan(const std::filesystem::path& plan, const SimulationRequest& asked,
                         const std::filesystem::path& target, const Invocation& invocation);
// A plan that is not certified is refused unless `uncertified` asks for it.
struct ExportRequest {
  std::filesystem::path plan;
  std::string format;  // of --format
  std::filesystem::path target;
  bool uncertified = false;
  std::string origin;  // of --origin; "" for none
};
ExitStatus export_plan(const ExportRequest& asked, const Invocation& invocation);
ExitStatus show_map(const std::filesystem::path& file, const Invocation& invocation);
// By the ending of the target: .ot, .bt or .ply.
ExitStatus convert_map(const std::filesystem::path& file, const std::filesystem::path& target,
                       const Invocation& invocation);
ExitStatus view_map(const std::filesystem::path& file, const std::filesystem::path& target,
                    const Invocation& invocation);
// Each pilot: LOG[:key=value,...].
ExitStatus race_plan(const std::filesystem::path& plan, const std::vector<std::string>& pilots,
                     const RaceRules& rules, const std::filesystem::path& target,
                     const Invocation& invocation);

// What a study of scan tours compares; see study/scan_study.h.
struct ScanEvaluation {
  std::vector<std::filesystem::path> missions;
  std::vector<std::string> methods;  // none: all
  std::vector<std::uint64_t> seeds{1};
  std::vector<double> budgets;  // s; none: each mission's own
  std::optional<DepthNoise> noise;
  std::optional<double> range, incidence;  // m and rad, of the judge; none: those of planning
  double guard = 300;                      // s of wall clock for one solver
  bool photos = false;                     // render photographs and ask COLMAP to register them
  ItemOptions items;                       // an item is a row
};
ExitStatus evaluate_scan(const ScanEvaluation& asked, const Invocation& invocation);

// What is said of a scene beside its name.
struct SceneStatement {
  std::optional<std::uint64_t> seed;  // of a script
  std::optional<double> unit;         // m that one unit of a mesh file is
  std::string up;                     // of a mesh file: "x", "y", "z"; "": as the file says
};

// A mesh file, a Lua scene or the name of a shipped one.
ExitStatus view_scene(const std::filesystem::path& file, const SceneStatement& stated,
                      const std::filesystem::path& target, const Invocation& invocation);
ExitStatus list_plugins(const Invocation& invocation);
// With `markdown` the parameters as a table of a README.
ExitStatus show_plugin(const std::string& name, bool markdown, const Invocation& invocation);
ExitStatus show_plugin_path(const Invocation& invocation);
// InputError naming the nearest.
[[noreturn]] void refuse_unknown_plugin(const Registry& registry, const std::string& name);

// Writes one object and a line end to standard output.
void print_json(const Value& value);

// `status`; or, when something that was written to standard output did not arrive, `defect` with a
// message on standard error. Of a pipe that nobody reads from any more nothing is said: a status
// that tells of a failure stays, else it is `reader_gone`. To be called last.
int finish_output(int status);

}  // namespace lapwing
