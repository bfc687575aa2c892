// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/mission.h"

#include <lua.hpp>

#include "framework/config/overrides.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/mission/explore_library.h"
#include "framework/mission/fleet_objects.h"
#include "framework/mission/guard.h"
#include "framework/mission/lua_value.h"
#include "framework/mission/map_objects.h"
#include "framework/mission/options.h"
#include "framework/mission/photo_objects.h"
#include "framework/mission/scan_objects.h"
#include "framework/mission/scene_script.h"
#include "framework/mission/script_lines.h"
#include "framework/mission/site_objects.h"
#include "framework/mission/term_recording.h"

namespace lapwing {

namespace {

constexpr const char* kSandboxKey = "sandbox";
constexpr const char* kPlanFunction = "lapwing.plan_function";

bool concerns_sandbox(const std::string& override_text) {
  return override_text.rfind("sandbox.", 0) == 0 || override_text.rfind("sandbox=", 0) == 0;
}

std::vector<std::filesystem::path> data_folders(const std::filesystem::path& script,
                                                const MissionSettings& settings) {
  std::vector<std::filesystem::path> folders;
  folders.push_back(script.parent_path().empty() ? "." : script.parent_path());
  folders.insert(folders.end(), settings.data.begin(), settings.data.end());
  folders.push_back(settings.configs);
  return folders;
}

// "my_race" of shots/my_race.lua, as a name may be.
std::string name_of_script(const std::filesystem::path& script) {
  std::string name = as_utf8(script.stem().string());
  for (char& letter : name)
    if (static_cast<unsigned char>(letter) < 0x20 || letter == 0x7f) letter = '_';
  return name;
}

// Before anything is computed.
void expect_start(const MissionRun& run) {
  if (!run.settings.start) return;
  if (!run.takes_start)
    throw InputError("--from: a mission of kind '" + run.kind + "' does not begin from a plan");
  const std::string& kind = run.settings.start->kind;
  if (kind != run.kind)
    throw InputError("--from: a plan of kind '" + kind + "'; this mission is of kind '" + run.kind +
                     "'");
  const std::string& name = run.settings.start->mission;
  if (name != run.name)
    throw InputError("--from: a plan of the mission '" + name + "'; this one is '" + run.name +
                     "' (with the same `name`, one begins from the other)");
}

}  // namespace

void open_script_libraries(lua_State* state, MissionRun& run) {
  open_lapwing_library(state, run);
  open_symbolic_types(state);
  open_symbolic_functions(state);
  open_stage_values(state);
  open_problem_library(state);
  open_solve_library(state);
  open_plan_library(state);
  open_run_library(state);
  open_map_library(state);
  open_site_library(state);
  open_photo_library(state);
  open_scan_library(state);
  open_fleet_library(state);
  open_explore_library(state);
  open_scene_library(state);
}

struct Mission::Impl {
  Impl(const std::filesystem::path& script_file, MissionSettings given)
      : script(script_file),
        run{given, DataFiles(data_folders(script_file, given)), "", "", Value::map(), 0, {}},
        sandbox(given.limits, given.seed, {given.scripts}, given.print) {
    sandbox.watch(given.cancellation);
    sandbox.watch_files(given.observe_script);
  }

  void load();
  void read_mission(lua_State* state);

