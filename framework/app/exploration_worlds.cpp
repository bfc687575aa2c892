// SPDX-License-Identifier: Apache-2.0
#include "framework/app/exploration_worlds.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>

#include "framework/app/command_options.h"
#include "framework/app/completion_names.h"
#include "framework/config/overrides.h"
#include "framework/config/shipped.h"
#include "framework/core/checksum.h"
#include "framework/core/log.h"
#include "framework/core/number_text.h"
#include "framework/core/units.h"
#include "framework/study/study_settings.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestName = 150;  // of 255 that file systems allow; more is added

std::uint64_t seed_of(const std::string& text, const std::string& given) {
  std::uint64_t seed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  if (error != std::errc{} || end != text.data() + text.size())
    throw InputError("world '" + given +
                     "': expected NAME, NAME:SEED, NAME:FIRST-LAST, FILE or FILE@X,Y,Z");
  return seed;
}

Eigen::Vector3d place_of(const std::string& text, const std::string& given) {
  Eigen::Vector3d place;
  const char* at = text.data();
  const char* const last = text.data() + text.size();
  bool good = true;
  for (int i = 0; i < 3 && good; ++i) {
    const auto [end, error] = std::from_chars(at, last, place[i]);
    good = error == std::errc{} && std::isfinite(place[i]) &&
           (i < 2 ? end != last && *end == ',' : end == last);
    at = end + (i < 2);
  }
  if (!good)
    throw InputError("world '" + given + "': expected FILE@X,Y,Z with a place in metres within it");
  return place;
}

}  // namespace

std::string WorldName::text() const {
  const fs::path path(scene);
  if (!path.has_extension()) return scene + " " + std::to_string(seed);
  if (path.extension() == ".lua") return path.filename().string() + " " + std::to_string(seed);
  return path.filename().string() + (inside_text.empty() ? "" : "@" + inside_text);
}

bool WorldName::is_mesh() const {
  const fs::path file(scene);
  return file.has_extension() && file.extension() != ".lua";
}

fs::path WorldName::file() const {
  const fs::path path(scene);
  if (path.has_extension()) return path;
  fs::path script = shipped_folder("scripts") / "scene" / path;
  script += ".lua";
  return script;
}

std::vector<WorldName> distinct_worlds(const std::vector<std::string>& given,
                                       const std::string& command) {
  std::vector<WorldName> names;
  std::map<std::string, std::string> taken;
  for (const std::string& one : given)
    for (WorldName& name : world_names(one)) {
      const auto [found, fresh] = taken.emplace(file_text(name.text()), one);
      if (found->first.size() > kLongestName)
        throw InputError(command + ": the name of world '" + name.text() + "' is too long for " +
                         "files that are named after it: rename it");
      if (!fresh)
        throw InputError(command + ": the worlds '" + found->second + "' and '" + one +
                         "' would both have the name '" + name.text() +
                         "': name each once, and files of one name one after the other, into "
                         "folders of their own");
      names.push_back(std::move(name));
    }
  if (names.empty()) throw InputError(command + ": name a world with --world NAME[:FIRST-LAST]");
  return names;
}

