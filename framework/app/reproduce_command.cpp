// SPDX-License-Identifier: Apache-2.0
#include "framework/app/reproduce_command.h"

#include <algorithm>
#include <chrono>
#include <iostream>

#include "framework/app/child_command.h"
#include "framework/app/input_checksums.h"
#include "framework/app/interruption.h"
#include "framework/app/item_command.h"
#include "framework/app/mission_loading.h"
#include "framework/app/text_table.h"
#include "framework/config/shipped.h"
#include "framework/core/checksum.h"
#include "framework/core/file_set.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/visible_text.h"
#include "framework/explore/view_utility.h"
#include "framework/export/report_value.h"
#include "framework/study/reproduced_report.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestFile = std::size_t{4} << 30;  // bytes, of data that a study reads

fs::path definitions() {
  return shipped_folder("configs") / "reproduce";
}

// What is written between braces in words of a study: {examples}, {here} (the folder of the
// tables), {data:FILE}, {model:UTILITY}, {study:NAME}.
class Places {
 public:
  Places(const Registry& registry, std::vector<fs::path> data, fs::path studies)
      : registry_(registry), data_(std::move(data)), studies_(std::move(studies)) {}

  // Studies are filled in their order: one may read what those before it made.
  std::vector<std::string> filled(const ReproducedStudy& study, bool quick) {
    std::vector<std::string> words;
    for (const std::string& word : study.words(quick)) words.push_back(filled(word, study));
    before_.push_back(study.name);
    return words;
  }

  const std::vector<std::string>& missing() const { return missing_; }

 private:
  std::string filled(const std::string& word, const ReproducedStudy& study) {
    std::string out;
    for (std::size_t at = 0; at < word.size();) {
      const std::size_t open = word.find('{', at), close = word.find('}', open);
      if (close == word.npos) return out + word.substr(at);
      out += word.substr(at, open - at) + place(word.substr(open + 1, close - open - 1), study);
      at = close + 1;
    }
    return out;
  }

  std::string place(const std::string& text, const ReproducedStudy& study) {
    const std::size_t colon = std::min(text.find(':'), text.size());
    const std::string kind = text.substr(0, colon);
    const std::string name = colon < text.size() ? text.substr(colon + 1) : "";
    if (kind == "examples") return shipped_folder("examples").string();
    if (kind == "here") return definitions().string();
    if (kind == "study") return made_before(name, study);
    if (kind == "model") {
      const fs::path library = registry_.find(ViewUtility::kKind, name).library;
      return (library.parent_path() / (name + ".model")).string();
    }
    if (kind == "data") return data_file(name);
    const bool a_word =
        !text.empty() && text.find_first_not_of("abcdefghijklmnopqrstuvwxyz_") == text.npos;
    if (a_word)
      throw InputError(study.origin,
                       "study '" + study.name + "': no place {" + text +
                           "}: there are {examples}, {here}, {data:FILE}, {model:UTILITY} and "
                           "{study:NAME}");
    return "{" + text + "}";  // a table of YAML's, such as --set region={...}
  }

  std::string made_before(const std::string& name, const ReproducedStudy& study) const {
    if (std::find(before_.begin(), before_.end(), name) != before_.end())
      return (studies_ / name).string();
    std::string names;
    for (const std::string& one : before_) names += (names.empty() ? "" : ", ") + one;
    throw InputError(study.origin, "study '" + study.name + "': no study '" + name + "' before it" +
                                       (names.empty() ? "" : "; there are ") + names);
  }

  std::string data_file(const std::string& name) {
    for (const fs::path& folder : data_)
      if (fs::exists(folder / name)) return (folder / name).string();
    if (std::find(missing_.begin(), missing_.end(), name) == missing_.end())
      missing_.push_back(name);
    return name;
  }

  const Registry& registry_;
  std::vector<fs::path> data_;
  fs::path studies_;
  std::vector<std::string> before_;  // names of the studies filled so far
  std::vector<std::string> missing_;
};

