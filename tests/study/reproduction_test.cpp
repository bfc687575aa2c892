// SPDX-License-Identifier: Apache-2.0
#include "framework/study/reproduction.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/study/reproduced_report.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTable = R"(
title: Two methods
thesis: table 9.1
studies:
  hut:
    command: evaluate scan
    arguments: ["{examples}/hut.lua"]
    options: {seeds: "1,2", method: [a, b], photos: true, resume: false}
    quick: {seeds: 1, guard: 5}
columns:
  - {name: F, unit: "%", figure: with_first/f, scale: 100}
  - {name: time, unit: s, figure: seconds, records: times}
rows:
  - {name: A, where: {method: a}, thesis: [50, "10-20"]}
  - {name: B, where: {method: b}, thesis: [40, null]}
ranks: [{above: A, below: B, column: F}]
paired: {to: A, column: F, by: seed}
differs: [The scene is another one.]
)";

class Reproductions : public ::testing::Test {
 protected:
  Reproductions() {
    fs::remove_all(folder_);
    write("9.1", kTable);
  }
  ~Reproductions() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) {
    write_file_atomically(folder_ / (name + ".yaml"), text);
  }
  std::string refusal(const std::string& name) const {
    try {
      read_reproduction(folder_, name);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  // What is said of the file with a part replaced.
  std::string refusal(const std::string& part, const std::string& by) {
    std::string text = kTable;
    text.replace(text.find(part), part.size(), by);
    write("9.2", text);
    return refusal("9.2");
  }

  fs::path folder_ =
      fs::temp_directory_path() / ("lapwing_reproduction_" + std::to_string(::getpid()));
};

TEST_F(Reproductions, StateCommandsAndCells) {
  const Reproduction made = read_reproduction(folder_, "9.1");
  EXPECT_EQ(made.owner, "9.1");
  const std::vector<std::string> words{"{examples}/hut.lua", "--seeds", "1,2",     "--method", "a",
                                       "--method",           "b",       "--photos"};
  EXPECT_EQ(made.studies.front().words(false), words);
  const std::vector<std::string> quick{
      "{examples}/hut.lua", "--seeds", "1",        "--method", "a",
      "--method",           "b",       "--photos", "--guard",  "5"};
  EXPECT_EQ(made.studies.front().words(true), quick);
}

TEST_F(Reproductions, RowsArePairedWithinAStudy) {
  std::string text = kTable;
  const auto put = [&](const std::string& part, const std::string& by) {
    text.replace(text.find(part), part.size(), by);
  };
  put("columns:", "  noisy:\n    command: evaluate scan\n    arguments: [hut.lua]\ncolumns:");
  put("{name: A, where", "{name: A, study: hut, where");
  put("{name: B, where", "{name: B, study: noisy, where");
  put(", records: times", "");
  write("9.2", text);
  const Reproduction made = read_reproduction(folder_, "9.2");
  const auto rows = [](const char* json) { return from_json(json, "rows").as_list(); };
  const ReproducedTable table = reproduced_table(
      made,
      {{{"hut", ""},
        rows(R"([{"method": "a", "seed": 1, "seconds": 1, "with_first": {"f": 0.5}}])")},
       {{"noisy", ""},
        rows(R"([{"method": "b", "seed": 1, "seconds": 1, "with_first": {"f": 0.4}}])")}},
      "caption");
  EXPECT_NEAR(table.cells[1][0].mean, 40, 1e-9);
  EXPECT_FALSE(table.below[1][0]);
}

TEST_F(Reproductions, CellsAreMeansBesideTheThesis) {
  const Reproduction made = read_reproduction(folder_, "9.1");
  const Value::List rows = from_json(R"([{"method": "a", "seed": 1, "with_first": {"f": 0.5}},
                    {"method": "a", "seed": 2, "with_first": {"f": 0.7}},
                    {"method": "b", "seed": 2, "with_first": {"f": 0.4}},
                    {"method": "b", "seed": 1, "with_first": {"f": 0.3}}])",
                                     "rows")
                               .as_list();
  const Value::List times =
      from_json(R"([{"method": "a", "seconds": 7}, {"method": "c", "seconds": 1}])", "times")
          .as_list();
  const ReproducedTable table =
      reproduced_table(made, {{{"hut", ""}, rows}, {{"hut", "times"}, times}}, "caption");
  EXPECT_NEAR(table.cells[0][0].mean, 60, 1e-9);
  // Two values: Student's t of one degree of freedom, 12.7062, times the standard error.
  EXPECT_NEAR(table.cells[0][0].interval, 12.7062 * 10, 1e-3);
  EXPECT_EQ(table.cells[0][1].mean, 7);
  EXPECT_TRUE(std::isnan(table.cells[1][1].mean)) << "there is no record of it";
  ASSERT_TRUE(table.below[1][0]);
  EXPECT_FALSE(table.below[0][0]);
  EXPECT_NEAR(table.below[1][0]->mean, 25, 1e-9) << "seed by seed: 20 and 30";
  EXPECT_NEAR(table.below[1][0]->interval, 12.7062 * 5, 1e-3);
  ASSERT_EQ(table.ranks.size(), 1u);
  EXPECT_TRUE(table.ranks[0].holds());
  const auto cells = table_cells(table);
  const std::vector<std::string> titles{"", "F, %", "thesis", "time, s", "thesis", "F below A"};
  EXPECT_EQ(cells[0], titles);
  EXPECT_EQ(cells[1][2], "50.00");
  EXPECT_EQ(cells[1][4], "10-20");
  EXPECT_EQ(cells[2][2], "40.00");
  EXPECT_EQ(cells[2][4], "-");
  EXPECT_NE(table_notes(table).find(
                "F: 'A' above 'B', as in the thesis? Yes, within the intervals: 60.000"),
            std::string::npos)
      << table_notes(table);
  EXPECT_EQ(table.ranks[0].interval, table.below[1][0]->interval) << "by pairs";
  EXPECT_NE(table_csv(table).find("\nA,F,%,60,"), std::string::npos) << table_csv(table);
  EXPECT_EQ(to_value(table).at("rows").as_list().size(), 2u);
}

