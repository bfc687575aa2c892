// SPDX-License-Identifier: Apache-2.0
// Edited missions: what an edit ends with is what `run` plans, judged as it is drawn.
#include "framework/mission/mission_editor.h"

#include <random>

#include "tests/mission/mission_fixture.h"

namespace lapwing {
namespace {

constexpr const char* kShot = R"(local film = require "mission.film"
return film.shot {
  name = "test",
  subject = { position = {0, 0, 2}, height = 4, width = 5 },
  keyframes = { { time = 0, position = {-18, -6, 3} }, { time = 10, position = {0, -12, 9} },
                { time = 20, position = {18, 4, 5} } },
})";

class Editing : public MissionTest {
 protected:
  void open(const std::string& text, std::shared_ptr<const Plan> start = nullptr) {
    write_file_atomically(folder_ / "shot.lua", text);
    MissionSettings with_start = settings();
    with_start.start = std::move(start);
    editor_ = std::make_unique<MissionEditor>(
        folder_ / "shot.lua", with_start, [this](const EditedPlan& edited) {
          heard_.push_back(edited);
          if (cancel_at_ && edited.answer.grade == *cancel_at_) editor_->cancel();
        });
  }
  const EditedPlan& edit(std::vector<std::string> overrides, std::vector<Value> layers = {}) {
    heard_.clear();
    editor_->edit({std::move(layers), std::move(overrides)});
    while (editor_->work()) {
    }
    return heard_.back();
  }
  MissionResult planned(const std::vector<std::string>& overrides) {
    Mission mission(folder_ / "shot.lua", settings());
    mission.configure({}, overrides);
    return mission.plan();
  }
  void expect_as_planned(const EditedPlan& edited, const std::vector<std::string>& overrides) {
    const MissionResult cold = planned(overrides);
    ASSERT_EQ(edited.answer.grade, AnswerGrade::certified) << edited.answer.message;
    const double best = cold.report.cost;
    EXPECT_NEAR(edited.answer.result.report.cost, best, 1e-5 * (1 + best));
    const auto &drawn = edited.plan->trajectory.samples, &other = cold.plan.trajectory.samples;
    ASSERT_EQ(drawn.size(), other.size());
    double apart = 0;
    for (std::size_t i = 0; i < drawn.size(); ++i)
      apart = std::max(apart, (drawn[i].position - other[i].position).norm());
    EXPECT_LT(apart, 0.1);  // m: the optimum is flat
    // But for the motion and what the solver says, the same document.
    const Value mine = to_value(*edited.plan), theirs = to_value(cold.plan);
    for (const char* key : {"mission", "kind", "vehicle", "environment", "task", "configuration"})
      EXPECT_EQ(to_json(mine.at(key)), to_json(theirs.at(key))) << key;
  }