  std::filesystem::path script;
  std::string script_text = {};
  MissionRun run;
  MissionOptions options;
  Sandbox sandbox;  // last: its state holds references to the run
};

void Mission::Impl::load() {
  script_text = read_file(script);  // what cannot be read has no line to blame
  sandbox.protect([this](lua_State* state) {
    open_script_libraries(state, run);
    sandbox.run_script(state, script);
    read_mission(state);
  });
}

// The script's result, on the stack.
void Mission::Impl::read_mission(lua_State* state) {
  const Origin origin = sandbox.script_position(state);
  constexpr const char* kShape =
      "a mission script returns {kind =, name =, options =, plan = function(run) ... end}";
  if (!lua_istable(state, -1)) {
    throw InputError(origin,
                     std::string(kShape) + "; this one returns " + luaL_typename(state, -1));
  }
  const int mission = lua_gettop(state);
  static constexpr std::string_view kParts[] = {"options", "plan"};
  ParameterTable table;
  table.required_text("kind", "kind of the mission: film, race, ...")
      .text("name", name_of_script(script),
            "name of the mission; absent: the file name of the script")
      .boolean("takes_start", false, "whether it begins from `run.start`, the plan of --from");
  const Parameters parts =
      check(table, value_from_lua(state, mission, origin, "mission", kParts), "mission");
  run.kind = parts.text("kind");
  run.name = parts.text("name");
  run.takes_start = parts.boolean("takes_start");
  if (run.name.empty()) throw InputError(origin, "name: expected a text that is not empty");
  for (const char c : run.name)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      throw InputError(origin, "name: a line break or another control character cannot be shown");
  if (lua_getfield(state, mission, "plan") != LUA_TFUNCTION) {
    throw InputError(origin, std::string(kShape) + "; plan is a " + luaL_typename(state, -1));
  }
  lua_setfield(state, LUA_REGISTRYINDEX, kPlanFunction);
  lua_getfield(state, mission, "options");
  if (const MissionOptions* declared = test_object<MissionOptions>(state, -1, kOptionsType)) {
    options = *declared;
    return;
  }
  options.given = value_from_lua(state, -1, origin, "options");
  claim_copies(state, options.given);
  if (options.given.is_null() || options.given == Value::list()) options.given = Value::map();
  if (!options.given.is_map()) {
    throw InputError(origin, "options: expected a table, got " + options.given.describe_type());
  }
  options.given.with_origin(origin);
  locate_in_result(options.given, script_text, "options");
  options.declarations = OptionDeclarations::from_options(options.given);
}

Mission::Mission(const std::filesystem::path& script, MissionSettings settings)
    : impl_(std::make_unique<Impl>(script, std::move(settings))) {
  impl_->load();
}

Mission::~Mission() = default;

const std::string& Mission::name() const {
  return impl_->run.name;
}
const std::string& Mission::kind() const {
  return impl_->run.kind;
}
const Value& Mission::configuration() const {
  return impl_->run.configuration;
}

std::vector<SettableOption> Mission::settable() const {
  return impl_->options.declarations.settable(impl_->run.configuration,
                                              *impl_->run.settings.registry);
}

Value Mission::declarations() const {
  return impl_->options.declarations.to_value();
}

void Mission::configure(std::span<const Value> layers, std::span<const std::string> overrides) {
  std::vector<Value> own_layers;
  for (const Value& layer : layers) {
    Value own = Value::map();
    own.with_origin(layer.origin());
    for (const auto& [key, value] : layer.as_map()) {
      if (key != kSandboxKey) own.set(key, value);
    }
    own_layers.push_back(impl_->options.declarations.spelled_out(std::move(own)));
  }
  std::vector<std::string> own_overrides;
  for (const std::string& text : overrides) {
    if (!concerns_sandbox(text))
      own_overrides.push_back(impl_->options.declarations.spelled_out(text));
  }
  const Value given = layered(impl_->options.declarations.spelled_out(impl_->options.given),
                              own_layers, own_overrides);
  impl_->run.configuration =
      impl_->options.declarations.check(given, *impl_->run.settings.registry);
  impl_->run.files.blame(impl_->run.configuration);
  const Value* input = impl_->run.configuration.find("input");
  const bool from_script = input && input->origin().source == impl_->sandbox.script();
  if (input && input->is_text() && !from_script) impl_->run.files.allow(input->as_text());
}

void Mission::judge() {
  MissionRun& run = impl_->run;
  struct Judging {
    explicit Judging(bool& flag) : judging(flag) { judging = true; }
    ~Judging() { judging = false; }
    bool& judging;
  } const judging(run.judging);
  try {
    plan();
  } catch (const PlanningBegins&) {
  } catch (const InputError&) {
    // A script that goes on after planning has begun fails for want of its results.
    if (!run.planning_began) throw;
  }
}

MissionStatement Mission::state() {
  MissionStatement statement;
  MissionRun& run = impl_->run;
  struct Stating {
    explicit Stating(MissionStatement*& place, MissionStatement& made) : stating(place) {
      stating = &made;
    }
    ~Stating() { stating = nullptr; }
    MissionStatement*& stating;
  } const stating(run.stating, statement);
  const auto made = [&] { return !statement.plan.kind.empty(); };
  try {
    plan();
  } catch (const StatementMade&) {
  } catch (const InputError&) {
    if (!made()) throw;  // else of a script that goes on after its plan was made
  }
  if (!made())
    throw InputError("a mission of kind '" + run.kind +
                     "' makes no plan of a problem that could be edited");
  statement.obstacle_folder = run.obstacles.folder();
  return statement;
}

const std::filesystem::path& Mission::obstacle_folder() const {
  return impl_->run.obstacles.folder();
}

bool Mission::planning_began() const {
  return impl_->run.planning_began;
}

namespace {

MissionResult result_of(const PlanObject& planned) {
  MissionResult result;
  result.plan = planned.plan;
  result.report = planned.report;
  result.solver = planned.solver;
  result.notes = planned.notes;
  result.details = planned.details;
  result.pilots = planned.pilots;
  result.block = planned.block;
  result.block_name = planned.block_name;
  result.told = planned.told;
  result.sections = planned.sections;
  result.scan = planned.scan;
  result.kept = planned.kept;
  result.exploration = planned.exploration;
  result.late_sections = planned.late_sections;
  return result;
}

MissionResult result_of(const FleetObject& made, const MissionRun& run) {
  MissionResult result;
  result.fleet = std::make_shared<FleetResult>();
  result.fleet->document = made.document;
  for (const PlanObject& plan : made.plans) result.fleet->tours.push_back(result_of(plan));
  result.plan.mission = run.name;
  result.plan.kind = run.kind;
  result.plan.configuration = run.configuration;
  result.report = made.report;
  result.solver = made.solver;
  result.notes = made.notes;
  result.told = made.told;
  result.block = made.block;
  result.block_name = "tour";
  result.scan = made.scan;
  result.late_sections = made.late_sections;
  return result;
}

}  // namespace

std::vector<Section> sections_of(const MissionResult& result) {
  std::vector<Section> sections = result.sections;
  if (!result.late_sections) return sections;
  for (Section& section : result.late_sections(result.plan)) sections.push_back(std::move(section));
  return sections;
}

MissionResult Mission::plan() {
  MissionResult result;
  Impl& impl = *impl_;
  impl.run.planning_began = false;
  expect_start(impl.run);
  impl.sandbox.protect([&](lua_State* state) {
    lua_getfield(state, LUA_REGISTRYINDEX, kPlanFunction);
    push_run(state);
    lua_call(state, 1, 1);
    if (const MapObject* mapped = test_object<MapObject>(state, -1, kMapType)) {
      result.mapping = mapped->mapping;
      result.plan.mission = impl.run.name;
      result.plan.kind = impl.run.kind;
      result.plan.configuration = impl.run.configuration;
      return;
    }
    if (const FleetObject* fleet = test_object<FleetObject>(state, -1, kFleetType)) {
      result = result_of(*fleet, impl.run);
      return;
    }
    const PlanObject* planned = test_object<PlanObject>(state, -1, kPlanType);
    if (!planned) {
      throw InputError(
          impl.sandbox.script_position(state),
          std::string(
              "plan: expected the function to return run:plan{...}, a map or a fleet, got ") +
              luaL_typename(state, -1));
    }
    result = result_of(*planned);
  });
  result.solve_seconds = impl.run.solve_seconds;
  result.obstacle_folder = impl.run.obstacles.folder();
  result.obstacle_files = impl.run.obstacles.files();
  if (result.fleet)
    for (MissionResult& tour : result.fleet->tours) {
      tour.obstacle_folder = result.obstacle_folder;
      tour.obstacle_files = result.obstacle_files;
    }
  return result;
}

SandboxLimits sandbox_limits(std::span<const Value> layers,
                             std::span<const std::string> overrides) {
  Value base = Value::map();
  for (const Value& layer : layers) {
    if (const Value* found = layer.find(kSandboxKey)) {
      Value own = Value::map();
      own.set(kSandboxKey, *found);
      merge(base, own);
    }
  }
  for (const std::string& text : overrides) {
    if (concerns_sandbox(text)) apply_override(base, text);
  }
  const Value* found = base.find(kSandboxKey);
  return sandbox_limits(check(sandbox_table(), found ? *found : Value::map(), kSandboxKey));
}

}  // namespace lapwing
