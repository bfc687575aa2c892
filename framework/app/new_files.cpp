// SPDX-License-Identifier: Apache-2.0
#include "framework/app/new_files.h"

#include <algorithm>
#include <cstdio>
#include <sstream>

#include "framework/config/shipped.h"
#include "framework/core/files.h"

namespace lapwing {

namespace {

namespace fs = std::filesystem;

// Every kind there are templates for: names of folders, or of files without their ending.
std::vector<std::string> kinds_in(const fs::path& folder) {
  std::vector<std::string> kinds;
  for (const auto& item : fs::directory_iterator(folder))
    kinds.push_back(item.path().stem().stem().string());
  std::sort(kinds.begin(), kinds.end());
  return kinds;
}

void expect_kind(const std::string& kind, const std::vector<std::string>& known,
                 const std::string& what) {
  if (std::find(known.begin(), known.end(), kind) != known.end()) return;
  std::string all;
  for (const std::string& one : known) all += (all.empty() ? "" : ", ") + one;
  std::string nearest = nearest_name(kind, known);
  for (const std::string& one : known)  // "cost" begins "cost_term"
    if (nearest.empty() && kind.size() > 2 && one.starts_with(kind)) nearest = one;
  throw InputError("there is no kind of " + what + " '" + kind + "'" +
                   (nearest.empty() ? "" : "; did you mean '" + nearest + "'?") +
                   "; there are: " + all);
}

constexpr std::size_t kLongestPluginName = 64;  // file systems take 255 bytes, endings included

void expect_usable_length(const std::string& name) {
  if (name.size() <= kLongestPluginName) return;
  throw InputError("a plugin's name of " + std::to_string(name.size()) +
                   " letters is too long: at most " + std::to_string(kLongestPluginName) +
                   " are taken");
}

// The name stands for the plugin in source, scripts and configurations.
void expect_no_keyword(const std::string& name, const fs::path& templates) {
  std::istringstream keywords(read_file(templates / "keywords.txt"));
  for (std::string word; keywords >> word;)
    if (word == name)
      throw InputError("'" + name +
                       "' cannot be a plugin's name: it is a keyword of C++; choose another, "
                       "such as my_" +
                       name);
}

void expect_snake_case(const std::string& name) {
  const auto fits = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  };
  if (!name.empty() && name[0] >= 'a' && name[0] <= 'z' && name.back() != '_' &&
      name.find("__") == std::string::npos && std::all_of(name.begin(), name.end(), fits))
    return;
  throw InputError("'" + name +
                   "' is not a name for a plugin: expected snake_case, such as keep_low");
}

// A class of the kernel's that has the name: pages of errors by the compiler, said in one line.
void expect_free_class(const std::string& name, const std::string& class_name,
                       const fs::path& templates) {
  std::istringstream taken(read_file(templates / "taken_names.txt"));
  for (std::string one; taken >> one;)
    if (one == class_name)
      throw InputError("'" + name + "' cannot be a plugin's name: its class would be " +
                       class_name + ", which the kernel uses; choose another, such as my_" + name);
}

// keep_low: KeepLow
std::string in_pascal_case(const std::string& name) {
  std::string result;
  bool upper = true;
  for (const char c : name) {
    if (c == '_') {
      upper = true;
      continue;
    }
    result += upper && c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    upper = false;
  }
  return result;
}

std::string filled_in(std::string text, const std::string& mark, const std::string& value) {
  for (std::size_t at = 0; (at = text.find(mark, at)) != std::string::npos; at += value.size())
    text.replace(at, mark.size(), value);
  return text;
}

void say(const Invocation& invocation, const std::vector<fs::path>& files,
         const std::string& next) {
  if (invocation.json) {
    Value list = Value::list();
    for (const fs::path& file : files) list.push_back(file.string());
    Value object = Value::map();
    object.set("files", std::move(list));
    print_json(object);
    return;
  }
  for (const fs::path& file : files) std::printf("%s\n", file.c_str());
  std::printf("%s", next.c_str());
}

}  // namespace

ExitStatus new_plugin(const NewFiles& wanted, const Invocation& invocation) {
  const fs::path templates = shipped_folder("scripts") / "templates" / "plugins";
  expect_kind(wanted.kind, kinds_in(templates), "plugin");
  expect_usable_length(wanted.name);
  expect_snake_case(wanted.name);
  expect_no_keyword(wanted.name, templates.parent_path());
  expect_free_class(wanted.name, in_pascal_case(wanted.name), templates.parent_path());
  std::error_code code;
  if (!wanted.folder.empty() && !fs::is_directory(wanted.folder, code))
    throw InputError("--in: '" + wanted.folder.string() + "' is not a folder");
  const fs::path folder = wanted.folder / wanted.name;
  if (fs::exists(folder)) throw InputError("'" + folder.string() + "' exists already");
  const Registry registry = invocation.registry();
  for (const PluginEntry& entry : registry.entries())
    if (entry.kind == wanted.kind && entry.name == wanted.name)
      throw InputError("there is a " + wanted.kind + " '" + wanted.name + "' already, in '" +
                       entry.library.string() + "'; choose another name");
  std::vector<fs::path> files;
  const auto write = [&](const fs::path& from, const std::string& name) {
    std::string text = read_file(from);
    text = filled_in(text, "@NAME@", wanted.name);
    text = filled_in(text, "@CLASS@", in_pascal_case(wanted.name));
    text = filled_in(text, "@KIND@", wanted.kind);
    files.push_back(folder / name);
    write_file_atomically(files.back(), text);
  };
  fs::create_directories(folder);
  write(templates / wanted.kind / "source.cpp.in", wanted.name + ".cpp");
  write(templates / wanted.kind / "README.md.in", "README.md");
  write(templates.parent_path() / "CMakeLists.txt.in", "CMakeLists.txt");
  say(invocation, files,
      "\nBuild and check it:\n  cd " + folder.string() +
          "\n  cmake -B build && cmake --build build && ctest --test-dir build\n"
          "Use it:\n  lapwing --plugin-path " +
          folder.string() + "/build/lib/plugins ...\n");
  return ExitStatus::done;
}

std::vector<std::string> mission_kinds() {
  try {
    return kinds_in(shipped_folder("scripts") / "templates" / "missions");
  } catch (const std::exception&) {  // a hint is not worth an error
    return {};
  }
}

ExitStatus new_mission(const NewFiles& wanted, const Invocation& invocation) {
  const fs::path templates = shipped_folder("scripts") / "templates" / "missions";
  expect_kind(wanted.kind, kinds_in(templates), "mission");
  const fs::path file = wanted.name;
  std::error_code code;
  static_cast<void>(fs::symlink_status(file, code));
  if (code && code != std::errc::no_such_file_or_directory)
    throw InputError("cannot write '" + file.string() + "': " + code.message());
  if (file.extension() != ".lua")
    throw InputError("'" + wanted.name +
                     "' is not a name for a script: expected one that ends in .lua");
  if (fs::exists(file)) throw InputError("'" + file.string() + "' exists already");
  const std::string text = read_file(templates / (wanted.kind + ".lua.in"));
  write_file_atomically(file, filled_in(text, "@NAME@", file.stem().string()));
  // What a script says of its time is said before it is run as well.
  const std::size_t takes = text.find("-- Takes ");
  const std::string time =
      takes == text.npos ? "" : text.substr(takes + 3, text.find('\n', takes) - takes - 2);
  say(invocation, {file}, "\nRun it:\n  lapwing run " + file.string() + "\n" + time);
  return ExitStatus::done;
}

}  // namespace lapwing