TEST_F(Reproductions, ToursThatWereNotFoundOrDoNotCountHaveNoFigure) {
  const Reproduction made = read_reproduction(folder_, "9.1");
  const Value::List rows =
      from_json(R"([{"method": "a", "seed": 1, "found": true, "with_first": {"f": 0.5}},
                    {"method": "a", "seed": 2, "found": true, "with_first": {"f": 0.7}},
                    {"method": "b", "seed": 1, "found": false, "with_first": {"f": 0}},
                    {"method": "b", "seed": 2, "counts": false, "with_first": {"f": 0.2}}])",
                "rows")
          .as_list();
  const Value::List times = from_json(R"([{"method": "a", "seconds": 7}])", "times").as_list();
  const ReproducedTable table =
      reproduced_table(made, {{{"hut", ""}, rows}, {{"hut", "times"}, times}}, "caption");
  EXPECT_TRUE(std::isnan(table.cells[1][0].mean)) << "not the mean of 0 and 20";
  EXPECT_EQ(table.cells[1][0].left_out, 2u);
  EXPECT_EQ(table.below[1][0]->count, 0u);
  EXPECT_EQ(table_cells(table)[2][1], "- (0 of 2)");
  EXPECT_EQ(table_cells(table)[1][1].find(" of "), std::string::npos);
  const std::string notes = table_notes(table);
  EXPECT_NE(notes.find("One of them has no figure"), std::string::npos) << notes;
  EXPECT_NE(notes.find("In brackets: how many of the tours count."), std::string::npos) << notes;
  EXPECT_NE(table_csv(table).find("\nB,F,%,,,0,2,40"), std::string::npos) << table_csv(table);
}

