// SPDX-License-Identifier: Apache-2.0
// Local search on published orienteering instances; every route is checked again by code that
// shares nothing with the reader.
#include "framework/view/orienteering_file.h"

#include <array>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <set>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "tests/plugins/tour_solvers/route_judge.h"
#include "tests/plugins/tour_solvers/tour_plugins.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

struct Known {
  std::string name;
  double optimum = 0;
};

std::vector<Known> known_instances(const fs::path& folder) {
  std::istringstream lines(read_file(folder / "best_known.csv"));
  std::vector<Known> known;
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    std::istringstream fields(line);
    std::string name, skipped, optimum;
    std::getline(fields, name, ',');
    for (int i = 0; i < 3; ++i) std::getline(fields, skipped, ',');
    std::getline(fields, optimum, ',');
    known.push_back({name, std::stod(optimum)});
  }
  return known;
}

TEST(Orienteering, RoutesOfPublishedInstancesComeNearTheOptimum) {
  const char* data = std::getenv("LAPWING_DATA");
  if (!data) GTEST_SKIP() << "LAPWING_DATA is not set";
  const fs::path folder = fs::path(data) / "orienteering";
  // With LAPWING_LONG as many iterations as 10 s of one thread allow, else a few.
  const bool whole = std::getenv("LAPWING_LONG") != nullptr;
  Value parameters = Value::map();
  parameters.set("iterations", whole ? 20000 : 1500);
  const auto solver = tour_plugins().create<TourSolver>("local_search", parameters);
  double gaps = 0;
  const std::vector<Known> instances = known_instances(folder);
  ASSERT_EQ(instances.size(), 16u);
  for (const auto& [name, optimum] : instances) {
    const fs::path path = folder / "oplib" / (name + ".oplib");
    const TourProblem problem(read_orienteering_file(path).definition);
    const std::clock_t began = std::clock();
    const TourResult result = solver->solve(problem);
    const double seconds = static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC;
    const double collected = RouteJudge(read_file(path)).collected(result.walk);
    EXPECT_EQ(collected, result.report.score) << name;
    EXPECT_LE(collected, optimum) << name;
    EXPECT_GE(result.report.upper_bound, optimum) << name;
    gaps += (optimum - collected) / optimum;
    if (!whole) continue;
    std::printf("%-12s %6.0f of %6.0f, %5.2f s\n", name.c_str(), collected, optimum, seconds);
    EXPECT_LE(seconds, 10) << name;
  }
  if (whole) std::printf("%.3f %% below the optimum on average\n", 100 * gaps / 16);
  EXPECT_LE(gaps / 16, whole ? 0.01 : 0.02);
}

// The 64 points of Chao, Golden and Wasil (EJOR 1996) for teams, whose cost limit each shares
// evenly, with the best scores known since (Archetti, Hertz and Speranza, J. Heuristics 2007, p6.2
// to p6.4). Left out is 65 for four, whose share of 16.25 was rounded to 16.2 there.
struct KnownTeam {
  int team = 0, limit = 0;
  double best = 0;
};
constexpr KnownTeam kTeams[] = {
    {2, 30, 192},  {2, 35, 360},  {2, 40, 588},  {2, 45, 660},  {2, 50, 780},  {2, 55, 888},
    {2, 60, 948},  {2, 65, 1032}, {2, 70, 1116}, {2, 75, 1188}, {2, 80, 1260}, {3, 45, 282},
    {3, 50, 444},  {3, 55, 642},  {3, 60, 828},  {3, 65, 894},  {3, 70, 1002}, {3, 75, 1080},
    {3, 80, 1170}, {4, 60, 366},  {4, 70, 696},  {4, 75, 912},  {4, 80, 1068}};

TEST(Orienteering, TeamsOfPublishedInstancesComeNearTheBestKnown) {
  const char* data = std::getenv("LAPWING_DATA");
  if (!data) GTEST_SKIP() << "LAPWING_DATA is not set";
  const fs::path folder = fs::path(data) / "orienteering" / "chao64";
  const auto solver = tour_plugins().create<TourSolver>("local_search", Value());
  double gaps = 0, slowest = 0;
  for (const KnownTeam& known : kTeams) {
    const std::string name = "set_64_1_" + std::to_string(known.limit) + ".txt";
    SCOPED_TRACE(name + " for a team of " + std::to_string(known.team));
    TourDefinition definition = read_orienteering_file(folder / name).definition;
    definition.budget = static_cast<double>(known.limit) / known.team;
    std::vector<TeamTour> tours;
    for (int t = 0; t < known.team; ++t)
      tours.push_back({std::to_string(t), TourProblem(definition)});
    const std::clock_t began = std::clock();
    const TeamResult result = solver->solve(TeamProblem(std::move(tours)), {});
    slowest = std::max(slowest, static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC);
    // Collected once each, by tours that keep their limit: read and summed without the solver.
    std::istringstream lines(read_file(folder / name));
    std::string head;
    std::getline(lines, head);
    std::vector<std::array<double, 3>> points;
    for (std::array<double, 3> p; lines >> p[0] >> p[1] >> p[2];) points.push_back(p);
    std::set<int> seen;
    for (const std::vector<int>& walk : result.walks) {
      double length = 0;
      for (std::size_t i = 1; i < walk.size(); ++i)
        length += std::hypot(points[walk[i]][0] - points[walk[i - 1]][0],
                             points[walk[i]][1] - points[walk[i - 1]][1]);
      EXPECT_LE(length, definition.budget + 1e-9);
      EXPECT_EQ(walk.front(), 0);
      EXPECT_EQ(walk.back(), 1);
      seen.insert(walk.begin(), walk.end());
    }
    double collected = 0;
    for (const int view : seen) collected += points[view][2];
    EXPECT_EQ(collected, result.report.score);
    EXPECT_LE(collected, known.best);
    gaps += (known.best - collected) / known.best;
  }
  const double mean = gaps / std::size(kTeams);
  std::printf("%.3f %% below the best known on average, at most %.2f s each\n", 100 * mean,
              slowest);
  EXPECT_LE(mean, 0.005);
  EXPECT_LE(slowest, 10);
}

