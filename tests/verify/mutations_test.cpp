// SPDX-License-Identifier: Apache-2.0
// Each check is flipped, and it alone, by one small change of a good plan.
#include <gtest/gtest.h>

#include <set>

#include "framework/verify/checks.h"
#include "framework/verify/verify.h"
#include "tests/verify/reference_plan.h"

namespace lapwing {
namespace {

std::set<std::string> failures_of(const Plan& plan) {
  std::set<std::string> names;
  for (const Check& check : verify(plan).failures()) names.insert(check.name);
  return names;
}

struct Mutation {
  Mutation(std::string flipped, std::function<void(Plan&)> how, ReferenceOptions of = {})
      : check(std::move(flipped)), change(std::move(how)), options(of) {}
  std::string check;  // the one that it flips
  std::function<void(Plan&)> change;
  ReferenceOptions options;
};

std::function<void(Plan&)> vehicle(std::function<void(Vehicle&)> change) {
  return [change](Plan& plan) {
    Vehicle v = vehicle_from_value(plan.vehicle);
    change(v);
    plan.vehicle = to_value(v);
  };
}

Sample& sample(Plan& plan, std::size_t i) {
  return plan.trajectory.samples.at(i);
}
Sample& last(Plan& plan) {
  return plan.trajectory.samples.back();
}

// Moves the walker far away from `from` to `to`.
void hide(Plan& plan, double from, double to) {
  Subject& walker = plan.environment.subjects[0];
  for (std::size_t i = 0; i < walker.times.size(); ++i) {
    if (walker.times[i] < from || walker.times[i] > to) continue;
    walker.positions[i] += Eigen::Vector3d(0, 0, 300);
  }
}

// 0.5 mm a sample over a second of samples 20 ms apart: each is within its own tolerance.
void creep(Plan& plan) {
  double offset = 0;
  for (std::size_t i = 0; i < plan.trajectory.samples.size(); ++i) {
    if (i >= 100 && i < 150) offset += 0.0005;
    sample(plan, i).position.y() += offset;
  }
}

const std::vector<Mutation>& mutations() {
  static const std::vector<Mutation> list{
      {"document", [](Plan& p) { sample(p, 3).time = sample(p, 2).time; }},
      {"defect_position", [](Plan& p) { sample(p, 40).position.y() += 0.002; }},
      {"defect_velocity", [](Plan& p) { last(p).velocity.y() += 0.02; }},
      {"defect_yaw", [](Plan& p) { sample(p, 40).yaw += 0.005; }},
      {"defect_yaw_rate", [](Plan& p) { last(p).yaw_rate += 0.05; }},
      {"defect_gimbal", [](Plan& p) { sample(p, 40).gimbal_pitch += 0.005; }},
      {"drift", creep, {.step = 0.02}},
      {"stated_acceleration", [](Plan& p) { sample(p, 9).acceleration.x() += 0.05; }},
      {"thrust_max", vehicle([](Vehicle& v) { v.rotors.thrust_max = 4.22; })},
      {"thrust_min", vehicle([](Vehicle& v) { v.rotors.thrust_min = 2.825; })},
      {"closed_loop", vehicle([](Vehicle& v) { v.rotors.lag = 0.3; })},
      {"yaw_torque", vehicle([](Vehicle& v) { v.rotors.torque_coefficient = 0.0005; })},
      {"speed_across", vehicle([](Vehicle& v) { v.speed_across_max = 3; })},
      {"climb_speed", vehicle([](Vehicle& v) { v.climb_speed_max = 0.5; })},
      {"descent_speed", vehicle([](Vehicle& v) { v.descent_speed_max = 0.5; }), {.lift = -0.4}},
      {"acceleration_across", vehicle([](Vehicle& v) { v.acceleration_across_max = 1; })},
      {"acceleration_up", vehicle([](Vehicle& v) { v.acceleration_up_max = 0.2; })},
      {"acceleration_down", vehicle([](Vehicle& v) { v.acceleration_down_max = 0.2; })},
      {"yaw_rate", vehicle([](Vehicle& v) { v.yaw_rate_max = 0.1; })},
      {"gimbal_yaw", vehicle([](Vehicle& v) { v.gimbal->yaw_max = 0.1; })},
      {"gimbal_pitch", vehicle([](Vehicle& v) { v.gimbal->pitch_max = -0.4; })},
      {"gimbal_pitch", vehicle([](Vehicle& v) { v.gimbal->pitch_min = -0.5; })},
      {"gimbal_yaw_rate", vehicle([](Vehicle& v) { v.gimbal->yaw_rate_max = 0.036; })},
      {"gimbal_pitch_rate", vehicle([](Vehicle& v) { v.gimbal->pitch_rate_max = 0.04; })},
      {"clearance", [](Plan& p) { p.environment.obstacles[0].parameters.set("radius", 2.51); }},
      {"clearance",
       [](Plan& p) {
         p.environment.obstacles[1] = box_at("house", {-20, -30, 0}, {20, -0.49, 30});
       }},
      {"clearance", [](Plan& p) { p.environment.margin = 2.01; }},
      {"clearance",
       [](Plan& p) {
         // Beside the start, behind the camera.
         p.environment.obstacles[2] =
             zone_at("yard", {{-30, 0.49}, {-7.9, 0.49}, {-7.9, 9}, {-30, 9}});
       }},
      {"clearance",
       [](Plan& p) {
         p.environment.obstacles[3] =
             zone_at("roofs", {{-30, -3}, {-7.9, -3}, {-7.9, 3}, {-30, 3}}, -5, 9.51);
       }},
      {"defect_gimbal", [](Plan& p) { sample(p, 40).gimbal_yaw += 0.005; }},
      {"defect_gimbal", [](Plan& p) { sample(p, 40).gimbal_yaw_rate += 0.05; }},
      {"framing", [](Plan& p) { hide(p, 5, 5.6); }},
      {"framing",
       [](Plan& p) {
         p.task.framing[1].subject = "castle";
         p.environment.obstacles.erase(p.environment.obstacles.begin() +
                                       2);  // which is before the castle
       }},
      {"line_of_sight",
       [](Plan& p) {
         const Sample& s = p.trajectory.samples[60];
         const Eigen::Vector3d& walker = p.environment.subjects[0].positions[12];
         p.environment.obstacles.push_back(sphere_at("kite", 0.2 * s.position + 0.8 * walker, 0.8));
       }},
      {"framing", vehicle([](Vehicle& v) {
         v.camera.width = 2;
         v.camera.height = 2;
         v.camera.principal_x = v.camera.principal_y = 0.5;
       })},
      {"document", [](Plan& p) { p.cuts[0].start = p.cuts[0].finish; }},
      {"document", [](Plan& p) { p.environment.obstacles[3].parameters.set("ceiling", -6.0); }},
      {"document", [](Plan& p) { p.environment.subjects[0].positions.pop_back(); }},
      {"document", [](Plan& p) { p.task.framing[0].subject = "runner"; }},
      {"flight_time", vehicle([](Vehicle& v) { v.flight_time = 7.9; })},
      {"budget", [](Plan& p) { p.budget = 7.9; }},
      {"keyframe_time", [](Plan& p) { p.task.keyframes[2].time = 8.2; }},
      {"keyframe_miss", [](Plan& p) { p.task.keyframes[1].position.y() += 0.51; }},
      {"keyframe_miss", [](Plan& p) { p.task.keyframes[1].time += 0.5; }},
      {"keyframe_yaw", [](Plan& p) { *p.task.keyframes[2].yaw += 0.2; }},
  };
  return list;
}

TEST(Mutations, TheReferencePassesHeldAndLinearAndAtAnyStep) {
  for (const bool held : {true, false}) {
    for (const double step : {0.02, 0.1, 0.5}) {
      for (const double lift : {0.4, -0.4}) {
        const Plan plan = reference_plan({.held = held, .step = step, .lift = lift});
        const Certificate certificate = verify(plan);
        EXPECT_TRUE(certificate.feasible());
        for (const Check& check : certificate.failures()) ADD_FAILURE() << to_line(check);
        EXPECT_LT(*certificate.find("defect_position")->worst, 1e-9);
      }
    }
  }
}

TEST(Mutations, EachFlipsItsCheckAndNoOther) {
  for (std::size_t i = 0; i < mutations().size(); ++i) {
    const Mutation& mutation = mutations()[i];
    SCOPED_TRACE("mutation " + std::to_string(i) + ", " + mutation.check);
    Plan plan = reference_plan(mutation.options);
    ASSERT_TRUE(verify(plan).feasible());
    mutation.change(plan);
    EXPECT_EQ(failures_of(plan), std::set<std::string>{mutation.check});
    EXPECT_FALSE(verify(plan).feasible());
  }
}

TEST(Mutations, ForceDownwardsAloneIsRefused) {
  // Thrust within its bounds, but for a tenth of a second the vehicle would have to fly upside
  // down.
  const Drive down{{0, 0, -13.5}}, up{{0, 0, 6.75}};
  const Plan plan = PlanBuilder(true).add(0.1, down).add(0.2, up).finish();
  EXPECT_EQ(failures_of(plan),
            (std::set<std::string>{"force_up", "closed_loop", "closed_loop_yaw"}));
}

TEST(Mutations, RotorsAreSaturatedWhereTheyCannotFollow) {
  Plan plan = reference_plan();
  EXPECT_EQ(*verify(plan).find("rotors_saturated")->worst, 0);
  vehicle([](Vehicle& v) { v.inertia.head<2>() *= 200; })(plan);
  EXPECT_FALSE(verify(plan).find("rotors_saturated")->pass);
}

TEST(Mutations, CoverEveryCheckThatIsMade) {
  // Upside down two fail above; the last two are reported alone: framing_test.cpp judges one of
  // them, RotorsAreSaturatedWhereTheyCannotFollow below the other.
  std::set<std::string> covered{"force_up",          "closed_loop_yaw", "acceleration_up",
                                "acceleration_down", "whole_subject",   "rotors_saturated"};
  for (const Mutation& mutation : mutations()) covered.insert(mutation.check);
  const Certificate certificate = verify(reference_plan());
  for (const Check& check : certificate.checks) {
    if (!check.skipped.empty()) continue;
    EXPECT_TRUE(covered.count(check.name)) << check.name;
  }
}

TEST(Mutations, EveryCertificateListsEveryCheckOnceInOrder) {
  Plan broken = reference_plan();
  broken.trajectory.samples.clear();
  Plan single = reference_plan();
  single.trajectory.samples.resize(1);
  single.cuts.clear();
  single.task.framing.clear();
  for (const Plan& plan : {reference_plan(), broken, single}) {
    const Certificate certificate = verify(plan);
    ASSERT_EQ(certificate.checks.size(), kCheckKinds.size());
    for (std::size_t i = 0; i < kCheckKinds.size(); ++i) {
      EXPECT_EQ(certificate.checks[i].name, kCheckKinds[i].name);
    }
  }
}

}  // namespace
}  // namespace lapwing
