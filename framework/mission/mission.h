// SPDX-License-Identifier: Apache-2.0
// A mission: a Lua script that states what is to be planned, and the plan that comes of it.
//
//   Mission mission("shot.lua", settings);        // runs the script's text; nothing is solved
//   mission.configure(layers, overrides);          // effective options, checked
//   MissionResult result = mission.plan();         // calls the script's plan function
//
// A script returns {kind, name, options, plan = function(run) ... end}; see README.md for what it
// may call. Not thread-safe; one mission per thread.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "framework/mission/map_work.h"
#include "framework/mission/options.h"
#include "framework/mission/run.h"
#include "framework/trajectory/fleet.h"

namespace lapwing {

struct FleetResult;
struct ExplorationRecord;  // export/exploration_report.h
struct KeptTour;           // scan_look.h
struct ScanRecord;         // export/scan_report.h

struct MissionResult {
  // Of a mapping mission, which returns a map and has no plan; else null.
  std::shared_ptr<const Mapping> mapping;
  // Of a mission of several batteries, which returns a fleet: `plan` has no flight; else null.
  std::shared_ptr<FleetResult> fleet;
  Plan plan;  // without certificate
  SolveReport report;
  std::string solver;
  double solve_seconds = 0;               // wall clock, all solves together
  std::vector<std::string> notes;         // sentences for the user
  std::vector<std::string> details = {};  // likewise, of what was tried and came to nothing
  Value block;                            // the kind's own figures, null or a map
  std::string block_name = {};            // of them in the answer; "": the kind
  std::vector<Pilot> pilots;              // who fly it by hand, in simulation
  std::vector<std::string> told = {};     // likewise, that stand in no plan
  // Of the report, beside those of every flight: those that are made already, and those that
  // sections_of draws; null where there are none of these.
  std::vector<Section> sections = {};
  std::function<std::vector<Section>(const Plan&)> late_sections = {};
  std::shared_ptr<const ScanRecord> scan = {};  // of a scan: what all its tours were planned on
  std::shared_ptr<const KeptTour> kept = {};    // of a tour of a scan, where it is asked for
  std::shared_ptr<const ExplorationRecord> exploration = {};  // of an exploration: how it went
  // Where the files lie that the plan's environment names, as long as the mission lives; and their
  // names.
  std::filesystem::path obstacle_folder = {};
  std::vector<std::string> obstacle_files = {};
};

// The fleet document, its plans without files' checksums, and one result for each of its tours.
struct FleetResult {
  Fleet document;
  std::vector<MissionResult> tours;
};

// All sections of its report. Pictures of a scan take longer than its certificate, so that they are
// drawn where a report is written, and only there.
std::vector<Section> sections_of(const MissionResult& result);

class Mission {
 public:
  // InputError, with the script's file and line, when the file cannot be read, does not compile,
  // breaks a limit or returns no mission.
  Mission(const std::filesystem::path& script, MissionSettings settings);
  ~Mission();

  const std::string& name() const;
  const std::string& kind() const;

  // Lays configurations and `key=value` overrides on the script's options and checks them against
  // what the mission declares. InputError with all errors. A file named by an override of `input`
  // is one that the script may read. Keys `sandbox.*` are taken for limits and must be given to
  // `sandbox_limits` before.
  void configure(std::span<const Value> layers, std::span<const std::string> overrides);
  // What --set may be given, for whoever completes it. InputError for an unknown plugin.
  std::vector<SettableOption> settable() const;
  // What its options are declared as: the list that `lapwing.options` took, or one made of the
  // options of a script that declares none.
  Value declarations() const;
  // Effective options; every value with its origin.
  const Value& configuration() const;

  // Calls the script's plan function up to where planning begins: whatever it finds wrong before,
  // `plan` finds as well, with the same message. Files that the mission names are read. InputError.
  void judge();
  // Where the files lie that its environment names, as far as it was stated by `plan`, `judge` or
  // `state`; as long as the mission lives.
  const std::filesystem::path& obstacle_folder() const;
  // Whether the last `plan` or `judge` came to where planning begins.
  bool planning_began() const;

  // Calls the script's plan function up to its first plan, with nothing solved: what a film's first
  // attempt would solve, and be judged by. A `stretch` that is sought is 1. InputError likewise,
  // and where the mission makes no plan of one problem.
  MissionStatement state();

  // Calls the script's plan function. InputError for errors of the script; everything that a solver
  // has to say is in the result.
  MissionResult plan();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// The limits that configurations and overrides ask for. InputError when malformed.
SandboxLimits sandbox_limits(std::span<const Value> layers, std::span<const std::string> overrides);

}  // namespace lapwing
