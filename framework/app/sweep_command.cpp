// SPDX-License-Identifier: Apache-2.0
#include "framework/app/sweep_command.h"

#include <algorithm>
#include <iostream>
#include <map>
#include <regex>
#include <set>

#include "framework/app/input_checksums.h"
#include "framework/app/mission_loading.h"
#include "framework/app/progress_line.h"
#include "framework/app/sweep_inputs.h"
#include "framework/app/sweep_tables.h"
#include "framework/app/text_table.h"
#include "framework/config/lookup.h"
#include "framework/config/shipped.h"
#include "framework/core/checksum.h"
#include "framework/core/file_set.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/portable.h"
#include "framework/core/visible_text.h"
#include "framework/items/statement.h"

namespace lapwing {

namespace {

namespace fs = std::filesystem;

template <class Texts>
Value list_of(const Texts& texts) {
  Value list = Value::list();
  for (const auto& text : texts) list.push_back(fs::path(text).string());
  return list;
}

// All that the runs are made of but the files that they read as they go: those are in
// app/sweep_inputs.h.
Value statement_of(const Sweep& asked, const Invocation& invocation, const Registry& registry) {
  Value value = Value::map();
  value.set("sweep", 1);
  value.set("version", program_version());
  value.set(kMachineEntry, machine_of_numbers());
  value.set("script", asked.script.string());
  fs::path folder = asked.script.parent_path();
  if (folder.empty()) folder = ".";
  add_script_checksums(folder / asked.script.filename(), folder,
                       value.set("scripts_sha256", Value::map()));
  value.set("shipped_scripts", checksum_of_folder(shipped_folder("scripts")));
  value.set("shipped_configs", checksum_of_folder(shipped_folder("configs")));
  ConfigSearch search;
  search.folders = {shipped_folder("configs")};
  Value& configs = value.set("configs", Value::list());
  for (const std::string& name : invocation.configs)
    configs.push_back(name + " " + sha256(read_file(find_config(name, search))));
  value.set("set", list_of(invocation.overrides));
  value.set("vary", list_of(asked.varied));
  value.set("data", list_of(invocation.data));
  value.set("plugin_path", list_of(invocation.plugin_path));
  value.set("plugins_sha256", plugin_checksums(registry));
  value.set("seed", static_cast<std::int64_t>(invocation.seed));
  return value;
}

constexpr const char* kStatement = "sweep.json";
constexpr const char* kRunFile = "exit.txt";  // says that a run came to its end
constexpr const char* kTable = "table.csv";
constexpr const char* kReport = "report.html";

// Of an earlier sweep into the same folder: its runs, its table and its report, and nothing else.
void remove_old_runs(const fs::path& out) {
  static const std::regex name("run_[0-9]{3,4}");
  std::error_code code;
  std::vector<fs::path> old;
  for (const auto& item : fs::directory_iterator(out, code))
    if (std::regex_match(item.path().filename().string(), name)) old.push_back(item.path());
  old.insert(old.end(), {out / kTable, out / kReport});
  for (const fs::path& folder : old) fs::remove_all(folder);
}

std::vector<std::string> words_of(const SweepRun& run, const std::vector<VariedKey>& keys,
                                  const Sweep& asked, const Invocation& invocation) {
  std::vector<std::string> words{
      "lapwing",           "run",    asked.script.string(),           "--json",  "--quiet", "--out",
      run.folder.string(), "--seed", std::to_string(invocation.seed), "--color", "never"};
  for (const fs::path& folder : invocation.plugin_path)
    words.insert(words.end(), {"--plugin-path", folder.string()});
  for (const fs::path& folder : invocation.data)
    words.insert(words.end(), {"--data", folder.string()});
  for (const std::string& file : invocation.configs) words.insert(words.end(), {"--config", file});
  for (const std::string& text : invocation.overrides) words.insert(words.end(), {"--set", text});
  for (std::size_t k = 0; k < keys.size(); ++k)
    words.insert(words.end(), {"--set", keys[k].name + "=" + run.values[k]});
  return words;
}

// What a run would be told is wrong with the option is wrong with what varies it.
std::string blaming_vary(std::string message, const std::vector<VariedKey>& keys) {
  for (const VariedKey& key : keys) {
    if (!message.starts_with("--set " + key.name + "=")) continue;
    const std::size_t said = message.find(": " + key.name);
    if (said != message.npos) return "--vary" + message.substr(said);
  }
  return message;
}

// What no run could do is refused before anything is written: InputError where neither the first
// nor the last can be loaded. One whose values alone are bad is a row of the table.
void require_one_that_loads(const Sweep& asked, const Invocation& invocation,
                            const std::vector<VariedKey>& keys, const std::vector<SweepRun>& runs,
                            const Registry& registry) {
  std::string first_error;
  for (const SweepRun* run : {&runs.front(), &runs.back()}) {
    Invocation one = invocation;
    one.quiet = true;
    for (std::size_t k = 0; k < keys.size(); ++k)
      one.overrides.push_back(keys[k].name + "=" + run->values[k]);
    try {
      load_mission(asked.script, one, registry);
      return;
    } catch (const InputError& error) {
      if (first_error.empty()) first_error = error.what();
    }
  }
  throw InputError(blaming_vary(first_error, keys));
}

// A folder that a new sweep may use: InputError where it holds files of a sweep's names that no
// sweep wrote, or, unless it was named by --out, the sweep of another script.
void require_sweep_folder(const Sweep& asked, const Invocation& invocation, const fs::path& out,
                          const std::vector<SweepRun>& runs) {
  const fs::path file = out / kStatement;
  std::error_code code;
  if (fs::exists(file, code)) {
    const Value before = from_json(read_file(file), file.string());
    const Value* script = before.find("script");
    if (invocation.out.empty() && script && script->is_text() &&
        script->as_text() != asked.script.string())
      throw InputError("'" + out.string() + "' contains the sweep of '" + script->as_text() +
                       "'; give another folder with -o, or -o " + out.string() + " to replace it");
    return;
  }
  std::vector<fs::path> names{out / kTable, out / kReport, out / "plan.json"};
  for (const SweepRun& run : runs) names.push_back(run.folder);
  for (const fs::path& name : names)
    if (fs::exists(name, code))
      throw InputError("'" + out.string() + "' holds '" + name.filename().string() +
                       "', which no sweep wrote; give another folder with -o");
}

// Of a folder that this process has claimed.
void begin(const Sweep& asked, const Invocation& invocation, const fs::path& out,
           const Value& statement, const std::vector<SweepRun>& runs) {
  const fs::path file = out / kStatement;
  std::error_code code;
  const bool there = fs::exists(file, code);
  if (asked.items.continues() && (there || !asked.items.shard)) {
    if (!there)
      throw InputError(asked.items.name() + ": there is no sweep in '" + out.string() + "'");
    open_statement(file, statement, asked.items, "sweep");
    return;
  }
  require_sweep_folder(asked, invocation, out, runs);
  if (asked.items.shard) {
    open_statement(file, statement, asked.items, "sweep");
    return;
  }
  if (there) {
    if (!invocation.quiet)
      std::cerr << "lapwing: replaces the sweep in '" << visible_line(out.string()) << "'\n";
    fs::remove(file);
    remove_old_runs(out);
  }
  write_file_atomically(file, to_json(statement) + "\n");
}

// The items: a run each.
ItemList items_of(std::vector<SweepRun>& runs, const fs::path& out,
                  const std::function<std::vector<std::string>(const SweepRun&)>& words,
                  const Value& mark, const CancellationToken& cancellation, Progress& progress) {
  ItemList list;
  list.folder = out;
  for (const SweepRun& run : runs)
    list.items.push_back({(fs::path(run.name) / kRunFile).string(), 0, {}});
  list.is_made = [&](std::size_t item) { return has_run(runs[item], mark); };
  list.make = [&, words](std::size_t item, const void*) {
    do_run(runs[item], words(runs[item]), mark, cancellation);
  };
  list.done = [&, made = std::size_t{0}](std::size_t) mutable {
    ++made;
    progress.report(static_cast<double>(made) / static_cast<double>(runs.size()),
                    std::to_string(made) + " of " + std::to_string(runs.size()) + " runs done");
  };
  return list;
}

void print_results(const Sweep& asked, const Invocation& invocation,
                   const std::vector<VariedKey>& keys, const std::vector<SweepRun>& runs,
                   const fs::path& out) {
  write_files_together(out, {{{kTable, sweep_csv(keys, runs)},
                              {kReport, sweep_page(asked.script.string(), keys, runs)}}});
  if (invocation.json)
    print_json(sweep_value(keys, runs));
  else if (!invocation.quiet)
    std::cout << sweep_text(keys, runs, columns_of_stdout())
              << "\ntable: " << visible_line((out / kTable).string())
              << "\nreport: " << visible_line((out / kReport).string()) << std::endl;
}

ExitStatus status_of(const std::vector<SweepRun>& runs, bool interrupted) {
  if (interrupted) {
    std::cerr << "lapwing: interrupted; the same command with --resume runs what is missing\n";
    return ExitStatus::interrupted;
  }
  int worst = 0;
  for (const SweepRun& run : runs) {
    if (!run.exit) {
      std::cerr << "lapwing: " << run.name << " was ended by a signal; --resume runs it again\n";
      return ExitStatus::defect;
    }
    worst = std::max(worst, *run.exit);
  }
  return static_cast<ExitStatus>(worst);
}

ExitStatus sweep(const Sweep& asked, const Invocation& invocation, const Registry& registry,
                 ItemRun& run, const CancellationToken& cancellation) {
  if (asked.varied.empty()) throw InputError("sweep: expected --vary KEY=VALUE,VALUE,...");
  if (!fs::exists(asked.script))
    throw InputError("there is no script '" + asked.script.string() + "'");
  std::vector<VariedKey> keys;
  for (const std::string& text : asked.varied) keys.push_back(read_varied(text));
  const fs::path out = invocation.out.empty() ? fs::path("out") / "sweep" : invocation.out;
  std::vector<SweepRun> runs = combinations(keys, out);
  require_one_that_loads(asked, invocation, keys, runs, registry);
  require_writable(out / kStatement);
  const Value statement = statement_of(asked, invocation, registry);
  const Value mark = made_by(std::string("lapwing ") + program_version(), statement);
  ProgressLine progress("sweep", std::cerr,
                        progress_style_of_stderr(invocation.quiet || !run.leads()),
                        columns_of_stderr(), &steady_seconds);
  std::optional<FolderClaim> claim;  // two sweeps in one folder would remove each other's runs
  bool interrupted = false;
  try {
    const ItemList list = items_of(
        runs, out, [&](const SweepRun& one) { return words_of(one, keys, asked, invocation); },
        mark, cancellation, progress);
    const bool whole = run.make(list, statement, [&] {
      claim.emplace(out, claim_for(asked.items));
      begin(asked, invocation, out, statement, runs);
    });
    progress.clear();
    if (!whole) return print_answer(run, invocation);
  } catch (const Cancelled&) {
    progress.clear();
    if (asked.items.shard || !claim) throw;
    interrupted = true;
  }
  for (SweepRun& one : runs) {  // some were done by other processes
    one = SweepRun{one.name, one.values, one.folder, {}, {}, {}, {}, {}};
    read_results(one);
  }
  print_results(asked, invocation, keys, runs, out);
  return status_of(runs, interrupted);
}

}  // namespace

ExitStatus sweep_missions(const Sweep& asked, const Invocation& invocation) {
  const Registry registry = invocation.registry();
  Invocation with_jobs = invocation;
  with_jobs.threads = asked.jobs;
  ItemOptions options = asked.items;
  options.usual_threads = 2;
  return run_items(options, with_jobs, registry,
                   [&](ItemRun& run, const CancellationToken& cancellation) {
                     return sweep(asked, invocation, registry, run, cancellation);
                   });
}

}  // namespace lapwing
