// SPDX-License-Identifier: Apache-2.0
// OMPL's sampling planners as a family: one library, five names (thesis 2.1; reading 2.1).
#include "framework/plugin/plugin.h"
#include "plugins/path_planners/ompl/search.h"

namespace lapwing {
namespace {

enum Takes : unsigned { kRange = 1, kGoalBias = 2, kRewiring = 4, kBatches = 8 };

ParameterTable table_of(unsigned takes, std::int64_t iterations) {
  ParameterTable table;
  table.integer("iterations", iterations,
                "largest number of iterations; planners that improve paths use all",
                between(1, 100'000'000));
  if (takes & kRange) {
    table.number("range", 0, "m", "longest segment; 0: a fifth of the bounds", between(0, 1e5));
  }
  if (takes & kGoalBias) {
    table.number("goal_bias", 0.05, "", "fraction of samples at the goal", between(0, 1));
  }
  if (takes & kRewiring) {
    table.number("rewire_factor", 1.1, "", "factor on the rewiring radius", between(1, 10));
  }
  if (takes & kBatches) {
    table.integer("samples_per_batch", 100, "samples per batch", between(1, 10'000));
  }
  return table;
}

OmplSettings settings_of(const Parameters& parameters, unsigned takes) {
  OmplSettings settings;
  settings.iterations = parameters.integer("iterations");
  if (takes & kRange) settings.range = parameters.number("range");
  if (takes & kGoalBias) settings.goal_bias = parameters.number("goal_bias");
  if (takes & kRewiring) settings.rewire_factor = parameters.number("rewire_factor");
  if (takes & kBatches) {
    settings.samples_per_batch = static_cast<int>(parameters.integer("samples_per_batch"));
  }
  return settings;
}

class OmplPlanner : public PathPlanner {
 protected:
  OmplPlanner(const OmplSettings& settings, MakePlanner make) : settings_(settings), make_(make) {}

  Search search(const PathProblem& problem, const PathRequest& request) const override {
    OmplOutcome outcome = search_with_ompl(problem, request, settings_, make_);
    return {outcome.status, std::move(outcome.message), outcome.iterations,
            std::move(outcome.points)};
  }

 private:
  OmplSettings settings_;
  MakePlanner make_;
};

class Rrt final : public OmplPlanner {
 public:
  static constexpr unsigned kTakes = kRange | kGoalBias;
  static constexpr PluginText kText{
      "rrt", "1.0.0", "rapidly exploring random tree: first path found", "LaValle 1998; OMPL"};
  static ParameterTable parameters() { return table_of(kTakes, 50'000); }
  explicit Rrt(const Parameters& p) : OmplPlanner(settings_of(p, kTakes), make_rrt) {}
};

class RrtStar final : public OmplPlanner {
 public:
  static constexpr unsigned kTakes = kRange | kGoalBias | kRewiring;
  static constexpr PluginText kText{"rrt_star", "1.0.0",
                                    "RRT with rewiring: paths become shorter with more samples",
                                    "thesis 2.1, algorithm 1; Karaman and Frazzoli 2011; OMPL"};
  static ParameterTable parameters() { return table_of(kTakes, 10'000); }
  explicit RrtStar(const Parameters& p) : OmplPlanner(settings_of(p, kTakes), make_rrt_star) {}
};

class RrtConnect final : public OmplPlanner {
 public:
  static constexpr unsigned kTakes = kRange;
  static constexpr PluginText kText{"rrt_connect", "1.0.0",
                                    "two trees that grow towards each other: fastest first path",
                                    "Kuffner and LaValle 2000; OMPL"};
  static ParameterTable parameters() { return table_of(kTakes, 50'000); }
  explicit RrtConnect(const Parameters& p)
      : OmplPlanner(settings_of(p, kTakes), make_rrt_connect) {}
};

class InformedRrtStar final : public OmplPlanner {
 public:
  static constexpr unsigned kTakes = kRange | kGoalBias | kRewiring;
  static constexpr PluginText kText{"informed_rrt_star", "1.0.0",
                                    "rrt_star that samples only where a shorter path is possible",
                                    "Gammell and others 2014; OMPL"};
  static ParameterTable parameters() { return table_of(kTakes, 10'000); }
  explicit InformedRrtStar(const Parameters& p)
      : OmplPlanner(settings_of(p, kTakes), make_informed_rrt_star) {}
};

class BitStar final : public OmplPlanner {
 public:
  static constexpr unsigned kTakes = kRewiring | kBatches;
  static constexpr PluginText kText{
      "bit_star", "1.0.0", "batches of samples, searched in order of estimated path length",
      "Gammell and others 2015; OMPL"};
  static ParameterTable parameters() { return table_of(kTakes, 3'000); }
  explicit BitStar(const Parameters& p) : OmplPlanner(settings_of(p, kTakes), make_bit_star) {}
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Rrt, lapwing::RrtStar, lapwing::RrtConnect, lapwing::InformedRrtStar,
                lapwing::BitStar)
