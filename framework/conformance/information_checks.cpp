// SPDX-License-Identifier: Apache-2.0
// What every plugin of kind `information` must pass.
#include <cmath>

#include "framework/conformance/differences.h"
#include "framework/conformance/every_case.h"
#include "framework/core/random.h"

namespace lapwing {
namespace {

// Near and far, square and grazing, from behind, and without a normal.
std::vector<VoxelSight> sights_to_ask(std::uint64_t seed) {
  std::vector<VoxelSight> sights;
  for (const float distance : {0.0f, 0.01f, 1.0f, 60.0f, 1e4f})
    for (const float degrees : {-1.0f, 0.0f, 45.0f, 90.0f, 180.0f}) {
      VoxelSight sight{distance, distance > 0 ? 69 / distance : 0, std::nullopt};
      if (degrees >= 0) sight.incidence = degrees * 0.0174533f;
      sights.push_back(sight);
    }
  // Near, far and very far; one in four without a normal.
  Random random(seed);
  for (int k = 0; k < 600; ++k) {
    const double reach = k % 3 == 0 ? 3 : k % 3 == 1 ? 80 : 3000;
    const auto distance = static_cast<float>(random.uniform(0.1, 1) * reach);
    VoxelSight sight{distance, 69 / distance, static_cast<float>(random.uniform(0, 3.14159))};
    if (k % 4 == 0) sight.incidence.reset();
    sights.push_back(sight);
  }
  return sights;
}

void check_one(const ViewInformation& information, const std::vector<VoxelSight>& sights,
               Findings& findings) {
  std::vector<float> values(sights.size(), std::nanf("")), again(values), one(1);
  information.contributions(sights, values);
  information.contributions(sights, again);
  for (std::size_t k = 0; k < sights.size(); ++k) {
    const auto says = [&](const std::string& what) {
      return [&, what] {
        return "of a voxel at " + text_of(sights[k].distance) + " m it tells " + what;
      };
    };
    findings.expect("finite", std::isfinite(values[k]), says(text_of(values[k])));
    findings.expect("at least 0", !(values[k] < 0), says(text_of(values[k])));
    findings.expect("repeats", values[k] == again[k], says("something else when asked again"));
    information.contributions({&sights[k], 1}, one);
    findings.expect("alone", values[k] == one[0], says("something else when asked alone"));
  }
}

// (4.4): a set of views tells of each voxel the sum of what they tell, 1 at the most. More views
// tell no less, and a view adds no more to more views than to fewer of them. A set is asked about
// in one call, so that what a plugin makes of many sights at once counts.
void check_chains(const ViewInformation& information, std::uint64_t seed, Findings& findings) {
  constexpr int kVoxels = 40, kViews = 8, kChains = 5;
  Random random(seed);
  std::vector<std::vector<VoxelSight>> sights(kViews);
  for (std::vector<VoxelSight>& view : sights)
    for (int k = 0; k < kVoxels; ++k) {
      const auto distance = static_cast<float>(random.uniform(0.5, 30));
      view.push_back({distance, 69 / distance, static_cast<float>(random.uniform(0, 1.5))});
    }
  const auto told_by = [&](const std::vector<int>& views) {
    std::vector<VoxelSight> all;
    for (const int view : views) all.insert(all.end(), sights[view].begin(), sights[view].end());
    std::vector<float> values(all.size());
    information.contributions(all, values);
    double sum = 0;
    for (int k = 0; k < kVoxels; ++k) {
      double told = 0;
      for (std::size_t v = 0; v < views.size(); ++v) told += values[v * kVoxels + k];
      sum += std::min(1.0, told);
    }
    return sum;
  };
  for (int chain = 0; chain < kChains; ++chain) {
    std::vector<int> taken;
    std::vector<double> before(kViews, HUGE_VAL);
    for (int step = 0; step < kViews; ++step) {
      const double now = told_by(taken);
      for (int view = 0; view < kViews; ++view) {
        std::vector<int> more = taken;
        more.push_back(view);
        const double gain = told_by(more) - now;
        findings.expect("submodular", gain >= -1e-6, [&] {
          return "one more view reduces the information of the others by " + text_of(-gain);
        });
        findings.expect("submodular", gain <= before[view] + 1e-4, [&] {
          return "a view adds " + text_of(gain) + " to more views, " + text_of(before[view]) +
                 " to fewer";
        });
        before[view] = gain;
      }
      taken.push_back(static_cast<int>(random.integer(0, kViews - 1)));
    }
  }
}

}  // namespace

std::vector<CheckResult> check_information(const Specimen<ViewInformation>& subject,
                                           const CheckOptions& options) {
  const std::vector<VoxelSight> sights = sights_to_ask(options.seed);
  return check_every_case(subject, options, "its contributions",
                          [&](const ViewInformation& information, Findings& findings, bool) {
                            check_one(information, sights, findings);
                            check_chains(information, options.seed, findings);
                          });
}

}  // namespace lapwing
