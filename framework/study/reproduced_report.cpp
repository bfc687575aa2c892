// SPDX-License-Identifier: Apache-2.0
#include "framework/study/reproduced_report.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "framework/core/error.h"
#include "framework/study/csv.h"

namespace lapwing {
namespace {

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
  const std::vector<ReproducedColumn>& columns = table.made.columns;
  return std::find_if(columns.begin(), columns.end(),
                      [&](const ReproducedColumn& one) { return one.name == column; })
      ->digits;
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

std::string rank_sentence(const RankFound& found) {
  std::string text = found.rank.column + ": '" + found.rank.above + "' above '" + found.rank.below +
                     "', as " + (found.rank.of_thesis ? "in the thesis" : "expected of Lapwing") +
                     "? ";
  if (!found.has_figures()) return text + "One of them has no figure";
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
      none += !found.has_figures();
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
    if (!rank.rank.of_order || (rank.has_figures() && !rank.holds()))
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
    const bool known = found.has_figures();
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
