// SPDX-License-Identifier: Apache-2.0
// A table or a figure of the thesis as one YAML file says how to make it again: which commands, on
// what, and which of their figures stand in which row and column, beside the thesis's own.
//
//   title: Courtyard, 2,700 m
//   thesis: table 4.3
//   studies:
//     courtyard:
//       command: evaluate scan
//       arguments: ["{examples}/scan/courtyard.lua"]
//       options: {seeds: "1,2,3,4,5", method: [greedy, circle_50]}  # --seeds ..., --method ...
//       quick: {seeds: 1}                                           # over the options
//   columns:
//     - {name: F, unit: "%", figure: with_first/f, scale: 100}
//   rows:
//     - {name: NextBestView, where: {method: greedy}, thesis: [79.30]}
//   pictures:
//     - {title: The path, study: flight, section: Path, blocks: [Path from above]}
//   ranks:
//     - {order: F}                                          # all that the thesis's figures say
//     - {above: NextBestView, below: [A, B], column: time}  # that one is above others
//   differs: [why figures cannot be compared, one sentence each]
//
// Pictures are blocks of the reports of studies whose command is `run`; a figure of pictures alone
// has neither columns nor rows.
// `from: "4.3"` in place of `studies` takes those of another file, and shares what they have done.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/value.h"

namespace lapwing {

struct ReproducedStudy {
  std::string name;
  std::string command;                 // "evaluate scan"
  std::vector<std::string> arguments;  // with places in braces: {examples}, {data:FILE}, ...
  Value options = Value::map();
  Value quick = Value::map();  // laid over the options when there is little time

  Origin origin;  // in the file of its table

  // The command's words: arguments, then options, of which a list gives one each and `true` a flag.
  std::vector<std::string> words(bool quickly) const;
  // SHA-256 of all that it is told: results of another one are others.
  std::string checksum() const;
};

struct ReproducedColumn {
  std::string name, unit;
  std::string study;     // ""; the row's, or the only one
  std::string figure;    // place in a record, "with_first/f"; the row's own follows
  std::string interval;  // place of its 95 % interval, of records that are means themselves
  // Folder of JSON files below that of the study, which are the records; "": its answer is.
  std::string records;
  Value where = Value::map();  // what a record must have
  double scale = 1;
  int digits = 2;
  bool quick = true;  // whether the quick version has records of it
};

struct ReproducedRow {
  std::string name;
  std::string study;
  std::string figure;  // place below that of the column
  Value where = Value::map();
  std::vector<Value> thesis;  // one for each column: a number, a text such as "30-60", or null
  bool quick = true;          // whether the quick version has records of it
};

// An order of two figures, which holds or does not hold of ours.
struct ReproducedRank {
  std::string above, below, column;  // names
  // Whose claim it is. The thesis's figures, where it has both, agree with its own.
  bool of_thesis = true;
  bool of_order = false;  // one of all that the thesis's figures of its column say
};

// Differences to one row, record by record of equal `by`.
struct PairedDifference {
  std::string to;                    // a row's name
  std::vector<std::string> columns;  // names
  std::string by;                    // "seed"
};

// Blocks of the report of a study's run.
struct ReproducedPictures {
  std::string title;           // above them, in our report
  std::string study, section;  // whose report, and which of its sections
  // By what their titles or captions begin with, in this order; empty: the whole section.
  std::vector<std::string> blocks;
};

struct Reproduction {
  std::string name;   // of the file: "4.3"
  std::string owner;  // of the file that states the studies: its own name unless it has `from`
  std::string title, thesis;
  std::vector<ReproducedStudy> studies;
  std::vector<ReproducedColumn> columns;
  std::vector<ReproducedRow> rows;
  std::vector<ReproducedRank> ranks;
  std::optional<PairedDifference> paired;
  std::vector<ReproducedPictures> pictures;
  std::vector<std::string> differs;
  std::string chart_axis, chart_unit;  // not empty: columns are places on this axis, named by it
};

// Of the YAML files of a folder, by chapter, tables first: "4.1", "4.2", "figure_4.12", "5.1".
std::vector<std::string> reproduction_names(const std::filesystem::path& folder);

// InputError for an unknown name, with the nearest, and for a malformed file, with its lines.
Reproduction read_reproduction(const std::filesystem::path& folder, const std::string& name);

}  // namespace lapwing