TEST_F(Reproductions, AnOrderIsEveryTwoFiguresThatDifferInTheThesis) {
  write("9.2", R"(
title: Four methods
thesis: table 9.2
studies: {s: {command: evaluate scan}}
columns: [{name: F, figure: f}, {name: G, figure: g}]
rows:
  - {name: A, where: {method: a}, thesis: [20, 7]}
  - {name: B, where: {method: b}, thesis: [30, 7]}
  - {name: C, where: {method: c}, thesis: [20, null]}
  - {name: D, where: {method: d}}
  - {name: E, where: {method: e}, thesis: [10, null]}
ranks: [{order: F}, {above: D, below: A, column: F, claim: lapwing}]
paired: {to: B, column: [F, G], by: seed}
)");
  const Reproduction made = read_reproduction(folder_, "9.2");
  ASSERT_EQ(made.ranks.size(), 6u) << "A and C are equal, and D has no figure in the thesis";
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(made.ranks[k].above, "B");
  const ReproducedTable table =
      reproduced_table(made,
                       {{{"s", ""},
                         from_json(R"([{"method": "a", "seed": 1, "f": 2, "g": 5},
                      {"method": "b", "seed": 1, "f": 3, "g": 9},
                      {"method": "c", "seed": 1, "f": 4, "g": 9},
                      {"method": "d", "seed": 1, "f": 5, "g": 9}])",
                                   "rows")
                             .as_list()}},
                       "caption");
  EXPECT_EQ(table.below[0][0]->mean, 1);
  EXPECT_EQ(table.below[0][1]->mean, 4);
  const std::string notes = table_notes(table);
  EXPECT_NE(notes.find("* F: of 5 orders of two rows in the thesis, 3 have no figures here and 1 "
                       "hold; 0 of them within the intervals, 1 with unknown intervals.\n"),
            std::string::npos)
      << notes;
  EXPECT_EQ(notes.find("'B' above 'A'"), std::string::npos) << "it holds: it is counted";
  EXPECT_EQ(notes.find("above 'E'"), std::string::npos) << "it was not run";
  EXPECT_NE(notes.find("'B' above 'C', as in the thesis? NO"), std::string::npos) << notes;
  EXPECT_NE(notes.find("'D' above 'A', as expected of Lapwing? Yes"), std::string::npos) << notes;
  EXPECT_NE(refusal("ranks: [{above: A, below: B, column: F}]", "ranks: [{order: time}]")
                .find("the thesis has no two different figures in 'time'"),
            std::string::npos);
  EXPECT_NE(
      refusal("{above: A, below: B, column: F}", "{order: F, above: A}").find("no key 'above'"),
      std::string::npos);
}

TEST_F(Reproductions, AQuickVersionLacksOnlyWhatSaysSo) {
  const std::map<RecordSource, Value::List> records = {
      {{"hut", ""},
       from_json(R"([{"method": "a", "seed": 1, "with_first": {"f": 0.5}}])", "rows").as_list()},
      {{"hut", "times"}, from_json(R"([{"method": "a", "seconds": 3}])", "times").as_list()}};
  EXPECT_THROW(require_records(read_reproduction(folder_, "9.1"), records, true), InputError);
  std::string text = kTable;
  const std::string row = "{name: B, ";
  text.replace(text.find(row), row.size(), row + "quick: false, ");
  write("9.2", text);
  const Reproduction said = read_reproduction(folder_, "9.2");
  EXPECT_NO_THROW(require_records(said, records, true));
  EXPECT_THROW(require_records(said, records, false), InputError);
}

TEST_F(Reproductions, ARowOrAColumnThatNoRecordFitsIsAMistake) {
  const auto refused = [&](const std::string& part, const std::string& by) -> std::string {
    std::string text = kTable;
    text.replace(text.find(part), part.size(), by);
    write("9.2", text);
    const Value::List rows = from_json(R"([{"method": "a", "seed": 1, "with_first": {"f": 0.5}},
                      {"method": "b", "seed": 1, "with_first": {"f": 0.4}}])",
                                       "rows")
                                 .as_list();
    const Value::List times =
        from_json(R"([{"method": "a", "seed": 1, "seconds": 3}])", "times").as_list();
    try {
      require_records(read_reproduction(folder_, "9.2"),
                      {{{"hut", ""}, rows}, {{"hut", "times"}, times}}, false);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refused("title", "title"), "") << "B has no time, but F";
  EXPECT_EQ(refused("where: {method: b}", "where: {method: c}"),
            "table 9.2, row 'B': study 'hut' has no record with method \"c\"; there are \"a\", "
            "\"b\"");
  EXPECT_EQ(refused("scale: 100", "where: {seed: 3}"),
            "table 9.2, column 'F': study 'hut' has no record with seed 3; there are 1");
  EXPECT_EQ(refused("where: {method: b}", "where: {method: b, seed: 2}"),
            "table 9.2, row 'B': study 'hut' has no record with seed 2; there are 1");
  EXPECT_EQ(refused("where: {method: b}", "where: {metod: b}"),
            "table 9.2: no record of study 'hut' has 'metod'; the first has method, seed, "
            "with_first");
}