std::vector<std::string> words_in(const std::string& text) {
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    if (end > begin) words.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

// How commands are told where to write, and to continue what is there.
struct CommandWays {
  const char* command;
  const char* out;  // "": nowhere
  bool resumes;
  bool quiets;
  bool threads;
};
constexpr CommandWays kCommands[] = {{"evaluate scan", "--out", true, true, true},
                                     {"evaluate explore", "--out", true, true, true},
                                     {"train dataset", "--output", true, true, true},
                                     {"train fit", "--output", true, true, true},
                                     {"train score", "", false, false, false},
                                     {"run", "--out", false, true, true},
                                     {"tour", "", false, false, false}};

const CommandWays& ways_of(const ReproducedStudy& study) {
  std::string all;
  for (const CommandWays& ways : kCommands) {
    if (study.command == ways.command) return ways;
    all += (all.empty() ? "" : ", ") + std::string(ways.command);
  }
  throw InputError(study.origin, "study '" + study.name + "': '" + study.command +
                                     "' is not a command of studies: " + all);
}

class Reproducing {
 public:
  Reproducing(const ReproduceRequest& asked, const Invocation& invocation)
      : asked_(asked),
        invocation_(invocation),
        registry_(invocation.registry()),
        made_(read_reproduction(definitions(), asked.table)),
        base_(invocation.out.empty() ? fs::path("out") / "reproduce" : invocation.out) {
    prepare_words();
  }

  ExitStatus run() {
    const FolderClaim claim(studies());
    claim_version();
    try {
      for (std::size_t k = 0; k < made_.studies.size(); ++k)
        if (!fs::exists(answer_of(made_.studies[k].name))) ask(made_.studies[k], words_[k]);
    } catch (const InputError&) {
      release_version();
      throw;
    } catch (const Cancelled&) {
      if (!invocation_.quiet)
        std::cerr << "`lapwing reproduce " << made_.name << "` continues with --resume"
                  << std::endl;
      throw;
    }
    std::map<RecordSource, Value::List> records;
    for (const RecordSource& source : record_sources(made_)) records[source] = records_of(source);
    require_records(made_, records, asked_.quick);
    ReproducedTable table = reproduced_table(made_, records, caption());
    for (const ReproducedPictures& asked : made_.pictures) table.pictures.push_back(drawn(asked));
    table.warnings = outcomes();
    write(table);
    return ExitStatus::done;
  }

 private:
  std::string folder_name(const std::string& table) const {
    return table + (asked_.quick ? "_quick" : "");
  }
  fs::path studies() const { return base_ / folder_name(made_.owner); }

  void prepare_words() {
    MissionSettings settings = mission_settings(invocation_, registry_);
    Places places(registry_, settings.data, studies());
    for (const ReproducedStudy& study : made_.studies) {
      ways_of(study);
      words_.push_back(places.filled(study, asked_.quick));
    }
    if (places.missing().empty()) return;
    std::string names;
    for (const std::string& name : places.missing()) names += (names.empty() ? "" : ", ") + name;
    throw InputError(made_.thesis + " needs data that are not there: " + names +
                     "; name the folder that has them by --data DIR or LAPWING_DATA");
  }

  // Of the files that the words of the studies name: missions, with modules of theirs, and data.
  // What a study makes for another one is no input.
  Value checksums_of_files() const {
    Value sums = Value::map();
    for (const std::vector<std::string>& words : words_)
      for (const std::string& word : words) {
        const fs::path file = word.substr(0, word.find('@'));  // FILE@X,Y,Z of worlds
        std::error_code code;
        if (file.string().starts_with(studies().string()) || !fs::is_regular_file(file, code))
          continue;
        if (file.extension() == ".lua")
          add_script_checksums(file, file.parent_path(), sums.set(file.string(), Value::map()));
        else if (!sums.find(file.string()))
          sums.set(file.string(), sha256(read_file(file, kLargestFile)));
      }
    return sums;
  }

  // What results depend on. Of studies and files, each by itself: what is not made yet may change.
  Value version() const {
    Value stated = Value::map();
    stated.set("format", 2);
    stated.set("program", std::string("lapwing ") + program_version());
    stated.set("executable", program_checksum());
    stated.set("table", made_.owner);
    stated.set("quick", asked_.quick);
    stated.set("scripts", checksum_of_folder(shipped_folder("scripts")));
    stated.set("configs", checksum_of_folder(shipped_folder("configs"), {"reproduce"}));
    stated.set("plugins", sha256(to_json(plugin_checksums(registry_))));
    Value& told = stated.set("studies", Value::map());
    for (const ReproducedStudy& study : made_.studies) told.set(study.name, study.checksum());
    stated.set("files", checksums_of_files());
    return stated;
  }

  // All in a folder is of one version. Tables may share it: it says which were asked for.
  void claim_version() const {
    const fs::path file = studies() / "reproduction.json";
    Value claimed = version();
    Value tables = Value::list();
    if (fs::exists(file)) {
      const Value there = from_json(read_file(file), file.string());
      if (const Value* asked = there.find("tables")) tables = *asked;
      const bool again =
          std::count(tables.as_list().begin(), tables.as_list().end(), Value(made_.name)) > 0;
      if (again && !asked_.resume)
        throw InputError("'" + studies().string() + "' contains a reproduction of " + made_.thesis +
                         ": continue it with --resume, or choose another folder with --out");
      require_same(there, claimed, file);
      // What other tables and earlier definitions named stays named.
      for (const char* key : {"studies", "files"})
        for (const auto& [name, sum] : there.at(key).as_map())
          if (!claimed.at(key).find(name)) claimed.find(key)->set(name, sum);
      if (!again) tables.push_back(made_.name);
    } else {
      if (fs::exists(studies()) && !fs::is_empty(studies()))
        throw InputError("'" + studies().string() +
                         "' is not empty, and not of a reproduction: choose another folder with "
                         "--out");
      tables.push_back(made_.name);
    }
    claimed.set("tables", std::move(tables));
    write_file_atomically(file, to_json(claimed) + "\n");
  }

  void require_same(const Value& there, const Value& here, const fs::path& file) const {
    for (const auto& [key, value] : here.as_map()) {
      const Value* before = there.find(key);
      if (before && *before == value) continue;
      std::string what = key;
      if (before && before->is_map() && value.is_map()) {
        what = changed(key, *before, value);
        if (what.empty()) continue;
      } else {
        what += " is " + (before ? to_json(*before, -1) : "not said") + " there, " +
                to_json(value, -1) + " here";
      }
      throw InputError("'" + file.string() + "': the reproduction there is of another version (" +
                       what +
                       "): --resume continues the same one only; choose another folder with "
                       "--out");
    }
  }

  // The first study or file that is another one than there; "" if what differs is not made yet.
  std::string changed(const std::string& key, const Value& there, const Value& here) const {
    for (const auto& [name, sum] : here.as_map()) {
      const Value* before = there.find(name);
      if (!before || *before == sum) continue;
      if (key == "files") return "file '" + name + "' is another one";
      if (fs::exists(answer_of(name)) || fs::exists(studies() / name))
        return "study '" + name + "' was told something else";
    }
    return "";
  }

  // A folder in which nothing was made is free for a corrected table: its claim takes it away.
  void release_version() const {
    const auto items = fs::directory_iterator(studies());
    if (std::distance(fs::begin(items), fs::end(items)) == 1)
      fs::remove(studies() / "reproduction.json");
  }

  fs::path answer_of(const std::string& study) const { return studies() / (study + ".json"); }

  Value::List records_of(const RecordSource& source) const {
    const auto& [study, folder] = source;
    if (!folder.empty()) return records_in(studies() / study / folder);
    const fs::path answer = answer_of(study);
    const Value all = from_json(read_file(answer), answer.string());
    for (const char* key : {"rows", "tours"})
      if (const Value* rows = all.find(key); rows && rows->is_list()) return rows->as_list();
    return {all};
  }

  Section drawn(const ReproducedPictures& asked) const {
    const fs::path file = studies() / asked.study / "report.json";
    const Value report = from_json(read_file(file), file.string());
    return chosen_pictures(asked, report_from_value(report).sections);
  }

  static Value::List records_in(const fs::path& folder) {
    std::vector<fs::path> files;
    for (const auto& item : fs::directory_iterator(folder))
      if (item.path().extension() == ".json") files.push_back(item.path());
    std::sort(files.begin(), files.end());
    Value::List records;
    for (const fs::path& file : files) records.push_back(from_json(read_file(file), file.string()));
    return records;
  }

  void ask(const ReproducedStudy& study, const std::vector<std::string>& words) const {
    const CommandWays& ways = ways_of(study);
    std::vector<std::string> all{"lapwing"};
    for (const fs::path& path : invocation_.plugin_path)
      all.insert(all.end(), {"--plugin-path", path.string()});
    for (const std::string& word : words_in(study.command)) all.push_back(word);
    all.insert(all.end(), words.begin(), words.end());
    if (*ways.out) all.insert(all.end(), {ways.out, (studies() / study.name).string()});
    if (study.command == "run") all.push_back("--report-data");
    if (ways.resumes) all.push_back("--resume");
    if (ways.quiets && invocation_.quiet) all.push_back("--quiet");
    if (invocation_.threads > 0 && ways.threads)
      all.insert(all.end(), {"--threads", std::to_string(invocation_.threads)});
    const bool has_json = study.command != "train dataset";
    if (has_json) all.push_back("--json");
    if (!invocation_.quiet)
      std::cerr << visible_line(made_.thesis + ", study " + study.name + ": " + study.command)
                << std::endl;
    const auto begun = std::chrono::steady_clock::now();
    const ChildAnswer said = run_child(all, interruption_.token());
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begun;
    const bool silent = said.status > 1 && said.output.empty();  // it said why on standard error
    Value object =
        has_json && !silent ? from_json(said.output, "study " + study.name) : Value::map();
    const Value* error = object.find("error");
    if (said.status > 1 || error) {
      // Its reason is on standard error already; an object of --json has to hold it, too.
      throw InputError("study '" + study.name + "' of " + made_.thesis + ": " +
                       (invocation_.json && error && error->is_text()
                            ? error->as_text()
                            : "`lapwing " + study.command + "` ended with exit status " +
                                  std::to_string(said.status)));
    }
    if (object.is_map()) object.set("wall_seconds", taken.count());
    write_file_atomically(answer_of(study.name), to_json(object) + "\n");
  }

  // Of runs that are not certified.
  std::vector<std::string> outcomes() const {
    std::vector<std::string> sentences;
    for (const ReproducedStudy& study : made_.studies) {
      if (study.command != "run") continue;
      const fs::path file = answer_of(study.name);
      const Value answer = from_json(read_file(file), file.string());
      const Value* status = answer.find("status");
      if (!status || !status->is_text() || status->as_text() == "ok") continue;
      sentences.push_back("The plan of study '" + study.name +
                          "' is not certified: its status is '" + status->as_text() + "'.");
    }
    return sentences;
  }

  // What was run, and what a quick look leaves out.
  std::string caption() const {
    std::string text = made_.title + " (" + made_.thesis + ").";
    for (const ReproducedStudy& study : made_.studies) {
      if (!asked_.quick || study.quick.as_map().empty()) continue;
      text += " Quick, " + study.name + ":";
      for (const auto& [key, value] : study.quick.as_map()) {
        const Value* whole = study.options.find(key);
        text += " " + key + " " + to_json(value, -1) +
                (whole ? " in place of " + to_json(*whole, -1) : "") + ";";
      }
      text.back() = '.';
    }
    const bool smaller =
        std::any_of(made_.studies.begin(), made_.studies.end(),
                    [](const ReproducedStudy& study) { return !study.quick.as_map().empty(); });
    if (asked_.quick && !smaller) text += " There is no quicker version: this is the whole.";
    return text;
  }

  void write(const ReproducedTable& table) const {
    const fs::path folder = base_ / folder_name(made_.name);
    const std::string shown = text_of(TextTable{.rows = table_cells(table)}, 100'000);
    write_files_together(folder,
                         {{{"table.txt", shown + (shown.empty() ? "" : "\n") + table_notes(table)},
                           {"table.csv", table_csv(table)},
                           {"report.html", render_html(table_report(table))}}});
    const std::string report = (folder / "report.html").string();
    if (invocation_.json) {
      Value object = Value::map();
      object.set("status", "ok");
      object.set("quick", asked_.quick);
      const Value value = to_value(table);
      for (const auto& [key, entry] : value.as_map()) object.set(key, entry);
      object.set("report", report);
      print_json(object);
    } else if (!invocation_.quiet) {
      std::cout << text_of(TextTable{.rows = table_cells(table)}, columns_of_stdout())
                << (table.cells.empty() ? "" : "\n") << visible_text(table_notes(table))
                << "\nreport: " << visible_line(report) << std::endl;
    }
  }

  const ReproduceRequest& asked_;
  const Invocation& invocation_;
  const Registry registry_;
  const Reproduction made_;
  const fs::path base_;
  std::vector<std::vector<std::string>> words_;  // of each study
  const Interruption interruption_;
};

}  // namespace

ExitStatus list_reproductions(const Invocation& invocation) {
  const fs::path folder = definitions();
  Value list = Value::list();
  TextTable table{.rows = {{"name", "title"}}};
  std::string errors;
  for (const std::string& name : reproduction_names(folder)) {
    Value entry = Value::map();
    entry.set("name", name);
    try {
      const Reproduction made = read_reproduction(folder, name);
      table.rows.push_back({name, made.title});
      entry.set("thesis", made.thesis);
      entry.set("title", made.title);
    } catch (const InputError& error) {  // the others are listed all the same
      errors += std::string(errors.empty() ? "" : "\n") + error.what();
      entry.set("error", error.what());
    }
    list.push_back(std::move(entry));
  }
  if (invocation.json) {
    Value object = Value::map();
    object.set("tables", std::move(list));
    print_json(object);
  } else {
    std::cout << text_of(table, columns_of_stdout());
  }
  if (errors.empty()) return ExitStatus::done;
  std::cout.flush();
  std::cerr << "lapwing: " << visible_text(errors) << std::endl;
  return ExitStatus::bad_input;
}

ExitStatus reproduce_table(const ReproduceRequest& asked, const Invocation& invocation) {
  if (launched_processes() > 1) {
    if (launched_rank() > 0) return ExitStatus::done;  // process 0 says it
    throw InputError(
        "reproduce: mpirun started " + std::to_string(launched_processes()) +
        " processes, but each study of a table is a command in a process of its own; start it "
        "without mpirun, and use --threads");
  }
  if (asked.table == "list") {
    if (asked.quick || asked.resume || !invocation.out.empty() || !invocation.data.empty() ||
        invocation.threads > 0)
      throw InputError(
          "reproduce list: --quick, --resume, --out, --data and --threads are for tables");
    return list_reproductions(invocation);
  }
  return Reproducing(asked, invocation).run();
}

}  // namespace lapwing