std::vector<WorldName> world_names(const std::string& given) {
  const std::size_t mark = given.rfind('@');
  if (mark != given.npos && !fs::exists(given)) {
    const std::string text = given.substr(mark + 1);
    const fs::path file = given.substr(0, mark);
    WorldName name{file.string(), 1, place_of(text, given), text};
    // A cell of a table of comma-separated values.
    std::replace(name.inside_text.begin(), name.inside_text.end(), ',', ' ');
    if (!file.has_extension() || file.extension() == ".lua")
      throw InputError("world '" + given + "': @X,Y,Z is for mesh files; a scene has its region");
    return {name};
  }
  const std::size_t colon = given.rfind(':');
  if (colon == given.npos || given.find('/', colon) != given.npos)  // one in a folder's name
    return {WorldName{.scene = given}};
  const std::string name = given.substr(0, colon), seeds = given.substr(colon + 1);
  if (WorldName{.scene = name}.is_mesh())
    throw InputError("world '" + given +
                     "': seeds are for scenes and scripts; a mesh file has none");
  const std::size_t dash = seeds.find('-');
  const std::uint64_t first = seed_of(seeds.substr(0, dash), given);
  const std::uint64_t last = dash == seeds.npos ? first : seed_of(seeds.substr(dash + 1), given);
  if (last < first || last - first > 10'000)
    throw InputError("world '" + given +
                     "': the last seed is below the first, or too far above it");
  std::vector<WorldName> names;
  if (last > kLargestSeed)
    throw InputError("world '" + given + "': expected seeds up to " + std::to_string(kLargestSeed));
  for (std::uint64_t seed = first; seed <= last; ++seed)
    names.push_back({.scene = name, .seed = seed});
  return names;
}

void require_world(const WorldName& name, const std::string& up) {
  if (!up.empty()) up_axis(up);
  if (!up.empty() && !name.is_mesh())
    throw InputError("--up is for mesh files, not for '" + name.scene + "'");
  if (fs::exists(name.file())) return;
  if (name.is_mesh()) throw InputError("'" + name.file().string() + "' not found");
  throw InputError(no_scene(name.scene) + " and no file");
}

World load_world(const WorldName& name, const std::string& up, const Registry& registry,
                 const Invocation& invocation) {
  require_world(name, up);
  if (name.is_mesh()) {
    const fs::path file(name.scene);
    MeshFileOptions options;
    if (!up.empty()) options.up = up_axis(up);
    MeshFile read = read_mesh(file, options);
    if (!read.doubt.empty()) logging::warning(file.string() + ": " + read.doubt);
    if (name.inside) {
      auto scene = std::make_shared<MeshScene>(std::move(read.mesh), name.text());
      const Eigen::AlignedBox3d region = scene->mesh().bounds();
      return {name.text(), std::move(scene), region, name.inside};
    }
    OpenWorld open = with_floor(std::move(read.mesh));
    return {name.text(), std::make_shared<MeshScene>(std::move(open.mesh), name.text()),
            open.region, std::nullopt};
  }
  GeneratedScene made = made_world(name, registry, invocation);
  return {name.text(), std::make_shared<MeshScene>(std::move(made.mesh), name.text()), made.region,
          std::nullopt};
}

GeneratedScene made_world(const WorldName& name, const Registry& registry,
                          const Invocation& invocation) {
  MissionSettings settings;
  settings.scripts = shipped_folder("scripts");
  settings.configs = shipped_folder("configs");
  settings.data = invocation.data;
  settings.registry = &registry;
  // No option of these commands could raise it, and a machine with much else to do is slow.
  settings.limits.seconds = 600;
  Value options = Value::map();
  options.set("seed", static_cast<std::int64_t>(name.seed));
  return generate_scene(name.file(), options, settings);
}

std::string checksum(const GeneratedScene& scene) {
  std::string bytes;
  const auto add = [&](const auto* first, std::size_t count) {
    bytes.append(reinterpret_cast<const char*>(first), count * sizeof *first);
  };
  for (const Eigen::Vector3d& corner : {scene.region.min(), scene.region.max()})
    add(corner.data(), 3);
  for (const Eigen::Vector3d& vertex : scene.mesh.vertices) add(vertex.data(), 3);
  for (const auto& triangle : scene.mesh.triangles) add(triangle.data(), 3);
  return sha256(bytes);
}

GroundTruth ExplorationSetup::truth_of(const World& world) const {
  try {
    return {world.scene, world.region, map.at("resolution").as_number(), world.inside};
  } catch (const InputError& error) {
    throw InputError("world '" + world.name + "': " + error.what());
  }
}

ExplorationSetup::ExplorationSetup() : map(Value::map()) {
  map.set("observations", true);
  set_mapping({});
}

Value ExplorationSetup::set_mapping(const std::vector<std::string>& given) {
  Value mapping = Value::map();
  for (const std::string& text : given) apply_override(mapping, text, "--mapping");
  const Parameters p = check(
      ParameterTable()
          .integer("width", 160, "pixels", between(1, 2000))
          .integer("height", 120, "pixels", between(1, 2000))
          .number("view_deg", 90, "deg", "angle across the image", between(1, 170))
          .number("pitch_deg", -10, "deg", "of every view, positive up", between(-89, 89))
          .number("range", EpisodeSettings().sensor.range, "m", "largest depth", between(0.1, 1000))
          .number("resolution", 0.4, "m", "edge of a voxel", between(0.01, 10))
          .number("hit", 0.9, "", "occupancy probability of a voxel with a measured point",
                  between(0.501, 0.999))
          .number("miss", 0.1, "", "occupancy probability of a voxel that a ray passed",
                  between(0.001, 0.499)),
      mapping, "");
  episode.sensor.pinhole =
      centered_pinhole(static_cast<int>(p.integer("width")), static_cast<int>(p.integer("height")),
                       radians(p.number("view_deg")));
  episode.sensor.range = p.number("range");
  pitch = radians(p.number("pitch_deg"));
  for (const char* key : {"resolution", "hit", "miss"}) map.set(key, p.number(key));
  map.set("maximum_range", episode.sensor.range);
  return p.value();
}

Value ExplorationSetup::set_moves(const std::vector<std::string>& given) {
  stated_moves = Value::map();
  for (const std::string& text : given) apply_override(stated_moves, text, "--moves");
  return recommend_moves(Value::map());
}

Value ExplorationSetup::recommend_moves(const Value& moves) {
  Value laid = Value::map();
  for (const char* key : {"step", "turn_deg", "body", "clear"})  // a study has no other moves
    if (const Value* value = moves.find(key)) laid.set(key, *value);
  merge(laid, stated_moves);
  const EpisodeSettings standard;
  const Parameters p =
      check(ParameterTable()
                .number("step", standard.step, "m", "to a neighbour", above(0))
                .number("turn_deg", standard.turn * 180 / EIGEN_PI, "deg", "to a neighbour",
                        between(1, 180))
                .number("body", standard.body, "m", "edge of the box that must be free", above(0))
                .number("clear", standard.clear, "m", "edge of the box that is free at the start",
                        above(0)),
            laid, "");
  episode.step = p.number("step");
  episode.turn = p.number("turn_deg") * EIGEN_PI / 180;
  episode.body = p.number("body");
  episode.clear = p.number("clear");
  return p.value();
}

InputError ExplorationSetup::with_options(const StartError& error, const std::string& world) const {
  return InputError("world '" + world + "': " + error.what() +
                    "; smaller moves may help: --moves " +
                    "clear=" + plain_number(std::max(episode.body, episode.clear / 2)) +
                    " --moves step=" + plain_number(episode.step / 2));
}

ObservedSurface::NewMap ExplorationSetup::new_map(const Registry& registry) const {
  return [&registry, type = backend, given = map] { return registry.create<Map>(type, given); };
}

std::shared_ptr<const WorldInUse> load_for_episodes(const WorldName& name, const std::string& up,
                                                    const ExplorationSetup& setup,
                                                    const Registry& registry,
                                                    const Invocation& invocation) {
  World world = load_world(name, up, registry, invocation);
  GroundTruth truth = setup.truth_of(world);
  return std::make_shared<const WorldInUse>(WorldInUse{std::move(world), std::move(truth)});
}

}  // namespace lapwing
