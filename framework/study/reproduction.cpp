// SPDX-License-Identifier: Apache-2.0
#include "framework/study/reproduction.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
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
  bool flag(const char* key, bool otherwise) const {
    const Value* found = value_.find(key);
    return found ? found->as_boolean() : otherwise;
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

// Studies are folders, beside reproduction.json.
void require_study_name(const std::string& name, const Origin& origin) {
  const bool usual = !name.empty() && name != "reproduction" &&
                     name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == name.npos;
  if (!usual)
    throw InputError(origin,
                     "a study's name has small letters, digits and '_', and is not "
                     "'reproduction': '" +
                         name + "'");
}

ReproducedStudy study_from(const std::string& name, const Value& value) {
  require_study_name(name, value.origin());
  const KnownMap given(value, "study " + name, {"command", "arguments", "options", "quick"});
  ReproducedStudy study;
  study.name = name;
  study.command = given.need("command").as_text();
  for (const Value& argument : given.list("arguments"))
    study.arguments.push_back(word_of(argument));
  study.options = given.map("options");
  study.quick = given.map("quick");
  study.origin = value.origin();
  return study;
}

ReproducedColumn column_from(const Value& value) {
  const KnownMap given(value, "a column",
                       {"name", "unit", "study", "figure", "interval", "records", "where", "scale",
                        "digits", "quick"});
  ReproducedColumn column;
  column.name = word_of(given.need("name"));
  column.unit = given.text("unit");
  column.study = given.text("study");
  column.figure = given.text("figure");
  column.interval = given.text("interval");
  column.records = given.text("records");
  column.where = given.map("where");
  column.scale = given.number("scale", 1);
  const double digits = given.number("digits", 2);
  if (digits != std::floor(digits) || digits < 0 || digits > 9)
    throw InputError(value.origin(),
                     "column '" + column.name + "': digits is a whole number from 0 to 9");
  column.digits = static_cast<int>(digits);
  column.quick = given.flag("quick", true);
  return column;
}

ReproducedRow row_from(const Value& value, std::size_t columns) {
  const KnownMap given(value, "a row", {"name", "study", "figure", "where", "thesis", "quick"});
  ReproducedRow row;
  row.name = word_of(given.need("name"));
  row.study = given.text("study");
  row.where = given.map("where");
  row.figure = given.text("figure");
  row.quick = given.flag("quick", true);
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

std::size_t column_place(const Reproduction& made, const std::string& name, const Origin& origin) {
  return static_cast<std::size_t>(&named(made.columns, name, "column", origin) -
                                  made.columns.data());
}

Value::List one_or_more(const Value& value) {
  return value.is_list() ? value.as_list() : Value::List{value};
}

// What the thesis is said to claim must be what its figures say, where there are figures.
void require_claimed(const Reproduction& made, const ReproducedRank& rank, const Origin& origin) {
  const ReproducedRow& above = named(made.rows, rank.above, "row", origin);
  const ReproducedRow& below = named(made.rows, rank.below, "row", origin);
  const std::size_t column = column_place(made, rank.column, origin);
  if (!rank.of_thesis) return;
  const Value &more = above.thesis[column], &less = below.thesis[column];
  if (more.is_number() && less.is_number()) {
    if (more.as_number() > less.as_number()) return;
    throw InputError(origin, "rank: in the thesis, '" + rank.above + "' is not above '" +
                                 rank.below + "' in '" + rank.column + "'");
  }
  for (const ReproducedRow& row : made.rows)
    if (row.thesis[column].is_number())
      throw InputError(origin, "rank: the thesis has no figures of '" + rank.above + "' and '" +
                                   rank.below + "' in '" + rank.column +
                                   "'; write `claim: lapwing` if it is ours");
}

// Every two rows whose figures differ in the thesis.
void add_order(const std::string& name, const Origin& origin, Reproduction& made) {
  const std::size_t column = column_place(made, name, origin);
  std::vector<const ReproducedRow*> rows;
  for (const ReproducedRow& row : made.rows)
    if (row.thesis[column].is_number()) rows.push_back(&row);
  const auto figure = [&](const ReproducedRow* row) { return row->thesis[column].as_number(); };
  std::stable_sort(rows.begin(), rows.end(), [&](const ReproducedRow* a, const ReproducedRow* b) {
    return figure(a) > figure(b);
  });
  if (rows.empty() || figure(rows.front()) == figure(rows.back()))
    throw InputError(origin, "order: the thesis has no two different figures in '" + name + "'");
  for (std::size_t a = 0; a < rows.size(); ++a)
    for (std::size_t b = a + 1; b < rows.size(); ++b)
      if (figure(rows[a]) > figure(rows[b]))
        made.ranks.push_back({rows[a]->name, rows[b]->name, name, true, true});
}

void add_ranks(const Value& entry, Reproduction& made) {
  if (entry.is_map() && entry.find("order")) {
    const KnownMap given(entry, "an order", {"order"});
    for (const Value& column : one_or_more(given.need("order")))
      add_order(word_of(column), entry.origin(), made);
    return;
  }
  const KnownMap given(entry, "a rank", {"above", "below", "column", "claim", "order"});
  const std::string claim = given.text("claim", "thesis");
  if (claim != "thesis" && claim != "lapwing")
    throw InputError(entry.origin(), "a rank's claim is thesis or lapwing, not '" + claim + "'");
  for (const Value& column : one_or_more(given.need("column")))
    for (const Value& below : one_or_more(given.need("below"))) {
      made.ranks.push_back({given.need("above").as_text(), below.as_text(), word_of(column),
                            claim == "thesis", false});
      require_claimed(made, made.ranks.back(), entry.origin());
    }
}

bool is_finite_number(const std::string& text) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  return !text.empty() && *end == '\0' && std::isfinite(number);
}

void add_rest(const KnownMap& given, const Value& file, Reproduction& made) {
  for (const Value& entry : given.list("ranks")) add_ranks(entry, made);
  if (const Value* entry = given.find("paired")) {
    const KnownMap paired(*entry, "paired", {"to", "column", "by"});
    made.paired = {paired.need("to").as_text(), {}, paired.need("by").as_text()};
    named(made.rows, made.paired->to, "row", entry->origin());
    for (const Value& column : one_or_more(paired.need("column")))
      made.paired->columns.push_back(
          named(made.columns, word_of(column), "column", entry->origin()).name);
  }
  if (const Value* entry = given.find("chart")) {
    const KnownMap chart(*entry, "chart", {"axis", "unit"});
    made.chart_axis = chart.need("axis").as_text();
    made.chart_unit = chart.text("unit");
    for (const auto& column : made.columns)
      if (!is_finite_number(column.name))
        throw InputError(file.origin(), "chart: column '" + column.name + "' is not a number");
  }
  for (const Value& entry : given.list("pictures"))
    made.pictures.push_back(pictures_from(entry, made.studies));
  for (const Value& sentence : given.list("differs")) made.differs.push_back(sentence.as_text());
}

// A table or figure of the same number before one whose name is alike.
std::string nearest_of(const std::vector<std::string>& names, const std::string& name) {
  const auto number = [](const std::string& text) {
    return text.substr(std::min(text.find_first_of("0123456789"), text.size()));
  };
  for (const std::string& one : names)
    if (!number(name).empty() && number(one) == number(name)) return one;
  return nearest_name(name, names);
}

fs::path file_named(const fs::path& folder, const std::string& name) {
  const std::vector<std::string> names = reproduction_names(folder);
  if (std::find(names.begin(), names.end(), name) != names.end()) return folder / (name + ".yaml");
  const std::string nearest = nearest_of(names, name);
  std::string all;
  for (const std::string& one : names) all += (all.empty() ? "" : ", ") + one;
  throw InputError("no table or figure '" + name + "'" +
                   (nearest.empty() ? "" : " (did you mean '" + nearest + "'?)") + "; there are " +
                   all);
}

// `sharing`: the name of a file that takes its studies, or "".
Reproduction read_table(const fs::path& folder, const std::string& name,
                        const std::string& sharing);

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

std::string ReproducedStudy::checksum() const {
  Value all = Value::map();
  all.set("command", command);
  all.set("arguments", Value(Value::List(arguments.begin(), arguments.end())));
  all.set("options", options);
  all.set("quick", quick);
  return sha256(to_json(all));
}

Reproduction read_reproduction(const fs::path& folder, const std::string& name) {
  return read_table(folder, name, "");
}

namespace {

Reproduction read_table(const fs::path& folder, const std::string& name,
                        const std::string& sharing) {
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
  if (const Value* from = given.find("from")) {
    if (!sharing.empty())
      throw InputError(from->origin(), "'" + sharing + "' takes its studies from '" + name +
                                           "', which takes them from '" + word_of(*from) +
                                           "': name the one that states them");
    if (given.find("studies"))
      throw InputError(from->origin(), "'from' and 'studies': give one of them");
    Reproduction other = read_table(folder, word_of(*from), name);
    made.owner = other.name;
    made.studies = std::move(other.studies);
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
  if (made.pictures.empty() && (made.rows.empty() || made.columns.empty()))
    throw InputError(file.origin(), "'" + path.string() + "' has neither figures nor pictures");
  return made;
}

}  // namespace
}  // namespace lapwing
