// SPDX-License-Identifier: Apache-2.0
#include "framework/study/reproduced_table.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>

#include "framework/core/error.h"
#include "framework/core/json.h"
#include "framework/study/csv.h"
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

std::string fixed(double number, int digits) {
  if (!std::isfinite(number)) return "-";
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, number);
  return text;
}

std::string shown(const ReproducedCell& cell, int digits) {
  std::string text = fixed(cell.mean, digits);
  if (std::isfinite(cell.interval)) text += " +- " + fixed(cell.interval, digits);
  if (cell.left_out > 0)
    text += " (" + std::to_string(cell.count) + " of " +
            std::to_string(cell.count + cell.left_out) + ")";
  return text;
}

std::string said_text(const Value& thesis, int digits) {
  if (thesis.is_null()) return "-";
  return thesis.is_text() ? thesis.as_text() : fixed(thesis.as_number(), digits);
}

bool has_left_out(const ReproducedTable& table) {
  for (const auto& row : table.cells)
    for (const ReproducedCell& cell : row)
      if (cell.left_out > 0) return true;
  return false;
}

bool any_thesis(const ReproducedTable& table, std::size_t column) {
  for (const auto& row : table.cells)
    if (!row[column].thesis.is_null()) return true;
  return false;
}

std::string title_of(const ReproducedColumn& column) {
  return column.name + (column.unit.empty() ? "" : ", " + column.unit);
}

std::string below_title(const ReproducedTable& table, const std::string& column) {
  return column + " below " + table.made.paired->to;
}

int digits_of(const ReproducedTable& table, const std::string& column) {
  return table.made.columns[place_of(table.made.columns, column)].digits;
}

Value finite_value(double number) {
  return std::isfinite(number) ? Value(number) : Value();
}

Value to_value(const ReproducedCell& cell) {
  Value value = Value::map();
  value.set("ours", finite_value(cell.mean));
  value.set("interval", finite_value(cell.interval));
  value.set("count", static_cast<std::int64_t>(cell.count));
  value.set("left_out", static_cast<std::int64_t>(cell.left_out));
  value.set("thesis", cell.thesis);
  return value;
}

bool has_figures(const RankFound& found) {
  return std::isfinite(found.above) && std::isfinite(found.below);
}

std::string rank_sentence(const RankFound& found) {
  std::string text = found.rank.column + ": '" + found.rank.above + "' above '" + found.rank.below +
                     "', as " + (found.rank.of_thesis ? "in the thesis" : "expected of Lapwing") +
                     "? ";
  if (!has_figures(found)) return text + "One of them has no figure";
  text += found.holds() ? "Yes" : "NO";
  if (!std::isfinite(found.interval))
    text += ", intervals unknown";
  else if (!found.clear())
    text += ", within the intervals";
  return text + ": " + fixed(found.above, 3) + " and " + fixed(found.below, 3);
}

// How many of a column's whole order hold; the others are told one by one.
std::string order_sentences(const ReproducedTable& table) {
  std::string text;
  for (const ReproducedColumn& column : table.made.columns) {
    std::size_t all = 0, none = 0, held = 0, open = 0, unknown = 0;
    for (const RankFound& found : table.ranks) {
      if (!found.rank.of_order || found.rank.column != column.name) continue;
      ++all;
      none += !has_figures(found);
      if (!found.holds()) continue;
      ++held;
      if (!std::isfinite(found.interval))
        ++unknown;
      else if (!found.clear())
        ++open;
    }
    if (all == 0) continue;
    text +=
        "* " + column.name + ": of " + std::to_string(all) + " orders of two rows in the thesis, " +
        (none > 0 ? std::to_string(none) + " have no figures here and " : "") +
        std::to_string(held) + " hold; " + std::to_string(open) + " of them within the intervals" +
        (unknown > 0 ? ", " + std::to_string(unknown) + " with unknown intervals" : "") + ".\n";
  }
  return text;
}

