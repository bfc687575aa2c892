// SPDX-License-Identifier: Apache-2.0
// lapwing scene view: a mesh file, or a scene that a Lua script makes.
#include <iostream>

#include "framework/app/command_line.h"
#include "framework/app/completion_names.h"
#include "framework/app/exploration_worlds.h"
#include "framework/app/output_target.h"
#include "framework/config/shipped.h"
#include "framework/core/files.h"
#include "framework/core/number_text.h"
#include "framework/core/visible_text.h"
#include "framework/export/scene_report.h"
#include "framework/geometry/mesh_file.h"
#include "framework/mission/scene_script.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

// A script where it is, or by its name in scripts/scene.
fs::path script_of(const fs::path& file) {
  if (file.extension() == ".lua" && fs::exists(file)) return file;
  fs::path shipped = shipped_folder("scripts") / "scene" / file;
  shipped.replace_extension(".lua");
  return !file.has_extension() && fs::exists(shipped) ? shipped : fs::path();
}

UpAxis axis_of_option(const std::string& up) {
  try {
    return up_axis(up);
  } catch (const InputError& error) {
    throw InputError(std::string("--") + error.what());
  }
}

MeshFileOptions mesh_options(const SceneStatement& stated) {
  if (stated.seed) throw InputError("--seed is for scenes of a script, not for a mesh file");
  MeshFileOptions options;
  if (stated.unit && !(*stated.unit > 0))
    throw InputError("--unit: expected a number of metres above 0, got " +
                     plain_number(*stated.unit));
  options.unit = stated.unit;
  if (!stated.up.empty()) options.up = axis_of_option(stated.up);
  return options;
}

void warn_of_doubt(const MeshFile& read, const std::string& name) {
  if (read.doubt.empty()) return;
  std::cerr << "lapwing: warning: " << visible_line(name + ": " + read.doubt) << "\n";
}

// Neither a script nor a file with an ending: a name that is none of the shipped scenes.
void require_an_ending(const fs::path& file) {
  if (file.extension() == ".lua") throw InputError("'" + file.string() + "' not found");
  if (file.has_extension()) return;
  throw InputError(no_scene(file.string()) + ", no script and no mesh file");
}

}  // namespace

ExitStatus view_scene(const fs::path& file, const SceneStatement& stated, const fs::path& target,
                      const Invocation& invocation) {
  require_output(target, {file});
  SceneReport shown;
  shown.threads = std::max(1, invocation.threads);
  const fs::path script = script_of(file);
  if (script.empty()) {
    require_an_ending(file);
    const MeshFile read = read_mesh(file, mesh_options(stated));
    shown.title = file.filename().string();
    shown.origin = read.description();
    warn_of_doubt(read, shown.title);
    const MeshScene scene(read.mesh, shown.title);
    write_file_atomically(target, render_html(scene_report(scene, shown)));
    return ExitStatus::done;
  }
  if (stated.unit || !stated.up.empty())
    throw InputError(
        "--unit and --up are for mesh files; the scene of a script is in metres, z up");
  const std::uint64_t seed = stated.seed.value_or(invocation.seed);
  const Registry registry = invocation.registry();
  MissionSettings settings;
  settings.scripts = shipped_folder("scripts");
  settings.configs = shipped_folder("configs");
  settings.registry = &registry;
  Value options = Value::map();
  options.set("seed", static_cast<std::int64_t>(seed));
  GeneratedScene made = generate_scene(script, options, settings);
  shown.title = made.name;
  shown.origin = "seed " + std::to_string(seed);
  shown.region = made.region;
  const MeshScene scene(std::move(made.mesh), made.name);
  write_file_atomically(target, render_html(scene_report(scene, shown)));
  return ExitStatus::done;
}

}  // namespace lapwing
