// What the readme of the learned utility says of it, on fewer and shorter episodes.
#include <map>
#include <sstream>

#include "tests/missions/flown_film.h"

namespace lapwing {
namespace {

class ExploringFigures : public Filming {
 protected:
  // Mean efficiency relative to the oracle, by world and utility.
  std::map<std::pair<std::string, std::string>, double> evaluate(const std::string& more,
                                                                 const char* name) {
    const fs::path out = folder_ / name;
    const std::string line = std::string(LAPWING_BUILD_DIR) +
                             "/bin/lapwing evaluate explore --world suburb --world downtown:202 "
                             "--episodes 2 --steps 80 --quiet -o '" +
                             out.string() + "' " + more;
    EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 0);
    std::map<std::pair<std::string, std::string>, double> relative;
    std::istringstream table(read_file(out / "table.csv"));
    std::string row;
    for (std::getline(table, row); std::getline(table, row);) {
      std::vector<std::string> cells;
      std::istringstream line_of(row);
      for (std::string cell; std::getline(line_of, cell, ',');) cells.push_back(cell);
      relative[{cells.at(0), cells.at(1)}] = std::stod(cells.at(5));
    }
    return relative;
  }
};

TEST_F(ExploringFigures, TheLearnedUtilityComesNextToTheOracle) {
  auto seeing = evaluate("", "seeing");
  auto blind = evaluate("--utility learned --utility oracle --set learned.blank=true", "blind");
  double mean = 0;
  for (const char* world : {"suburb 1", "downtown 202"}) {
    const double learned = (seeing.at({world, "learned"}));
    for (const char* other : {"frontier", "average_entropy", "proximity_count"})
      EXPECT_GT(learned, (seeing.at({world, other}))) << world << " " << other;
    EXPECT_GT(learned, (blind.at({world, "learned"})) + 0.1) << world;
    EXPECT_GT(learned, 0.6) << world;
    mean += learned / 2;
  }
  EXPECT_GT(mean, 0.75);
}

// Spearman's rho of the network alone in the worlds that it was validated by.
TEST_F(ExploringFigures, ItRanksTheViewsOfItsValidation) {
  const std::string program = std::string(LAPWING_BUILD_DIR) + "/bin/lapwing train ";
  const std::string samples = (folder_ / "samples").string(), said = (folder_ / "said").string();
  const std::string made = program + "dataset --world downtown:101-103 --episodes 1 --seed 7 " +
                           "--quiet -o '" + samples + "'";
  ASSERT_EQ(std::system(made.c_str()), 0);
  const std::string judged = program + "score '" + samples + "' -o '" + LAPWING_SOURCE_DIR +
                             "/plugins/utilities/learned/learned.model' > '" + said + "'";
  ASSERT_EQ(std::system(judged.c_str()), 0);
  std::istringstream table(read_file(said));
  std::string row, name;
  std::getline(table, row);
  double mean = 0;
  for (const int world : {101, 102, 103}) {
    int seed = 0, count = 0;
    double rho = 0, loss = 0;
    table >> name >> seed >> count >> rho >> loss;
    EXPECT_EQ(seed, world) << read_file(said);
    EXPECT_GT(count, 1000);
    EXPECT_GT(rho, 0.4) << world;
    mean += rho / 3;
  }
  EXPECT_GT(mean, 0.6);
}

}  // namespace
}  // namespace lapwing
