// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "framework/conformance/check.h"
#include "framework/core/units.h"

namespace lapwing {
namespace {

const Registry& registry() {
  static const Registry registry({std::filesystem::path(LAPWING_BUILD_DIR) / "lib/plugins"});
  return registry;
}

double told(const std::string& name, const VoxelSight& sight, const Value& given = Value::map()) {
  float value = -1;
  registry().create<ViewInformation>(name, given)->contributions({&sight, 1}, {&value, 1});
  return value;
}

// The thesis's camera, 345 px, and voxels of 0.2 m.
VoxelSight at(float distance, float degrees) {
  return {distance, 69 / distance, static_cast<float>(radians(degrees))};
}

TEST(FrontoParallel, HasTheFiguresOfItsReading) {
  EXPECT_NEAR(told("fronto_parallel", at(5, 0)), 1 / 3.0, 1e-6);
  EXPECT_NEAR(told("fronto_parallel", at(11.5f, 25)), 1 / 3.0, 1e-6);
  EXPECT_NEAR(told("fronto_parallel", at(23, 0)), std::exp(-1.0) / 3, 1e-6);
  EXPECT_NEAR(told("fronto_parallel", at(5, 50)), std::exp(-1.0) / 3, 1e-6);
  EXPECT_NEAR(told("fronto_parallel", at(23, 50)), std::exp(-2.0) / 3, 1e-6);
  EXPECT_EQ(told("fronto_parallel", at(5, 90.01f)), 0);
  EXPECT_NEAR(told("fronto_parallel", {5, 13.8f, std::nullopt}), 0.2 / 3, 1e-6);
}

TEST(FrontoParallel, TakesItsParameters) {
  Value given = Value::map();
  given.set("views", 1.0);
  given.set("unknown_normal", 0.5);
  EXPECT_NEAR(told("fronto_parallel", {5, 13.8f, std::nullopt}, given), 0.5, 1e-6);
}

TEST(Uniform, IsTheSameFromEverywhere) {
  for (const VoxelSight& sight : {at(1, 0), at(50, 80), VoxelSight{3, 1, std::nullopt}})
    EXPECT_NEAR(told("uniform", sight), 1 / 3.0, 1e-7);
}

TEST(Information, EveryPluginPassesTheChecks) {
  int count = 0;
  for (const PluginEntry& entry : registry().entries()) {
    if (entry.kind != ViewInformation::kKind) continue;
    ++count;
    for (const CheckResult& result : check_plugin(registry(), entry))
      EXPECT_EQ(result.outcome, Outcome::passed) << entry.name << ": " << result.message;
  }
  EXPECT_GE(count, 2);
}

// Tells less than nothing of what is far away.
class Broken final : public ViewInformation {
 public:
  void contributions(std::span<const VoxelSight> sights, std::span<float> values) const override {
    for (std::size_t k = 0; k < sights.size(); ++k) values[k] = 1 - sights[k].distance;
  }
};

TEST(Information, TheChecksFindWhatIsNegative) {
  Specimen<ViewInformation> subject{"broken", ParameterTable(),
                                    [](const Value&) { return std::make_unique<Broken>(); }};
  bool failed = false;
  for (const CheckResult& result : check_information(subject))
    failed = failed || (result.name == "at least 0" && result.outcome == Outcome::failed);
  EXPECT_TRUE(failed);
}

}  // namespace
}  // namespace lapwing
