// SPDX-License-Identifier: Apache-2.0
// Plans that nobody should fly: the verifier refuses them in words and never crashes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "framework/core/json.h"
#include "framework/verify/verify.h"
#include "tests/verify/reference_plan.h"

namespace lapwing {
namespace {

using testing::HasSubstr;

// The reason of the check `document`, after seeing that nothing else was judged.
std::string refusal(const Plan& plan) {
  const Certificate c = verify(plan);
  EXPECT_FALSE(c.feasible());
  EXPECT_EQ(c.failures().size(), 1u);
  EXPECT_NO_THROW(to_json(c.to_value()));
  return c.failures().empty() ? "" : to_line(c.failures()[0]);
}

template <class Change>
std::string refusal_after(Change change) {
  Plan plan = reference_plan();
  change(plan);
  return refusal(plan);
}

TEST(HostilePlans, NumbersThatAreNotFinite) {
  for (const double bad : {std::nan(""), double(INFINITY), 1e300}) {
    EXPECT_THAT(refusal_after([&](Plan& p) { p.trajectory.samples[4].velocity.z() = bad; }),
                HasSubstr("document: sample 5 holds a number that is not finite"));
    EXPECT_THAT(refusal_after([&](Plan& p) { p.trajectory.samples[4].time = bad; }),
                HasSubstr("sample 5"));
    EXPECT_THAT(refusal_after([&](Plan& p) { p.task.keyframes[1].position.x() = bad; }),
                HasSubstr("keyframe 2"));
    EXPECT_THAT(refusal_after([&](Plan& p) { p.task.keyframes[1].tolerance = bad; }),
                HasSubstr("keyframe 2 needs tolerances"));
    EXPECT_THAT(refusal_after([&](Plan& p) { p.environment.margin = bad; }), HasSubstr("margin"));
    EXPECT_THAT(
        refusal_after([&](Plan& p) { p.environment.obstacles[0].parameters.set("radius", bad); }),
        HasSubstr("sphere 'tree'"));
    EXPECT_THAT(refusal_after([&](Plan& p) { p.budget = bad; }), HasSubstr("budget"));
  }
}

TEST(HostilePlans, TimesOutOfOrder) {
  EXPECT_THAT(refusal_after([](Plan& p) {
                std::swap(p.trajectory.samples[4].time, p.trajectory.samples[5].time);
              }),
              HasSubstr("sample 6 is not later"));
  EXPECT_THAT(refusal_after([](Plan& p) {
                for (Sample& s : p.trajectory.samples) s.time += 5;
              }),
              HasSubstr("first sample is not at time 0"));
}

TEST(HostilePlans, NoSampleAndOneSample) {
  EXPECT_THAT(refusal_after([](Plan& p) { p.trajectory.samples.clear(); }), HasSubstr("no sample"));
  Plan plan = reference_plan();
  plan.trajectory.samples.resize(1);
  plan.cuts.clear();
  plan.task.framing.clear();
  const Certificate c = verify(plan);
  EXPECT_FALSE(c.find("keyframe_time")->pass);  // the others lie after its end
  EXPECT_FALSE(c.find("keyframe_miss")->pass);
  plan.task.keyframes.resize(1);
  EXPECT_TRUE(verify(plan).feasible());
  plan.task.framing = {{"walker", {0, 0}}};
  EXPECT_THAT(refusal(plan), HasSubstr("framing 1 must start before"));
}

TEST(HostilePlans, NegativeMarginAndEmptyObstacles) {
  EXPECT_THAT(refusal_after([](Plan& p) { p.environment.margin = -1; }), HasSubstr("margin"));
  EXPECT_THAT(
      refusal_after([](Plan& p) { p.environment.obstacles[0].parameters.set("radius", -1.0); }),
      HasSubstr("sphere"));
  EXPECT_THAT(refusal_after([](Plan& p) {
                p.environment.obstacles[1] = box_at("house", {20, -4, 30}, {-20, -30, 0});
              }),
              HasSubstr("box 'house'"));
}

TEST(HostilePlans, ZonesThatAreNoPolygons) {
  const auto refusal_of = [](std::vector<Eigen::Vector2d> corners) {
    return refusal_after([&](Plan& p) {
      p.environment.obstacles[2].parameters.set("corners", corners_value(corners));
    });
  };
  EXPECT_THAT(refusal_of({}), HasSubstr("zone 'yard' must have at least three corners"));
  EXPECT_THAT(refusal_of({{50, 0}, {51, 0}}), HasSubstr("at least three corners"));
  EXPECT_THAT(refusal_of(std::vector<Eigen::Vector2d>(1001, {50, 0})), HasSubstr("at most 1000"));
  EXPECT_THAT(refusal_of({{50, 0}, {51, std::nan("")}, {51, 1}}), HasSubstr("not finite"));
  EXPECT_THAT(refusal_of({{50, 0}, {51, 1e8}, {51, 1}}), HasSubstr("beyond 1e7"));
  for (const auto& crossed : std::vector<std::vector<Eigen::Vector2d>>{
           {{50, 0}, {52, 2}, {52, 0}, {50, 2}},                   // a bow tie
           {{50, 0}, {51, 0}, {52, 0}},                            // on one line
           {{50, 0}, {50, 0}, {51, 0}, {51, 1}},                   // a corner twice
           {{50, 0}, {54, 0}, {54, 4}, {52, 0}, {50, 4}},          // a corner on another edge
           {{50, 0}, {54, 0}, {54, 4}, {53, 4}, {54, 4}, {50, 4}}  // an edge that turns back
       }) {
    EXPECT_THAT(refusal_of(crossed), HasSubstr("edges that cross or touch"));
  }
  for (const auto& [floor, ceiling] : std::vector<std::pair<double, double>>{
           {3, 3}, {3, 2}, {INFINITY, INFINITY}, {-INFINITY, -INFINITY}, {std::nan(""), 3}}) {
    EXPECT_THAT(refusal_after([floor = floor, ceiling = ceiling](Plan& p) {
                  p.environment.obstacles[3].parameters.set("floor", floor);
                  p.environment.obstacles[3].parameters.set("ceiling", ceiling);
                }),
                HasSubstr("zone 'roofs' must have its floor below its ceiling"));
  }
}

TEST(HostilePlans, SubjectsWithoutASoundTrack) {
  const auto refusal_of = [](auto change) {
    return refusal_after([&](Plan& p) { change(p.environment.subjects[0]); });
  };
  EXPECT_THAT(refusal_of([](Subject& s) { s.times.clear(); }), HasSubstr("at least one time"));
  EXPECT_THAT(refusal_of([](Subject& s) { s.times.pop_back(); }), HasSubstr("positions"));
  EXPECT_THAT(refusal_of([](Subject& s) { s.times[2] = s.times[1]; }),
              HasSubstr("subject 'walker' has times that do not increase"));
  EXPECT_THAT(refusal_of([](Subject& s) { s.times[2] = std::nan(""); }), HasSubstr("not finite"));
  EXPECT_THAT(refusal_of([](Subject& s) { s.positions[0].y() = INFINITY; }),
              HasSubstr("not finite"));
  EXPECT_THAT(refusal_of([](Subject& s) { s.height = -1; }), HasSubstr("height and a width"));
  EXPECT_THAT(refusal_of([](Subject& s) { s.width = std::nan(""); }),
              HasSubstr("height and a width"));
  EXPECT_THAT(refusal_of([](Subject& s) { s.name = "castle"; }),
              HasSubstr("two subjects are named 'castle'"));
  EXPECT_THAT(refusal_of([](Subject& s) { s.name.clear(); }), HasSubstr("a subject has no name"));
}

TEST(HostilePlans, CutsAndFramingOutOfPlace) {
  const auto with_cuts = [](std::vector<TimeSpan> cuts) {
    return refusal_after([&](Plan& p) { p.cuts = cuts; });
  };
  EXPECT_THAT(with_cuts({{2, 1}}), HasSubstr("cut 1 must start before it finishes"));
  EXPECT_THAT(with_cuts({{-1, 1}}), HasSubstr("lie within the flight"));
  EXPECT_THAT(with_cuts({{7, 8.1}}), HasSubstr("lie within the flight"));
  EXPECT_THAT(with_cuts({{1, std::nan("")}}), HasSubstr("cut 1"));
  EXPECT_THAT(with_cuts({{3, 4}, {1, 2}}), HasSubstr("cut 2 must start after the one before"));
  EXPECT_THAT(with_cuts({{1, 2}, {2, 3}}), HasSubstr("cut 2 must start after the one before"));
  const auto with_framing = [](const FramingTask& framing) {
    return refusal_after([&](Plan& p) { p.task.framing = {framing}; });
  };
  EXPECT_THAT(with_framing({"runner", {0, 1}}), HasSubstr("names the subject 'runner'"));
  EXPECT_THAT(with_framing({"walker", {0, 9}}), HasSubstr("framing 1 must start before"));
  EXPECT_THAT(with_framing({"walker", {0, std::nan("")}}), HasSubstr("framing 1 must start"));
  for (const double share : {0.0, -1.0, 1.001, std::nan("")}) {
    EXPECT_THAT(refusal_after([&](Plan& p) { p.task.framing_share = share; }),
                HasSubstr("share of framing"));
  }
}

TEST(HostilePlans, VehicleTamperedWith) {
  EXPECT_THAT(refusal_after([](Plan& p) { p.vehicle = {}; }), HasSubstr("expected a map"));
  EXPECT_THAT(refusal_after([](Plan& p) { p.vehicle.set("mass", -1.5); }), HasSubstr("mass"));
  EXPECT_THAT(refusal_after([](Plan& p) { p.vehicle.set("mass", 1e-300); }), HasSubstr("hover"));
  EXPECT_THAT(refusal_after([](Plan& p) { p.vehicle.set("mass", 5.0); }), HasSubstr("hover"));
  EXPECT_THAT(refusal_after([](Plan& p) { p.vehicle.find("gimbal")->set("pitch_min", 1.0); }),
              HasSubstr("pitch_deg"));
  EXPECT_THAT(refusal_after([](Plan& p) { p.vehicle.find("limits")->set("climb_speed", -2.0); }),
              HasSubstr("climb_speed"));
  EXPECT_THAT(refusal_after([](Plan& p) { p.vehicle.find("limits")->set("speed", 99.0); }),
              HasSubstr("unknown"));
  EXPECT_THAT(refusal_after([](Plan& p) {
                std::erase_if(p.vehicle.as_map(),
                              [](const auto& e) { return e.first == "gimbal"; });
              }),
              HasSubstr("a gimbal that the vehicle does not have"));
}

void give_rotors(Plan& plan) {
  plan.trajectory.motion = rotors_motion();
  for (Sample& s : plan.trajectory.samples) {
    s.columns = {};
    s.columns.set("orientation", Eigen::Quaterniond::Identity());
    s.columns.set("body_rates", Eigen::Vector3d(0, 0, 0));
    s.columns.set("rotor_thrusts", Eigen::Vector4d(1, 1, 1, 1));
  }
}

TEST(HostilePlans, RotorsWithoutAnAttitude) {
  EXPECT_THAT(refusal_after([](Plan& p) {
                give_rotors(p);
                p.trajectory.samples[2].columns.set("orientation", Eigen::Vector4d(0, 0, 0, 0));
              }),
              HasSubstr("sample 3 has an orientation that is not a unit quaternion"));
  EXPECT_THAT(refusal_after([](Plan& p) {
                give_rotors(p);
                p.trajectory.samples[1].columns.set("rotor_thrusts",
                                                    Eigen::Vector4d(0, 0, 0, std::nan("")));
              }),
              HasSubstr("sample 2 holds a number that is not finite"));
  EXPECT_THAT(refusal_after([](Plan& p) { p.trajectory.motion = rotors_motion(); }),
              HasSubstr("sample 1 lacks the column 'orientation' of its motion"));
}

TEST(HostilePlans, MotionsThatNobodyCanIntegrate) {
  const auto refusal = [](const MotionRecord& motion) {
    return refusal_after([&](Plan& p) { p.trajectory.motion = motion; });
  };
  EXPECT_THAT(refusal({.name = "submarine"}),
              HasSubstr("the motion 'submarine' has no integrator in this version, which has "
                        "force, rotors, path, velocity, coordinated_turn"));
  EXPECT_THAT(
      refusal({.name = "velocity"}),
      HasSubstr("the motion 'velocity' has the columns jerk (3, input, m/s^3), and the plan "
                "states none"));
  EXPECT_THAT(refusal({.name = "coordinated_turn"}), HasSubstr("needs a wing, and vehicle"));
  MotionRecord own = force_motion();
  own.table = MotionTable{};
  EXPECT_THAT(refusal(own), HasSubstr("a motion with derivatives of its own needs another name"));
  own.name = "sled";
  EXPECT_THAT(refusal(own), HasSubstr("its derivatives lack 'acceleration', component 0"));
}

TEST(HostilePlans, IntervalsTooCoarseToFollow) {
  const Drive wild{{1e6, 0, 0}}, back{{-1e6, 0, 0}};
  EXPECT_THAT(refusal(PlanBuilder(false).add(1e4, wild, back).finish(back)),
              HasSubstr("sample 2 holds a number"));
  Plan plan = PlanBuilder(false).add(3000, {{3, 0, 0}}, {{-3, 0, 0}}).finish();
  EXPECT_NO_THROW(verify(plan));
  plan = reference_plan();
  for (std::size_t i = 0; i < plan.trajectory.samples.size(); ++i) {
    plan.trajectory.samples[i].time = 1e4 * static_cast<double>(i);
  }
  EXPECT_THAT(refusal(plan), HasSubstr("too coarse"));
}

TEST(HostilePlans, ManyProblemsAreCounted) {
  const std::string text = refusal_after([](Plan& p) {
    for (Sample& s : p.trajectory.samples) s.yaw = std::nan("");
  });
  EXPECT_THAT(text, HasSubstr("and 76 more"));
}

}  // namespace
}  // namespace lapwing