Chart chart_of(const ReproducedTable& table) {
  Chart chart;
  chart.title = table.made.title;
  chart.x = {table.made.chart_axis, table.made.chart_unit};
  chart.y = {"", table.made.columns.front().unit};
  for (std::size_t r = 0; r < table.cells.size(); ++r) {
    Series series;
    series.name = table.made.rows[r].name;
    for (std::size_t c = 0; c < table.cells[r].size(); ++c) {
      series.x.push_back(std::stod(table.made.columns[c].name));
      series.y.push_back(table.cells[r][c].mean);
    }
    chart.series.push_back(std::move(series));
  }
  return chart;
}

// What a block is known by in a report: its title or caption, or nothing.
std::string name_of(const Block& block) {
  return std::visit(
      [](const auto& one) -> std::string {
        if constexpr (requires { one.title; })
          return one.title;
        else if constexpr (requires { one.caption; })
          return one.caption;
        else
          return "";
      },
      block);
}

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
  Assembly(made, records).require_records(quick);
}

Section chosen_pictures(const ReproducedPictures& asked, const std::vector<Section>& sections) {
  const auto nothing = [&](const std::string& what, const std::string& there) {
    return InputError("study '" + asked.study + "': its report has no " + what + "; there are " +
                      there);
  };
  std::string there;
  const Section* found = nullptr;
  for (const Section& section : sections) {
    there += (there.empty() ? "'" : ", '") + section.title + "'";
    if (section.title == asked.section) found = &section;
  }
  if (!found) throw nothing("section '" + asked.section + "'", there);
  if (asked.blocks.empty()) return {asked.title, found->blocks};
  Section chosen{asked.title, {}};
  for (const std::string& wanted : asked.blocks) {
    there.clear();
    std::vector<const Block*> blocks;
    for (const Block& block : found->blocks) {
      const std::string name = name_of(block);
      if (name.starts_with(wanted)) blocks.push_back(&block);
      if (!name.empty()) there += (there.empty() ? "'" : ", '") + name + "'";
    }
    const std::string of = "'" + wanted + "' in its section '" + asked.section + "'";
    if (blocks.empty()) throw nothing(of, there);
    if (blocks.size() > 1) throw nothing("single " + of, there);
    chosen.blocks.push_back(*blocks.front());
  }
  return chosen;
}

std::vector<std::vector<std::string>> table_cells(const ReproducedTable& table) {
  if (table.cells.empty()) return {};
  std::vector<std::vector<std::string>> rows(1 + table.cells.size());
  rows[0].push_back("");
  for (std::size_t r = 0; r < table.cells.size(); ++r)
    rows[r + 1].push_back(table.made.rows[r].name);
  for (std::size_t c = 0; c < table.made.columns.size(); ++c) {
    const ReproducedColumn& column = table.made.columns[c];
    const bool beside = any_thesis(table, c);
    rows[0].push_back(title_of(column));
    if (beside) rows[0].push_back("thesis");
    for (std::size_t r = 0; r < table.cells.size(); ++r) {
      const ReproducedCell& cell = table.cells[r][c];
      rows[r + 1].push_back(shown(cell, column.digits));
      if (beside) rows[r + 1].push_back(said_text(cell.thesis, column.digits));
    }
  }
  if (!table.made.paired) return rows;
  for (std::size_t c = 0; c < table.made.paired->columns.size(); ++c) {
    const std::string& column = table.made.paired->columns[c];
    rows[0].push_back(below_title(table, column));
    for (std::size_t r = 0; r < table.cells.size(); ++r) {
      const auto& below = table.below[r][c];
      rows[r + 1].push_back(below ? shown(*below, digits_of(table, column)) : "");
    }
  }
  return rows;
}

std::string table_notes(const ReproducedTable& table) {
  std::string text = table.caption + "\n";
  if (has_left_out(table))
    text +=
        "In brackets: how many of the tours count. A tour that was not found has no figure, nor "
        "has one of an integer program that the greedy method beats by the program's own "
        "rewards.\n";
  for (const std::string& sentence : table.warnings) text += "! " + sentence + "\n";
  text += order_sentences(table);
  for (const RankFound& rank : table.ranks)
    if (!rank.rank.of_order || (has_figures(rank) && !rank.holds()))
      text += "* " + rank_sentence(rank) + ".\n";
  if (!table.made.differs.empty()) text += "Why the figures differ from the thesis's:\n";
  for (const std::string& sentence : table.made.differs) text += "* " + sentence + "\n";
  return text;
}

