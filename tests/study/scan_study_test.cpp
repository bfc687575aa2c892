// SPDX-License-Identifier: Apache-2.0
// A study on a small made-up scene: a block on the ground, views on rings around it.
#include "framework/study/scan_study.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <map>
#include <numbers>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/random.h"
#include "framework/study/scan_tables.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

const Registry& plugins() {
  static const Registry registry({LAPWING_BUILD_DIR "/lib/plugins"});
  return registry;
}

std::shared_ptr<const MeshScene> block() {
  TriangleMesh mesh;
  const auto face = [&](Eigen::Vector3d a, Eigen::Vector3d u, Eigen::Vector3d v) {
    const auto first = static_cast<std::int32_t>(mesh.vertices.size());
    for (const Eigen::Vector3d& p :
         {a, Eigen::Vector3d(a + u), Eigen::Vector3d(a + u + v), Eigen::Vector3d(a + v)}) {
      mesh.vertices.push_back(p);
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  };
  face({-12, -12, 0}, {24, 0, 0}, {0, 24, 0});
  face({-2, -2, 4}, {4, 0, 0}, {0, 4, 0});
  face({-2, -2, 0}, {4, 0, 0}, {0, 0, 4});
  face({-2, 2, 0}, {0, 0, 4}, {4, 0, 0});
  face({-2, -2, 0}, {0, 0, 4}, {0, 4, 0});
  face({2, -2, 0}, {0, 4, 0}, {0, 0, 4});
  return std::make_shared<const MeshScene>(mesh);
}

ScanCase small_case(std::uint64_t seed) {
  ScanCase scan;
  scan.surface = block();
  scan.region = {Eigen::Vector3d(-3, -3, 0), Eigen::Vector3d(3, 3, 5)};
  scan.camera = {80, 60, 47, 47, 39.5, 29.5};
  scan.pattern_height = 9;
  scan.leg_seconds = [](const Viewpoint& from, const Viewpoint& to) {
    return 3 + (to.position - from.position).norm() / 3;
  };
  Random random(seed);
  const Eigen::Vector3d middle(0, 0, 2);
  for (const double height : {2.0, 5.0, 9.0}) {
    for (int i = 0; i < 16; ++i) {
      const double angle = 2 * std::numbers::pi * (i + random.uniform(-0.2, 0.2)) / 16;
      Viewpoint v;
      v.position = {7 * std::cos(angle), 7 * std::sin(angle), height};
      const Eigen::Vector3d d = middle - v.position;
      v.yaw = std::atan2(d.y(), d.x());
      v.pitch = std::atan2(d.z(), d.head<2>().norm());
      scan.viewpoints.push_back(v);
    }
  }
  scan.first_flight = {camera_pose({0, 0, 12}, 0, -1.57), camera_pose({1, 0, 12}, 0, -1.57),
                       camera_pose({0, 1, 12}, 0, -1.57)};
  scan.first_seconds = 10;
  // What a view shows: points of the block's walls and roof that it sees.
  std::vector<Eigen::Vector3d> points;
  for (double a = -1.75; a < 2; a += 0.5) {
    for (double b = 0.25; b < 4; b += 0.5) {
      for (const double side : {-2.01, 2.01}) {
        points.push_back({side, a, b});
        points.push_back({a, side, b});
      }
      points.push_back({a, b - 2, 4.01});
    }
  }
  ViewScoreBuilder builder(points.size());
  for (const Viewpoint& v : scan.viewpoints) {
    std::vector<ViewScore::Contribution> seen;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Eigen::Vector3d ray = points[k] - v.position;
      if (scan.surface->blocked({v.position, ray.normalized(), ray.norm()})) continue;
      seen.push_back({static_cast<std::uint32_t>(k), 1.0f / 3});
    }
    builder.add_view(seen);
  }
  TourDefinition& d = scan.definition;
  d.score = std::make_shared<const ViewScore>(std::move(builder).take());
  d.view_seconds = {3};
  d.budget = 60;
  for (int a = 0; a < 48; ++a) {
    for (int b = a + 1; b < 48; ++b) {
      const double apart = (scan.viewpoints[a].position - scan.viewpoints[b].position).norm();
      if (apart < 4.5) d.motions.push_back({a, b, apart / 3});
    }
  }
  return scan;
}

ScanStudy small_study(std::vector<std::string> methods, int seeds = 1) {
  ScanStudy study;
  study.missions = {"block"};
  for (int s = 1; s <= seeds; ++s) study.seeds.push_back(static_cast<std::uint64_t>(s));
  for (const std::string& method : methods) {
    study.methods.push_back(scan_method(method, plugins()));
  }
  study.guard.reset();
  study.prepare = [seeds = study.seeds](std::size_t, std::size_t seed) {
    return small_case(seeds[seed]);
  };
  return study;
}