TEST_F(Reproductions, MeansBringTheirOwnIntervals) {
  write("9.3", R"(
title: t
thesis: table 9.3
studies: {s: {command: evaluate explore}}
columns: [{name: "20", figure: observed/2, interval: half}]
rows: [{name: A, where: {world: w}}]
chart: {axis: images}
)");
  const Value::List rows =
      from_json(R"([{"world": "w", "observed": [4, 6], "half": 0.5}])", "rows").as_list();
  const ReproducedTable table =
      reproduced_table(read_reproduction(folder_, "9.3"), {{{"s", ""}, rows}}, "");
  EXPECT_EQ(table.cells[0][0].mean, 6) << "entries of lists count from 1";
  EXPECT_EQ(table.cells[0][0].interval, 0.5);
  EXPECT_EQ(table_cells(table)[0].size(), 2u) << "the thesis has no number";
}

TEST_F(Reproductions, ShareStudiesOfOneOther) {
  const std::string alone =
      "title: t\nthesis: table 9.4\nfrom: \"9.1\"\ncolumns: [{name: F, figure: alone/f}]\n"
      "rows: [{name: A, where: {method: a}}]\n";
  write("9.4", alone);
  const Reproduction made = read_reproduction(folder_, "9.4");
  EXPECT_EQ(made.owner, "9.1");
  EXPECT_EQ(made.studies.front().name, "hut");
  write("9.5", "title: t\nthesis: table 9.5\nfrom: \"9.4\"\ncolumns: []\nrows: []\n");
  EXPECT_NE(refusal("9.5").find("'9.5' takes its studies from '9.4', which takes them from '9.1'"),
            std::string::npos)
      << refusal("9.5");
  write("9.6", "title: t\nthesis: table 9.6\nfrom: \"9.6\"\ncolumns: []\nrows: []\n");
  EXPECT_NE(refusal("9.6").find("from '9.6'"), std::string::npos) << "it ends";
}

TEST_F(Reproductions, RefuseWhatIsUnknown) {
  EXPECT_NE(refusal("9.11").find("did you mean '9.1'?"), std::string::npos) << refusal("9.11");
  EXPECT_NE(refusal("").find("there are 9.1"), std::string::npos) << refusal("");
  EXPECT_NE(refusal("../9.1").find("no table or figure"), std::string::npos);
  EXPECT_NE(refusal("quick:", "quik:").find("did you mean 'quick'?"), std::string::npos);
  EXPECT_NE(refusal("thesis: [50, \"10-20\"]", "thesis: [50]").find("1 figures for 2 columns"),
            std::string::npos);
  EXPECT_NE(refusal("below: B", "below: C").find("no row 'C'"), std::string::npos);
  EXPECT_NE(refusal("name: B", "name: A").find("two rows 'A'"), std::string::npos);
  EXPECT_NE(refusal("command: evaluate scan\n", "").find("9.2.yaml"), std::string::npos);
  EXPECT_NE(refusal("figure: seconds, ", "").find("`figure`"), std::string::npos);
  EXPECT_NE(refusal("column: F, by", "column: G, by").find("no column 'G'"), std::string::npos);
}

TEST_F(Reproductions, RefuseWhatCannotBeMade) {
  EXPECT_NE(refusal("  hut:", "  ../hut:").find("a study's name"), std::string::npos);
  EXPECT_NE(refusal("  hut:", "  reproduction:").find("a study's name"), std::string::npos);
  for (const char* digits : {"60", "-3", "2.7"})
    EXPECT_NE(refusal("scale: 100}", "scale: 100, digits: " + std::string(digits) + "}")
                  .find("digits is a whole number from 0 to 9"),
              std::string::npos)
        << digits;
  for (const char* name : {"F", ".", "1.2.3", "''"}) {
    write("9.2",
          "title: t\nthesis: table 9.2\nfrom: \"9.1\"\nchart: {axis: x}\n"
          "columns: [{name: " +
              std::string(name) + ", figure: f}]\nrows: [{name: A}]\n");
    EXPECT_NE(refusal("9.2").find("is not a number"), std::string::npos) << name << refusal("9.2");
  }
  write("9.3", "title: t\nthesis: table 9.3\nfrom: \"9.1\"\ncolumns: []\nrows: []\n");
  EXPECT_NE(refusal("9.3").find("has neither figures nor pictures"), std::string::npos);
}

