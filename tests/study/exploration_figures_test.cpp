// SPDX-License-Identifier: Apache-2.0
// Tables of explorations from episodes made up with known sums, ratios and ends.
#include "framework/study/exploration_figures.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <sstream>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/json.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

class ExplorationFiles : public ::testing::Test {
 protected:
  ExplorationFiles()
      : base_(fs::temp_directory_path() / ("lapwing_figures_" + std::to_string(::getpid()))) {
    fs::remove_all(base_);
    fs::create_directories(base_ / "now/episodes");
    fs::create_directories(base_ / "before/episodes");
  }
  ~ExplorationFiles() override { fs::remove_all(base_); }

  ExplorationFigures asked(std::vector<std::string> worlds, std::vector<std::string> utilities,
                           std::int64_t episodes, int steps) const {
    ExplorationFigures figures;
    figures.folder = base_ / "now";
    figures.settings = from_json(
        R"({"seed": 7, "sigma": 0.02, "dropped": 0.25, "smooth_to": 0.01, "stereo": 0,
            "lookahead": 1, "moves": {"step": 0.5}, "mapping": {}, "parameters": {}})",
        "settings");
    figures.worlds = std::move(worlds);
    figures.utilities = std::move(utilities);
    figures.episodes = episodes;
    figures.steps = steps;
    return figures;
  }

  // An episode's file, as an evaluation leaves it.
  void flown(const Trial& trial, const std::vector<double>& observed, double length,
             const std::string& end = "", const char* evaluation = "now") {
    Value value = Value::map();
    value.set("world", trial.world);
    value.set("utility", trial.utility);
    value.set("episode", trial.episode);
    Value& list = value.set("observed", Value::list());
    for (const double number : observed) list.push_back(number);
    value.set("length", length);
    value.set("end", end);
    write_file_atomically(base_ / evaluation / "episodes" / (trial.name() + ".json"),
                          to_json(value));
  }

  std::string refusal(const ExplorationFigures& figures) const {
    try {
      write_exploration_figures(figures);
    } catch (const InputError& error) {
      EXPECT_FALSE(fs::exists(base_ / "now/table.csv"));
      EXPECT_FALSE(fs::exists(base_ / "now/report.html"));
      return error.what();
    }
    return "no error";
  }

  static const Value& row(const Value& rows, const std::string& world, const std::string& utility) {
    static const Value none;
    for (const Value& one : rows.as_list())
      if (one.at("world").as_text() == world && one.at("utility").as_text() == utility) return one;
    ADD_FAILURE() << "no row of " << world << ", " << utility;
    return none;
  }

  static double figure(const Value& row, const char* name) {
    return row.at(name).is_null() ? std::nan("") : row.at(name).as_number();
  }

  fs::path base_;
};

TEST_F(ExplorationFiles, EfficiencyIsTheAreaUnderTheCurve) {
  flown({"office", "count", 1}, {10, 20, 40}, 5);
  flown({"office", "count", 2}, {10, 30, 50}, 7);
  const Value rows = write_exploration_figures(asked({"office"}, {"count"}, 2, 3)).rows;
  ASSERT_EQ(rows.as_list().size(), 1u);
  const Value& one = rows.as_list().front();
  EXPECT_EQ(one.at("episodes").as_integer(), 2);
  EXPECT_EQ(figure(one, "efficiency"), 80);
  EXPECT_NEAR(figure(one, "efficiency_deviation"), std::sqrt(200), 1e-12);
  EXPECT_EQ(figure(one, "length"), 6);
  EXPECT_EQ(one.at("ended_early").as_integer(), 0);
  for (const char* name : {"relative", "relative_interval", "below_learned", "against"})
    EXPECT_TRUE(one.at(name).is_null()) << name << ": nothing to compare with";
  EXPECT_EQ(read_file(base_ / "now/curves.csv"),
            "world,utility,images,observed,observed_deviation\n"
            "office,count,1,10,0\noffice,count,2,25,7.07107\noffice,count,3,45,7.07107\n");
}

