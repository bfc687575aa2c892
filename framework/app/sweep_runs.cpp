// SPDX-License-Identifier: Apache-2.0
#include "framework/app/sweep_runs.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <thread>

#include "framework/app/command_line.h"
#include "framework/app/progress_line.h"
#include "framework/app/sweep_inputs.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/items/statement.h"

namespace lapwing {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostRuns = 1000;
constexpr auto kGlance = std::chrono::milliseconds(20);  // between looks at the processes
constexpr double kPatience = 4;  // s for a run that was asked to end, then for one that was told

// What a run leaves beside its plan. The last says that it came to its end.
constexpr const char* kAnswer = "answer.json";
constexpr const char* kErrors = "errors.txt";
constexpr const char* kExit = "exit.txt";

constexpr const char* kMark = "made_by.json";

// Of this process, without what mpirun tells it: a run is a program of its own.
std::vector<std::string> environment_of_run() {
  std::vector<std::string> variables;
  for (char** variable = environ; *variable; ++variable) {
    const std::string_view text = *variable;
    const auto begins = [&](const char* start) { return text.starts_with(start); };
    if (!begins("OMPI_") && !begins("PMIX_") && !begins("PMI_")) variables.emplace_back(text);
  }
  return variables;
}

std::vector<char*> pointers_to(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

pid_t start_run(const SweepRun& run, std::vector<std::string> words) {
  std::vector<char*> arguments = pointers_to(words);
  std::vector<std::string> variables = environment_of_run();
  std::vector<char*> environment = pointers_to(variables);
  fs::remove_all(run.folder);  // whatever of it is there, it begins anew
  fs::create_directories(run.folder);
  const std::string answer = run.folder / kAnswer, errors = run.folder / kErrors;
  const pid_t parent = ::getpid();
  const pid_t child = ::fork();
  if (child < 0) throw Error(std::string("sweep: no process for a run: ") + std::strerror(errno));
  if (child > 0) return child;
  // Ctrl-C at a terminal reaches whoever ends the runs in order; should that die, so do they.
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(static_cast<int>(ExitStatus::interrupted));
  const int to = ::open(answer.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  const int log = ::open(errors.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  if (to < 0 || log < 0 || ::dup2(to, STDOUT_FILENO) < 0 || ::dup2(log, STDERR_FILENO) < 0)
    ::_exit(static_cast<int>(ExitStatus::defect));
  ::execve("/proc/self/exe", arguments.data(), environment.data());
  ::_exit(static_cast<int>(ExitStatus::defect));
}

// Whether the process has ended, with its status.
bool has_ended(pid_t process, int& status) {
  return ::waitpid(process, &status, WNOHANG) == process;
}

// Asks it to end with the best so far, then tells it to, then ends it.
void end_run(pid_t process, int& status) {
  for (const int signal : {SIGTERM, SIGTERM, SIGKILL}) {
    ::kill(process, signal);
    const double asked = steady_seconds();
    while (signal == SIGKILL || steady_seconds() - asked < kPatience) {
      if (has_ended(process, status)) return;
      std::this_thread::sleep_for(kGlance);
    }
  }
}

}  // namespace

VariedKey read_varied(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    throw InputError("--vary: expected KEY=VALUE,VALUE,..., got '" + text + "'");
  VariedKey key{text.substr(0, equals), {}};
  int depth = 0;  // of brackets: {1, 2, 3} is one value
  std::string value;
  for (const char c : text.substr(equals + 1)) {
    depth += (c == '[' || c == '{') - (c == ']' || c == '}');
    if (c != ',' || depth > 0) {
      value += c;
      continue;
    }
    key.values.push_back(std::move(value));
    value.clear();
  }
  key.values.push_back(std::move(value));
  return key;
}

std::vector<SweepRun> combinations(const std::vector<VariedKey>& keys, const fs::path& out) {
  std::vector<SweepRun> runs(1);
  for (const VariedKey& key : keys) {
    std::vector<SweepRun> longer;
    for (const SweepRun& run : runs)
      for (const std::string& value : key.values) {
        longer.push_back(run);
        longer.back().values.push_back(value);
      }
    runs = std::move(longer);
    if (runs.size() > kMostRuns) throw InputError("--vary: more than a thousand runs");
  }
  for (std::size_t i = 0; i < runs.size(); ++i) {
    char name[32];
    std::snprintf(name, sizeof name, "run_%03zu", i + 1);
    runs[i].name = name;
    runs[i].folder = out / name;
  }
  return runs;
}

void read_results(SweepRun& run) {
  constexpr int kKilled = static_cast<int>(ExitStatus::interrupted);
  std::error_code code;
  run.exit.reset();
  if (!fs::exists(run.folder / kExit, code)) return;
  const std::string exit = read_file(run.folder / kExit);
  if (exit.empty() || exit.find_first_not_of("0123456789\n") != exit.npos || exit.size() > 4)
    throw InputError("'" + (run.folder / kExit).string() + "' is not an exit status; remove it");
  run.exit = std::stoi(exit);
  run.errors = read_file(run.folder / kErrors);
  if (const std::string text = read_file(run.folder / kAnswer); !text.empty())
    run.answer = from_json(text, (run.folder / kAnswer).string());
  const fs::path plan = run.folder / "plan.json";
  const bool planned = *run.exit < 2 || *run.exit == kKilled;
  if (!planned || !run.answer.find("plan") || !fs::exists(plan, code)) return;
  run.plan = read_plan(plan);
  run.figures = figures_of(*run.plan);
}

std::string SweepRun::status() const {
  if (!exit) return "not run";
  const Value* status = answer.find("status");
  return status && status->is_text() ? status->as_text() : "exit " + std::to_string(*exit);
}

std::vector<std::string> SweepRun::reasons() const {
  if (!exit || *exit == 0) return {};
  std::vector<std::string> reasons = figures.reasons;
  if (const Value* error = answer.find("error"); error && error->is_text())
    reasons.push_back(error->as_text());
  else if (!plan && !errors.empty())
    reasons.push_back(errors.substr(0, errors.find_last_not_of('\n') + 1));
  if (const Value* notes = answer.find("notes"); notes && notes->is_list())
    for (const Value& note : notes->as_list())
      if (note.is_text()) reasons.push_back(note.as_text());
  return said_once(reasons);
}

bool has_run(SweepRun& run, const Value& mark) {
  read_results(run);
  const bool ended = run.exit && *run.exit < static_cast<int>(ExitStatus::defect);
  if (!ended || !has_inputs(run.folder)) return false;
  if (const std::string changed = changed_input(run.folder); !changed.empty())
    throw InputError("--resume: '" + changed + "', which " + run.name +
                     " read, has changed since; leave --resume out to start again");
  return has_item(run.folder / kMark, mark);
}

void do_run(const SweepRun& run, const std::vector<std::string>& words, const Value& mark,
            const CancellationToken& token) {
  const pid_t process = start_run(run, words);
  int status = 0;
  while (!token.cancelled() && !has_ended(process, status)) std::this_thread::sleep_for(kGlance);
  const bool cancelled = token.cancelled();
  if (cancelled) end_run(process, status);
  if (WIFEXITED(status)) {
    keep_inputs(run.folder);
    Value made = Value::map();
    made.set(kMadeByEntry, mark);
    write_file_atomically(run.folder / kMark, to_json(made) + "\n");
    write_file_atomically(run.folder / kExit, std::to_string(WEXITSTATUS(status)) + "\n");
  }
  if (cancelled) throw Cancelled();
}

}  // namespace lapwing
