// SPDX-License-Identifier: Apache-2.0
#include "framework/app/command_options.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <sstream>

#include "framework/core/number_text.h"

namespace lapwing {

namespace {

template <class T>
void add_values(CLI::App& command, const std::string& name, const std::string& value_name,
                std::vector<T>& values, const std::string& help) {
  add_text(command, name, value_name, help,
           [&values](const std::string& value) { values.emplace_back(value); })
      ->allow_extra_args(false)
      ->take_all();
}

}  // namespace

void add_json(CLI::App& command, Invocation& invocation) {
  command.add_flag("--json", invocation.json, "one JSON object on standard output");
}

CLI::Option* add_text(CLI::App& command, const std::string& name, const std::string& value_name,
                      const std::string& help, std::function<void(const std::string&)> take) {
  const auto callback = [take = std::move(take), name, value_name](const CLI::results_t& values) {
    for (const std::string& value : values) {
      if (value.empty())
        throw CLI::ValidationError(name, "expected " + value_name + ", not an empty text");
      take(value);
    }
    return true;
  };
  return command.add_option(name, callback, help)->type_name(value_name)->expected(1);
}

CLI::Option* add_page(CLI::App& command, std::filesystem::path& target) {
  return add_text(command, "-o,--output", "PATH", "the report page to write, .html; default: none",
                  [&](const std::string& path) {
                    target = path;
                    if (target.extension() != ".html")
                      throw CLI::ValidationError("-o",
                                                 "'" + path +
                                                     "' is not a name for a page: expected one "
                                                     "that ends in .html");
                  });
}

void add_repeated(CLI::App& command, const std::string& name, const std::string& value_name,
                  std::vector<std::string>& values, const std::string& help) {
  add_values(command, name, value_name, values, help);
}

void add_repeated(CLI::App& command, const std::string& name, const std::string& value_name,
                  std::vector<std::filesystem::path>& values, const std::string& help) {
  add_values(command, name, value_name, values, help);
}

void add_count(CLI::App& command, const std::string& name, std::uint64_t least, std::uint64_t most,
               const std::string& help, std::function<void(std::uint64_t)> take) {
  add_text(command, name, "N", help, [=](const std::string& text) {
    std::uint64_t count = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
    if (error != std::errc{} || end != text.data() + text.size() || count < least || count > most)
      throw CLI::ValidationError(name, "must be a whole number from " + std::to_string(least) +
                                           " to " + std::to_string(most) + ", not '" + text + "'");
    take(count);
  });
}

void add_configuration(CLI::App& command, Invocation& invocation) {
  add_repeated(
      command, "--config", "FILE", invocation.configs,
      "a configuration file or its name in configs/; repeatable, later ones win; default: none");
  add_repeated(command, "--set", "KEY=VALUE", invocation.overrides,
               "set one option; repeatable, later ones win; default: none");
  add_repeated(command, "--data", "DIR", invocation.data,
               "a folder that the script may read; repeatable; default: those of LAPWING_DATA");
  add_seed(command, invocation.seed, "seed of all random numbers; default: 1");
}

void add_mission(CLI::App& command, std::filesystem::path& script) {
  add_text(command, "mission", "MISSION.lua", "mission script", [&](const std::string& path) {
    script = path;
  })->required();
}

void add_threads(CLI::App& command, Invocation& invocation, const std::string& help) {
  add_count(command, "--threads", 1, kMostThreads, help,
            [&](std::uint64_t threads) { invocation.threads = static_cast<int>(threads); });
}

void add_seed(CLI::App& command, std::uint64_t& seed, const std::string& help) {
  add_count(command, "--seed", 0, kLargestSeed, help, [&](std::uint64_t given) { seed = given; });
}

void add_plan(CLI::App& command, std::filesystem::path& plan) {
  add_text(command, "plan", "PLAN.json", "plan document", [&](const std::string& path) {
    plan = path;
  })->required();
}

double read_number(const std::string& option, const std::string& text) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size())
    throw CLI::ValidationError(option, "expected a number, not '" + text + "'");
  return number;
}

double read_within(const std::string& option, const std::string& text, double most) {
  const double number = read_number(option, text);
  if (!(number >= 0 && number <= most))
    throw CLI::ValidationError(
        option, "expected a number from 0 to " + plain_number(most) + ", not '" + text + "'");
  return number;
}

void read_list(const std::string& text, const std::function<void(const std::string&)>& take) {
  std::istringstream rest(text);
  for (std::string part; std::getline(rest, part, ',');) take(part);
}

}  // namespace lapwing
