// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "framework/core/json.h"
#include "framework/verify/verify.h"
#include "tests/verify/reference_plan.h"

namespace lapwing {
namespace {

TEST(Certificate, RoundTrips) {
  Plan missed = reference_plan();
  missed.task.keyframes[1].position.y() += 2;
  Plan broken = reference_plan();
  broken.trajectory.samples.clear();
  for (const Plan& plan : {reference_plan(), missed, broken}) {
    const Certificate certificate = verify(plan);
    const Value value = certificate.to_value();
    const Certificate again =
        Certificate::from_value(from_json(to_json(value), "certificate.json"));
    EXPECT_EQ(again.to_value(), value);
    EXPECT_EQ(again.feasible(), certificate.feasible());
  }
}

TEST(Certificate, HasTheStatedShape) {
  const Value value = verify(reference_plan()).to_value();
  EXPECT_TRUE(value.at("feasible").as_boolean());
  for (const Value& check : value.at("checks").as_list()) {
    EXPECT_TRUE(check.at("name").is_text());
    if (check.find("skipped")) continue;
    EXPECT_TRUE(check.at("worst").is_number()) << check.at("name").as_text();
    EXPECT_TRUE(check.at("limit").is_number());
    EXPECT_TRUE(check.at("unit").is_text());
    EXPECT_TRUE(check.at("at").is_number());
    EXPECT_TRUE(check.at("pass").as_boolean());
  }
}

TEST(Certificate, ReadingRefusesAVerdictThatTheChecksDeny) {
  Plan plan = reference_plan();
  plan.budget = 1;
  Value value = verify(plan).to_value();
  value.set("feasible", true);
  EXPECT_THROW(Certificate::from_value(value), InputError);
}

TEST(Certificate, ReadingRefusesUnknownAndMissingFields) {
  Value value = verify(reference_plan()).to_value();
  auto& checks = value.find("checks")->as_list();
  checks[1].set("wurst", 1.0);
  EXPECT_THROW(Certificate::from_value(value), InputError);
  EXPECT_THROW(Certificate::from_value(Value::map()), InputError);
}

TEST(Certificate, NothingCheckedIsNotFeasible) {
  Certificate certificate;
  EXPECT_FALSE(certificate.feasible());
  certificate.checks.push_back({.name = "clearance", .skipped = "no obstacle"});
  EXPECT_FALSE(certificate.feasible());
}

TEST(Certificate, ReportedChecksDoNotDecide) {
  Certificate certificate;
  certificate.checks.push_back({.name = "a", .worst = 1, .pass = true});
  certificate.checks.push_back({.name = "b", .required = false, .worst = 1, .pass = false});
  EXPECT_TRUE(certificate.feasible());
  EXPECT_TRUE(certificate.failures().empty());
  certificate.checks.push_back({.name = "c", .worst = 1, .pass = false});
  EXPECT_FALSE(certificate.feasible());
}

}  // namespace
}  // namespace lapwing
