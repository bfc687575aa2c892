#include "framework/app/sweep_command.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <map>

#include "framework/core/files.h"
#include "framework/core/json.h"

namespace lapwing {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostRuns = 1000;

struct SweepRun {
  std::vector<std::string> values;  // one for each key
  fs::path folder;
  int status = -1;
  Value answer;  // null where it gave none
};

struct VariedKey {
  std::string name;
  std::vector<std::string> values;
};

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
    runs[i].folder = out / name;
  }
  return runs;
}

pid_t start_run(const SweepRun& run, const std::vector<VariedKey>& keys, const Sweep& asked,
                const Invocation& invocation) {
  std::vector<std::string> words{
      "lapwing",           "run",    asked.script.string(),          "--json", "--out",
      run.folder.string(), "--seed", std::to_string(invocation.seed)};
  for (const fs::path& folder : invocation.plugin_path)
    words.insert(words.end(), {"--plugin-path", folder.string()});
  for (const fs::path& folder : invocation.data)
    words.insert(words.end(), {"--data", folder.string()});
  for (const std::string& file : invocation.configs) words.insert(words.end(), {"--config", file});
  for (const std::string& text : invocation.overrides) words.insert(words.end(), {"--set", text});
  for (std::size_t k = 0; k < keys.size(); ++k)
    words.insert(words.end(), {"--set", keys[k].name + "=" + run.values[k]});
  fs::create_directories(run.folder);
  const std::string out = run.folder / "answer.json", errors = run.folder / "errors.txt";
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const pid_t child = ::fork();
  if (child != 0) return child;
  const int to = ::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  const int log = ::open(errors.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  if (to < 0 || log < 0 || ::dup2(to, STDOUT_FILENO) < 0 || ::dup2(log, STDERR_FILENO) < 0)
    ::_exit(static_cast<int>(ExitStatus::defect));
  ::execv("/proc/self/exe", arguments.data());
  ::_exit(static_cast<int>(ExitStatus::defect));
}

void finish_one(std::map<pid_t, SweepRun*>& running) {
  int status = 0;
  const pid_t ended = ::waitpid(-1, &status, 0);
  const auto found = running.find(ended);
  if (found == running.end()) return;
  SweepRun& run = *found->second;
  run.status = WIFEXITED(status) ? WEXITSTATUS(status) : static_cast<int>(ExitStatus::defect);
  const fs::path answer = run.folder / "answer.json";
  if (const std::string text = read_file(answer); !text.empty())
    run.answer = from_json(text, answer.string());
  running.erase(found);
}

std::string seconds_of(const Value& answer, const char* part) {
  const Value* seconds = answer.find("seconds");
  const Value* found = seconds ? seconds->find(part) : nullptr;
  char text[32] = "-";
  if (found && found->is_number()) std::snprintf(text, sizeof text, "%.2f", found->as_number());
  return text;
}

void print_table(const std::vector<VariedKey>& keys, const std::vector<SweepRun>& runs) {
  std::vector<std::vector<std::string>> rows(1);
  for (const VariedKey& key : keys) rows[0].push_back(key.name);
  rows[0].insert(rows[0].end(), {"status", "solve [s]", "folder"});
  for (const SweepRun& run : runs) {
    rows.push_back(run.values);
    const Value* status = run.answer.find("status");
    rows.back().insert(rows.back().end(),
                       {status ? status->as_text() : "exit " + std::to_string(run.status),
                        seconds_of(run.answer, "solve"), run.folder.string()});
  }
  std::vector<std::size_t> widths(rows[0].size(), 0);
  for (const auto& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i)
      std::printf("%-*s%s", i + 1 < row.size() ? static_cast<int>(widths[i]) : 0, row[i].c_str(),
                  i + 1 < row.size() ? "  " : "\n");
  }
}

}  // namespace

ExitStatus sweep_missions(const Sweep& asked, const Invocation& invocation) {
  if (asked.varied.empty()) throw InputError("sweep: expected --vary KEY=VALUE,VALUE,...");
  if (!fs::exists(asked.script))
    throw InputError("there is no script '" + asked.script.string() + "'");
  std::vector<VariedKey> keys;
  for (const std::string& text : asked.varied) keys.push_back(read_varied(text));
  const fs::path out = invocation.out.empty() ? fs::path("out") / "sweep" : invocation.out;
  std::vector<SweepRun> runs = combinations(keys, out);
  std::map<pid_t, SweepRun*> running;
  for (SweepRun& run : runs) {
    while (static_cast<int>(running.size()) >= std::max(asked.jobs, 1)) finish_one(running);
    const pid_t child = start_run(run, keys, asked, invocation);
    if (child < 0) throw Error("sweep: no process for a run");
    running[child] = &run;
  }
  while (!running.empty()) finish_one(running);
  int worst = 0;
  Value list = Value::list();
  for (const SweepRun& run : runs) {
    worst = std::max(worst, run.status);
    Value entry = Value::map(), values = Value::map();
    for (std::size_t k = 0; k < keys.size(); ++k) values.set(keys[k].name, run.values[k]);
    entry.set("values", std::move(values));
    entry.set("folder", run.folder.string());
    entry.set("exit", run.status);
    entry.set("answer", run.answer);
    list.push_back(std::move(entry));
  }
  if (invocation.json) {
    Value object = Value::map();
    object.set("runs", std::move(list));
    print_json(object);
  } else {
    print_table(keys, runs);
  }
  return static_cast<ExitStatus>(worst);
}

}  // namespace lapwing
