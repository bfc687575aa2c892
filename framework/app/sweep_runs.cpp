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
#include <map>
#include <thread>

#include "framework/app/command_line.h"
#include "framework/app/progress_line.h"
#include "framework/app/sweep_inputs.h"
#include "framework/core/files.h"
#include "framework/core/json.h"

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

using Running = std::map<pid_t, SweepRun*>;

pid_t start_run(const SweepRun& run, std::vector<std::string> words) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  fs::create_directories(run.folder);
  for (const char* name : {kExit, kAnswer, kErrors}) fs::remove(run.folder / name);
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
  ::execv("/proc/self/exe", arguments.data());
  ::_exit(static_cast<int>(ExitStatus::defect));
}

// A run that a signal ended has no result: it is done again.
void finish_run(SweepRun& run, int status) {
  if (!WIFEXITED(status)) return;
  keep_inputs(run.folder);
  write_file_atomically(run.folder / kExit, std::to_string(WEXITSTATUS(status)) + "\n");
  read_results(run);
}

// Takes every process that has ended out of `running`.
void collect(Running& running) {
  for (auto one = running.begin(); one != running.end();) {
    int status = 0;
    const pid_t ended = ::waitpid(one->first, &status, WNOHANG);
    if (ended == 0 || (ended < 0 && errno == EINTR)) {
      ++one;
      continue;
    }
    if (ended > 0) finish_run(*one->second, status);
    one = running.erase(one);
  }
}

// Asks them to end with the best so far, then tells them to, then ends them.
void end_all(Running& running) {
  for (const int signal : {SIGTERM, SIGTERM, SIGKILL}) {
    for (const auto& [process, run] : running) ::kill(process, signal);
    const double asked = steady_seconds();
    while (!running.empty() && (signal == SIGKILL || steady_seconds() - asked < kPatience)) {
      collect(running);
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

void do_runs(std::vector<SweepRun>& runs, int jobs,
             const std::function<std::vector<std::string>(const SweepRun&)>& arguments,
             const CancellationToken& token, Progress& progress) {
  Running running;
  std::size_t next = 0;
  while (!token.cancelled()) {
    while (next < runs.size() && running.size() < static_cast<std::size_t>(std::max(jobs, 1))) {
      SweepRun& run = runs[next++];
      if (!run.exit) running[start_run(run, arguments(run))] = &run;
    }
    if (running.empty()) return;
    const auto done = std::count_if(runs.begin(), runs.end(),
                                    [](const SweepRun& run) { return run.exit.has_value(); });
    progress.report(static_cast<double>(done) / static_cast<double>(runs.size()),
                    std::to_string(done) + " of " + std::to_string(runs.size()) + " runs done, " +
                        std::to_string(running.size()) + " running");
    std::this_thread::sleep_for(kGlance);
    collect(running);
  }
  end_all(running);
}

}  // namespace lapwing
