// SPDX-License-Identifier: Apache-2.0
// A table of the thesis made again: the figures of studies, and the thesis's own beside them.
#pragma once

#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "framework/export/report.h"
#include "framework/study/reproduction.h"

namespace lapwing {

struct ReproducedCell {
  double mean = 0;      // not a number: no record has it
  double interval = 0;  // half the width of the 95 % interval; not a number below two records
  std::size_t count = 0;
  std::size_t left_out = 0;  // records of tours that were not found, or that do not count
  Value thesis;
};

struct RankFound {
  ReproducedRank rank;
  double above = 0, below = 0;  // our means
  // Half the width of the 95 % interval of their difference: by pairs if the table has pairs of
  // both, else as if they did not depend on each other. Not a number: unknown, of single records.
  double interval = 0;
  bool has_figures() const { return std::isfinite(above) && std::isfinite(below); }
  bool holds() const { return above > below; }
  bool clear() const { return std::abs(above - below) > interval; }
};

struct ReproducedTable {
  Reproduction made;
  std::string caption;                             // what was run, one paragraph
  std::vector<std::vector<ReproducedCell>> cells;  // by row, by column
  // By row, by column of `paired`: how far below that row.
  std::vector<std::vector<std::optional<ReproducedCell>>> below;
  std::vector<RankFound> ranks;
  std::vector<Section> pictures;      // of the report, one for each of `made.pictures`
  std::vector<std::string> warnings;  // sentences: what a reader of the figures must know
};

// Where the records of a cell come from: a study, and the folder of them or "".
using RecordSource = std::pair<std::string, std::string>;
std::vector<RecordSource> record_sources(const Reproduction& made);

// `records`: of all sources. A cell is the mean of the figure over the records of its study that
// have what its row and its column ask for, without tours that were not found and those that do not
// count (study/scan_row.h). InputError for a figure that is not a number, and for places that no
// record of the study has.
ReproducedTable reproduced_table(const Reproduction& made,
                                 const std::map<RecordSource, Value::List>& records,
                                 std::string caption);

// InputError for a place that no record of the study has, and for a row or a column that no record
// fits: its `where` has a mistake. The quick version leaves out rows and columns that say so.
void require_records(const Reproduction& made, const std::map<RecordSource, Value::List>& records,
                     bool quick);

}  // namespace lapwing
