// SPDX-License-Identifier: Apache-2.0
// What every plugin of kind `utility` must pass.
#include <cmath>
#include <deque>

#include "framework/conformance/differences.h"
#include "framework/conformance/every_case.h"
#include "framework/core/random.h"
#include "framework/map/plain_map.h"

namespace lapwing {
namespace {

constexpr int kAnywhere = 10;
constexpr double kBehind = 20;  // m behind surfaces that utilities may ask for

// What an exploration knows of a room after some looks, or before the first; and views to ask
// about: in what is known, at its border, beyond it, the other way round, and anywhere.
struct UtilityWorld {
  class Told final : public TrueGain {
   public:
    explicit Told(int looks) : looks_(looks) {}
    double gain(const Viewpoint& view) const override {
      return (10 + 5 * std::sin(view.position.x() + view.yaw)) / (1 + looks_);
    }

   private:
    int looks_;
  };

  std::string name;
  int looks = 0;
  std::unique_ptr<PlainMap> map;
  std::unique_ptr<MapMeans> means;
  std::unique_ptr<HiddenVoxels> hidden;
  Told told;
  EpisodeView known;
  std::vector<Viewpoint> views;

  UtilityWorld(std::string named, int looked, std::uint64_t seed)
      : name(std::move(named)), looks(looked), told(looked) {
    MapSettings settings;
    settings.resolution = 0.4;
    settings.hit = log_odds_of(0.9);
    settings.miss = log_odds_of(0.1);
    settings.clamp_min = log_odds_of(0.1192);
    settings.clamp_max = log_odds_of(0.971);
    settings.free_below = log_odds_of(0.25);
    settings.occupied_above = log_odds_of(0.75);
    settings.maximum_range = 20;
    settings.observations = true;
    map = std::make_unique<PlainMap>(settings);
    hidden = std::make_unique<HiddenVoxels>(*map);
    hidden->follow(kBehind);
    // From the middle, then from aside and from outside of the opening.
    const Eigen::Vector3d places[] = {
        {-0.3, 0.2, 1.5}, {0.7, 0.2, 1.6}, {-4, -2.5, 0.5}, {4.5, 2.9, 2.5}, {9, 0, 1}};
    for (int look = 0; look < looks; ++look) look_around(places[look]);
    means = std::make_unique<MapMeans>(*map);
    if (const auto bounds = map->bounds()) means->touch(*bounds);
    const double pitch = -10 * EIGEN_PI / 180;
    known = {map.get(), means.get(), {160, 120, 80, 80, 79.5, 59.5}, 20, pitch, &told,
             1,         hidden.get()};
    views = {{{0.1, 0.1, 1.6}, 0.2, pitch},
             {{2.6, 1.5, 1.6}, 2.9, pitch},
             {{5.9, 0, 1.5}, 3.1, pitch},
             {{40, -30, 12}, -1.5, pitch}};
    Random random(seed + static_cast<std::uint64_t>(looks));
    for (int k = 0; k < kAnywhere; ++k)
      views.push_back({{-6 + 15 * (k + random.uniform()) / kAnywhere, random.uniform(-4, 4),
                        random.uniform(-0.8, 3.8)},
                       random.uniform(-3, 3),
                       pitch});
  }

  // A room of 12 m x 8 m x 5 m with an opening in its wall to the east.
  void look_around(const Eigen::Vector3d& from) {
    std::vector<Eigen::Vector3f> points;
    for (double y = -3.9; y < 4; y += 0.4)
      for (double z = -0.9; z < 4; z += 0.4) {
        if (std::abs(y) > 1.2)
          points.emplace_back(6.1f, static_cast<float>(y), static_cast<float>(z));
        points.emplace_back(-6.1f, static_cast<float>(y), static_cast<float>(z));
      }
    for (double x = -5.9; x < 6; x += 0.4)
      for (double y = -3.9; y < 4; y += 0.4)
        points.emplace_back(static_cast<float>(x), static_cast<float>(y), -1.1f);
    map->integrate(points, from.cast<float>());
    hidden->saw(points, from);
  }
};

// A utility that declares it is worth no less than 0 (monotone), and no more the more is known
// (submodular): asked about the same views along a chain of looks.
void check_chain(const ViewUtility& utility, const std::deque<UtilityWorld>& chain, bool monotone,
                 bool submodular, Findings& findings) {
  std::vector<double> before;
  for (const UtilityWorld& world : chain) {
    std::vector<double> now(chain.front().views.size());
    try {
      utility.require_fit(world.known);
    } catch (const InputError&) {
      continue;  // trained with another mapping
    }
    utility.score(world.known, chain.front().views, now);
    for (std::size_t k = 0; k < now.size(); ++k) {
      const auto at = [&] { return world.name + ": view " + std::to_string(k); };
      if (monotone)
        findings.expect("monotone", now[k] >= 0, [&] {
          return at() + " is worth " + text_of(now[k]) + ", less than nothing";
        });
      if (submodular && !before.empty())
        findings.expect("submodular", now[k] <= before[k] + 1e-9 * std::abs(before[k]), [&] {
          return at() + " is worth " + text_of(now[k]) + ", with less known " + text_of(before[k]);
        });
    }
    before = std::move(now);
  }
}

class UtilityCheck {
 public:
  // With other parameters than its defaults two views are enough.
  UtilityCheck(const ViewUtility& utility, const UtilityWorld& world, const CheckOptions& options,
               Findings& findings, bool defaults)
      : utility_(utility),
        world_(world),
        options_(options),
        findings_(findings),
        defaults_(defaults),
        views_(std::span(world.views).first(defaults ? world.views.size() : 2)) {}

