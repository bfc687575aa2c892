// SPDX-License-Identifier: Apache-2.0
// A term that declares an invariance is held to it: for each, one that has it and one that has not.
#include <gtest/gtest.h>

#include "framework/conformance/check.h"
#include "framework/problem/differentiable.h"
#include "framework/problem/invariance.h"

namespace lapwing {
namespace {

// What a term looks at, each with invariances of its own.
enum class Looks { at_speed, at_heading, at_height, at_place, at_time };

class LookingCost final : public DifferentiableCost<LookingCost> {
 public:
  explicit LookingCost(Looks looks) : looks_(looks) {}
  FunctionShape declare(const ProblemSetting& setting) {
    const char* block = looks_ == Looks::at_place || looks_ == Looks::at_height ? "position"
                        : looks_ == Looks::at_time                              ? "time"
                                                                                : "velocity";
    return {.blocks = setting.layout.indices({block}), .rows = 2};
  }
  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    if (looks_ == Looks::at_time) {
      rows[0] = stage.scalar(0);
      rows[1] = T(0.0);
      return;
    }
    const auto v = stage.template vector<3>(0);
    rows[0] = looks_ == Looks::at_height ? v[2] : v[0];
    rows[1] = looks_ == Looks::at_heading || looks_ == Looks::at_height ? T(0.0) : v[1];
  }

 private:
  Looks looks_;
};

bool invariance_fails(Looks looks, const char* declared) {
  CheckOptions options;
  options.only = {"invariance"};
  Specimen<CostTerm> subject{
      "looking", {}, [=](const Value&) { return std::make_unique<LookingCost>(looks); }};
  subject.declares = {declared};
  bool seen = false, failed = false;
  for (const CheckResult& result : check_cost_term(subject, options)) {
    if (result.name != "invariance") {
      EXPECT_EQ(result.outcome, Outcome::passed) << result.name << ": " << result.message;
      continue;
    }
    seen = true;
    failed = result.outcome == Outcome::failed;
    EXPECT_TRUE(!failed || result.message.find(declared) != std::string::npos) << result.message;
  }
  EXPECT_TRUE(seen) << "the check was not made";
  return failed;
}

TEST(BrokenInvariance, IsCaughtAndATrueOneIsNot) {
  const struct {
    Looks looks;
    bool translation, rotation, time;
  } cases[] = {{Looks::at_speed, true, true, true},     // |v across|: the same however it is turned
               {Looks::at_heading, true, false, true},  // v east
               {Looks::at_height, false, true, true},
               {Looks::at_place, false, true, true},  // distance from the axis: turned, it stays
               {Looks::at_time, true, true, false}};
  for (const auto& one : cases) {
    EXPECT_EQ(invariance_fails(one.looks, kInvariantToTranslation), !one.translation)
        << static_cast<int>(one.looks);
    EXPECT_EQ(invariance_fails(one.looks, kInvariantToRotationAboutZ), !one.rotation)
        << static_cast<int>(one.looks);
    EXPECT_EQ(invariance_fails(one.looks, kInvariantToTime), !one.time)
        << static_cast<int>(one.looks);
  }
}

}  // namespace
}  // namespace lapwing