// After an early end what was observed stays as it is; the end counts by its kind, and not where
// all images were taken all the same.
TEST_F(ExplorationFiles, AnEarlyEndKeepsWhatWasObserved) {
  flown({"office", "count", 1}, {10, 20}, 5, "no_way");
  flown({"office", "count", 2}, {}, 0, "nothing_to_gain");
  flown({"office", "count", 3}, {5}, 0, "no_way");
  flown({"office", "count", 4}, {1, 2, 3, 4}, 0, "nothing_to_gain");
  const ExplorationTables tables = write_exploration_figures(asked({"office"}, {"count"}, 4, 4));
  const Value& one = row(tables.rows, "office", "count");
  EXPECT_EQ(figure(one, "efficiency"), (70 + 0 + 20 + 10) / 4.0);
  EXPECT_EQ(one.at("ended_early").as_integer(), 3);
  EXPECT_EQ(one.at("ends").as_text(), "no_way 2; nothing_to_gain 1");
  EXPECT_NE(tables.text.find("3: no_way 2, nothing_to_gain 1"), std::string::npos) << tables.text;
}

// The ratio is of each start's own episodes, then the mean: not the ratio of means.
TEST_F(ExplorationFiles, RatiosAreOfTheSameStart) {
  const std::vector<std::string> utilities{"oracle", "learned", "count"};
  for (const auto& [episode, oracle, learned, count] :
       {std::tuple{1, 100.0, 90.0, 50.0}, {2, 400.0, 300.0, 100.0}}) {
    flown({"office", "oracle", episode}, {oracle}, 1);
    flown({"office", "learned", episode}, {learned}, 1);
    flown({"office", "count", episode}, {count}, 1);
  }
  const Value rows = write_exploration_figures(asked({"office"}, utilities, 2, 1)).rows;
  const Value& count = row(rows, "office", "count");
  EXPECT_DOUBLE_EQ(figure(count, "relative"), (0.5 + 0.25) / 2);
  EXPECT_DOUBLE_EQ(figure(count, "below_learned"), (0.4 + 0.5) / 2);
  // Student's t of one degree of freedom, and the error of a mean of two.
  EXPECT_NEAR(figure(count, "relative_interval"), 12.7062047 * 0.25 / 2, 1e-7);
  EXPECT_DOUBLE_EQ(figure(row(rows, "office", "oracle"), "relative"), 1);
  EXPECT_DOUBLE_EQ(figure(row(rows, "office", "learned"), "below_learned"), 0);
  EXPECT_DOUBLE_EQ(figure(row(rows, "office", "learned"), "relative"), (0.9 + 0.75) / 2);
}

TEST_F(ExplorationFiles, WithoutARatioAnEpisodeIsLeftOutAndSaid) {
  flown({"office", "oracle", 1}, {0}, 1);
  flown({"office", "oracle", 2}, {10}, 1);
  flown({"office", "count", 1}, {7}, 1);
  flown({"office", "count", 2}, {5}, 1);
  const ExplorationTables tables =
      write_exploration_figures(asked({"office"}, {"oracle", "count"}, 2, 1));
  const Value& count = row(tables.rows, "office", "count");
  EXPECT_EQ(count.at("episodes").as_integer(), 2);
  EXPECT_EQ(count.at("compared").as_integer(), 1);
  EXPECT_DOUBLE_EQ(figure(count, "relative"), 0.5);
  EXPECT_TRUE(count.at("relative_interval").is_null());
  EXPECT_NE(tables.text.find("; relative: 1 episodes"), std::string::npos) << tables.text;
}

