// SPDX-License-Identifier: Apache-2.0
#include "framework/app/exploration_settings.h"

#include "framework/core/checksum.h"
#include "framework/core/files.h"

namespace lapwing {

namespace fs = std::filesystem;

WorldRecords records_of(const std::vector<WorldName>& worlds,
                        const std::vector<std::string>& utilities, const Value& parameters,
                        const ExplorationSetup& setup, const Registry& registry,
                        const Invocation& invocation) {
  constexpr std::size_t kMost = std::size_t{4} << 30;
  WorldRecords records;
  Value& files = records.files;
  const auto keep = [&](const std::string& name, const fs::path& path) {
    if (fs::is_regular_file(path)) files.set(name, sha256(read_file(path, kMost)));
  };
  ExplorationSetup own = setup;
  const Value standard = own.recommend_moves(Value::map());
  for (const WorldName& world : worlds) {
    if (world.is_mesh()) {
      keep(world.text(), world.file());
      continue;
    }
    const GeneratedScene made = made_world(world, registry, invocation);
    files.set(world.text(), checksum(made));
    Value moves = own.recommend_moves(made.moves);
    if (!(moves == standard)) records.moves.set(world.text(), std::move(moves));
  }
  for (const std::string& utility : utilities) {
    const fs::path library = registry.find("utility", utility).library;
    keep(utility + ".library", library);
    keep(utility, library.parent_path() / (utility + ".model"));
    const Value* given = parameters.find(utility);
    if (!given || !given->is_map()) continue;
    for (const auto& [key, value] : given->as_map())
      if (value.is_text()) keep(utility + "." + key, value.as_text());
  }
  return records;
}

ExplorationSetup setup_of(const ExplorationSetup& setup, const WorldRecords& records,
                          const std::string& world) {
  ExplorationSetup own = setup;
  if (const Value* moves = records.moves.find(world)) own.recommend_moves(*moves);
  return own;
}

}  // namespace lapwing
