// SPDX-License-Identifier: Apache-2.0
// Small orienteering instances of tests/data with their optima, found by going through all sets of
// nodes.
#include <gtest/gtest.h>

#include <sstream>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/view/orienteering_file.h"
#include "tests/plugins/tour_solvers/tour_plugins.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

const fs::path kShippedInstances = fs::path(LAPWING_SOURCE_DIR) / "tests/data/orienteering";

struct ShippedInstance {
  fs::path file;
  double optimum = 0;
};

std::vector<ShippedInstance> shipped_instances() {
  std::vector<ShippedInstance> known{{kShippedInstances / "meadow13.txt", 90}};
  std::istringstream lines(read_file(kShippedInstances / "best_known.csv"));
  std::string line;
  std::getline(lines, line);  // instance,nodes,distance,cost_limit,optimum
  while (std::getline(lines, line))
    known.push_back({kShippedInstances / "oplib" / (line.substr(0, line.find(',')) + ".oplib"),
                     std::stod(line.substr(line.rfind(',') + 1))});
  return known;
}

// Rounded, geographic and stated distances, and the plain format's exact ones.
TEST(ShippedInstances, AreSolvedToTheirOptima) {
  const std::vector<ShippedInstance> instances = shipped_instances();
  ASSERT_EQ(instances.size(), 4u);
  for (const ShippedInstance& known : instances) {
    SCOPED_TRACE(known.file.filename());
    const TourProblem problem(read_orienteering_file(known.file).definition);
    for (const char* solver : {"local_search", "milp"}) {
      const TourResult result = tour_plugins().create<TourSolver>(solver, {})->solve(problem);
      EXPECT_EQ(problem.problem_of(result.walk), "") << solver;
      EXPECT_EQ(result.report.score, known.optimum) << solver << ": " << result.report.message;
      EXPECT_GE(result.report.upper_bound, known.optimum - 1e-6) << solver;
    }
  }
}

TEST(ShippedInstances, AFileThatCannotHoldItsNodesIsRefused) {
  const std::string text =
      "TYPE: OP\nDIMENSION: 10000\nCOST_LIMIT: 9\nEDGE_WEIGHT_TYPE: EXPLICIT\n"
      "EDGE_WEIGHT_FORMAT: FULL_MATRIX\nEDGE_WEIGHT_SECTION\n0 1 2\n";
  try {
    read_orienteering(text, "small.oplib");
    FAIL() << "800 MB were taken for a file of 120 bytes";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("small.oplib:6: the file ends before the distances"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace lapwing