TEST(Orienteering, PlainFilesGoFromTheFirstPointToTheSecond) {
  const OrienteeringInstance instance =
      read_orienteering("10\t1\n0 0 0\n6 0 0\n3 4 5\n3 -1 2\n", "f");
  const TourProblem problem(instance.definition);
  EXPECT_EQ(problem.start(), 0);
  EXPECT_EQ(problem.end(), 1);
  EXPECT_DOUBLE_EQ(problem.leg(0, 2), 5);
  const TourResult result =
      tour_plugins().create<TourSolver>("local_search", Value())->solve(problem);
  EXPECT_EQ(result.walk, (std::vector<int>{0, 2, 1}));
  EXPECT_EQ(result.report.score, 5);
}

// Four nodes at given places, and with the given distances.
std::string of_four(const std::string& type, const std::string& more) {
  return "NAME : four\nTYPE : OP\nDIMENSION : 4\nCOST_LIMIT : 100000\nEDGE_WEIGHT_TYPE : " + type +
         "\n" + more + "NODE_SCORE_SECTION\n1 0\n2 5\n3 6\n4 7\nDEPOT_SECTION\n1\n-1\nEOF\n";
}

TEST(Orienteering, JudgeAndReaderAgreeOnEveryKindOfDistance) {
  const std::string places = "NODE_COORD_SECTION\n1 0 0\n2 38.24 20.42\n3 -12.5 7.3\n4 3 94.1\n";
  const auto stated = [](const std::string& format, const std::string& numbers) {
    return of_four("EXPLICIT",
                   "EDGE_WEIGHT_FORMAT: " + format + "\nEDGE_WEIGHT_SECTION\n" + numbers);
  };
  const std::vector<std::string> files = {
      of_four("EUC_2D", places),
      of_four("CEIL_2D", places),
      of_four("ATT", places),
      of_four("GEO", places),
      stated("FULL_MATRIX", "0 1 2 3\n1 0 4 5\n2 4 0 6\n3 5 6 0\n"),
      stated("LOWER_DIAG_ROW", "0 1 0 2 4 0 3 5 6 0\n"),
      stated("LOWER_ROW", "1 2 4\n3 5 6\n"),
      stated("UPPER_DIAG_ROW", "0 1 2 3 0 4 5 0 6 0\n"),
      stated("UPPER_ROW", "1 2 3 4 5 6\n")};
  for (const std::string& file : files) {
    const TourProblem problem(read_orienteering(file, "four.oplib").definition);
    const RouteJudge judge(file);
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < 4; ++b)
        EXPECT_TRUE(a == b || problem.leg(a, b) == judge.distance(a, b)) << a << b << file;
    EXPECT_EQ(judge.collected({0, 1, 2, 3, 0}), 18) << file;
    EXPECT_EQ(judge.collected({0, 1, 1, 0}), -1);
    EXPECT_EQ(judge.collected({1, 2, 1}), -1);
  }
  // By hand: of nodes 1 and 2 the length is 43.35; over the root of ten 13.71.
  EXPECT_EQ(RouteJudge(files[0]).distance(0, 1), 43);
  EXPECT_EQ(RouteJudge(files[1]).distance(0, 1), 44);
  EXPECT_EQ(RouteJudge(files[2]).distance(0, 1), 14);
  EXPECT_EQ(RouteJudge(files[7]).distance(3, 1), 5);
}

TEST(Orienteering, BrokenFilesAreRefused) {
  const std::string good =
      "NAME: x\nTYPE: OP\nDIMENSION: 2\nCOST_LIMIT: 9\nEDGE_WEIGHT_TYPE: EUC_2D\n"
      "NODE_COORD_SECTION\n1 0 0\n2 3 4\nNODE_SCORE_SECTION\n1 0\n2 7\nDEPOT_SECTION\n1\n-1\nEOF\n";
  EXPECT_NO_THROW(TourProblem(read_orienteering(good, "good").definition));
  const auto refusal = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    try {
      const TourProblem problem(read_orienteering(text, "bad.oplib").definition);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  const auto says = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_TRUE(says(refusal("2 3 4", "3 3 4"), "bad.oplib:8: a node's number"));
  EXPECT_TRUE(says(refusal("3 4", "nan 4"), "bad.oplib:8"));
  EXPECT_TRUE(says(refusal("TYPE: OP", "TYPE: TSP"), "must be OP"));
  EXPECT_TRUE(says(refusal("EUC_2D", "MAN_3D"), "MAN_3D"));
  EXPECT_TRUE(says(refusal("DIMENSION: 2", "DIMENSION: 9999999"), "bad.oplib:3: DIMENSION"));
  EXPECT_TRUE(says(refusal("NODE_SCORE_SECTION", "NODE_SCORES"), "NODE_SCORES"));
  EXPECT_TRUE(says(refusal("1\n-1", "1\n2\n-1"), "one depot"));
  EXPECT_TRUE(says(refusal("2 7", "2 -7"), "at least 0"));
  EXPECT_TRUE(says(refusal(good, ""), "empty"));
}

}  // namespace
}  // namespace lapwing