class ScanStudies : public ::testing::Test {
 protected:
  void SetUp() override {
    base_ = fs::temp_directory_path() / ("lapwing_study_" + std::to_string(::getpid()));
    fs::remove_all(base_);
  }
  void TearDown() override { fs::remove_all(base_); }

  std::vector<ScanRow> run(const ScanStudy& study, const std::string& folder, bool resume = false,
                           int threads = 1) const {
    const auto executor = plugins().create<Executor>("threads");
    const CancellationToken token;
    ItemOptions options;
    options.resume = resume;
    ItemRun items(*executor, options, threads, token, [](const std::string&) {});
    const auto nothing = [](const std::string&) {};
    return run_study(
               study, base_ / folder, items, plugins(), nullptr, [] {}, nothing)
        .value();
  }
  // Rows and what is made of them; times are the clock's.
  std::map<std::string, std::string> bytes(const std::string& folder) const {
    std::map<std::string, std::string> all;
    for (const auto& item : fs::recursive_directory_iterator(base_ / folder)) {
      const std::string name = item.path().lexically_relative(base_ / folder).string();
      if (item.is_regular_file() && !name.starts_with("times")) all[name] = read_file(item.path());
    }
    return all;
  }
  fs::path base_;
};

TEST_F(ScanStudies, MeasureMethodsOnTheSameCandidates) {
  const ScanStudy study = small_study({"cost_benefit+local_search:iterations=50", "greedy",
                                       "milp:nodes=2", "hemisphere_7", "circle_7"});
  const std::vector<ScanRow> rows = run(study, "a");
  ASSERT_EQ(rows.size(), 5u);
  for (const ScanRow& row : rows) {
    EXPECT_TRUE(row.found) << row.method << ": " << row.message;
    EXPECT_TRUE(row.counts) << row.method;
    EXPECT_TRUE(row.reproducible) << row.method;
    EXPECT_EQ(row.candidates, 48);
    EXPECT_LE(row.seconds, 60.001) << row.method;
    EXPECT_GT(row.alone.recall, 0.05) << row.method;
    EXPECT_GT(row.alone.precision, 0.95) << row.method;
    EXPECT_EQ(row.first_images, 3);
    if (row.method == "circle_7") {
      EXPECT_TRUE(std::isnan(row.score)) << "its views are no candidates";
      EXPECT_EQ(row.message.find("the whole pattern"), std::string::npos) << row.message;
    } else {
      EXPECT_LE(row.score, row.upper_bound.value_or(1e9) * (1 + 1e-9)) << row.method;
    }
    // Three images from above show the roof and the ground around.
    if (row.method != "circle_7") {
      EXPECT_GE(row.with_first.recall, row.alone.recall) << row.method;
    } else {
      EXPECT_EQ(row.with_first.recall, row.alone.recall);  // needs no first flight, has none
    }
  }
  EXPECT_GE(rows[0].score, rows[1].score);
  for (const ScanRow& row : rows) {
    const ScanRow again = scan_row_from(from_json(to_json(to_value(row)), "row"));
    EXPECT_EQ(to_json(to_value(again)), to_json(to_value(row)));
  }
}

TEST_F(ScanStudies, AreTheSameForAnyNumberOfThreads) {
  ScanStudy study = small_study({"greedy", "recursive_greedy", "circle_7"}, 2);
  study.budgets = {30, 60};
  study.noise = DepthNoise{0.2, 0.02};
  const auto one = run(study, "one");
  ASSERT_EQ(one.size(), 12u);
  EXPECT_EQ(one[0].budget, 30);
  EXPECT_LT(one[0].score, one[6].score);
  run(study, "three", false, 3);
  EXPECT_EQ(bytes("one"), bytes("three"));
}

// Killed with no chance to say anything, several times; --resume ends with the bytes of a study
// that nobody disturbed.
TEST_F(ScanStudies, GoOnAfterTheyWereKilled) {
  const ScanStudy study = small_study({"greedy", "hemisphere_7", "circle_7"}, 3);
  const auto unbroken = run(study, "unbroken");
  Random random(static_cast<std::uint64_t>(::getpid()));
  int kills = 0;
  for (int turn = 0; turn < 4; ++turn) {
    const pid_t child = ::fork();
    if (child == 0) {
      try {
        run(study, "broken", turn > 0);
      } catch (...) {
        ::_exit(1);
      }
      ::_exit(0);
    }
    ASSERT_GT(child, 0);
    ::usleep(static_cast<useconds_t>(random.integer(20'000, 150'000)));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    kills += WIFSIGNALED(status);
    if (!fs::exists(base_ / "broken" / "study.json")) fs::remove_all(base_ / "broken");
    if (!fs::exists(base_ / "broken")) --turn;
  }
  EXPECT_GE(kills, 1);
  const auto resumed = run(study, "broken", true);
  EXPECT_EQ(tables_csv(summarise(resumed)), tables_csv(summarise(unbroken)));
  // What a kill leaves half-written has another name, and is no row.
  std::map<std::string, std::string> left = bytes("broken");
  std::erase_if(left, [](const auto& file) { return file.first.find(".tmp-") != file.first.npos; });
  EXPECT_EQ(left, bytes("unbroken"));
}