  // Thorough: more than that values are finite.
  void run(bool thorough) {
    if (!thorough && !options_.wants("finite")) return;
    try {
      utility_.require_fit(world_.known);
    } catch (const InputError&) {
      return;  // trained with another mapping
    }
    const std::vector<double> values = asked(1);
    for (std::size_t k = 0; k < values.size(); ++k)
      findings_.expect("finite", std::isfinite(values[k]),
                       [&] { return place(k) + " is worth " + text_of(values[k]); });
    if (!thorough) return;
    if (options_.wants("repeatable"))
      findings_.expect("repeatable", asked(1) == values,
                       [&] { return world_.name + ": other values when asked again"; });
    if (options_.wants("threads"))
      findings_.expect("threads", asked(4) == values,
                       [&] { return world_.name + ": other values with four threads"; });
    for (std::size_t k = 0; options_.wants("alone") && k < values.size(); ++k) {
      double alone = 0;
      utility_.score(world_.known, {&world_.views[k], 1}, {&alone, 1});
      findings_.expect("alone", alone == values[k],
                       [&] { return place(k) + " has another value when asked alone"; });
    }
    if (options_.wants("truth")) blind();
  }

 private:
  std::vector<double> asked(int threads) const {
    EpisodeView known = world_.known;
    known.threads = threads;
    std::vector<double> values(views_.size(), std::nan(""));
    utility_.score(known, views_, values);
    return values;
  }
  std::string place(std::size_t k) const { return world_.name + ": view " + std::to_string(k); }

  // Without the truth: the same values, or refused in words.
  void blind() {
    EpisodeView known = world_.known;
    known.truth = nullptr;
    std::vector<double> values(world_.views.size());
    try {
      utility_.score(known, world_.views, values);
      findings_.expect("truth", values == asked(1), [&] {
        return world_.name + ": asks the truth, and answers otherwise without it";
      });
    } catch (const InputError&) {
      findings_.expect("truth", true, {});
    }
  }

  const ViewUtility& utility_;
  const UtilityWorld& world_;
  const CheckOptions& options_;
  Findings& findings_;
  bool defaults_;
  std::span<const Viewpoint> views_;
};

}  // namespace

std::vector<CheckResult> check_utility(const Specimen<ViewUtility>& subject,
                                       const CheckOptions& options) {
  const bool monotone = subject.says(kMonotone) && options.wants("monotone");
  const bool submodular = subject.says(kSubmodular) && options.wants("submodular");
  const bool chain = monotone || submodular;
  std::deque<UtilityWorld> worlds;  // which point into themselves
  const auto need = [&](const char* name, int looks, bool always) {
    if (always || chain || options.wants("finite")) worlds.emplace_back(name, looks, options.seed);
  };
  need("nothing known", 0, false);
  need("a room seen twice", 2, true);
  need("a room seen from all sides", 5, false);
  return check_every_case(subject, options, "its values",
                          [&](const ViewUtility& utility, Findings& findings, bool defaults) {
                            if (defaults && chain)
                              check_chain(utility, worlds, monotone, submodular, findings);
                            if (!defaults && !options.wants("finite")) return;
                            for (const UtilityWorld& world : worlds)
                              UtilityCheck(utility, world, options, findings, defaults)
                                  .run(defaults && world.looks == 2);
                          });
}

}  // namespace lapwing
