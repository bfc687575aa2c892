#include "framework/app/exploration_worlds.h"

#include <charconv>
#include <cmath>

#include "framework/config/overrides.h"
#include "framework/config/shipped.h"
#include "framework/geometry/mesh_file.h"
#include "framework/mission/scene_script.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

std::uint64_t seed_of(const std::string& text, const std::string& given) {
  std::uint64_t seed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  if (error != std::errc{} || end != text.data() + text.size())
    throw InputError("world '" + given + "': expected NAME, NAME:SEED, NAME:FIRST-LAST or a file");
  return seed;
}

}  // namespace

std::string WorldName::text() const {
  const fs::path path(scene);
  return path.has_extension() ? path.filename().string() : scene + " " + std::to_string(seed);
}

std::vector<WorldName> world_names(const std::string& given) {
  const std::size_t colon = given.rfind(':');
  if (colon == given.npos) return {{given, 1}};
  const std::string name = given.substr(0, colon), seeds = given.substr(colon + 1);
  const std::size_t dash = seeds.find('-');
  const std::uint64_t first = seed_of(seeds.substr(0, dash), given);
  const std::uint64_t last = dash == seeds.npos ? first : seed_of(seeds.substr(dash + 1), given);
  if (last < first || last - first > 10'000)
    throw InputError("world '" + given + "': the last seed lies before the first, or far beyond");
  std::vector<WorldName> names;
  for (std::uint64_t seed = first; seed <= last; ++seed) names.push_back({name, seed});
  return names;
}

World load_world(const WorldName& name, const Registry& registry, const Invocation& invocation) {
  const fs::path file(name.scene);
  if (file.has_extension() && file.extension() != ".lua") {
    OpenWorld open = with_floor(read_mesh(file).mesh);
    return {name.text(), std::make_shared<MeshScene>(std::move(open.mesh), name.text()),
            open.region};
  }
  fs::path script = file;
  if (!file.has_extension()) {
    script = shipped_folder("scripts") / "scene" / file;
    script += ".lua";
  }
  if (!fs::exists(script))
    throw InputError("'" + name.scene + "' is no scene of scripts/scene and no file");
  MissionSettings settings;
  settings.scripts = shipped_folder("scripts");
  settings.configs = shipped_folder("configs");
  settings.data = invocation.data;
  settings.registry = &registry;
  // No option of these commands could raise it, and a machine with much else to do is slow.
  settings.limits.seconds = 600;
  Value options = Value::map();
  options.set("seed", static_cast<std::int64_t>(name.seed));
  GeneratedScene made = generate_scene(script, options, settings);
  return {name.text(), std::make_shared<MeshScene>(std::move(made.mesh), name.text()), made.region};
}

ExplorationSetup::ExplorationSetup() : map(Value::map()) {
  constexpr int kWidth = 160, kHeight = 120;
  constexpr double kFocal = kWidth / 2.0;  // 90 degrees across
  pitch = -10 * EIGEN_PI / 180;
  episode.sensor.pinhole = {
      kWidth, kHeight, kFocal, kFocal, (kWidth - 1) / 2.0, (kHeight - 1) / 2.0};
  map.set("resolution", 0.4);
  map.set("hit", 0.9);
  map.set("miss", 0.1);
  map.set("maximum_range", episode.sensor.range);
  map.set("observations", true);
}

Value ExplorationSetup::set_moves(const std::vector<std::string>& given) {
  Value moves = Value::map();
  for (const std::string& text : given) apply_override(moves, text);
  const Parameters p =
      check(ParameterTable()
                .number("step", episode.step, "m", "to a neighbour", above(0))
                .number("turn_deg", episode.turn * 180 / EIGEN_PI, "deg", "to a neighbour",
                        between(1, 180))
                .number("body", episode.body, "m", "edge of the box that must be free", above(0))
                .number("clear", episode.clear, "m", "edge of the box that is free at the start",
                        above(0)),
            moves, "moves");
  episode.step = p.number("step");
  episode.turn = p.number("turn_deg") * EIGEN_PI / 180;
  episode.body = p.number("body");
  episode.clear = p.number("clear");
  return moves;
}

ObservedSurface::NewMap ExplorationSetup::new_map(const Registry& registry) const {
  return [&registry, type = backend, given = map] { return registry.create<Map>(type, given); };
}

}  // namespace lapwing
