#include "framework/app/exploration_settings.h"

#include "framework/core/checksum.h"
#include "framework/core/files.h"
#include "framework/core/json.h"

namespace lapwing {

namespace fs = std::filesystem;

Value checksums_of(const std::vector<WorldName>& worlds, const std::vector<std::string>& utilities,
                   const Value& parameters, const Registry& registry,
                   const Invocation& invocation) {
  constexpr std::size_t kMost = std::size_t{4} << 30;
  Value files = Value::map();
  const auto keep = [&](const std::string& name, const fs::path& path) {
    if (fs::is_regular_file(path)) files.set(name, sha256(read_file(path, kMost)));
  };
  for (const WorldName& world : worlds)
    if (world.is_mesh())
      keep(world.text(), world.file());
    else
      files.set(world.text(), checksum(made_world(world, registry, invocation)));
  for (const std::string& utility : utilities) {
    const fs::path library = registry.find("utility", utility).library;
    keep(utility + ".library", library);
    keep(utility, fs::path(library).replace_extension("model"));
    const Value* given = parameters.find(utility);
    if (!given || !given->is_map()) continue;
    for (const auto& [key, value] : given->as_map())
      if (value.is_text()) keep(utility + "." + key, value.as_text());
  }
  return files;
}

std::string settings_difference(const Value& there, const Value& here) {
  if (!there.is_map()) return "nothing there says how";
  for (const Value* one : {&here, &there})
    for (const auto& [key, ignored] : one->as_map()) {
      if (key == "files") continue;
      const Value *a = there.find(key), *b = here.find(key);
      if (!a || !b || !(*a == *b))
        return key + " is " + (a ? to_json(*a, -1) : "not said") + " there, " +
               (b ? to_json(*b, -1) : "not said") + " here";
    }
  const Value* files = there.find("files");
  for (const auto& [name, sum] : here.at("files").as_map())
    if (const Value* before = files ? files->find(name) : nullptr; before && !(*before == sum))
      return "the file of " + name + " is another one";
  return "";
}

}  // namespace lapwing
