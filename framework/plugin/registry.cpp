// SPDX-License-Identifier: Apache-2.0
#include "framework/plugin/registry.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <tuple>

#include "framework/core/active_call.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/log.h"
#include "framework/plugin/library.h"
#include "framework/plugin/sidecar.h"

namespace lapwing {

namespace fs = std::filesystem;

namespace {

// Files with this extension in `folder` and one level below, sorted, so that errors repeat.
std::vector<fs::path> files_below(const fs::path& folder, std::string_view extension) {
  std::vector<fs::path> files;
  std::error_code code;
  fs::recursive_directory_iterator it(folder, fs::directory_options::skip_permission_denied, code);
  for (; !code && it != fs::recursive_directory_iterator(); it.increment(code)) {
    if (it.depth() >= 1) it.disable_recursion_pending();
    if (it->path().extension() == extension && it->is_regular_file(code)) {
      files.push_back(it->path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

bool is_older(const fs::path& a, const fs::path& b) {
  std::error_code code_a, code_b;
  const auto time_a = fs::last_write_time(a, code_a);
  const auto time_b = fs::last_write_time(b, code_b);
  return !code_a && !code_b && time_a < time_b;
}

std::string in_quotes(std::string_view text) {
  return "'" + std::string(text) + "'";
}

// The sidecar in `file`; none, with a warning, where the file is something else. A file beside a
// library of its name is meant to be one.
std::optional<Value> sidecar_in(const fs::path& file) {
  std::string why = "it has no key 'sidecar'";
  try {
    Value read = from_json(read_file(file), file.string());
    if (read.is_map() && read.find("sidecar")) return read;
  } catch (const InputError& error) {
    why = error.what();
  }
  if (fs::exists(fs::path(file).replace_extension(".so")))
    throw InputError("malformed plugin sidecar " + in_quotes(file.string()) + ": " + why);
  logging::warning(in_quotes(file.string()) +
                   " lies in a folder of plugins and is not a plugin's sidecar: " + why +
                   "; it is left out");
  return std::nullopt;
}

std::string without_its_library(const PluginEntry& entry, const fs::path& sidecar) {
  return in_quotes(sidecar.string()) + " describes " + in_quotes(entry.library.string()) +
         ", which does not exist: build the plugin again, or remove the sidecar";
}

}  // namespace

struct Registry::Impl {
  std::vector<fs::path> folders;
  std::vector<PluginEntry> entries;
  std::vector<fs::path> undescribed;        // libraries without a sidecar
  std::vector<PluginEntry> unbuilt;         // of sidecars without their library
  std::map<fs::path, fs::path> sidecar_of;  // by library
  mutable std::mutex mutex;
  mutable std::set<fs::path> compared;  // libraries whose sidecar was found true

  void read_folder(const fs::path& folder, std::set<fs::path>& seen);
  void read_sidecar(const fs::path& file);
  void refuse_duplicates() const;
  const PluginLibrary& open(const PluginEntry& entry) const;
  const PluginDescriptor& descriptor(const PluginEntry& entry) const;
};

void Registry::Impl::read_folder(const fs::path& folder, std::set<fs::path>& seen) {
  for (const fs::path& file : files_below(folder, ".json")) {
    std::error_code code;
    // The same folder may be on the path twice; two names of one file are no duplicate.
    if (seen.insert(fs::weakly_canonical(file, code)).second) read_sidecar(file);
  }
  for (const fs::path& file : files_below(folder, ".so")) {
    if (!sidecar_of.count(file)) undescribed.push_back(file);
  }
}

void Registry::Impl::read_sidecar(const fs::path& file) {
  const std::optional<Value> sidecar = sidecar_in(file);
  if (!sidecar) return;
  std::vector<PluginEntry> found = entries_from_sidecar(*sidecar, file);
  const fs::path library = found.front().library;
  if (!fs::exists(library)) {
    logging::warning("plugin sidecar " + without_its_library(found.front(), file) +
                     "; its plugins are left out");
    unbuilt.insert(unbuilt.end(), found.begin(), found.end());
    return;
  }
  sidecar_of[library] = file;
  entries.insert(entries.end(), found.begin(), found.end());
  // A library newer than its sidecar may have changed under it; only looking inside tells. A copied
  // tree passes here, because what is compared is what they say.
  if (is_older(file, library) && found.front().abi_tag == kAbiTag) open(found.front());
}

void Registry::Impl::refuse_duplicates() const {
  for (std::size_t i = 1; i < entries.size(); ++i) {
    const PluginEntry& a = entries[i - 1];
    const PluginEntry& b = entries[i];
    if (a.kind != b.kind || a.name != b.name) continue;
    throw InputError("two plugins of kind " + a.kind + " are named " + in_quotes(a.name) + ": " +
                     in_quotes(a.library.string()) + " and " + in_quotes(b.library.string()) +
                     "; remove one or rename it");
  }
}

const PluginLibrary& Registry::Impl::open(const PluginEntry& entry) const {
  require_abi_tag(entry.abi_tag, entry.library);
  const PluginLibrary& library = open_library(entry.library);
  const std::lock_guard<std::mutex> lock(mutex);
  if (compared.count(entry.library)) return library;
  const fs::path& file = sidecar_of.at(entry.library);
  const Value written = from_json(read_file(file), file.string());
  if (!(from_json(to_json(describe_as_value(entry.library)), "") == written)) {
    throw InputError(
        "plugin sidecar '" + file.string() + "' does not describe '" + entry.library.string() +
        "' in its present version; rebuild the plugin, or run lapwing_sidecar on both");
  }
  compared.insert(entry.library);
  return library;
}

const PluginDescriptor& Registry::Impl::descriptor(const PluginEntry& entry) const {
  const PluginLibrary& library = open(entry);
  const std::string& name = entry.preset_of.empty() ? entry.name : entry.preset_of;
  for (std::size_t i = 0; i < library.count; ++i) {
    const PluginDescriptor& candidate = library.descriptors[i];
    if (entry.kind == candidate.kind && name == candidate.text.name) return candidate;
  }
  throw Error("a sidecar that equals its library names a plugin that the library lacks");
}

Registry::Registry(std::vector<fs::path> folders) : impl_(std::make_unique<Impl>()) {
  impl_->folders = std::move(folders);
  std::set<fs::path> seen;
  for (const fs::path& folder : impl_->folders) impl_->read_folder(folder, seen);
  std::stable_sort(impl_->entries.begin(), impl_->entries.end(),
                   [](const PluginEntry& a, const PluginEntry& b) {
                     return std::tie(a.kind, a.name) < std::tie(b.kind, b.name);
                   });
  impl_->refuse_duplicates();
}

Registry::~Registry() = default;
Registry::Registry(Registry&&) noexcept = default;

const std::vector<fs::path>& Registry::folders() const {
  return impl_->folders;
}
const std::vector<PluginEntry>& Registry::entries() const {
  return impl_->entries;
}

const PluginEntry& Registry::find(std::string_view kind, std::string_view name,
                                  const Origin& origin) const {
  std::vector<std::string> known;
  std::string list;
  std::string elsewhere;
  for (const PluginEntry& entry : impl_->entries) {
    if (entry.kind != kind) {
      if (entry.name == name) elsewhere = entry.kind;
      continue;
    }
    if (entry.name == name) return entry;
    known.push_back(entry.name);
    list += (list.empty() ? "" : ", ") + entry.name;
  }
  std::string message = "unknown " + std::string(kind) + " " + in_quotes(name);
  const std::string nearest = nearest_name(name, known);
  if (!nearest.empty()) message += "; did you mean " + in_quotes(nearest) + "?";
  if (!elsewhere.empty())
    message += "; there is a plugin of that name, but its kind is " + elsewhere;
  for (const PluginEntry& entry : impl_->unbuilt)
    if (entry.kind == kind && entry.name == name)
      message +=
          "; " + in_quotes(entry.library.string()) + " does not exist, only its sidecar does";
  for (const fs::path& library : impl_->undescribed) {
    if (library.stem() != name) continue;
    message += "; " + in_quotes(library.string()) + " has no sidecar: run lapwing_sidecar on it";
  }
  if (list.empty()) {
    message += "; no plugin of that kind was found in";
    for (const fs::path& folder : impl_->folders) message += " " + in_quotes(folder.string());
  } else {
    message += "; known: " + list + "; --plugin-path FOLDER adds a folder of your plugins";
  }
  throw InputError(origin, message);
}

void* Registry::create_untyped(std::string_view kind, std::string_view name, const Value& given,
                               const std::string& key_path) const {
  const PluginEntry& entry = find(kind, name, given.origin());
  const Parameters parameters = check(entry.parameters, given, key_path);
  const PluginDescriptor& descriptor = impl_->descriptor(entry);
  const char* const known = lasting_name(kind, name);
  const ActiveCall mark(known, "create");
  void* created = call_plugin(known, "create", [&] { return descriptor.create(parameters); });
  if (!created) throw plugin_failure(known, "create", "it returned null");
  return created;
}

const char* Registry::lasting_name(std::string_view kind, std::string_view name) const {
  for (const PluginEntry& entry : impl_->entries)
    if (entry.name == name && entry.kind != kind)
      return lasting_text(std::string(kind) + "/" + std::string(name));
  return lasting_text(name);
}

const void* Registry::extension(std::string_view kind, std::string_view name,
                                std::string_view id) const {
  const PluginEntry& entry = find(kind, name);
  // The sidecar answers "no" without loading code.
  if (std::find(entry.extensions.begin(), entry.extensions.end(), id) == entry.extensions.end()) {
    return nullptr;
  }
  const PluginDescriptor& descriptor = impl_->descriptor(entry);
  const char* const known = lasting_name(kind, name);
  const ActiveCall mark(known, "extensions");
  for (const Extension& extension : call_plugin(known, "extensions", descriptor.extensions)) {
    if (extension.id == id) return extension.table;
  }
  return nullptr;
}

}  // namespace lapwing
