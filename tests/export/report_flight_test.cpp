// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/export/flight_report.h"
#include "tests/export/synthetic_flight.h"

namespace lapwing {
namespace {

const Section& named(const std::vector<Section>& sections, const std::string& title) {
  for (const Section& s : sections) {
    if (s.title == title) return s;
  }
  throw Error("no section " + title);
}

const Chart& flight_chart(const Section& section, const std::string& title) {
  for (const Block& b : section.blocks) {
    const auto* c = std::get_if<Chart>(&b);
    if (c != nullptr && c->title == title) return *c;
  }
  throw Error("no chart " + title);
}

double limit(const Chart& c, const std::string& label) {
  for (const LimitLine& l : c.limits) {
    if (l.label == label) return l.value;
  }
  throw Error("no limit " + label);
}

const Table& table(const Section& section, std::size_t index = 0) {
  for (const Block& b : section.blocks) {
    const auto* t = std::get_if<Table>(&b);
    if (t != nullptr && index-- == 0) return *t;
  }
  throw Error("no table in " + section.title);
}

TEST(FlightReport, DrawsMotionAndInputsAgainstTheVehiclesLimits) {
  const Plan plan = synthetic_flight(20, 201, 4);
  const std::vector<Section> sections = flight_sections(plan);
  const Section& motion = named(sections, "Motion");
  EXPECT_EQ(limit(flight_chart(motion, "Speed across"), "maximum"), 10);
  EXPECT_EQ(limit(flight_chart(motion, "Climb and descent"), "climb at most"), 2.5);
  EXPECT_EQ(limit(flight_chart(motion, "Climb and descent"), "descent at most"), -2);
  EXPECT_EQ(limit(flight_chart(motion, "Acceleration across"), "maximum"), 4);
  EXPECT_TRUE(flight_chart(motion, "Acceleration up").limits.empty());
  const Section& inputs = named(sections, "Inputs");
  // (1 - 0.2/2) 4 * 8 N and (0.2/2) 4 * 8 N + 4 * 0.2 N.
  EXPECT_NEAR(limit(flight_chart(inputs, "Thrust"), "maximum"), 28.8, 1e-12);
  EXPECT_NEAR(limit(flight_chart(inputs, "Thrust"), "minimum"), 4.0, 1e-12);
  EXPECT_TRUE(flight_chart(inputs, "Thrust").series[0].stepped);
  EXPECT_NEAR(limit(flight_chart(named(sections, "Direction"), "Yaw rate"), "maximum"), 90, 1e-9);
  const Sample& s = plan.trajectory.samples[50];
  EXPECT_EQ(flight_chart(motion, "Speed across").series[0].y[50], s.velocity.head<2>().norm());
  EXPECT_EQ(flight_chart(inputs, "Thrust").series[0].y[50], s.columns.vector3("force").norm());
  EXPECT_EQ(flight_chart(motion, "Position").series[2].y[50], s.position.z());
  EXPECT_EQ(flight_chart(motion, "Position").markers.size(), 6u);
}

TEST(FlightReport, MeasuresTheMissOfEachKeyframe) {
  Plan plan = synthetic_flight(20, 201, 4);
  plan.task.keyframes[1].position.z() += 1.0;  // 1.2 m beside the path
  plan.task.keyframes[2].yaw = *plan.task.keyframes[2].yaw + 0.5;
  plan.task.keyframes[3].time = 99;
  const Table t = table(named(flight_sections(plan), "Keyframes"));
  ASSERT_EQ(t.rows.size(), 6u);
  EXPECT_NEAR(std::get<double>(t.rows[0].cells[2]), 0.2, 1e-6);
  EXPECT_EQ(t.rows[0].mark, Mark::pass);
  EXPECT_NEAR(std::get<double>(t.rows[1].cells[2]), 1.2, 1e-3);
  EXPECT_EQ(t.rows[1].mark, Mark::fail);
  EXPECT_NEAR(std::get<double>(t.rows[2].cells[5]), degrees(0.5), 0.1);
  EXPECT_EQ(t.rows[2].mark, Mark::fail);
  EXPECT_TRUE(std::isnan(std::get<double>(t.rows[3].cells[2])));
  EXPECT_EQ(t.rows[3].mark, Mark::fail);
}

TEST(FlightReport, ShowsTheCertificateAsItIs) {
  const Plan plan = synthetic_flight(20, 201, 4, false);
  const Report report = flight_report(plan);
  EXPECT_EQ(report.status, "not certified");
  EXPECT_EQ(report.status_mark, Mark::fail);
  const Table why = table(named(report.sections, "Summary"));
  ASSERT_EQ(why.rows.size(), 1u) << "the failing check that is required, no other";
  EXPECT_EQ(std::get<std::string>(why.rows[0].cells[0]), "speed_across");
  const Table safety = table(named(report.sections, "Certificate"));
  ASSERT_EQ(safety.rows.size(), 7u);
  EXPECT_NEAR(std::get<double>(safety.rows[4].cells[1]), degrees(0.5), 1e-9);
  EXPECT_EQ(std::get<std::string>(safety.rows[4].cells[3]), "\u00b0/s");
  EXPECT_EQ(safety.rows[5].mark, Mark::fail);
  EXPECT_EQ(std::get<std::string>(safety.rows[5].cells[5]), "reported, not required");
  EXPECT_EQ(safety.rows[6].mark, Mark::skipped);
  EXPECT_EQ(std::get<std::string>(safety.rows[6].cells[5]), "the environment is empty");
  EXPECT_EQ(flight_report(synthetic_flight(20, 201, 4)).status, "certified");
}

TEST(FlightReport, FollowsTheCostOfEachTerm) {
  const Section solver = named(flight_sections(synthetic_flight(20, 201, 4)), "Solver");
  const Chart& costs = flight_chart(solver, "Weighted cost per term");
  ASSERT_EQ(costs.series.size(), 4u);
  EXPECT_EQ(costs.series[1].name, "keyframe");
  EXPECT_EQ(costs.series[1].x.size(), 9u);
  EXPECT_NEAR(costs.series[1].y[0], 901.2, 1e-9);
  EXPECT_TRUE(costs.y.logarithmic);
  for (int i = 0; i < 9; ++i) {
    EXPECT_NEAR(costs.series[0].y[i],
                costs.series[1].y[i] + costs.series[2].y[i] + costs.series[3].y[i], 1e-9);
  }
}

TEST(FlightReport, ATermThatComesLateBeginsLate) {
  Plan plan = synthetic_flight(20, 201, 4);
  auto& history = plan.solver.find("history")->as_list();
  history[5].find("terms")->set("late", 3.0);
  const Section solver = named(flight_sections(plan), "Solver");
  const Series& late = flight_chart(solver, "Weighted cost per term").series.back();
  EXPECT_EQ(late.name, "late");
  EXPECT_EQ(late.x, std::vector<double>{5});
}

TEST(FlightReport, LeavesOutWhatThePlanDoesNotHold) {
  Plan plan = synthetic_flight(20, 201, 4);
  plan.solver = plan.certificate = plan.configuration = Value();
  plan.task.keyframes.clear();
  plan.trajectory.motion = path_motion();
  plan.trajectory.has_gimbal = false;
  const Report report = flight_report(plan);
  std::string titles;
  for (const Section& s : report.sections) titles += s.title + " ";
  EXPECT_EQ(titles, "Summary Path Motion Direction ");
  EXPECT_EQ(report.status, "not judged");
  EXPECT_NO_THROW(render_html(report));
}

TEST(FlightReport, DrawsRotorsAgainstTheirLimits) {
  Plan plan = synthetic_flight(20, 201, 4);
  plan.trajectory.motion = rotors_motion();
  plan.trajectory.inputs_held = false;
  const Section inputs = named(flight_sections(plan), "Inputs");
  const Chart& rotors = flight_chart(inputs, "Rotor thrusts");
  EXPECT_EQ(rotors.series.size(), 4u);
  EXPECT_FALSE(rotors.series[0].stepped);
  EXPECT_EQ(limit(rotors, "maximum"), 8);
  EXPECT_EQ(limit(rotors, "minimum"), 0.2);
}

TEST(FlightReport, ASingleSampleIsDrawn) {
  Plan plan = synthetic_flight(20, 201, 4);
  plan.trajectory.samples.resize(1);
  EXPECT_NO_THROW(render_html(flight_report(plan)));
  plan.trajectory.samples.clear();
  EXPECT_THROW(flight_report(plan), Error);
}

TEST(FlightReport, RefusesAMalformedSolverReport) {
  Plan plan = synthetic_flight(20, 201, 4);
  plan.solver = Value::map();
  EXPECT_THROW(flight_report(plan), InputError);
  plan.solver = synthetic_solver();
  plan.solver.set("terms", Value::list());
  EXPECT_THROW(flight_report(plan), InputError);
}

TEST(FlightReport, IsTheSameEachTime) {
  const Plan plan = synthetic_flight(20, 201, 4);
  EXPECT_EQ(render_html(flight_report(plan)), render_html(flight_report(plan)));
}

TEST(FlightReport, LightPaintingsAreSeenFromTheirSpectators) {
  Plan plan = synthetic_flight(20, 201, 4);
  const auto side = [&plan](const Eigen::Vector3d& view) {
    plan.task.drawing_view = view;
    return std::get<PathView>(named(flight_sections(plan), "Path").blocks.at(1)).title;
  };
  EXPECT_EQ(side({1, 0, 0}), "Path from the south") << "no strokes: where it looks widest";
  plan.task.strokes.emplace_back();
  EXPECT_EQ(side({0, 1, 0}), "Path from the south");
  EXPECT_EQ(side({0, -1, 0}), "Path from the north");
  EXPECT_EQ(side({1, 0.5, 0}), "Path from the west") << "they look east";
  EXPECT_EQ(side({-1, 0.5, 0}), "Path from the east");
}

}  // namespace
}  // namespace lapwing
