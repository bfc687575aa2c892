// SPDX-License-Identifier: Apache-2.0
#include "framework/study/reproduction.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "framework/config/overrides.h"
#include "framework/config/yaml.h"
#include "framework/core/checksum.h"
#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/parameters.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

// A map of which every key is known.
class KnownMap {
 public:
  KnownMap(const Value& value, const std::string& what, std::vector<std::string> known)
      : value_(value), what_(what) {
    if (!value.is_map())
      throw InputError(value.origin(), what + ": expected a table, not " + value.describe_type());
    for (const auto& [key, entry] : value.as_map()) {
      if (std::find(known.begin(), known.end(), key) != known.end()) continue;
      const std::string nearest = nearest_name(key, known);
      throw InputError(entry.origin(),
                       what + " has no key '" + key + "'" +
                           (nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
    }
  }

  const Value* find(const char* key) const { return value_.find(key); }
  const Value& need(const char* key) const {
    if (const Value* found = value_.find(key)) return *found;
    throw InputError(value_.origin(), what_ + " needs '" + key + "'");
  }
  std::string text(const char* key, const std::string& otherwise = "") const {
    const Value* found = value_.find(key);
    return found ? found->as_text() : otherwise;
  }
  double number(const char* key, double otherwise) const {
    const Value* found = value_.find(key);
    return found ? found->as_number() : otherwise;
  }
  Value map(const char* key) const {
    const Value* found = value_.find(key);
    if (!found) return Value::map();
    found->as_map();
    return *found;
  }
  const Value::List& list(const char* key) const {
    static const Value::List none;
    const Value* found = value_.find(key);
    return found ? found->as_list() : none;
  }

 private:
  const Value& value_;
  std::string what_;
};

std::string word_of(const Value& value) {
  return value.is_text() ? value.as_text() : to_json(value, -1);
}

ReproducedStudy study_from(const std::string& name, const Value& value) {
  const KnownMap given(value, "study " + name, {"command", "arguments", "options", "quick"});
  ReproducedStudy study{.name = name, .command = given.need("command").as_text(), .arguments = {}};
  for (const Value& argument : given.list("arguments"))
    study.arguments.push_back(word_of(argument));
  study.options = given.map("options");
  study.quick = given.map("quick");
  return study;
}

ReproducedColumn column_from(const Value& value) {
  const KnownMap given(
      value, "a column",
      {"name", "unit", "study", "figure", "interval", "records", "where", "scale", "digits"});
  ReproducedColumn column;
  column.name = word_of(given.need("name"));
  column.unit = given.text("unit");
  column.study = given.text("study");
  column.figure = given.text("figure");
  column.interval = given.text("interval");
  column.records = given.text("records");
  column.where = given.map("where");
  column.scale = given.number("scale", 1);
  column.digits = static_cast<int>(given.number("digits", 2));
  return column;
}

ReproducedRow row_from(const Value& value, std::size_t columns) {
  const KnownMap given(value, "a row", {"name", "study", "figure", "where", "thesis"});
  ReproducedRow row;
  row.name = word_of(given.need("name"));
  row.study = given.text("study");
  row.where = given.map("where");
  row.figure = given.text("figure");
  row.thesis = given.list("thesis");
  for (const Value& said : row.thesis)
    if (!said.is_null() && !said.is_number() && !said.is_text())
      throw InputError(said.origin(), "row '" + row.name +
                                          "': thesis has numbers, texts and null, not " +
                                          said.describe_type());
  if (!row.thesis.empty() && row.thesis.size() != columns)
    throw InputError(value.origin(), "row '" + row.name + "': thesis has " +
                                         std::to_string(row.thesis.size()) + " figures for " +
                                         std::to_string(columns) + " columns");
  row.thesis.resize(columns);
  return row;
}

template <class Entry>
const Entry& named(const std::vector<Entry>& entries, const std::string& name, const char* what,
                   const Origin& origin) {
  std::vector<std::string> names;
  for (const Entry& entry : entries) {
    if (entry.name == name) return entry;
    names.push_back(entry.name);
  }
  const std::string nearest = nearest_name(name, names);
  throw InputError(origin, std::string("no ") + what + " '" + name + "'" +
                               (nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
}

template <class Entry>
void require_names_once(const std::vector<Entry>& entries, const char* what, const Value& file) {
  std::set<std::string> names;
  for (const Entry& entry : entries)
    if (!names.insert(entry.name).second)
      throw InputError(file.origin(), std::string("two ") + what + " '" + entry.name + "'");
}

// Which study a cell is of must be clear, and which figure.
void require_studies(const Reproduction& made, const Value& file) {
  for (const auto& column : made.columns)
    if (!column.study.empty()) named(made.studies, column.study, "study", file.origin());
  for (const auto& row : made.rows) {
    if (!row.study.empty()) named(made.studies, row.study, "study", file.origin());
    for (const auto& column : made.columns)
      if (row.figure.empty() && column.figure.empty())
        throw InputError(file.origin(), "row '" + row.name + "' and column '" + column.name +
                                            "': one of them needs `figure`");
    for (const auto& column : made.columns)
      if (row.study.empty() && column.study.empty() && made.studies.size() != 1)
        throw InputError(file.origin(), "row '" + row.name + "' and column '" + column.name +
                                            "': one of them needs `study`, there are several");
  }
}

ReproducedPictures pictures_from(const Value& value, const std::vector<ReproducedStudy>& studies) {
  const KnownMap given(value, "a picture", {"title", "study", "section", "blocks"});
  ReproducedPictures pictures{.title = given.need("title").as_text(),
                              .study = given.need("study").as_text(),
                              .section = given.need("section").as_text(),
                              .blocks = {}};
  for (const Value& block : given.list("blocks")) pictures.blocks.push_back(block.as_text());
  if (named(studies, pictures.study, "study", value.origin()).command != "run")
    throw InputError(value.origin(), "study '" + pictures.study +
                                         "' has no pictures: those of `run` have a report");
  return pictures;
}

void add_rest(const KnownMap& given, const Value& file, Reproduction& made) {
  for (const Value& entry : given.list("ranks")) {
    const KnownMap rank(entry, "a rank", {"above", "below", "column"});
    made.ranks.push_back(
        {rank.need("above").as_text(), rank.need("below").as_text(), word_of(rank.need("column"))});
    named(made.rows, made.ranks.back().above, "row", entry.origin());
    named(made.rows, made.ranks.back().below, "row", entry.origin());
    named(made.columns, made.ranks.back().column, "column", entry.origin());
  }
  if (const Value* entry = given.find("paired")) {
    const KnownMap paired(*entry, "paired", {"to", "column", "by"});
    made.paired = {paired.need("to").as_text(), word_of(paired.need("column")),
                   paired.need("by").as_text()};
    named(made.rows, made.paired->to, "row", entry->origin());
    named(made.columns, made.paired->column, "column", entry->origin());
  }
  if (const Value* entry = given.find("chart")) {
    const KnownMap chart(*entry, "chart", {"axis", "unit"});
    made.chart_axis = chart.need("axis").as_text();
    made.chart_unit = chart.text("unit");
    for (const auto& column : made.columns)
      if (column.name.find_first_not_of("0123456789.") != column.name.npos)
        throw InputError(file.origin(), "chart: column '" + column.name + "' is not a number");
  }
  for (const Value& entry : given.list("pictures"))
    made.pictures.push_back(pictures_from(entry, made.studies));
  for (const Value& sentence : given.list("differs")) made.differs.push_back(sentence.as_text());
}

fs::path file_named(const fs::path& folder, const std::string& name) {
  const std::vector<std::string> names = reproduction_names(folder);
  if (std::find(names.begin(), names.end(), name) != names.end()) return folder / (name + ".yaml");
  const std::string nearest = nearest_name(name, names);
  std::string all;
  for (const std::string& one : names) all += (all.empty() ? "" : ", ") + one;
  throw InputError("no table or figure '" + name + "'" +
                   (nearest.empty() ? "" : " (did you mean '" + nearest + "'?)") + "; there are " +
                   all);
}

}  // namespace

std::vector<std::string> ReproducedStudy::words(bool quickly) const {
  std::vector<std::string> words = arguments;
  Value all = options;
  if (quickly)
    for (const auto& [key, value] : quick.as_map()) all.set(key, value);
  for (const auto& [key, value] : all.as_map()) {
    if (value == Value(false) || value.is_null()) continue;
    if (value == Value(true)) {
      words.push_back("--" + key);
      continue;
    }
    const Value::List one{value};
    for (const Value& entry : value.is_list() ? value.as_list() : one) {
      words.push_back("--" + key);
      words.push_back(word_of(entry));
    }
  }
  return words;
}

std::vector<std::string> reproduction_names(const fs::path& folder) {
  std::vector<std::string> names;
  if (fs::is_directory(folder))
    for (const auto& item : fs::directory_iterator(folder))
      if (item.path().extension() == ".yaml") names.push_back(item.path().stem().string());
  const auto numbers = [](const std::string& name) {
    const std::size_t first = std::min(name.find_first_of("0123456789"), name.size());
    const std::size_t dot = std::min(name.find('.', first), name.size());
    return std::tuple(std::atoi(name.c_str() + first), first,
                      dot < name.size() ? std::atoi(name.c_str() + dot + 1) : 0);
  };
  std::sort(names.begin(), names.end(), [&](const std::string& a, const std::string& b) {
    return std::pair(numbers(a), a) < std::pair(numbers(b), b);
  });
  return names;
}

Reproduction read_reproduction(const fs::path& folder, const std::string& name) {
  const fs::path path = file_named(folder, name);
  const std::string text = read_file(path);
  const Value file = from_yaml(text, path.string());
  const KnownMap given(file, "'" + path.string() + "'",
                       {"title", "thesis", "from", "studies", "columns", "rows", "ranks", "paired",
                        "chart", "pictures", "differs"});
  Reproduction made;
  made.name = made.owner = name;
  made.title = given.need("title").as_text();
  made.thesis = given.need("thesis").as_text();
  made.checksum = sha256(text);
  if (const Value* from = given.find("from")) {
    if (given.find("studies"))
      throw InputError(from->origin(), "'from' and 'studies': give one of them");
    Reproduction other = read_reproduction(folder, word_of(*from));
    if (other.owner != other.name)
      throw InputError(from->origin(), "'" + other.name + "' takes its studies from '" +
                                           other.owner + "' itself: name that");
    made.owner = other.name;
    made.studies = std::move(other.studies);
    made.checksum = sha256(made.checksum + other.checksum);
  } else {
    for (const auto& [study, value] : given.need("studies").as_map())
      made.studies.push_back(study_from(study, value));
  }
  const bool of_pictures = given.find("pictures") && !given.find("columns") && !given.find("rows");
  if (!of_pictures) {
    for (const Value& column : given.need("columns").as_list())
      made.columns.push_back(column_from(column));
    for (const Value& row : given.need("rows").as_list())
      made.rows.push_back(row_from(row, made.columns.size()));
  }
  require_names_once(made.columns, "columns", file);
  require_names_once(made.rows, "rows", file);
  require_studies(made, file);
  add_rest(given, file, made);
  return made;
}

}  // namespace lapwing
