// SPDX-License-Identifier: Apache-2.0
// Figures of studies of scans from rows and files with known means, gaps and times.
#include "framework/study/scan_tables.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <map>
#include <sstream>

#include "framework/core/error.h"
#include "framework/core/files.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

ScanRow tour(const std::string& mission, const std::string& method, double budget,
             std::uint64_t seed, double score) {
  ScanRow row{.mission = mission, .method = method, .seed = seed, .budget = budget};
  row.found = true;
  row.score = score;
  row.score_share = score / 10;
  row.images = static_cast<int>(seed);
  return row;
}

// Cells by the name of their column; fields here hold no quotes.
std::vector<std::map<std::string, std::string>> table(const std::string& csv) {
  std::istringstream lines(csv);
  std::vector<std::string> names;
  std::vector<std::map<std::string, std::string>> rows;
  for (std::string line; std::getline(lines, line);) {
    std::vector<std::string> cells(1);
    for (const char c : line)
      if (c == ',')
        cells.emplace_back();
      else
        cells.back() += c;
    if (names.empty()) {
      names = cells;
      continue;
    }
    EXPECT_EQ(cells.size(), names.size()) << line;
    std::map<std::string, std::string> row;
    for (std::size_t i = 0; i < std::min(names.size(), cells.size()); ++i) row[names[i]] = cells[i];
    EXPECT_EQ(row.size(), names.size()) << "two columns of one name";
    rows.push_back(std::move(row));
  }
  return rows;
}

TEST(ScanSummaries, OneForEachMissionBudgetAndMethod) {
  const std::vector<ScanSummary> all =
      summarise({tour("a", "x", 30, 1, 1), tour("a", "x", 30, 2, 3), tour("a", "y", 30, 1, 5),
                 tour("a", "y", 60, 1, 7), tour("b", "y", 60, 1, 9)});
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(all[0].rows, 2);
  EXPECT_DOUBLE_EQ(all[0].score.mean, 2);
  EXPECT_DOUBLE_EQ(all[0].score.error, 1);  // deviation sqrt(2), of two
  EXPECT_DOUBLE_EQ(all[0].score_share.mean, 20);
  EXPECT_DOUBLE_EQ(all[0].images.mean, 1.5);
  EXPECT_EQ(all[1].score.error, 0);
  EXPECT_EQ(all[2].budget, 60);
  EXPECT_EQ(all[3].mission, "b");
  EXPECT_TRUE(summarise({}).empty());
}

// (bound - score) / bound of those that have a bound above 0; of others there is none.
TEST(ScanSummaries, TheGapIsToWhatNoTourExceeds) {
  std::vector<ScanRow> rows{tour("a", "x", 30, 1, 6), tour("a", "x", 30, 2, 9),
                            tour("a", "x", 30, 3, 5), tour("a", "x", 30, 4, 5)};
  rows[0].upper_bound = 8;
  rows[1].upper_bound = 10;
  rows[2].upper_bound = 0;
  const ScanSummary summary = summarise(rows).front();
  EXPECT_DOUBLE_EQ(summary.gap.mean, 17.5);
  EXPECT_DOUBLE_EQ(summary.gap.error, 7.5);
  EXPECT_TRUE(std::isnan(summarise({tour("a", "x", 30, 1, 6)}).front().gap.mean));
}

// Rows without a tour, or that do not count, are named and left out of every mean.
TEST(ScanSummaries, WhatDoesNotCountIsLeftOut) {
  std::vector<ScanRow> rows{tour("a", "x", 30, 1, 6), tour("a", "x", 30, 2, 900),
                            tour("a", "x", 30, 3, 900)};
  rows[1].found = false;
  rows[2].counts = false;
  ScanSummary summary = summarise(rows).front();
  EXPECT_EQ(summary.rows, 3);
  EXPECT_EQ(summary.counted, 1);
  EXPECT_DOUBLE_EQ(summary.score.mean, 6);
  rows[0].found = false;
  summary = summarise(rows).front();
  EXPECT_TRUE(std::isnan(summary.score.mean));
  EXPECT_NE(tables_text({summary}).find("0 of 3 count"), std::string::npos);
  EXPECT_EQ(table(tables_csv({summary})).front().at("score"), "");
}

