// SPDX-License-Identifier: Apache-2.0
#include <fstream>

#include <gtest/gtest.h>

#include "framework/explore/lookahead.h"
#include "tests/explore/explore_fixture.h"

namespace lapwing {
namespace {

// Whatever a function says of a view.
class Stated final : public ViewUtility {
 public:
  explicit Stated(std::function<double(const Viewpoint&)> value) : value_(std::move(value)) {}

 protected:
  void values_of(const EpisodeView&, std::span<const Viewpoint> views,
                 std::span<double> values) const override {
    for (std::size_t k = 0; k < views.size(); ++k) values[k] = value_(views[k]);
  }

 private:
  std::function<double(const Viewpoint&)> value_;
};

double hilly(const Viewpoint& view) {
  return 5 + view.position.x() + 2 * std::sin(3 * view.position.y()) + std::cos(2 * view.yaw);
}

// Every way written out, none shortened.
double best_sum(std::vector<Viewpoint> way, std::size_t length, double step, double turn) {
  const double here = hilly(way.back());
  if (way.size() == length) return here;
  double best = 0;
  for (const Viewpoint& next : neighbours_of(way.back(), step, turn)) {
    const bool met = std::any_of(way.begin(), way.end(), [&](const Viewpoint& view) {
      return (view.position - next.position).norm() < 1e-6 &&
             std::abs(std::remainder(view.yaw - next.yaw, 2 * EIGEN_PI)) < 1e-6;
    });
    if (met) continue;
    way.push_back(next);
    best = std::max(best, best_sum(way, length, step, turn));
    way.pop_back();
  }
  return here + best;
}

TEST(Lookahead, ValuesAViewByTheBestWayThatBeginsWithIt) {
  YardWorld world(1);
  world.settings.step = 0.6;  // ways of four views stay within the box that is free at the start
  const Stated utility(hilly);
  for (const int length : {1, 2, 3, 4}) {
    world.settings.lookahead = length;
    const EpisodeResult result = world.run(utility);
    const double expected = best_sum({world.start}, static_cast<std::size_t>(length),
                                     world.settings.step, world.settings.turn);
    EXPECT_NEAR(result.steps.front().value, expected / length, 1e-9) << length;
  }
}

// A gain two moves away is not seen by who looks at the next view alone.
TEST(Lookahead, SeesOverWhatIsWorthNothing) {
  YardWorld world(4);
  const Viewpoint start = world.start;
  const Stated far([&](const Viewpoint& view) {
    return (view.position - start.position).norm() > 1.5 * 2.5 ? 1.0 : 0.0;
  });
  EXPECT_EQ(world.run(far).end, EpisodeEnd::nothing_to_gain);
  world.settings.lookahead = 2;
  EXPECT_EQ(world.run(far).end, EpisodeEnd::steps);
}

// kB of this process in memory.
double resident() {
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("VmRSS:")) return std::stod(line.substr(6));
  return 0;
}

// Turns about, and asks for all that an episode keeps for utilities.
class Turning final : public ViewUtility {
 public:
  void require_fit(const EpisodeView& known) const override { known.hidden->follow(5); }

 protected:
  void values_of(const EpisodeView& known, std::span<const Viewpoint> views,
                 std::span<double> values) const override {
    known.means->refresh(3);
    for (std::size_t k = 0; k < views.size(); ++k) values[k] = 2 + std::sin(5 * views[k].yaw);
  }
};

// In a box the map and the viewpoints have an end, and so has all that is made of them.
TEST(Episode, NeedsNoMoreMemoryAfterAThousandStepsThanAfterThreeHundred) {
  YardWorld world(1000);
  world.settings.sensor.pinhole = {24, 18, 12, 12, 11.5, 8.5};
  world.settings.turn = EIGEN_PI / 6;  // twelve ways to look from 27 places
  world.settings.visits = 4;
  world.settings.bounds =
      Eigen::AlignedBox3d(world.start.position.array() - 2.6, world.start.position.array() + 2.6);
  world.start.pitch = 0;
  double early = 0, late = 0;
  std::size_t kept_early = 0, kept_late = 0;
  const auto kept = [](const EpisodeView& known) {
    return known.means->bytes() + known.hidden->bytes();
  };
  world.run(Turning(), [&](const EpisodeMoment& moment) {
    if (moment.step == 300) early = resident(), kept_early = kept(moment.known);
    if (moment.step == 999) late = resident(), kept_late = kept(moment.known);
  });
  EXPECT_GT(kept_early, 100'000u);
  EXPECT_LE(kept_late, kept_early + kept_early / 50);
  ASSERT_GT(early, 0);
  ASSERT_GT(late, 0);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // they keep what is freed
  EXPECT_LT(late - early, 4000) << "kB";
#endif
}

TEST(Lookahead, HasAnEnd) {
  YardWorld world(1);
  world.settings.lookahead = 9;
  EXPECT_THROW(world.run(Stated(hilly)), InputError);
  world.settings.lookahead = 0;
  EXPECT_THROW(world.run(Stated(hilly)), InputError);
}

}  // namespace
}  // namespace lapwing
