// SPDX-License-Identifier: Apache-2.0
// A plan whose vehicle nobody could build fails its document, in words.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "framework/verify/verify.h"
#include "tests/verify/reference_plan.h"

namespace lapwing {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string failure_with(const std::string& table, const std::string& key, Value value) {
  Plan plan = reference_plan();
  (table.empty() ? plan.vehicle : *plan.vehicle.find(table)).set(key, std::move(value));
  const Certificate certificate = verify(plan);
  EXPECT_FALSE(certificate.feasible());
  return certificate.failures().empty() ? "certified" : to_line(certificate.failures()[0]);
}

TEST(PlausibleVehicle, APlanOfNoRealVehicleFailsItsDocument) {
  EXPECT_THAT(failure_with("", "inertia", Value(Value::List{6000.0, 6000.0, 9000.0})),
              AllOf(HasSubstr("document"), HasSubstr("inertia"), HasSubstr("is it g cm^2?")));
  EXPECT_THAT(failure_with("rotors", "arm_length", 1e-12), HasSubstr("rotors.arm_length"));
  EXPECT_THAT(failure_with("", "yaw_share", 1e-300), HasSubstr("yaw_share"));
  EXPECT_THAT(failure_with("rotors", "torque_coefficient", 1e-300), HasSubstr("torque_coeffic"));
  EXPECT_THAT(failure_with("", "flight_time", 1e300), HasSubstr("flight_time"));
}

}  // namespace
}  // namespace lapwing