  std::vector<EditedPlan> heard_;
  std::optional<AnswerGrade> cancel_at_;
  std::unique_ptr<MissionEditor> editor_;
};

TEST_F(Editing, EndsAsTheMissionIsPlanned) {
  open(kShot);
  const std::vector<std::vector<std::string>> edits = {
      {},
      {"keyframes[2].position=[0,-10,11]"},
      {"keyframes[2].position=[0,-10,11]", "keyframes[2].time=9.3"},
      {"keyframes[2].time=9.3", "weights.smoothness=0.01"},
      {"keyframes[3].time=22"},  // more stages
      {"obstacles=[{type: sphere, name: ball, center: [0, -12, 6], radius: 1.5}]"},
      {"obstacles=[{type: sphere, name: ball, center: [0, -12, 6], radius: 2}]"},
      {}};
  for (std::size_t k = 0; k < edits.size(); ++k) {
    SCOPED_TRACE(k);
    expect_as_planned(edit(edits[k]), edits[k]);
    EXPECT_EQ(heard_.back().answer.revision, k + 1);
  }
}

TEST_F(Editing, ACertificateIsOfWhatIsDrawn) {
  open(kShot);
  edit({});
  edit({"keyframes[2].position=[0,-10,11]"});
  ASSERT_GE(heard_.size(), 3u);
  for (const EditedPlan& edited : heard_) {
    ASSERT_TRUE(edited.plan);
    const bool judged = edited.answer.grade == AnswerGrade::certified;
    EXPECT_EQ(edited.certificate.has_value(), judged);
    // The plan is the answer's motion.
    const Trajectory drawn = edited.answer.problem->trajectory(edited.answer.result.point.stages);
    ASSERT_EQ(drawn.samples.size(), edited.plan->trajectory.samples.size());
    for (std::size_t i = 0; i < drawn.samples.size(); ++i)
      EXPECT_EQ(drawn.samples[i].position, edited.plan->trajectory.samples[i].position);
    if (!judged) continue;
    EXPECT_EQ(to_json(edited.certificate->to_value()), to_json(verify(*edited.plan).to_value()));
  }
  EXPECT_EQ(heard_.front().answer.grade, AnswerGrade::step);
  EXPECT_EQ(heard_.back().answer.grade, AnswerGrade::certified);
}

TEST_F(Editing, WhatCannotBeFlownIsRejectedWithTheVerifiersWords) {
  open(kShot);
  edit({});
  const EditedPlan& hasty = edit({"keyframes[2].time=1", "keyframes[3].time=2"});
  EXPECT_EQ(hasty.answer.grade, AnswerGrade::rejected);
  ASSERT_TRUE(hasty.certificate);
  ASSERT_FALSE(hasty.certificate->failures().empty());
  EXPECT_NE(hasty.answer.message.find(to_line(hasty.certificate->failures().front())),
            std::string::npos);
  expect_as_planned(edit({}), {});
}

TEST_F(Editing, ErrorsAreToldAndLeaveTheEditorWhole) {
  open(kShot);
  edit({});
  const auto refused = [&](std::vector<std::string> overrides, const std::string& why) {
    const EditedPlan& edited = edit(std::move(overrides));
    EXPECT_EQ(edited.answer.grade, AnswerGrade::refused);
    EXPECT_FALSE(edited.plan);
    EXPECT_FALSE(edited.certificate);
    EXPECT_NE(edited.answer.message.find(why), std::string::npos) << edited.answer.message;
  };
  refused({"keyframes[2].positoin=[0,0,0]"}, "positoin");
  refused({"solver=iqq"}, "iqq");
  refused({"keyframes[2].time=-4"}, "time");
  refused({"timing=free"}, "cannot be edited as one");
  write_file_atomically(folder_ / "shot.lua", "return {");
  refused({}, "shot.lua:1");
  write_file_atomically(folder_ / "shot.lua",
                        "return { kind = 'own', plan = function(run) return nil end }");
  refused({}, "shot.lua");
  write_file_atomically(folder_ / "shot.lua", kShot);
  expect_as_planned(edit({"keyframes[2].position=[0,-11,10]"}),
                    {"keyframes[2].position=[0,-11,10]"});
  // It went on from the last answer, and was not begun anew.
  EXPECT_LE(heard_.back().answer.result.report.iterations,
            planned({"keyframes[2].position=[0,-11,10]"}).report.iterations);
}

TEST_F(Editing, AnEditEndsTheOneBefore) {
  open(kShot);
  edit({});
  cancel_at_ = AnswerGrade::step;
  EXPECT_EQ(edit({"keyframes[2].position=[0,-10,11]"}).answer.grade, AnswerGrade::step);
  cancel_at_ = AnswerGrade::converged;
  EXPECT_EQ(edit({"keyframes[2].position=[0,-10,11]"}).answer.grade, AnswerGrade::converged);
  cancel_at_.reset();
  expect_as_planned(edit({"keyframes[2].position=[0,-10,11]"}),
                    {"keyframes[2].position=[0,-10,11]"});
  // Of several that wait, the newest is answered alone.
  heard_.clear();
  editor_->edit({{}, {"keyframes[2].position=[0,-9,11]"}});
  const std::uint64_t last = editor_->edit({{}, {"keyframes[2].position=[0,-8,11]"}});
  EXPECT_TRUE(editor_->work());
  EXPECT_FALSE(editor_->work());
  for (const EditedPlan& edited : heard_) EXPECT_EQ(edited.answer.revision, last);
  expect_as_planned(heard_.back(), {"keyframes[2].position=[0,-8,11]"});
}

TEST_F(Editing, RepeatsBitForBit) {
  std::string ends[2];
  for (std::string& end : ends) {
    open(kShot);
    for (const char* place : {"[0,-12,9]", "[1,-11,9]", "[2,-10,8]"})
      end += plan_text(*edit({std::string("keyframes[2].position=") + place}).plan);
  }
  EXPECT_EQ(ends[0], ends[1]);
}

// Its closed loop is flown by what the plan names, as `run` judges it.
TEST_F(Editing, PlansThatNameAControllerAreCertified) {
  open(kShot);
  const EditedPlan& flown = edit({"controller=geometric"});
  EXPECT_EQ(flown.answer.grade, AnswerGrade::certified) << flown.answer.message;
  const Check* check = flown.certificate->find("closed_loop");
  ASSERT_TRUE(check);
  EXPECT_EQ(check->skipped, "");
}

TEST_F(Editing, MissionsTellWhatTheyDeclare) {
  open(kShot);
  const Mission mission(folder_ / "shot.lua", settings());
  bool found = false;
  const Value declared = mission.declarations();
  for (const Value& entry : declared.as_list()) {
    if (entry.at("name") != Value("margin")) continue;
    found = true;
    EXPECT_EQ(entry.at("unit"), Value("m"));
    EXPECT_EQ(entry.at("default").as_number(), 0.5);
  }
  EXPECT_TRUE(found);
}

// A tower in the way leaves two ways past it: the flight that is given decides.
TEST_F(Editing, BeginsAtTheFlightThatIsGiven) {
  open(R"(return require("mission.film").shot {
    keyframes = { { time = 0, position = {-12, 1, 3}, yaw_deg = 0 },
                  { time = 20, position = {12, 1, 3} } },
    obstacles = { { type = "cylinder", base = {0, 0, -20}, radius = 3, height = 60 } } })");
  const auto side = [](const Trajectory& flight) {
    return flight.samples[flight.samples.size() / 2].position.y();
  };
  const std::vector<std::string> other{"keyframes[1].position=[-12,-1,3]",
                                       "keyframes[2].position=[12,-1,3]"};
  EXPECT_GT(side(edit({}).plan->trajectory), 3);
  const Trajectory right = planned(other).plan.trajectory;
  EXPECT_LT(side(right), -3);
  editor_->begin_at(right);
  EXPECT_LT(side(edit({"keyframes[1].position=[-12,0.2,3]"}).plan->trajectory), -3);
  // Once, and then from the last point again.
  EXPECT_LT(side(edit({"keyframes[1].position=[-12,0.3,3]"}).plan->trajectory), -3);
  // Another motion is no start.
  Trajectory foreign = right;
  foreign.motion.name = "other";
  editor_->begin_at(foreign);
  EXPECT_LT(side(edit({"keyframes[1].position=[-12,0.4,3]"}).plan->trajectory), -3);
}

TEST_F(Editing, TheScriptAndItsModulesAreTold) {
  write_file_atomically(folder_ / "part.lua", "return 3");
  write_file_atomically(folder_ / "shot.lua", "require 'part'\nreturn nil +");
  MissionSettings hearing = settings();
  std::vector<std::string> heard;
  hearing.observe_script = [&](const std::filesystem::path& file) {
    heard.push_back(file.filename().string());
  };
  EXPECT_THROW(Mission(folder_ / "shot.lua", hearing), InputError);
  write_file_atomically(folder_ / "shot.lua", "require 'part'\nreturn nil");
  EXPECT_THROW(Mission(folder_ / "shot.lua", hearing), InputError);
  EXPECT_EQ(heard, (std::vector<std::string>{"shot.lua", "shot.lua", "part.lua"}));
}

TEST_F(Editing, BeginsFromAPlan) {
  open(kShot);
  const MissionResult cold = planned({});
  open(kShot, std::make_shared<const Plan>(cold.plan));
  const EditedPlan& first = edit({});
  EXPECT_EQ(first.answer.grade, AnswerGrade::certified) << first.answer.message;
  EXPECT_LT(first.answer.result.report.iterations, cold.report.iterations);
}

}  // namespace
}  // namespace lapwing