TEST_F(ScanStudies, AreNotMixedUp) {
  const ScanStudy study = small_study({"circle_7"});
  run(study, "a");
  EXPECT_THROW(run(study, "a"), InputError);                            // without --resume
  EXPECT_THROW(run(small_study({"circle_6"}), "a", true), InputError);  // another one
  EXPECT_NO_THROW(run(study, "a", true));
  EXPECT_THROW(run(small_study({"circle_7", "circle_7"}), "b"), InputError);
  EXPECT_THROW(run(small_study({}), "b"), InputError);
  for (const char* name : {"circle_", "simplex", "milp:nodes=-1", "milp:notes=1", "greedy+"}) {
    EXPECT_THROW(scan_method(name, plugins()), std::exception) << name;
  }
}

TEST_F(ScanStudies, ABudgetThatIsTooSmallIsARow) {
  ScanStudy study = small_study({"greedy", "circle_7"});
  study.budgets = {1};
  for (const ScanRow& row : run(study, "a")) {
    EXPECT_FALSE(row.found);
    EXPECT_EQ(row.status, "infeasible");
    EXPECT_FALSE(row.message.empty());
    EXPECT_EQ(row.with_first.f, 0);
  }
}

TEST_F(ScanStudies, StopWhenTheyAreTold) {
  CancellationToken token;
  token.cancel();
  const auto executor = plugins().create<Executor>("threads");
  ItemRun items(*executor, {}, 1, token, [](const std::string&) {});
  EXPECT_THROW(run_study(
                   small_study({"greedy"}), base_ / "a", items, plugins(), &token, [] {},
                   [](const std::string&) {}),
               Cancelled);
}

ScanRow row_of(const std::string& method, std::uint64_t seed, double f, double budget = 60) {
  ScanRow row{.mission = "street", .method = method, .seed = seed, .budget = budget};
  row.found = true;
  row.score_share = f;
  row.with_first.f = row.with_first.recall = f;
  return row;
}

TEST(ScanTables, HaveMeansAndStandardErrors) {
  std::vector<ScanRow> rows{row_of("ours", 1, 0.8), row_of("ours", 2, 0.9), row_of("ours", 3, 0.7),
                            row_of("milp", 1, 0.6), row_of("milp", 2, 0.5), row_of("milp", 3, 0.1)};
  rows[5].counts = false;
  rows[4].reproducible = false;
  const std::vector<ScanSummary> summaries = summarise(rows);
  ASSERT_EQ(summaries.size(), 2u);
  EXPECT_NEAR(summaries[0].f.mean, 80, 1e-9);
  EXPECT_NEAR(summaries[0].f.error, 10 / std::sqrt(3.0), 1e-9);
  EXPECT_EQ(summaries[1].counted, 2);
  EXPECT_NEAR(summaries[1].f.mean, 55, 1e-9);
  const std::string text = tables_text(summaries);
  EXPECT_NE(text.find("80.00 +- 5.77"), text.npos) << text;
  EXPECT_NE(text.find("2 of 3 count; ended by the clock"), text.npos) << text;
  EXPECT_NE(tables_csv(summaries).find("street,60,milp,3,2,false"), std::string::npos);
}

TEST(ScanTables, ThePageHasCurvesWhereThereAreBudgets) {
  std::vector<ScanRow> rows;
  for (const double budget : {30.0, 60.0, 90.0}) {
    for (const char* method : {"ours", "greedy"}) {
      rows.push_back(row_of(method, 1, budget / 100, budget));
    }
  }
  const Report report = study_report(summarise(rows), rows);
  int charts = 0;
  for (const Block& block : report.sections.front().blocks) {
    if (const Chart* chart = std::get_if<Chart>(&block)) {
      ++charts;
      EXPECT_EQ(chart->series.size(), 2u);
      EXPECT_EQ(chart->series[0].x.size(), 3u);
    }
  }
  EXPECT_EQ(charts, 2);
  EXPECT_NE(render_html(report).find("Comparison of scan tours"), std::string::npos);
  const std::vector<ScanRow> one{row_of("ours", 1, 0.5)};
  for (const Block& block : study_report(summarise(one), one).sections.front().blocks) {
    EXPECT_EQ(std::get_if<Chart>(&block), nullptr);
  }
}

}  // namespace
}  // namespace lapwing
