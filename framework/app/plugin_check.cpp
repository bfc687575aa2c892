// SPDX-License-Identifier: Apache-2.0
#include "framework/app/plugin_check.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "framework/app/terminal.h"
#include "framework/conformance/check.h"
#include "framework/core/json.h"
#include "framework/core/own_process.h"
#include "framework/core/visible_text.h"

namespace lapwing {

namespace {

namespace fs = std::filesystem;

std::function<std::int64_t()>& allocation_count() {
  static std::function<std::int64_t()> count;
  return count;
}

// What became of one test.
struct Tested {
  std::string name;
  std::string outcome;  // passed, failed, crashed, skipped, warned
  std::string message;
};

bool is_good(const Tested& test) {
  return test.outcome != "failed" && test.outcome != "crashed";
}

std::string word_of(Outcome outcome) {
  switch (outcome) {
    case Outcome::passed:
      return "passed";
    case Outcome::failed:
      return "failed";
    case Outcome::warned:
      return "warned";
    case Outcome::skipped:
      break;
  }
  return "skipped";
}

// Runs `work`, whose results come back as data, in a copy of this process that writes nothing of
// its own to standard output.
std::vector<Tested> in_a_copy(const std::string& name, double limit,
                              const std::function<std::vector<CheckResult>()>& work) {
  const ProcessResult result = run_in_own_process({.seconds = limit}, [&] {
    ::dup2(STDERR_FILENO, STDOUT_FILENO);
    Value list = Value::list();
    for (const CheckResult& found : work()) {
      Value entry = Value::map();
      entry.set("name", found.name);
      entry.set("outcome", word_of(found.outcome));
      entry.set("message", found.message);
      list.push_back(std::move(entry));
    }
    return to_json(list);
  });
  switch (result.end) {
    case ProcessEnd::answered:
      break;
    case ProcessEnd::crashed:
      return {{name, "crashed", result.text}};
    case ProcessEnd::overtime:
      return {{name, "crashed", "it did not return: " + result.text}};
    default:
      return {{name, "failed", result.text}};
  }
  std::vector<Tested> tests;
  const Value found = from_json(result.text, name);
  for (const Value& entry : found.as_list())
    tests.push_back(
        {entry.at("name").as_text(), entry.at("outcome").as_text(), entry.at("message").as_text()});
  return tests;
}

// Of all results of a copy that was asked for one test: that test's. What stands in its way
// (a plugin that cannot be created) is its failure as well.
Tested result_of(const std::string& name, const std::vector<Tested>& all) {
  for (const Tested& test : all)
    if (test.name == name && !is_good(test)) return test;
  for (const Tested& test : all) {
    const bool stands_in_the_way = test.name == "creation" || test.name == "exceptions" ||
                                   test.name == "shape" || test.outcome == "crashed";
    if (test.name != name && !is_good(test) && stands_in_the_way)
      return {name, test.outcome, test.name + ": " + test.message};
  }
  for (const Tested& test : all)
    if (test.name == name) return test;
  return {name, "skipped", "does not apply"};
}

class OnePlugin {
 public:
  OnePlugin(const Registry& registry, const PluginEntry& entry, const PluginCheck& asked)
      : registry_(registry), entry_(entry), asked_(asked) {}

  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const auto& group : groups()) names.insert(names.end(), group.begin(), group.end());
    return names;
  }

  std::vector<Tested> run() const {
    std::vector<Tested> tests;
    for (const auto& group : groups()) {
      std::vector<std::string> wanted;
      for (const std::string& name : group)
        if (asked_.only.empty() ||
            std::find(asked_.only.begin(), asked_.only.end(), name) != asked_.only.end())
          wanted.push_back(name);
      if (!wanted.empty()) run_group(wanted, tests);
    }
    const bool described = asked_.only.empty() && entry_.reference.empty();
    if (described)
      tests.push_back(
          {"reference", "warned", "it names no source; write \"own\" if there is none"});
    return tests;
  }

 private:
  std::vector<std::vector<std::string>> groups() const {
    std::vector<std::vector<std::string>> groups{{"description"}, {"sidecar"}, {"rubbish"}};
    for (auto& group : check_groups(entry_.kind)) groups.push_back(std::move(group));
    return groups;
  }

  // Tests that look at the same answers share a process; where that ends early, each gets its own.
  void run_group(const std::vector<std::string>& names, std::vector<Tested>& tests) const {
    const std::vector<Tested> found =
        in_a_copy(names.front(), asked_.limit, [&] { return results(names); });
    const bool ended = found.size() == 1 && found[0].outcome == "crashed";
    if (ended && names.size() > 1) {
      for (const std::string& name : names) run_group({name}, tests);
      return;
    }
    for (const std::string& name : names) tests.push_back(result_of(name, found));
  }

