// SPDX-License-Identifier: Apache-2.0
#include "framework/study/reproduced_table.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>

#include "framework/core/error.h"
#include "framework/core/json.h"
#include "framework/study/stratified_sample.h"

namespace lapwing {
namespace {

constexpr double kNoFigure = std::numeric_limits<double>::quiet_NaN();

// "with_first/f", "observed/20" within a record, entries of lists from 1; null where it is not
// there.
const Value* at_place(const Value& record, const std::string& place) {
  const Value* value = &record;
  for (std::size_t begin = 0; value && begin <= place.size();) {
    const std::size_t end = std::min(place.find('/', begin), place.size());
    const std::string step = place.substr(begin, end - begin);
    if (value->is_list()) {
      const std::size_t number = static_cast<std::size_t>(std::atoi(step.c_str()));
      const Value::List& list = value->as_list();
      value = number >= 1 && number <= list.size() ? &list[number - 1] : nullptr;
    } else {
      value = value->find(step);
    }
    begin = end + 1;
  }
  return value;
}

// Whether a record may have something there: in a list that is shorter, another record may.
bool may_have(const Value& record, const std::string& place) {
  const Value* value = &record;
  for (std::size_t begin = 0; begin <= place.size();) {
    const std::size_t end = std::min(place.find('/', begin), place.size());
    if (value->is_list()) return true;
    value = value->find(place.substr(begin, end - begin));
    if (!value) return false;
    if (value->is_null()) return true;
    begin = end + 1;
  }
  return true;
}

bool fits(const Value& record, const Value& where) {
  for (const auto& [place, wanted] : where.as_map()) {
    const Value* found = at_place(record, place);
    if (!found) return false;
    const bool numbers = found->is_number() && wanted.is_number();
    if (numbers ? found->as_number() != wanted.as_number() : !(*found == wanted)) return false;
  }
  return true;
}

std::string join_places(const std::string& a, const std::string& b) {
  return a + (a.empty() || b.empty() ? "" : "/") + b;
}

RecordSource source_of(const Reproduction& made, const ReproducedRow& row,
                       const ReproducedColumn& column) {
  const std::string& study = !column.study.empty() ? column.study
                             : !row.study.empty()  ? row.study
                                                   : made.studies.front().name;
  return {study, column.records};
}

// Of records of `evaluate scan`: what is said of such a tour is no figure of its method.
bool is_left_out(const Value& record) {
  for (const char* key : {"found", "counts"})
    if (const Value* said = record.find(key); said && *said == Value(false)) return true;
  return false;
}

struct RecordFigures {
  std::vector<std::pair<double, const Value*>> used;  // and their records
  std::size_t left_out = 0;
};

ReproducedCell cell_of(const RecordFigures& figures) {
  ReproducedCell cell{kNoFigure, kNoFigure, 0, figures.left_out, Value()};
  if (figures.used.empty()) return cell;
  StratifiedSample sample;
  for (const auto& [figure, record] : figures.used) sample.add(figure);
  cell.mean = sample.mean();
  cell.interval = sample.interval();
  cell.count = sample.count();
  return cell;
}

template <class Entry>
std::size_t place_of(const std::vector<Entry>& entries, const std::string& name) {
  for (std::size_t k = 0; k < entries.size(); ++k)
    if (entries[k].name == name) return k;
  throw Error("no entry '" + name + "'");
}

class Assembly {
 public:
  Assembly(const Reproduction& made, const std::map<RecordSource, Value::List>& records)
      : made_(made), records_(records) {}

  // A place that no record has is a mistake of the table.
  void require_places() const {
    for (const ReproducedRow& row : made_.rows)
      for (const ReproducedColumn& column : made_.columns) {
        const RecordSource source = source_of(made_, row, column);
        require(source, join_places(column.figure, row.figure));
        for (const Value* where : {&row.where, &column.where})
          for (const auto& [place, wanted] : where->as_map()) require(source, place);
        if (is_paired(column)) require(source, made_.paired->by);
      }
  }

  // A row or a column that no record fits is one, too.
  void require_records(bool quick) const {
    for (const ReproducedRow& row : made_.rows) {
      if (quick && !row.quick) continue;
      if (std::any_of(made_.columns.begin(), made_.columns.end(),
                      [&](const ReproducedColumn& column) {
                        return has_record(source_of(made_, row, column), {&row.where});
                      }))
        continue;
      refuse("row '" + row.name + "'", source_of(made_, row, made_.columns.front()), row.where);
    }
    for (const ReproducedColumn& column : made_.columns) {
      if (quick && !column.quick) continue;
      if (std::any_of(made_.rows.begin(), made_.rows.end(), [&](const ReproducedRow& row) {
            return has_record(source_of(made_, row, column), {&row.where, &column.where});
          }))
        continue;
      refuse("column '" + column.name + "'", source_of(made_, made_.rows.front(), column),
             column.where);
    }
  }

  // The figure of every record of a cell, and the record.
  RecordFigures figures(const ReproducedRow& row, const ReproducedColumn& column) const {
    RecordFigures all;
    const std::string place = join_places(column.figure, row.figure);
    for (const Value& record : records_.at(source_of(made_, row, column))) {
      if (!fits(record, row.where) || !fits(record, column.where)) continue;
      if (is_left_out(record)) {
        ++all.left_out;
        continue;
      }
      const Value* figure = at_place(record, place);
      if (!figure || figure->is_null()) continue;
      if (!figure->is_number())
        throw InputError("table " + made_.name + ", row '" + row.name + "', column '" +
                         column.name + "': '" + place + "' is " + figure->describe_type() +
                         ", not a number");
      all.used.emplace_back(column.scale * figure->as_number(), &record);
    }
    return all;
  }

