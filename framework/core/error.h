// SPDX-License-Identifier: Apache-2.0
// Errors and collected diagnostics.
//
// Exceptions are for bad input and for defects; outcomes of solvers are values (solve/report). An
// input error says what was wrong, where, and what would be right; the command line answers it with
// exit status 2. Everything else that escapes is a defect: exit status 3.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace lapwing {

// Where a value was written. `source` is a file path as the user typed it, "--set" or "default";
// `line` counts from 1, 0 where there is none.
struct Origin {
  std::string source;
  int line = 0;

  // "shot.lua:12", "--set", or "" when unknown.
  std::string to_string() const;
  bool operator==(const Origin&) const = default;
};

class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Something the user wrote or gave is wrong.
class InputError : public Error {
 public:
  using Error::Error;
  InputError(const Origin& origin, const std::string& message);
};

// An exception that escaped from a plugin, named with the plugin and the call that it ended.
class PluginError : public Error {
 public:
  using Error::Error;
};

// The user asked to stop and there is nothing worth keeping.
class Cancelled : public Error {
 public:
  Cancelled() : Error("cancelled") {}
};

// Collects every error of an input, so that the user mends them in one go.
class Diagnostics {
 public:
  // `key_path` is "weights.snap" or empty; `message` says what is wrong and what would be right.
  void add(const Origin& origin, const std::string& key_path, const std::string& message);
  bool empty() const { return lines_.empty(); }
  const std::vector<std::string>& lines() const { return lines_; }
  // One line each: "file:line: key.path: message".
  std::string to_string() const;
  // Throws InputError with all lines; does nothing when empty.
  void throw_if_any() const;

 private:
  std::vector<std::string> lines_;
};

// "; try it alone: lapwing plugins check keep_low": what to do about a plugin.
std::string cure_of_plugin(std::string_view plugin);

// "plugin 'keep_low' failed in evaluate: no", and the cure.
PluginError plugin_failure(std::string_view plugin, std::string_view call, const std::string& what);

// Runs `body`, the call named `call` of plugin `plugin`. InputError, PluginError and Cancelled
// pass; anything else that it throws becomes a PluginError with both names.
template <class Body>
decltype(auto) call_plugin(std::string_view plugin, std::string_view call, Body&& body) {
  try {
    return body();
  } catch (const InputError&) {
    throw;
  } catch (const PluginError&) {
    throw;
  } catch (const Cancelled&) {
    throw;
  } catch (const std::exception& error) {
    throw plugin_failure(plugin, call, error.what());
  } catch (...) {
    throw plugin_failure(plugin, call, "an exception of unknown type");
  }
}

}  // namespace lapwing
