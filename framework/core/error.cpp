// SPDX-License-Identifier: Apache-2.0
#include "framework/core/error.h"

#include <new>

namespace lapwing {

std::string Origin::to_string() const {
  return line > 0 ? source + ":" + std::to_string(line) : source;
}

namespace {

// A message is read as a C string: a NUL in what it quotes would end it.
std::string with_visible_nul(std::string text) {
  for (std::size_t at = 0; (at = text.find('\0', at)) != text.npos; ++at)
    text.replace(at, 1, "\\0");
  return text;
}

std::string located(const Origin& origin, const std::string& message) {
  const std::string where = origin.to_string();
  return with_visible_nul(where.empty() ? message : where + ": " + message);
}

}  // namespace

InputError::InputError(const Origin& origin, const std::string& message)
    : Error(located(origin, message)) {}

void Diagnostics::add(const Origin& origin, const std::string& key_path,
                      const std::string& message) {
  lines_.push_back(located(origin, key_path.empty() ? message : key_path + ": " + message));
}

std::string Diagnostics::to_string() const {
  std::string text;
  for (const std::string& line : lines_) {
    if (!text.empty()) text += '\n';
    text += line;
  }
  return text;
}

void Diagnostics::throw_if_any() const {
  if (!empty()) throw InputError(to_string());
}

std::string cure_of_plugin(std::string_view plugin) {
  return "; try it alone: lapwing plugins check " + std::string(plugin);
}

PluginError plugin_failure(std::string_view plugin, std::string_view call,
                           const std::string& what) {
  const bool scarce = what == std::bad_alloc().what();
  const std::string where = "plugin '" + std::string(plugin) + "' failed in " + std::string(call);
  if (scarce)
    return PluginError(where +
                       ": out of memory: it needs more than the system or a limit "
                       "(ulimit -v) gives");
  return PluginError(where + ": " + what + cure_of_plugin(plugin));
}

}  // namespace lapwing
