// SPDX-License-Identifier: Apache-2.0
// What a view would really add: needs the true surface, which only a simulation has.
//
//   utility: oracle
#include "framework/core/error.h"
#include "framework/core/parallel.h"
#include "framework/explore/view_utility.h"
#include "framework/plugin/plugin.h"

namespace lapwing {
namespace {

class Oracle final : public ViewUtility {
 public:
  static constexpr PluginText kText{"oracle", "1.0.0", "true gain of a view in observed surface",
                                    "thesis 5.4.2, (5.3)"};
  static ParameterTable parameters() { return {}; }
  static std::span<const Extension> extensions() {
    static const Extension all[] = {{kNeedsGroundTruth, nullptr}};
    return all;
  }
  explicit Oracle(const Parameters&) {}

 protected:
  void values_of(const EpisodeView& known, std::span<const Viewpoint> views,
                 std::span<double> values) const override {
    if (!known.truth)
      throw InputError("utility 'oracle' needs the true surface, which only a simulation has");
    parallel_for(views.size(), known.threads,
                 [&](std::size_t i) { values[i] = known.truth->gain(views[i]); });
  }
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Oracle)
