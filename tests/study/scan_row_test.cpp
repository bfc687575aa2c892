// SPDX-License-Identifier: Apache-2.0
// Rows of a study of scans survive their files, and methods are what their names say.
#include "framework/study/scan_row.h"

#include <gtest/gtest.h>

#include <cmath>

#include "framework/core/error.h"
#include "framework/core/json.h"

namespace lapwing {
namespace {

const Registry& known_plugins() {
  static const Registry registry({LAPWING_BUILD_DIR "/lib/plugins"});
  return registry;
}

ScanRow whole_row() {
  ScanRow row{.mission = "street \"1\"", .method = "milp:nodes=2", .seed = 18446744073709551615u};
  row.budget = 0.1;
  row.status = "optimal";
  row.message = "a\nb, \xc3\xa9";
  row.found = true;
  row.reproducible = false;
  row.counts = false;
  row.score = 1.0 / 3;
  row.score_share = 0.7;
  row.upper_bound = 1e-300;
  row.seconds = 12.5;
  row.images = 7;
  row.first_images = 3;
  row.candidates = 48;
  row.evaluations = 9'007'199'254'740'993;
  row.with_first = {.precision = 0.1, .recall = 0.2, .f = 0.3, .points = 4, .surface_points = 5};
  row.alone = {.precision = 0.6, .recall = 0.7, .f = 0.8, .points = 9, .surface_points = 10};
  return row;
}

ScanRow through_a_file(const ScanRow& row) {
  return scan_row_from(from_json(to_json(to_value(row)), "row.json"));
}

TEST(ScanRow, SurvivesItsFile) {
  const ScanRow row = whole_row(), back = through_a_file(row);
  EXPECT_EQ(back.mission, row.mission);
  EXPECT_EQ(back.method, row.method);
  EXPECT_EQ(back.seed, row.seed);
  EXPECT_EQ(back.budget, row.budget);
  EXPECT_EQ(back.status, row.status);
  EXPECT_EQ(back.message, row.message);
  EXPECT_EQ(back.found, row.found);
  EXPECT_EQ(back.reproducible, row.reproducible);
  EXPECT_EQ(back.counts, row.counts);
  EXPECT_EQ(back.score, row.score);
  EXPECT_EQ(back.score_share, row.score_share);
  EXPECT_EQ(back.upper_bound, row.upper_bound);
  EXPECT_EQ(back.seconds, row.seconds);
  EXPECT_EQ(back.images, row.images);
  EXPECT_EQ(back.first_images, row.first_images);
  EXPECT_EQ(back.candidates, row.candidates);
  EXPECT_EQ(back.evaluations, row.evaluations);
  for (const auto& [was, is] :
       {std::pair{row.with_first, back.with_first}, std::pair{row.alone, back.alone}}) {
    EXPECT_EQ(is.precision, was.precision);
    EXPECT_EQ(is.recall, was.recall);
    EXPECT_EQ(is.f, was.f);
    EXPECT_EQ(is.points, was.points);
    EXPECT_EQ(is.surface_points, was.surface_points);
  }
}

// A pattern flown freely has no score and no bound: absent, not 0.
TEST(ScanRow, WhatItHasNotStaysAbsent) {
  ScanRow row = whole_row();
  row.score = row.score_share = std::nan("");
  row.upper_bound.reset();
  const Value value = to_value(row);
  for (const char* key : {"score", "score_share", "upper_bound"})
    EXPECT_EQ(value.find(key), nullptr) << key;
  const ScanRow back = through_a_file(row);
  EXPECT_TRUE(std::isnan(back.score));
  EXPECT_TRUE(std::isnan(back.score_share));
  EXPECT_FALSE(back.upper_bound.has_value());
}

// Every key but those three must be there: a file that lacks one is no row.
TEST(ScanRow, AFileThatLacksSomethingIsRefused) {
  const Value whole = to_value(whole_row());
  for (const auto& [left_out, ignored] : whole.as_map()) {
    if (left_out == "score" || left_out == "upper_bound") continue;
    Value value = Value::map();
    for (const auto& [key, item] : whole.as_map())
      if (key != left_out) value.set(key, item);
    EXPECT_THROW(scan_row_from(value), Error) << left_out;
  }
}

TEST(ScanMethod, IsAChainOfSolvers) {
  const ScanMethod one = scan_method("greedy", known_plugins());
  EXPECT_EQ(one.name, "greedy");
  EXPECT_FALSE(one.pattern);
  ASSERT_EQ(one.solvers.size(), 1u);
  EXPECT_TRUE(one.solvers[0].parameters.as_map().empty());
  const ScanMethod chain = scan_method(
      "cost_benefit+local_search:iterations=50+milp:candidates=5,nodes=2", known_plugins());
  ASSERT_EQ(chain.solvers.size(), 3u);
  EXPECT_EQ(chain.solvers[0].name, "cost_benefit");
  EXPECT_EQ(chain.solvers[1].parameters.at("iterations").as_integer(), 50);
  EXPECT_EQ(chain.solvers[2].parameters.at("candidates").as_integer(), 5);
  EXPECT_EQ(chain.solvers[2].parameters.at("nodes").as_integer(), 2);
}

TEST(ScanMethod, IsAPattern) {
  for (const char* name : {"circle_50", "ellipse_30x40", "meander_85x100", "hemisphere_60"}) {
    const ScanMethod method = scan_method(name, known_plugins());
    EXPECT_TRUE(method.pattern) << name;
    EXPECT_TRUE(method.solvers.empty()) << name;
  }
}

TEST(ScanMethod, WrongNamesAreRefusedWithTheName) {
  for (const auto& [text, said] : std::initializer_list<std::pair<const char*, const char*>>{
           {"", "''"},
           {"greedi", "did you mean 'greedy'"},
           {"greedy+greedi", "greedi"},
           {"+greedy", "''"},
           {"milp:notes=1", "did you mean 'nodes'"},
           {"milp:nodes=-1", "nodes"},
           {"milp:nodes=1e99", "nodes"},
           {"milp:nodes", "nodes"},
           {"circle", "circle"},
           {"circle_x", "circle_x"},
           {"circle_-5", "circle_-5"},
           {"circle_nan", "circle_nan"},
           {"meander_5", "meander_5"}}) {
    try {
      scan_method(text, known_plugins());
      ADD_FAILURE() << text << " is no method";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(said), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace lapwing
