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
    EXPECT_THAT(refusal_after([&](Plan& p) { p.environment.spheres[0].radius = bad; }),
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
  const Certificate c = verify(plan);
  EXPECT_FALSE(c.find("keyframe_time")->pass);  // the others lie after its end
  EXPECT_FALSE(c.find("keyframe_miss")->pass);
  plan.task.keyframes.resize(1);
  EXPECT_TRUE(verify(plan).feasible());
}

TEST(HostilePlans, NegativeMarginAndEmptyObstacles) {
  EXPECT_THAT(refusal_after([](Plan& p) { p.environment.margin = -1; }), HasSubstr("margin"));
  EXPECT_THAT(refusal_after([](Plan& p) { p.environment.spheres[0].radius = -1; }),
              HasSubstr("sphere"));
  EXPECT_THAT(refusal_after([](Plan& p) {
                std::swap(p.environment.boxes[0].lower, p.environment.boxes[0].upper);
              }),
              HasSubstr("box 'house'"));
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

TEST(HostilePlans, ModelsThatThisVersionCannotIntegrate) {
  for (const auto model : {MotionModel::rotors, MotionModel::path}) {
    EXPECT_THAT(refusal_after([&](Plan& p) { p.trajectory.model = model; }),
                HasSubstr("the motion model 'force' alone"));
  }
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
