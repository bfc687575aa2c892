// SPDX-License-Identifier: Apache-2.0
#include "framework/app/item_command.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstring>
#include <iostream>

#include "framework/app/command_options.h"
#include "framework/app/interruption.h"
#include "framework/core/files.h"
#include "framework/core/named_parameters.h"
#include "framework/core/portable.h"
#include "framework/core/visible_text.h"

namespace lapwing {

namespace {

constexpr const char* kThreads = "threads";
constexpr const char* kMpi = "mpi";

// A number that mpirun of Open MPI gives its processes; -1 where there is none.
int number_of_launcher(const char* variable) {
  const char* text = std::getenv(variable);
  int number = -1;
  if (text) std::from_chars(text, text + std::strlen(text), number);
  return number;
}

std::unique_ptr<Executor> executor_for(const ItemOptions& options, const Registry& registry) {
  const int processes = launched_processes();
  const bool launched = options.executor.empty() && processes > 1;
  const std::string asked =
      options.executor.empty() ? (launched ? kMpi : kThreads) : options.executor;
  const auto named = named_parameters_from(asked);
  if (!named)
    throw InputError("--executor: expected NAME or NAME:KEY=VALUE,..., not '" + asked + "'");
  const auto is_mpi = [](const PluginEntry& entry) {
    return entry.kind == Executor::kKind && entry.name == kMpi;
  };
  const auto& entries = registry.entries();
  if (named->name == kMpi && std::none_of(entries.begin(), entries.end(), is_mpi))
    throw InputError(
        (launched ? "mpirun started " + std::to_string(processes) + " processes, but the"
                  : std::string("--executor mpi: this")) +
        " executor was not built; install libopenmpi-dev and openmpi-bin (scripts/setup.sh --for "
        "cluster) and build again, or start one process for each --shard");
  return registry.create<Executor>(named->name, named->parameters, "--executor");
}

std::vector<std::string> own_words() {
  const std::string text = read_file("/proc/self/cmdline");
  std::vector<std::string> words;
  for (std::size_t at = 0; at < text.size(); at = text.find('\0', at) + 1)
    words.emplace_back(text.c_str() + at);
  return words;
}

void require_consistent(const ItemOptions& options) {
  if (options.shard && options.gather)
    throw InputError("--shard and --gather: a shard makes items, and --gather makes none");
  if (options.schedule && (options.shard || options.gather))
    throw InputError("--schedule makes no items: give it without --shard and --gather");
}

// Starts the program again with the environment that limits the libraries, which read it when they
// are loaded. Returns where that has been done.
void become_portable() {
  if (is_portable()) return;
  const auto variables = portable_environment();
  if (std::getenv(variables.front().first.c_str()))
    throw InputError("--portable: the environment has " + variables.front().first +
                     " without the variables that belong to it; unset it");
  for (const auto& [name, value] : variables) ::setenv(name.c_str(), value.c_str(), 1);
  std::vector<std::string> words = own_words();
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  ::execv("/proc/self/exe", arguments.data());
  throw Error(std::string("--portable: the program cannot be started again: ") +
              std::strerror(errno));
}

}  // namespace

int launched_rank() {
  return std::max(0, number_of_launcher("OMPI_COMM_WORLD_RANK"));
}

int launched_processes() {
  return std::max(1, number_of_launcher("OMPI_COMM_WORLD_SIZE"));
}

void add_items(CLI::App& command, ItemOptions& options, const std::string& resume_help) {
  command.add_flag("--resume", options.resume, resume_help);
  add_text(command, "--shard", "K/N",
           "make part K of N of the items, K from 1 to N (0 is N), as one process of a batch "
           "array; keeps what is there; default: all",
           [&](const std::string& text) {
             try {
               options.shard = read_shard(text);
             } catch (const InputError& error) {
               throw CLI::ValidationError(error.what());
             }
           });
  command.add_flag("--gather", options.gather,
                   "make no items: read those of all shards, which must be complete");
  command.add_flag("--schedule", options.schedule,
                   "make no items: print times on 1 to 1000 processes, simulated from measured "
                   "times of items");
  add_text(command, "--executor", "NAME[:KEY=VALUE,...]",
           "the plugin that makes the items: threads or mpi; default: threads, under mpirun mpi",
           [&](const std::string& text) { options.executor = text; });
  command.add_flag("--portable", options.portable,
                   "compute the same numbers on every x86-64 processor, without FMA and AVX2");
}

ExitStatus run_items(const ItemOptions& options, const Invocation& invocation,
                     const Registry& registry,
                     const std::function<ExitStatus(ItemRun&, const CancellationToken&)>& body) {
  std::unique_ptr<Executor> executor;
  try {
    require_consistent(options);
    if (options.portable) become_portable();
    executor = executor_for(options, registry);
  } catch (const InputError&) {
    if (launched_rank() > 0) return ExitStatus::done;  // process 0 says it
    throw;
  }
  const Interruption interruption;
  const auto say = [&](const std::string& line) {
    if (!invocation.quiet) std::cerr << "lapwing: " << visible_text(line) << std::endl;
  };
  ItemRun run(*executor, options, invocation.threads, interruption.token(), say);
  try {
    return body(run, interruption.token());
  } catch (const ToldByAnother&) {
    return ExitStatus::done;
  } catch (const std::exception& error) {
    try {
      run.fail(error.what());
    } catch (const ToldByAnother&) {
      return ExitStatus::done;
    } catch (const InputError&) {  // process 0 has an error of its own, which it throws
    }
    throw;
  }
}

ExitStatus print_answer(const ItemRun& run, const Invocation& invocation) {
  if (!run.leads()) return ExitStatus::done;
  if (invocation.json)
    print_json(run.answer());
  else if (!invocation.quiet || run.options().schedule)
    std::cout << visible_text(run.answer_text()) << std::endl;
  return ExitStatus::done;
}

ClaimKind claim_for(const ItemOptions& options) {
  return options.shard ? ClaimKind::shared : ClaimKind::alone;
}

}  // namespace lapwing
