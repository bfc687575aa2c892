// Local search on published orienteering instances; every route is checked again by code that
// shares nothing with the reader.
#include "framework/view/orienteering_file.h"

#include <cmath>
#include <cstdlib>
#include <ctime>

#include "framework/core/error.h"
#include "framework/core/files.h"
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

// A route judged from the file's text: what it collects, negative where it is none.
class Judge {
 public:
  explicit Judge(const std::string& text) {
    std::istringstream words(text);
    std::string word;
    while (words >> word) {
      if (word == "DIMENSION:" || word == "DIMENSION") n_ = static_cast<int>(value(words, word));
      if (word == "COST_LIMIT" || word == "COST_LIMIT:") limit_ = value(words, word);
      if (word == "EDGE_WEIGHT_TYPE:" || word == "EDGE_WEIGHT_TYPE")
        type_ = text_value(words, word);
      if (word == "NODE_COORD_SECTION") read(words, 2, points_);
      if (word == "NODE_SCORE_SECTION") read(words, 1, scores_);
      if (word == "EDGE_WEIGHT_SECTION") {
        for (int i = 0; i < n_ * (n_ + 1) / 2; ++i) words >> lower_.emplace_back();
      }
    }
  }

  double collected(const std::vector<int>& walk) const {
    if (walk.size() < 2 || walk.front() != 0 || walk.back() != 0) return -1;
    double length = 0, score = 0;
    std::vector<bool> visited(n_, false);
    for (std::size_t i = 1; i < walk.size(); ++i) {
      if (visited[walk[i]]) return -1;
      visited[walk[i]] = true;
      score += scores_[walk[i]][0];
      length += distance(walk[i - 1], walk[i]);
    }
    return length <= limit_ ? score : -1;
  }

 private:
  static std::string text_value(std::istringstream& words, const std::string& key) {
    std::string word;
    if (key.back() != ':') words >> word;
    words >> word;
    return word;
  }
  static double value(std::istringstream& words, const std::string& key) {
    return std::stod(text_value(words, key));
  }
  void read(std::istringstream& words, int count, std::vector<std::vector<double>>& rows) const {
    rows.assign(n_, std::vector<double>(count));
    for (int i = 0, node = 0; i < n_; ++i) {
      words >> node;
      for (double& number : rows[node - 1]) words >> number;
    }
  }
  double distance(int a, int b) const {
    if (type_ == "EXPLICIT")
      return lower_[std::max(a, b) * (std::max(a, b) + 1) / 2 + std::min(a, b)];
    const auto &p = points_[a], &q = points_[b];
    if (type_ == "EUC_2D") return std::lround(std::hypot(p[0] - q[0], p[1] - q[1]));
    const auto radians = [](double x) {
      const int degrees = static_cast<int>(x);
      return 3.141592 * (degrees + 5.0 * (x - degrees) / 3.0) / 180.0;
    };
    const double a1 = radians(p[0]), o1 = radians(p[1]), a2 = radians(q[0]), o2 = radians(q[1]);
    const double q1 = std::cos(o1 - o2), q2 = std::cos(a1 - a2), q3 = std::cos(a1 + a2);
    return static_cast<int>(6378.388 * std::acos(0.5 * ((1 + q1) * q2 - (1 - q1) * q3)) + 1);
  }

  int n_ = 0;
  double limit_ = 0;
  std::string type_;
  std::vector<std::vector<double>> points_, scores_;
  std::vector<double> lower_;
};

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
    const double collected = Judge(read_file(path)).collected(result.walk);
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