TEST(ScanTablesText, ATableForEachMissionAndBudget) {
  const std::string text =
      tables_text(summarise({tour("a", "a long name of a method", 30, 1, 1),
                             tour("a", "y", 30, 1, 5), tour("a", "y", 60, 1, 7)}));
  EXPECT_NE(text.find("a, a budget of 30 s, 1 seed, in percent\n"), text.npos) << text;
  EXPECT_NE(text.find("\n\na, a budget of 60 s, 1 seed"), text.npos) << text;
  EXPECT_EQ(text.find("+-"), text.npos) << "one seed has no error";
  // Lines of one table have their columns below each other.
  std::istringstream lines(text.substr(0, text.find("\n\n")));
  std::string line;
  std::getline(lines, line);
  std::getline(lines, line);
  std::size_t width = 0;
  while (std::getline(lines, line)) {
    if (width > 0) {
      EXPECT_EQ(line.size(), width) << line;
    }
    width = line.size();
  }
}

TEST(ScanTablesText, CellsHaveNamesAndUnits) {
  ScanRow row = tour("a", "x", 30, 4, 5);
  row.with_first = {.precision = 0.5, .recall = 0.25, .f = 0.125, .points = 11};
  row.alone = {.precision = 0.75, .recall = 1, .f = 0.0625, .points = 12, .surface_points = 13};
  row.upper_bound = 10;
  row.seconds = 29.5;
  row.evaluations = 77;
  row.status = "optimal";
  const auto means = table(tables_csv(summarise({row}))).front();
  for (const auto& [name, value] : std::map<std::string, std::string>{{"mission", "a"},
                                                                      {"budget [s]", "30"},
                                                                      {"method", "x"},
                                                                      {"rows", "1"},
                                                                      {"counted", "1"},
                                                                      {"reproducible", "true"},
                                                                      {"precision [%]", "50"},
                                                                      {"precision error", "0"},
                                                                      {"recall [%]", "25"},
                                                                      {"F [%]", "12.5"},
                                                                      {"precision alone [%]", "75"},
                                                                      {"recall alone [%]", "100"},
                                                                      {"F alone [%]", "6.25"},
                                                                      {"score", "5"},
                                                                      {"score share [%]", "50"},
                                                                      {"gap [%]", "50"},
                                                                      {"images", "4"},
                                                                      {"seconds", "29.5"}}) {
    ASSERT_TRUE(means.contains(name)) << name;
    EXPECT_EQ(means.at(name), value) << name;
  }
  const auto cells = table(rows_csv({row})).front();
  for (const auto& [name, value] : std::map<std::string, std::string>{{"seed", "4"},
                                                                      {"status", "optimal"},
                                                                      {"found", "true"},
                                                                      {"counts", "true"},
                                                                      {"score", "5"},
                                                                      {"score share", "0.5"},
                                                                      {"upper bound", "10"},
                                                                      {"flight [s]", "29.5"},
                                                                      {"images", "4"},
                                                                      {"evaluations", "77"},
                                                                      {"precision", "0.5"},
                                                                      {"recall", "0.25"},
                                                                      {"F", "0.125"},
                                                                      {"points", "11"},
                                                                      {"precision alone", "0.75"},
                                                                      {"recall alone", "1"},
                                                                      {"F alone", "0.0625"},
                                                                      {"points alone", "12"},
                                                                      {"surface points", "13"},
                                                                      {"message", ""}}) {
    ASSERT_TRUE(cells.contains(name)) << name;
    EXPECT_EQ(cells.at(name), value) << name;
  }
}

TEST(ScanTablesText, TextsOfOthersAreQuoted) {
  ScanRow row = tour("street, \"A\"", "milp:candidates=5,nodes=2", 30, 1, 5);
  row.message = "line\nbreak";
  const std::string line = "\"street, \"\"A\"\"\",30,\"milp:candidates=5,nodes=2\",1";
  EXPECT_NE(tables_csv(summarise({row})).find("\n" + line + ",1,true"), std::string::npos);
  const std::string csv = rows_csv({row});
  EXPECT_NE(csv.find("\n" + line), csv.npos) << csv;
  EXPECT_TRUE(csv.ends_with(",\"line\nbreak\"\n")) << csv;
}

