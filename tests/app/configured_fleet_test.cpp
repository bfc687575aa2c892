// SPDX-License-Identifier: Apache-2.0
// Fleets that ask for less than the configuration of their plans.
#include "framework/app/configured_fleet.h"

#include <gmock/gmock.h>

namespace lapwing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class ConfiguredFleet : public testing::Test {
 protected:
  ConfiguredFleet() : plans_(2) {
    Value stated = Value::map();
    stated.set("separation", 8.0);
    stated.set("swap", 60.0);
    stated.set("reserve", 45.0);
    asked_ = Value::map();
    asked_.set("fleet", stated);
    asked_.set("gps_accuracy", 0.5);
    asked_.set("drones", 2);
    asked_.set("batteries", 3);
    fleet_.separation = 9;
    fleet_.swap = 60;
    fleet_.reserve = 45;
    fleet_.tours = {{"1", 1, 0, "plan_1.json", ""}, {"2", 1, 0, "plan_2.json", ""}};
  }

  ConfigurationComparison compared() {
    std::vector<const Plan*> pointers;
    for (Plan& plan : plans_) {
      if (!plan.configuration.is_map()) plan.configuration = asked_;
      pointers.push_back(&plan);
    }
    return compare_fleet(fleet_, pointers);
  }
  std::string fault() {
    const auto faults = compared().faults;
    return faults.size() == 1 ? faults[0] : std::to_string(faults.size()) + " faults";
  }

  Value asked_;
  std::vector<Plan> plans_;
  Fleet fleet_;
};

TEST_F(ConfiguredFleet, OneThatAsksForAsMuchOrMoreIsRight) {
  EXPECT_THAT(compared().faults, IsEmpty());
  EXPECT_THAT(compared().not_compared, IsEmpty());
  fleet_.separation = 20, fleet_.swap = 100, fleet_.reserve = 400;
  EXPECT_THAT(compared().faults, IsEmpty());
}

TEST_F(ConfiguredFleet, LessIsTold) {
  const Fleet good = fleet_;
  fleet_.separation = 8.9;
  EXPECT_EQ(fault(), "the separation is 8.9 m in the plan and 9 m in its configuration");
  fleet_ = good;
  fleet_.swap = 10;
  EXPECT_EQ(fault(), "the swap is 10 s in the plan and 60 s in its configuration");
  fleet_ = good;
  fleet_.reserve = 0;
  EXPECT_EQ(fault(), "the reserve is 0 s in the plan and 45 s in its configuration");
  fleet_ = good;
  fleet_.seen_share = 0.5;
  EXPECT_THAT(fault(), HasSubstr("the share that must be seen again is 0.5 in the plan"));
  fleet_ = good;
  fleet_.tours.push_back({"3", 1, 0, "plan_3.json", ""});
  plans_.emplace_back();
  EXPECT_EQ(fault(), "the number of drones is 3 in the fleet and 2 in its configuration");
  fleet_.tours[2].drone = "1";
  EXPECT_THAT(compared().faults, IsEmpty());
  fleet_.tours.push_back({"1", 3, 0, "plan_4.json", ""});
  plans_.emplace_back();
  EXPECT_EQ(fault(), "the number of batteries is 4 in the fleet and 3 in its configuration");
}

TEST_F(ConfiguredFleet, AnySeparationIsRightWhereNoneIsAsked) {
  asked_.find("fleet")->set("separation", 0.0);
  fleet_.separation = 0;
  EXPECT_THAT(compared().faults, IsEmpty());
}

TEST_F(ConfiguredFleet, PlansOfOtherConfigurationsAreTold) {
  compared();
  plans_[1].configuration.set("gps_accuracy", 0.1);
  EXPECT_THAT(fault(), HasSubstr("drone 2, battery 1 has another configuration"));
}

TEST_F(ConfiguredFleet, WhatIsNotComparedIsSaid) {
  asked_.set("accuracy", 0.02);
  asked_.set("batteries", 1);
  EXPECT_THAT(compared().faults, IsEmpty());
  EXPECT_THAT(compared().not_compared, ElementsAre(HasSubstr("the accuracy decides it")));
  for (Plan& plan : plans_) plan.configuration = Value::map();
  EXPECT_THAT(compared().not_compared, ElementsAre(HasSubstr("no configuration of a fleet")));
}

}  // namespace
}  // namespace lapwing