// A mistyped place would be an empty cell, after hours.
TEST_F(Reproductions, PlacesThatNoRecordHasAreNamed) {
  const auto made_of = [&](const std::string& part, const std::string& by) -> std::string {
    std::string text = kTable;
    text.replace(text.find(part), part.size(), by);
    write("9.2", text);
    const Value::List rows =
        from_json(R"([{"method": "a", "seed": 1, "with_first": {"f": 0.5, "curve": [1, 2]},
                       "none": null}])",
                  "rows")
            .as_list();
    const Value::List times = from_json(R"([{"method": "a", "seconds": 3}])", "times").as_list();
    try {
      reproduced_table(read_reproduction(folder_, "9.2"),
                       {{{"hut", ""}, rows}, {{"hut", "times"}, times}}, "");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(made_of("with_first/f", "with_first/f"), "");
  EXPECT_EQ(made_of("with_first/f", "with_first/curve/7"), "") << "another record may be longer";
  EXPECT_EQ(made_of("with_first/f", "none"), "");
  EXPECT_EQ(made_of("with_first/f", "with_first/g"),
            "table 9.2: no record of study 'hut' has 'with_first/g'; the first has method, seed, "
            "with_first, none");
  EXPECT_NE(made_of("where: {method: a}", "where: {methud: a}").find("has 'methud'"),
            std::string::npos);
}

TEST_F(Reproductions, RanksAreWhatTheThesisSays) {
  const auto with = [&](const std::string& rank, const std::string& figures = "[40, null]") {
    std::string text = kTable;
    text.replace(text.find("[40, null]"), 10, figures);
    const std::string old = "{above: A, below: B, column: F}";
    text.replace(text.find(old), old.size(), rank);
    write("9.2", text);
    return refusal("9.2");
  };
  EXPECT_EQ(with("{above: A, below: B, column: F}"), "");
  EXPECT_NE(with("{above: B, below: A, column: F}").find("'B' is not above 'A' in 'F'"),
            std::string::npos);
  EXPECT_EQ(with("{above: B, below: A, column: F, claim: lapwing}"), "");
  EXPECT_NE(with("{above: B, below: A, column: F, claim: mine}").find("thesis or lapwing"),
            std::string::npos);
  EXPECT_NE(with("{above: A, below: B, column: F}", "[null, null]")
                .find("the thesis has no figures of 'A' and 'B' in 'F'"),
            std::string::npos);
  EXPECT_EQ(with("{above: A, below: B, column: time}"), "") << "a column without numbers";
  EXPECT_EQ(with("{above: A, below: [B], column: [F, time]}"), "");
  EXPECT_EQ(read_reproduction(folder_, "9.2").ranks.size(), 2u);
}

TEST_F(Reproductions, ARankSaysWhetherIntervalsAllowIt) {
  const auto sentence = [](double above, double below, double interval) {
    ReproducedTable table;
    table.ranks = {{{"A", "B", "F"}, above, below, interval}};
    return table_notes(table);
  };
  const std::string asked = "\n* F: 'A' above 'B', as in the thesis? ";
  EXPECT_EQ(sentence(3, 1, 0), asked + "Yes: 3.000 and 1.000.\n");
  EXPECT_EQ(sentence(3, 1, 5), asked + "Yes, within the intervals: 3.000 and 1.000.\n");
  EXPECT_EQ(sentence(1, 3, 5), asked + "NO, within the intervals: 1.000 and 3.000.\n");
  EXPECT_EQ(sentence(1, 3, 0), asked + "NO: 1.000 and 3.000.\n");
  EXPECT_EQ(sentence(3, 1, std::nan("")), asked + "Yes, intervals unknown: 3.000 and 1.000.\n");
  EXPECT_EQ(sentence(std::nan(""), 3, 0), asked + "One of them has no figure.\n");
}

TEST_F(Reproductions, WordsOfATableDoNotChangeItsStudies) {
  const auto told = [&](const char* name) {
    std::string all;
    for (const ReproducedStudy& study : read_reproduction(folder_, name).studies)
      all += study.checksum();
    return all;
  };
  const std::string before = told("9.1");
  const auto after = [&](const std::string& part, const std::string& by) {
    std::string text = kTable;
    text.replace(text.find(part), part.size(), by);
    write("9.2", text);
    return told("9.2");
  };
  EXPECT_EQ(after("The scene is another one.", "Another scene."), before);
  EXPECT_EQ(after("name: time,", "name: seconds,"), before);
  EXPECT_NE(after("seeds: \"1,2\"", "seeds: \"1,3\""), before);
  EXPECT_NE(after("guard: 5", "guard: 6"), before);
  EXPECT_NE(after("{examples}/hut.lua", "{examples}/hat.lua"), before);
}

