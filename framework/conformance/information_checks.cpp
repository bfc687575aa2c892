// What every plugin of kind `information` must pass.
#include <cmath>

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
  Random random(seed);
  for (int k = 0; k < 200; ++k) {
    const auto distance = static_cast<float>(random.uniform(0.1, 80));
    sights.push_back({distance, 69 / distance, static_cast<float>(random.uniform(0, 3.14159))});
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
        return "of a voxel at " + std::to_string(sights[k].distance) + " m it tells " + what;
      };
    };
    findings.expect("finite", std::isfinite(values[k]), says(std::to_string(values[k])));
    findings.expect("at least 0", !(values[k] < 0), says(std::to_string(values[k])));
    findings.expect("repeats", values[k] == again[k], says("something else when asked again"));
    information.contributions({&sights[k], 1}, one);
    findings.expect("alone", values[k] == one[0], says("something else when asked alone"));
  }
}

// (4.4): a set of views tells of each voxel the sum of what they tell, 1 at the most. More views
// tell no less, and a view adds no more to more views than to fewer of them.
void check_chains(const ViewInformation& information, std::uint64_t seed, Findings& findings) {
  constexpr int kVoxels = 40, kViews = 8, kChains = 5;
  Random random(seed);
  std::vector<std::vector<float>> told(kViews, std::vector<float>(kVoxels));
  for (std::vector<float>& values : told) {
    std::vector<VoxelSight> sights;
    for (int k = 0; k < kVoxels; ++k) {
      const auto distance = static_cast<float>(random.uniform(0.5, 30));
      sights.push_back({distance, 69 / distance, static_cast<float>(random.uniform(0, 1.5))});
    }
    information.contributions(sights, values);
  }
  const auto gain = [&](int view, const std::vector<float>& sums) {
    double added = 0;
    for (int k = 0; k < kVoxels; ++k)
      added += std::min(1.0f, sums[k] + told[view][k]) - std::min(1.0f, sums[k]);
    return added;
  };
  for (int chain = 0; chain < kChains; ++chain) {
    std::vector<float> sums(kVoxels, 0.0f);
    std::vector<double> before(kViews, HUGE_VAL);
    for (int step = 0; step < kViews; ++step) {
      for (int view = 0; view < kViews; ++view) {
        const double now = gain(view, sums);
        findings.expect("submodular", now >= 0, [&] {
          return "one more view takes away " + std::to_string(-now) + " of what others tell";
        });
        findings.expect("submodular", now <= before[view] + 1e-4, [&] {
          return "a view adds " + std::to_string(now) + " to more views, " +
                 std::to_string(before[view]) + " to fewer";
        });
        before[view] = now;
      }
      const auto next = static_cast<std::size_t>(random.integer(0, kViews - 1));
      for (int k = 0; k < kVoxels; ++k) sums[k] += told[next][k];
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