std::string table_csv(const ReproducedTable& table) {
  std::string out = "row,column,unit,ours,interval,count,left_out,thesis\n";
  const auto line = [&](const std::string& row, const std::string& column, const std::string& unit,
                        const ReproducedCell& cell) {
    out += csv_text(row) + "," + csv_text(column) + "," + csv_text(unit) + "," +
           csv_number(cell.mean) + "," + csv_number(cell.interval) + "," +
           std::to_string(cell.count) + "," + std::to_string(cell.left_out) + "," +
           csv_text(cell.thesis.is_null() ? "" : said_text(cell.thesis, 6)) + "\n";
  };
  for (std::size_t r = 0; r < table.cells.size(); ++r) {
    for (std::size_t c = 0; c < table.cells[r].size(); ++c)
      line(table.made.rows[r].name, table.made.columns[c].name, table.made.columns[c].unit,
           table.cells[r][c]);
    for (std::size_t c = 0; c < table.below[r].size(); ++c)
      if (const auto& below = table.below[r][c])
        line(table.made.rows[r].name, below_title(table, table.made.paired->columns[c]), "",
             *below);
  }
  return out;
}

Value to_value(const ReproducedTable& table) {
  Value value = Value::map();
  value.set("table", table.made.name);
  value.set("title", table.made.title);
  value.set("thesis", table.made.thesis);
  value.set("caption", table.caption);
  Value& rows = value.set("rows", Value::list());
  for (std::size_t r = 0; r < table.cells.size(); ++r) {
    Value row = Value::map();
    row.set("name", table.made.rows[r].name);
    Value& cells = row.set("cells", Value::map());
    for (std::size_t c = 0; c < table.cells[r].size(); ++c)
      cells.set(table.made.columns[c].name, to_value(table.cells[r][c]));
    Value below = Value::map();
    for (std::size_t c = 0; c < table.below[r].size(); ++c)
      if (table.below[r][c]) below.set(table.made.paired->columns[c], to_value(*table.below[r][c]));
    if (!below.as_map().empty()) row.set("below", std::move(below));
    rows.push_back(std::move(row));
  }
  value.set("warnings", Value(Value::List(table.warnings.begin(), table.warnings.end())));
  Value& ranks = value.set("ranks", Value::list());
  for (const RankFound& found : table.ranks) {
    Value rank = Value::map();
    rank.set("above", found.rank.above);
    rank.set("below", found.rank.below);
    rank.set("column", found.rank.column);
    rank.set("claim", found.rank.of_thesis ? "thesis" : "lapwing");
    const bool known = has_figures(found);
    rank.set("holds", known ? Value(found.holds()) : Value());
    rank.set("clear", known && std::isfinite(found.interval) ? Value(found.clear()) : Value());
    ranks.push_back(std::move(rank));
  }
  return value;
}

Report table_report(const ReproducedTable& table) {
  Report report;
  report.title = table.made.title;
  report.subtitle = "Thesis: " + table.made.thesis;
  if (const auto cells = table_cells(table); !cells.empty()) {
    Table shown_table;
    shown_table.title = table.made.title;
    for (const std::string& title : cells.front()) shown_table.columns.push_back({title, ""});
    for (std::size_t r = 1; r < cells.size(); ++r) {
      TableRow row;
      for (const std::string& cell : cells[r]) row.cells.emplace_back(cell);
      shown_table.rows.push_back(std::move(row));
    }
    Section section{"Table", {shown_table}};
    if (!table.made.chart_axis.empty()) section.blocks.push_back(chart_of(table));
    report.sections.push_back(std::move(section));
  }
  report.sections.insert(report.sections.end(), table.pictures.begin(), table.pictures.end());
  TextBlock notes;
  for (const char c : table_notes(table)) notes.text += c == '\n' ? "\n\n" : std::string(1, c);
  report.sections.push_back({"Notes", {notes}});
  return report;
}

}  // namespace lapwing