TEST_F(ExplorationFiles, AnotherEvaluationIsComparedStartByStart) {
  for (int episode = 1; episode <= 2; ++episode) {
    flown({"office", "count", episode}, {10.0 * episode}, 1);
    flown({"office", "count", episode}, {40.0 / episode}, 1, "", "before");
  }
  ExplorationFigures figures = asked({"office"}, {"count"}, 2, 1);
  figures.against = base_ / "before";
  const ExplorationTables tables = write_exploration_figures(figures);
  EXPECT_DOUBLE_EQ(figure(row(tables.rows, "office", "count"), "against"), (0.25 + 1) / 2);
  EXPECT_NE(tables.text.find("against"), std::string::npos);
  fs::remove(base_ / "now/table.csv");
  fs::remove(base_ / "now/report.html");
  fs::remove(base_ / "before/episodes/office_count_2.json");
  EXPECT_NE(refusal(figures).find("before/episodes/office_count_2.json"), std::string::npos);
}

// The rows of "all" hold every world's episodes; what lies between worlds is no chance.
TEST_F(ExplorationFiles, AllWorldsTogether) {
  for (int episode = 1; episode <= 2; ++episode) {
    flown({"a", "count", episode}, {1}, 2);
    flown({"b", "count", episode}, {3}, 4, episode == 1 ? "" : "no_way");
    flown({"a", "oracle", episode}, {2}, 2);
    flown({"b", "oracle", episode}, {4}, 4);
  }
  const Value rows = write_exploration_figures(asked({"a", "b"}, {"count", "oracle"}, 2, 1)).rows;
  EXPECT_EQ(rows.as_list().size(), 6u);
  const Value& all = row(rows, "all", "count");
  EXPECT_EQ(all.at("episodes").as_integer(), 4);
  EXPECT_DOUBLE_EQ(figure(all, "efficiency"), 2);
  EXPECT_NEAR(figure(all, "efficiency_deviation"), std::sqrt(4.0 / 3), 1e-12);
  EXPECT_DOUBLE_EQ(figure(all, "relative"), (0.5 + 0.75) / 2);
  EXPECT_DOUBLE_EQ(figure(all, "relative_interval"), 0);
  EXPECT_DOUBLE_EQ(figure(all, "length"), 3);
}

TEST_F(ExplorationFiles, TimesAreThereOrNot) {
  flown({"office", "count", 1}, {1}, 1);
  flown({"office", "count", 2}, {1}, 1);
  flown({"office", "random", 1}, {1}, 1);
  flown({"office", "random", 2}, {1}, 1);
  fs::create_directories(base_ / "now/seconds");
  write_file_atomically(base_ / "now/seconds/office_count_2.json", R"({"seconds_per_step": 0.25})");
  const ExplorationTables tables =
      write_exploration_figures(asked({"office"}, {"count", "random"}, 2, 1));
  EXPECT_EQ(read_file(base_ / "now/seconds.csv"),
            "world,utility,episodes,seconds_per_step\noffice,count,1,0.25\noffice,random,0,\n");
  // Wall clocks are no part of what two runs must agree on.
  EXPECT_EQ(read_file(base_ / "now/table.csv").find("0.25"), std::string::npos);
  EXPECT_EQ(read_file(base_ / "now/report.html").find("seconds_per_step"), std::string::npos);
}

TEST_F(ExplorationFiles, NamesWithCommasAreQuoted) {
  const std::string world = "a \"b\",\rc";
  flown({world, "count", 1}, {1}, 1);
  write_exploration_figures(asked({world}, {"count"}, 1, 1));
  const std::string quoted = "\"a \"\"b\"\",\rc\",count,1,";
  for (const char* file : {"table.csv", "curves.csv"})
    EXPECT_NE(read_file(base_ / "now" / file).find("\n" + quoted), std::string::npos) << file;
  EXPECT_NE(read_file(base_ / "now/seconds.csv").find("\n\"a \"\"b\"\",\rc\",count,0,"),
            std::string::npos);
  // A carriage return alone must be quoted as well: readers take it for the end of the line.
  flown({"a\rb", "count", 1}, {1}, 1);
  write_exploration_figures(asked({"a\rb"}, {"count"}, 1, 1));
  EXPECT_NE(read_file(base_ / "now/table.csv").find("\n\"a\rb\",count,1,"), std::string::npos);
}

