// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/trajectory/motion_recorder.h"
#include "framework/trajectory/plan.h"

namespace lapwing {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// A glider whose columns are a state and an input.
MotionRecord glide() {
  MotionRecorder motion;
  for (int i = 0; i < 3; ++i)
    motion.rate("acceleration", i, motion.input("pull") - motion.input("velocity", i));
  motion.rate("yaw_rate", 0, sin(motion.input("yaw")) / 2.0);
  motion.rate("bank", 0, motion.input("pull"));
  return {.name = "glide",
          .columns = {{"bank", "rad", 1, false}, {"pull", "1", 1, true}},
          .tracked = Tracking::none,
          .table = motion.table()};
}

std::string problem_with(const std::function<void(MotionRecord&)>& change) {
  MotionRecord motion = glide();
  change(motion);
  const std::vector<std::string> problems = problems_of(motion);
  return problems.empty() ? "" : problems.front();
}

TEST(MotionRecord, KnowsWhatHoldsTogether) {
  EXPECT_THAT(problems_of(glide()), IsEmpty());
  for (const char* name : {"force", "rotors", "path"}) {
    ASSERT_NE(named_motion(name), nullptr) << name;
    EXPECT_THAT(problems_of(*named_motion(name)), IsEmpty()) << name;
  }
  EXPECT_EQ(named_motion("glide"), nullptr);
}

TEST(MotionRecord, NamesWhatDoesNot) {
  EXPECT_THAT(problem_with([](auto& m) { m.name = "No Name"; }), HasSubstr("not in snake_case"));
  EXPECT_THAT(problem_with([](auto& m) { m.columns[0].name = "velocity"; }),
              HasSubstr("column 'velocity' has a name that every sample has"));
  EXPECT_THAT(problem_with([](auto& m) { m.columns[1].name = "bank"; }),
              HasSubstr("column 'bank' stands there twice"));
  EXPECT_THAT(problem_with([](auto& m) { m.columns[0].size = 99; }),
              HasSubstr("has 99 numbers, expected 1 to 16"));
  EXPECT_THAT(problem_with([](auto& m) { m.table->rates.pop_back(); }),
              HasSubstr("its derivatives lack 'bank', component 0"));
  EXPECT_THAT(problem_with([](auto& m) {
                m.table->rates.push_back({"pull", 0, 0});
              }),
              HasSubstr("is not of a quantity that changes"));
  EXPECT_THAT(problem_with([](auto& m) { m.table->rates[0].operation = 999; }),
              HasSubstr("is of operation 999, which does not exist"));
  EXPECT_THAT(problem_with([](auto& m) { m.table->operations[0].name = "wind"; }),
              HasSubstr("reads 'wind', which the motion does not have"));
  EXPECT_THAT(problem_with([](auto& m) { m.table->operations[2].operands[0] = 7; }),
              HasSubstr("reads operation 7, which is not before it"));
  EXPECT_THAT(problem_with([](auto& m) { m.table->operations[2].op = ConstraintOp::subject; }),
              HasSubstr("reads the environment"));
}

TEST(MotionRecord, NamesEachNumberOfAColumn) {
  EXPECT_THAT(component_names({"bank", "rad", 1, false}), ElementsAre("bank"));
  EXPECT_THAT(component_names({"jerk", "m/s^3", 3, true}),
              ElementsAre("jerk_x", "jerk_y", "jerk_z"));
  EXPECT_THAT(component_names({"orientation", "1", 4, false}),
              ElementsAre("orientation_w", "orientation_x", "orientation_y", "orientation_z"));
  EXPECT_THAT(component_names({"rotor_thrusts", "N", 2, true}),
              ElementsAre("rotor_thrust_1", "rotor_thrust_2"));
}

TEST(MotionRecord, PlanCarriesColumnsAndDerivatives) {
  Plan plan;
  plan.mission = "glide";
  plan.kind = "film";
  plan.vehicle = Value::map();
  plan.trajectory.motion = glide();
  Sample sample;
  sample.columns.set("bank", 0.25);
  sample.columns.set("pull", -1.5);
  plan.trajectory.samples = {sample};
  const Value document = to_value(plan);
  EXPECT_EQ(document.at("samples").as_list()[0].at("bank").as_number(), 0.25);
  const Plan back = plan_from_value(document);
  EXPECT_EQ(back.trajectory.motion.name, "glide");
  EXPECT_EQ(back.trajectory.motion.columns, plan.trajectory.motion.columns);
  ASSERT_TRUE(back.trajectory.motion.table);
  EXPECT_EQ(back.trajectory.samples[0].columns, sample.columns);
  EXPECT_EQ(plan_text(back), plan_text(plan));

  Value nameless = document;
  std::erase_if(nameless.find("motion")->as_map(),
                [](const auto& entry) { return entry.first == "columns"; });
  try {
    plan_from_value(nameless);
    ADD_FAILURE() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("'glide' is not force, rotors or path"));
  }
}

TEST(SampleColumns, KeepTheirSize) {
  SampleColumns columns;
  EXPECT_EQ(columns.scalar("bank"), 0);
  EXPECT_FALSE(columns.has("bank"));
  columns.set("bank", 0.5);
  columns.set("jerk", Eigen::Vector3d(1, 2, 3));
  columns.set("bank", 0.75);
  EXPECT_EQ(columns.scalar("bank"), 0.75);
  EXPECT_EQ(columns.vector3("jerk"), Eigen::Vector3d(1, 2, 3));
  EXPECT_THROW(columns.set("bank", Eigen::Vector3d(1, 2, 3)), Error);
  EXPECT_THROW(columns.vector3("bank"), Error);
  EXPECT_EQ(columns.quaternion("orientation").w(), 1);
}

}  // namespace
}  // namespace lapwing
