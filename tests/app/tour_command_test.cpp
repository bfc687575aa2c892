// SPDX-License-Identifier: Apache-2.0
// lapwing tour.
#include <gmock/gmock.h>

#include "framework/core/json.h"
#include "tests/app/program_fixture.h"

namespace lapwing {
namespace {

using ::testing::HasSubstr;

class TourCommand : public CommandLine {
 protected:
  TourCommand() {
    fs::copy(fs::path(LAPWING_SOURCE_DIR) / "tests/data/orienteering/oplib", folder_);
    fs::copy(fs::path(LAPWING_SOURCE_DIR) / "tests/data/orienteering/meadow13.txt", folder_);
  }
};

TEST_F(TourCommand, SolvesAFileByEverySolver) {
  const Finished finished =
      run({"tour", "meadow13.txt", "--solver", "local_search", "--solver", "milp", "--json"});
  ASSERT_EQ(finished.status, 0) << finished.err;
  const Value answer = from_json(finished.out, "answer");
  const Value::List& tours = answer.at("tours").as_list();
  ASSERT_EQ(tours.size(), 2u);
  EXPECT_EQ(tours[0].at("solver").as_text(), "local_search");
  EXPECT_EQ(tours[1].at("solver").as_text(), "milp");
  EXPECT_EQ(tours[1].at("status").as_text(), "optimal");
  for (const Value& tour : tours) {
    EXPECT_EQ(tour.at("instance").as_text(), "meadow13");
    EXPECT_EQ(tour.at("score").as_number(), 90);
    EXPECT_EQ(tour.at("walk").as_list().front().as_integer(), 1);
    EXPECT_EQ(tour.at("walk").as_list().back().as_integer(), 2);
    EXPECT_LE(tour.at("length").as_number(), tour.at("cost_limit").as_number());
  }
}

// The plain format of Chao's team instances: the limit of the file is dealt to the tours.
TEST_F(TourCommand, ProvesTheToursOfATeam) {
  std::string text = read_file(folder_ / "meadow13.txt");
  write("team.txt", "30" + text.substr(text.find('\t')));
  const Finished finished = run({"tour", "team.txt", "--team", "2", "--solver", "milp", "--solver",
                                 "local_search", "--json"});
  ASSERT_EQ(finished.status, 0) << finished.err;
  const Value answer = from_json(finished.out, "answer");
  const Value::List& rows = answer.at("tours").as_list();
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].at("status").as_text(), "optimal") << rows[0].at("message").as_text();
  EXPECT_EQ(rows[0].at("gap").as_number(), 0);
  EXPECT_LE(rows[1].at("score").as_number(), rows[0].at("score").as_number());
  const Value::List& team = rows[0].at("team").as_list();
  ASSERT_EQ(team.size(), 2u);
  for (const Value& tour : team) {
    EXPECT_LE(tour.at("length").as_number(), 15);
    EXPECT_EQ(tour.at("walk").as_list().front().as_integer(), 1);
    EXPECT_EQ(tour.at("walk").as_list().back().as_integer(), 2);
  }
}

TEST_F(TourCommand, PrintsATable) {
  const Finished finished =
      run({"tour", "meadow13.txt", "garden14.oplib", "--set", "iterations=50"});
  ASSERT_EQ(finished.status, 0) << finished.err;
  EXPECT_THAT(finished.out, HasSubstr("instance"));
  EXPECT_THAT(finished.out, HasSubstr("meadow13"));
  EXPECT_THAT(finished.out, HasSubstr("local_search"));
  EXPECT_THAT(finished.out, HasSubstr("garden14"));
}

TEST_F(TourCommand, BadInputIsRefused) {
  refused({"tour", "nowhere.oplib"}, {"nowhere.oplib"});
  refused({"tour", "meadow13.txt", "--solver", "local_serch"}, {"did you mean 'local_search'"});
  refused({"tour", "meadow13.txt", "--set", "iteration=5"}, {"did you mean 'iterations'"});
  refused({"tour", "meadow13.txt", "--guard", "0"}, {"above 0"});
  write("bad.oplib",
        "TYPE: OP\nDIMENSION: 2\nCOST_LIMIT: -4\nEDGE_WEIGHT_TYPE: EUC_2D\n"
        "NODE_COORD_SECTION\n1 0 0\n2 3 4\nNODE_SCORE_SECTION\n1 0\n2 7\n"
        "DEPOT_SECTION\n1\n-1\nEOF\n");
  refused({"tour", "bad.oplib"}, {"'bad.oplib'", "budget"});
  write("cut.oplib",
        "TYPE: OP\nDIMENSION: 2\nCOST_LIMIT: 4\nEDGE_WEIGHT_TYPE: EUC_2D\n"
        "NODE_COORD_SECTION\n1 0 0\n");
  refused({"tour", "cut.oplib"}, {"cut.oplib:7", "a node's number"});
  write("empty.oplib", "");
  refused({"tour", "empty.oplib"}, {"empty.oplib:1: the file is empty"});
}

}  // namespace
}  // namespace lapwing