TEST_F(ExplorationFiles, TheTableSaysWhatItsRowsSay) {
  flown({"office", "oracle", 1}, {8, 9}, 3);
  flown({"office", "count", 1}, {4, 4}, 3);
  const Value rows = write_exploration_figures(asked({"office"}, {"oracle", "count"}, 1, 2)).rows;
  std::istringstream lines(read_file(base_ / "now/table.csv"));
  std::string line, wanted;
  std::getline(lines, line);
  for (const auto& [name, value] : rows.as_list()[0].as_map())
    wanted += (wanted.empty() ? "" : ",") + name;
  EXPECT_EQ(line, wanted);
  for (const Value& one : rows.as_list()) {
    ASSERT_TRUE(std::getline(lines, line));
    std::istringstream cells(line + ",");
    for (const auto& [name, value] : one.as_map()) {
      std::string cell;
      ASSERT_TRUE(std::getline(cells, cell, ',')) << name;
      if (value.is_null()) {
        EXPECT_EQ(cell, "") << name;
      } else if (value.is_text()) {
        EXPECT_EQ(cell, value.as_text()) << name;
      } else {
        EXPECT_NEAR(std::stod(cell), value.as_number(), 1e-5 * value.as_number()) << name;
      }
    }
  }
  EXPECT_FALSE(std::getline(lines, line));
}

TEST_F(ExplorationFiles, EpisodesOfOthersAreRefused) {
  const ExplorationFigures figures = asked({"office"}, {"count"}, 1, 2);
  EXPECT_NE(refusal(figures).find("office_count_1.json' is not a complete episode: delete it"),
            std::string::npos);
  const fs::path file = base_ / "now/episodes/office_count_1.json";
  for (const char* text : {"", "{}", "[]", R"({"world": "office", "observed": [1)",
                           R"({"world": "office", "utility": "count", "episode": 1, "length": 1,
                               "end": "", "observed": ["many"]})",
                           R"({"world": "office", "utility": "count", "episode": 1,
                               "end": "", "observed": [1]})"}) {
    write_file_atomically(file, text);
    EXPECT_NE(refusal(figures).find("is not a complete episode"), std::string::npos) << text;
  }
  // "a b" and "a_b" have the same files.
  flown({"a b", "count", 1}, {1}, 1);
  const std::string other = refusal(asked({"a_b"}, {"count"}, 1, 2));
  EXPECT_NE(other.find("is of the world 'a b', not 'a_b': choose another folder"), other.npos)
      << other;
  flown({"office", "count", 1}, {1}, 1);
  fs::rename(file, base_ / "now/episodes/office_random_1.json");
  const std::string moved = refusal(asked({"office"}, {"random"}, 1, 2));
  EXPECT_NE(moved.find("is count's episode 1: delete it"), moved.npos) << moved;
}

TEST_F(ExplorationFiles, TheSameFilesGiveTheSameBytes) {
  flown({"office", "count", 1}, {1, 5}, 1);
  const ExplorationFigures figures = asked({"office"}, {"count"}, 1, 2);
  const auto bytes = [&] {
    write_exploration_figures(figures);
    std::string all;
    for (const char* file : {"table.csv", "seconds.csv", "curves.csv", "report.html"})
      all += read_file(base_ / "now" / file);
    return all;
  };
  const std::string once = bytes();
  EXPECT_EQ(bytes(), once);
  // What was asked stands in the report, in the units of its label.
  EXPECT_NE(once.find("noise of the depth"), once.npos);
  EXPECT_NE(once.find("pixels dropped"), once.npos);
  EXPECT_NE(once.find("smoothed towards"), once.npos);
  EXPECT_EQ(once.find("stereo, apart"), once.npos) << "there was none";
}

}  // namespace
}  // namespace lapwing