  std::vector<CheckResult> results(const std::vector<std::string>& names) const {
    if (names.front() == "description") return check_description(entry_);
    if (names.front() == "sidecar") return check_sidecar(entry_);
    if (names.front() == "rubbish") return check_rubbish(registry_, entry_);
    CheckOptions options;
    options.allocations = allocation_count();
    options.only = names;
    return check_plugin(registry_, entry_, options);
  }

  const Registry& registry_;
  const PluginEntry& entry_;
  const PluginCheck& asked_;
};

// Whether a library opens, and its sidecar says what it says.
Tested opens(const fs::path& library, double limit) {
  const fs::path sidecar = fs::path(library).replace_extension(".json");
  const std::vector<Tested> found = in_a_copy("opens", limit, [&]() -> std::vector<CheckResult> {
    describe_library(library);
    if (!fs::exists(sidecar))
      return {{"opens", Outcome::failed,
               "there is no sidecar '" + sidecar.string() +
                   "': build it with lapwing_add_plugin, or write it with lapwing_sidecar"}};
    Registry({library.parent_path().empty() ? fs::path(".") : library.parent_path()});
    return {{"opens", Outcome::passed, ""}};
  });
  return result_of("opens", found);
}

// Padded to the longest outcome.
std::string in_its_colour(std::string outcome) {
  const Tone tone = outcome == "passed"                           ? Tone::good
                    : outcome == "failed" || outcome == "crashed" ? Tone::bad
                                                                  : Tone::faint;
  outcome.resize(std::max<std::size_t>(outcome.size(), 8), ' ');
  return tinted(tone, outcome);
}

bool report(const std::string& title, const std::vector<Tested>& tests, bool json, Value& list) {
  bool good = true;
  Value values = Value::list();
  int failed = 0;
  if (!json) std::printf("%s\n", title.c_str());
  for (const Tested& test : tests) {
    good &= is_good(test);
    failed += !is_good(test);
    Value value = Value::map();
    value.set("name", test.name);
    value.set("outcome", test.outcome);
    if (!test.message.empty()) value.set("message", test.message);
    values.push_back(std::move(value));
    if (!json)
      std::printf("  %s %s%s%s\n", in_its_colour(test.outcome).c_str(), test.name.c_str(),
                  test.message.empty() ? "" : ": ", visible_text(test.message).c_str());
  }
  if (!json) std::printf("%zu tests, %d failed\n", tests.size(), failed);
  list.as_list().back().set("tests", std::move(values));
  list.as_list().back().set("passed", good);
  return good;
}

void expect_known(const PluginCheck& asked, const std::vector<std::string>& names) {
  for (const std::string& name : asked.only) {
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    std::string all;
    for (const std::string& known : names) all += (all.empty() ? "" : ", ") + known;
    throw InputError("--only: there is no test '" + name + "' for it; there are " + all);
  }
}

}  // namespace

void count_allocations_by(std::function<std::int64_t()> count) {
  allocation_count() = std::move(count);
}

ExitStatus check_plugins(const PluginCheck& asked, const Invocation& invocation) {
  Value list = Value::list();
  bool good = true;
  const auto finish = [&] {
    if (invocation.json) {
      Value object = Value::map();
      object.set("plugins", std::move(list));
      object.set("passed", good);
      print_json(object);
    }
    return good ? ExitStatus::done : ExitStatus::not_certified;
  };
  const auto begin = [&](const std::string& kind, const std::string& name, const fs::path& file) {
    Value value = Value::map();
    if (!kind.empty()) value.set("kind", kind);
    if (!name.empty()) value.set("name", name);
    value.set("library", file.string());
    list.push_back(std::move(value));
  };
  const bool is_file = asked.target.ends_with(".so");
  if (is_file && !fs::exists(asked.target))
    throw InputError("there is no library '" + asked.target + "'");
  if (is_file) {
    const Tested opened = opens(asked.target, asked.limit);
    if (!is_good(opened)) {
      begin("", "", asked.target);
      good = report(asked.target, {opened}, invocation.json, list);
      return finish();
    }
  }
  std::vector<fs::path> folders = plugin_search_path(invocation.plugin_path);
  const fs::path own = fs::absolute(asked.target).parent_path();
  if (is_file) folders = {own};
  const Registry registry(folders);
  std::vector<const PluginEntry*> found;
  for (const PluginEntry& entry : registry.entries())
    if (is_file ? fs::equivalent(entry.library, asked.target)
                : entry.name == asked.target || entry.kind + "/" + entry.name == asked.target)
      found.push_back(&entry);
  if (found.empty()) refuse_unknown_plugin(registry, asked.target);
  for (const PluginEntry* entry : found) {
    const OnePlugin plugin(registry, *entry, asked);
    expect_known(asked, plugin.names());
    begin(entry->kind, entry->name, entry->library);
    good &= report(entry->kind + " " + entry->name + "  " + entry->library.string(), plugin.run(),
                   invocation.json, list);
  }
  return finish();
}

}  // namespace lapwing