  ReproducedCell cell(const ReproducedRow& row, std::size_t column) const {
    const ReproducedColumn& of = made_.columns[column];
    const RecordFigures found = figures(row, of);
    ReproducedCell cell = cell_of(found);
    cell.thesis = row.thesis[column];
    if (found.used.size() != 1 || of.interval.empty()) return cell;
    const Value* interval = at_place(*found.used.front().second, of.interval);
    if (interval && interval->is_number()) cell.interval = of.scale * interval->as_number();
    return cell;
  }

  // How far a row is below another, record by record.
  ReproducedCell below(const ReproducedRow& row, const ReproducedRow& to,
                       const ReproducedColumn& column, const std::string& by) const {
    RecordFigures differences;
    const RecordFigures ours = figures(row, column), others = figures(to, column);
    for (const auto& [figure, record] : ours.used)
      for (const auto& [other, beside] : others.used) {
        const Value *a = at_place(*record, by), *b = at_place(*beside, by);
        if (a && b && *a == *b) differences.used.emplace_back(other - figure, record);
      }
    return cell_of(differences);
  }

  RankFound rank(const ReproducedRank& asked) const {
    const std::size_t column = place_of(made_.columns, asked.column);
    const ReproducedRow& above = made_.rows[place_of(made_.rows, asked.above)];
    const ReproducedRow& below_it = made_.rows[place_of(made_.rows, asked.below)];
    const ReproducedCell more = cell(above, column), less = cell(below_it, column);
    RankFound found{asked, more.mean, less.mean, std::hypot(more.interval, less.interval)};
    const ReproducedColumn& of = made_.columns[column];
    if (!made_.paired || source_of(made_, above, of) != source_of(made_, below_it, of))
      return found;
    const ReproducedCell pairs = below(below_it, above, of, made_.paired->by);
    if (pairs.count > 1 && pairs.count == more.count && pairs.count == less.count)
      found.interval = pairs.interval;
    return found;
  }

 private:
  bool is_paired(const ReproducedColumn& column) const {
    if (!made_.paired) return false;
    const std::vector<std::string>& names = made_.paired->columns;
    return std::find(names.begin(), names.end(), column.name) != names.end();
  }

  // That fits all of `wheres`.
  bool has_record(const RecordSource& source, std::initializer_list<const Value*> wheres) const {
    const Value::List& all = records_.at(source);
    return std::any_of(all.begin(), all.end(), [&](const Value& record) {
      return std::all_of(wheres.begin(), wheres.end(),
                         [&](const Value* where) { return fits(record, *where); });
    });
  }

  // Names the first entry of `where` that no record has, and what they have instead.
  [[noreturn]] void refuse(const std::string& what, const RecordSource& source,
                           const Value& where) const {
    std::string reason;
    for (const auto& [place, wanted] : where.as_map()) {
      std::set<std::string> there;
      bool found = false;
      for (const Value& record : records_.at(source))
        if (const Value* value = at_place(record, place)) {
          there.insert(to_json(*value, -1));
          found = found || fits(record, Value(Value::Map{{place, wanted}}));
        }
      if (found) continue;
      reason = " with " + place + " " + to_json(wanted, -1) + "; there are";
      for (const std::string& value : there)
        reason += (value == *there.begin() ? " " : ", ") + value;
      break;
    }
    throw InputError("table " + made_.name + ", " + what + ": study '" + source.first +
                     "' has no record" + (reason.empty() ? " of it" : reason));
  }

  void require(const RecordSource& source, const std::string& place) const {
    const Value::List& all = records_.at(source);
    for (const Value& record : all)
      if (may_have(record, place)) return;
    if (all.empty()) return;
    std::string there;
    for (const auto& [key, value] : all.front().as_map())
      there += (there.empty() ? "" : ", ") + key;
    throw InputError("table " + made_.name + ": no record of study '" + source.first + "' has '" +
                     place + "'; the first has " + there);
  }

  const Reproduction& made_;
  const std::map<RecordSource, Value::List>& records_;
};

}  // namespace

std::vector<RecordSource> record_sources(const Reproduction& made) {
  std::set<RecordSource> sources;
  for (const ReproducedRow& row : made.rows)
    for (const ReproducedColumn& column : made.columns)
      sources.insert(source_of(made, row, column));
  return {sources.begin(), sources.end()};
}

ReproducedTable reproduced_table(const Reproduction& made,
                                 const std::map<RecordSource, Value::List>& records,
                                 std::string caption) {
  const Assembly assembly(made, records);
  assembly.require_places();
  ReproducedTable table;
  table.made = made;
  table.caption = std::move(caption);
  for (const ReproducedRow& row : made.rows) {
    auto& cells = table.cells.emplace_back();
    for (std::size_t c = 0; c < made.columns.size(); ++c) cells.push_back(assembly.cell(row, c));
    auto& below = table.below.emplace_back();
    if (!made.paired) continue;
    const ReproducedRow& to = made.rows[place_of(made.rows, made.paired->to)];
    for (const std::string& name : made.paired->columns) {
      const ReproducedColumn& column = made.columns[place_of(made.columns, name)];
      below.emplace_back();
      // The conditions of another study differ, and so would more than the method.
      if (&row != &to && source_of(made, row, column) == source_of(made, to, column))
        below.back() = assembly.below(row, to, column, made.paired->by);
    }
  }
  for (const ReproducedRank& rank : made.ranks) table.ranks.push_back(assembly.rank(rank));
  return table;
}

void require_records(const Reproduction& made, const std::map<RecordSource, Value::List>& records,
                     bool quick) {
  const Assembly assembly(made, records);
  assembly.require_places();  // first: a mistyped place is no reason to name values
  assembly.require_records(quick);
}

}  // namespace lapwing
