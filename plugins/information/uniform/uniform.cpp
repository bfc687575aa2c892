// SPDX-License-Identifier: Apache-2.0
// Every view of a voxel tells the same of it, however far and oblique: plain coverage.
//
//   information: {type: uniform, views: 1}
#include <algorithm>

#include "framework/plugin/plugin.h"
#include "framework/view/view_information.h"

namespace lapwing {
namespace {

class Uniform final : public ViewInformation {
 public:
  static constexpr PluginText kText{"uniform", "1.0.0",
                                    "equal information from every view of a voxel",
                                    "thesis 4.3 (observation count)"};
  static ParameterTable parameters() {
    return ParameterTable().number(
        "views", 3, "", "number of views for full information about a voxel", at_least(1));
  }
  explicit Uniform(const Parameters& p) : share_(static_cast<float>(1 / p.number("views"))) {}

  void contributions(std::span<const VoxelSight> sights, std::span<float> values) const override {
    std::fill_n(values.begin(), sights.size(), share_);
  }

 private:
  float share_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Uniform)
