// SPDX-License-Identifier: Apache-2.0
// Options that several commands take, and the groups of commands that have sources of their own.
//
// Options go through CLI11's callbacks on text: its typed ones instantiate a conversion of every
// kind for each type, which took most of the time that this folder needs to compile.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "framework/app/command_line.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace lapwing {

struct Description;
struct ExploreEvaluation;
struct NewFiles;
struct PluginCheck;
struct ReproduceRequest;
struct ScanCheckRequest;
struct TourRun;
struct TrainRequest;

constexpr std::uint64_t kMostThreads = 1024;
constexpr std::uint64_t kLargestSeed = (std::uint64_t{1} << 53) - 1;  // JSON readers hold no more

using Command = std::function<ExitStatus()>;  // what was asked for

void add_json(CLI::App& command, Invocation& invocation);
CLI::Option* add_text(CLI::App& command, const std::string& name, const std::string& value_name,
                      const std::string& help, std::function<void(const std::string&)> take);
// A report page: refused before any work when its name does not say so.
CLI::Option* add_page(CLI::App& command, std::filesystem::path& target);
// Repeatable; every use takes one value, which may hold brackets and commas.
void add_repeated(CLI::App& command, const std::string& name, const std::string& value_name,
                  std::vector<std::string>& values, const std::string& help);
void add_repeated(CLI::App& command, const std::string& name, const std::string& value_name,
                  std::vector<std::filesystem::path>& values, const std::string& help);
void add_count(CLI::App& command, const std::string& name, std::uint64_t least, std::uint64_t most,
               const std::string& help, std::function<void(std::uint64_t)> take);
void add_threads(CLI::App& command, Invocation& invocation, const std::string& help);
void add_seed(CLI::App& command, std::uint64_t& seed, const std::string& help);
void add_configuration(CLI::App& command, Invocation& invocation);
void add_mission(CLI::App& command, std::filesystem::path& script);
void add_plan(CLI::App& command, std::filesystem::path& plan);

// A number and nothing else; CLI::ValidationError names the option.
double read_number(const std::string& option, const std::string& text);
// From 0 to `most`.
double read_within(const std::string& option, const std::string& text, double most);
// "1,2,5": each entry is read by `take`.
void read_list(const std::string& text, const std::function<void(const std::string&)>& take);

// Each adds commands that set `command` to what is to be run; what it is given outlives the parse.
void add_plugin_commands(CLI::App& app, Invocation& invocation, std::string& name,
                         Description& described, PluginCheck& asked, Command& command);
void add_description_commands(CLI::App& app, Invocation& invocation, Description& asked,
                              Command& command);
void add_new_commands(CLI::App& app, Invocation& invocation, NewFiles& wanted, Command& command);
void add_train_commands(CLI::App& app, Invocation& invocation, TrainRequest& request,
                        Command& command);
void add_tour_command(CLI::App& app, Invocation& invocation, TourRun& asked, Command& command);
void add_reproduce_command(CLI::App& app, Invocation& invocation, ReproduceRequest& asked,
                           Command& command);
void add_scan_commands(CLI::App& app, Invocation& invocation, ScanCheckRequest& asked,
                       Command& command);
void add_evaluate_scan(CLI::App& evaluate, Invocation& invocation, ScanEvaluation& asked,
                       Command& command);
void add_evaluate_explore(CLI::App& evaluate, Invocation& invocation, ExploreEvaluation& request,
                          Command& command);

}  // namespace lapwing