// Curves are over budgets in rising order, each method's value at each; a method that lacks a
// budget leaves no chart with a line of one point.
TEST(ScanPage, CurvesRiseWithTheBudget) {
  const std::vector<ScanRow> rows{tour("a", "x", 90, 1, 9), tour("a", "y", 90, 1, 7),
                                  tour("a", "x", 30, 1, 3), tour("a", "y", 30, 1, 2)};
  const Report report = study_report(summarise(rows), rows);
  const Chart* chart = nullptr;
  for (const Block& block : report.sections.front().blocks)
    if (const Chart* found = std::get_if<Chart>(&block); found && !chart) chart = found;
  ASSERT_NE(chart, nullptr);
  ASSERT_EQ(chart->series.size(), 2u);
  EXPECT_EQ(chart->series[0].name, "x");
  EXPECT_EQ(chart->series[0].x, (std::vector<double>{30, 90}));
  EXPECT_EQ(chart->series[0].y, (std::vector<double>{30, 90}));
  EXPECT_EQ(chart->series[1].y, (std::vector<double>{20, 70}));
  const std::vector<ScanRow> uneven{rows[0], rows[1], rows[2]};
  for (const Block& block : study_report(summarise(uneven), uneven).sections.front().blocks)
    EXPECT_EQ(std::get_if<Chart>(&block), nullptr);
}

class StudyFolders : public ::testing::Test {
 protected:
  StudyFolders()
      : folder_(fs::temp_directory_path() / ("lapwing_tables_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~StudyFolders() override { fs::remove_all(folder_); }

  void time(const std::string& file, const std::string& method, double first, double flight,
            double prepare, double plan) {
    std::ostringstream text;
    text << R"({"mission": "a", "method": ")" << method << R"(", "first_flight": )" << first
         << R"(, "flight": )" << flight << R"(, "prepare": )" << prepare << R"(, "plan": )" << plan
         << "}";
    write_file_atomically(folder_ / file, text.str());
  }
  fs::path folder_;
};

// Means over seeds. A circle is flown at once: no first flight and no candidates are its own.
TEST_F(StudyFolders, TimesAreMeansOfTheirFiles) {
  time("1.json", "greedy", 10, 100, 4, 1);
  time("2.json", "greedy", 20, 200, 6, 3);
  time("3.json", "circle_50", 10, 100, 4, 1);
  time("4.json", "hemisphere_60", 10, 100, 4, 1);
  write_file_atomically(folder_ / "5.json.tmp-1", "half");
  std::istringstream text(times_text(folder_));
  std::map<std::string, std::vector<double>> lines;
  std::string line;
  std::getline(text, line);
  std::getline(text, line);
  while (std::getline(text, line)) {
    std::istringstream words(line);
    std::string mission, method;
    words >> mission >> method;
    EXPECT_EQ(mission, "a,");
    for (double number; words >> number;) lines[method].push_back(number);
  }
  EXPECT_EQ(lines.at("greedy"), (std::vector<double>{15, 150, 5, 2, 172}));
  EXPECT_EQ(lines.at("circle_50"), (std::vector<double>{0, 100, 0, 1, 101}));
  EXPECT_EQ(lines.at("hemisphere_60"), (std::vector<double>{10, 100, 4, 1, 115}));
}

TEST_F(StudyFolders, ABrokenFileOfTimesIsNamed) {
  write_file_atomically(folder_ / "1.json", R"({"mission": "a"})");
  EXPECT_THROW(times_text(folder_), Error);
  write_file_atomically(folder_ / "1.json", R"({"mission": )");
  try {
    times_text(folder_);
    ADD_FAILURE() << "half a file";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("1.json"), std::string::npos) << error.what();
  }
}

TEST_F(StudyFolders, PhotographsAreListedInOrder) {
  for (const auto& [name, largest] : {std::pair{"b", 7}, {"a", 9}}) {
    fs::create_directories(folder_ / name);
    write_file_atomically(folder_ / name / "registered.json",
                          R"({"mission": "m", "seed": 2, "budget": 12.5, "method": "x", "images": )"
                          "10, \"largest\": " +
                              std::to_string(largest) + R"(, "models": 1})");
  }
  fs::create_directories(folder_ / "c");  // ended before COLMAP was
  const std::string text = photos_text(folder_);
  const std::size_t first = text.find("m, seed 2, 12.5 s, x: 9 of 10, 1 models\n");
  const std::size_t second = text.find("m, seed 2, 12.5 s, x: 7 of 10, 1 models\n");
  EXPECT_LT(first, second) << text;
  EXPECT_NE(second, text.npos) << text;
}

}  // namespace
}  // namespace lapwing