TEST_F(Reproductions, AFigureThatIsNoNumberIsNamed) {
  const Reproduction made = read_reproduction(folder_, "9.1");
  const Value::List rows =
      from_json(R"([{"method": "a", "seed": 1, "with_first": {"f": "much"}}])", "rows").as_list();
  try {
    reproduced_table(made, {{{"hut", ""}, rows}, {{"hut", "times"}, {}}}, "");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("'with_first/f' is a text"), std::string::npos)
        << error.what();
  }
}

constexpr const char* kPictures = R"(
title: A path
thesis: figure 9.8
studies:
  flight: {command: run, arguments: ["{here}/flight.lua"]}
  hut: {command: evaluate scan, arguments: ["{examples}/hut.lua"]}
pictures:
  - {title: Seen twice, study: flight, section: Path, blocks: [from the south, from above]}
  - {title: All, study: flight, section: Path}
)";

TEST_F(Reproductions, AFigureMayBePicturesAlone) {
  write("figure_9.8", kPictures);
  const Reproduction made = read_reproduction(folder_, "figure_9.8");
  ASSERT_EQ(made.pictures.size(), 2u);
  std::vector<Section> sections{{"Path", {}}};
  sections[0].blocks = {PathView{"from above, in metres", Projection::above, {}},
                        TextBlock{.text = "words", .folded_title = {}},
                        PathView{"from the south", Projection::from_south, {}}};
  ReproducedTable table = reproduced_table(made, {}, "what was flown");
  for (const ReproducedPictures& asked : made.pictures)
    table.pictures.push_back(chosen_pictures(asked, sections));
  ASSERT_EQ(table.pictures[0].blocks.size(), 2u);
  EXPECT_EQ(std::get<PathView>(table.pictures[0].blocks[0]).title, "from the south");
  EXPECT_EQ(std::get<PathView>(table.pictures[0].blocks[1]).title, "from above, in metres");
  EXPECT_EQ(table.pictures[1].blocks.size(), 3u);
  EXPECT_TRUE(table_cells(table).empty());
  const Report report = table_report(table);
  ASSERT_EQ(report.sections.size(), 3u);
  EXPECT_EQ(report.sections[0].title, "Seen twice");
  EXPECT_EQ(report.sections[2].title, "Notes");

  const auto refused = [&](const std::string& section, const std::string& block) {
    try {
      chosen_pictures({"t", "flight", section, {block}}, sections);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refused("Paths", "from above"),
            "study 'flight': its report has no section 'Paths'; there are 'Path'");
  EXPECT_EQ(refused("Path", "from below"),
            "study 'flight': its report has no 'from below' in its section 'Path'; there are "
            "'from above, in metres', 'from the south'");
  EXPECT_NE(refused("Path", "from").find("no single 'from'"), std::string::npos);
}

TEST_F(Reproductions, PicturesAreThoseOfRuns) {
  const auto refused = [&](const std::string& part, const std::string& by) {
    std::string text = kPictures;
    text.replace(text.find(part), part.size(), by);
    write("figure_9.8", text);
    return refusal("figure_9.8");
  };
  EXPECT_NE(refused("study: flight", "study: fligt").find("did you mean 'flight'?"),
            std::string::npos);
  EXPECT_NE(refused("study: flight", "study: hut").find("'hut' has no pictures"),
            std::string::npos);
  EXPECT_NE(refused("section: Path, ", "").find("a picture needs 'section'"), std::string::npos);
  EXPECT_NE(refused("blocks:", "block:").find("did you mean 'blocks'?"), std::string::npos);
  EXPECT_NE(refused("pictures:", "rows: []\npictures:").find("needs 'columns'"), std::string::npos);
}

TEST(ShippedReproductions, AreReadAndSayWhyTheyDiffer) {
  const fs::path folder = LAPWING_SOURCE_DIR "/configs/reproduce";
  const std::vector<std::string> names = reproduction_names(folder);
  EXPECT_GE(names.size(), 27u);
  EXPECT_EQ(names.front(), "figure_3.4");
  for (const std::string& name : names) {
    const Reproduction made = read_reproduction(folder, name);
    EXPECT_FALSE(made.differs.empty()) << name;
    EXPECT_FALSE(made.rows.empty() && made.pictures.empty()) << name;
  }
}

}  // namespace
}  // namespace lapwing
