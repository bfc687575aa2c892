// SPDX-License-Identifier: Apache-2.0
// lapwing compare, log and vehicle, as a user runs them.
#include <gmock/gmock.h>

#include "framework/core/json.h"
#include "tests/app/program_fixture.h"
#include "tests/flight_review/log_writers.h"

namespace lapwing {
namespace {

using testing::HasSubstr;

class HomeAgain : public CommandLine {
 protected:
  HomeAgain() {
    plan_ = wave_plan(20);
    write("plan.json", plan_text(plan_));
  }
  void fly(const std::string& name, const Recording& recording,
           const std::function<void(RecordedState&)>& change = {}) {
    auto states = ideal_flight(plan_, 20);
    if (change)
      for (RecordedState& s : states) change(s);
    write(name, ulog_of(recorded(states, recording)));
  }
  Plan plan_;
};

TEST_F(HomeAgain, AFlightAsPlannedIsSaidToBeSo) {
  fly("a.ulg", {.clock = 321.5, .offset = {1, 2, 0.5}, .noise = 0.01});
  const Finished good = run({"compare", "plan.json", "a.ulg", "-o", "a.html"});
  EXPECT_EQ(good.status, 0) << good.err << good.out;
  EXPECT_THAT(good.out, HasSubstr("wave: flown as planned"));
  EXPECT_THAT(good.out, HasSubstr("time 0 of the plan is 321.5"));
  EXPECT_THAT(good.out, HasSubstr(" m east, -2.00"));
  EXPECT_THAT(read_file(folder_ / "a.html"), HasSubstr("the flight against its plan"));
  const Finished json = run({"compare", "plan.json", "a.ulg", "--json"});
  const Value value = from_json(json.out, "answer");
  EXPECT_NEAR(value.at("alignment").at("clock").as_number(), 321.5, 0.01);
  EXPECT_NEAR(value.at("alignment").at("offset").as_list()[1].as_number(), -2, 0.02);
  EXPECT_TRUE(value.at("kept").as_boolean());
}

TEST_F(HomeAgain, ABrokenLimitEndsWithOne) {
  plan_.task.keyframes.push_back({10, sample_at(plan_.trajectory, 10).position});
  write("plan.json", plan_text(plan_));
  fly("b.ulg", {.clock = 30},
      [](RecordedState& s) { s.position.z() += 2 * std::exp(-std::pow(s.time - 10, 2)); });
  const Finished broken = run({"compare", "plan.json", "b.ulg", "--no-offset"});
  EXPECT_EQ(broken.status, 1) << broken.err << broken.out;
  EXPECT_THAT(broken.out, HasSubstr("broke limits that the plan keeps"));
  EXPECT_THAT(broken.out, HasSubstr("broken: keyframe_miss"));
  EXPECT_THAT(broken.out, HasSubstr("what would have to change"));
}

TEST_F(HomeAgain, AnotherFlightEndsWithOneMessageAndOne) {
  fly("far.ulg", {.offset = {9000, 0, 0}});
  const Finished far = run({"compare", "plan.json", "far.ulg"});
  EXPECT_EQ(far.status, 1);
  EXPECT_EQ(far.out, "");
  EXPECT_THAT(far.err, HasSubstr("'far.ulg': the log is of another place: it comes no nearer"));
  fly("other.ulg", {}, [](RecordedState& s) {
    s.position = {20 * std::cos(s.time), 20 * std::sin(s.time), 30};
  });
  const Finished other = run({"compare", "plan.json", "other.ulg", "--json", "-o", "o.html"});
  EXPECT_EQ(other.status, 1);
  EXPECT_THAT(other.err, HasSubstr("the log never flew this plan"));
  EXPECT_EQ(from_json(other.out, "answer").at("status").as_text(), "another flight");
  EXPECT_FALSE(fs::exists(folder_ / "o.html"));
}

TEST_F(HomeAgain, BadInputIsOneMessage) {
  write("note.txt", "no log\n");
  refused({"compare", "plan.json", "note.txt"},
          {"'note.txt' is not a flight log of a known format; there are csv, dataflash, gpx, mcap, "
           "tlog, ulog"});
  refused({"compare", "plan.json", "note.txt", "--format", "ulog"},
          {"'note.txt': byte 0: a ULog begins with"});
  refused({"compare", "plan.json", "note.txt", "--format", "kml"}, {"kml"});
  refused({"compare", "plan.json", "missing.ulg"}, {"missing.ulg"});
  fly("a.ulg", {});
  refused({"compare", "plan.json", "a.ulg", "--origin", "46.5,6.5,0,ground"},
          {"the plan states an origin of its own"});
  refused({"compare", "plan.json", "a.ulg", "-o", "page.txt"}, {"page.txt"});
  refused({"log", "info", "note.txt"}, {"is not a flight log"});
  refused({"vehicle", "from", "a.ulg", "--base", "vehicles/none"}, {"--base", "vehicles/none"});
}

TEST_F(HomeAgain, ContentDecidesNotTheName) {
  const auto states = recorded(ideal_flight(plan_, 20), {.clock = 40});
  write("log.csv", gpx_of(states));
  const Finished gpx = run({"log", "info", "log.csv"});
  EXPECT_EQ(gpx.status, 0) << gpx.err;
  EXPECT_THAT(gpx.out, HasSubstr("gpx, test"));
  write("log.ulg", airdata_of(states));
  EXPECT_THAT(run({"compare", "plan.json", "log.ulg"}).out, HasSubstr("flown as planned"));
}

TEST_F(HomeAgain, ALogCutShortIsCompared) {
  fly("a.ulg", {.clock = 30});
  const std::string bytes = read_file(folder_ / "a.ulg");
  write("cut.ulg", bytes.substr(0, bytes.size() / 2));
  const Finished cut = run({"compare", "plan.json", "cut.ulg"});
  EXPECT_EQ(cut.status, 1) << cut.err << cut.out;
  EXPECT_THAT(cut.out, HasSubstr("wave: kept as far as the log goes ("));
  EXPECT_THAT(cut.out, HasSubstr("the log is damaged: it ends within"));
  EXPECT_THAT(cut.out, HasSubstr("of the plan are not in the log"));
}

TEST_F(HomeAgain, AVehicleFileHoldsWhatWasShown) {
  plan_ = wave_plan(60);
  fly("a.ulg", {.clock = 10}, [](RecordedState& s) { s.position.z() -= 5; });
  const Finished made = run({"vehicle", "from", "a.ulg", "-o", "mine.yaml"});
  EXPECT_EQ(made.status, 0) << made.err;
  const std::string text = read_file(folder_ / "mine.yaml");
  EXPECT_THAT(text, HasSubstr("# shown, held for 0.5 s"));
  EXPECT_THAT(text, HasSubstr("# of vehicles/solo"));
  EXPECT_THAT(text, HasSubstr("mass and inertia cannot be seen"));
  // It is a vehicle file.
  write("shot.lua", film("vehicle = 'mine.yaml',"));
  const Finished planned =
      run({"config", "shot.lua", "--set", "vehicle=" + (folder_ / "mine.yaml").string()});
  EXPECT_EQ(planned.status, 0) << planned.err;
}

}  // namespace
}  // namespace lapwing
