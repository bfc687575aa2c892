// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "framework/explore/viewpoint_graph.h"
#include "tests/explore/explore_fixture.h"

namespace lapwing {
namespace {

class Oracle final : public ViewUtility {
 protected:
  void values_of(const EpisodeView& known, std::span<const Viewpoint> views,
                 std::span<double> values) const override {
    for (std::size_t k = 0; k < views.size(); ++k) values[k] = known.truth->gain(views[k]);
  }
};

class Constant final : public ViewUtility {
 public:
  explicit Constant(double value) : value_(value) {}

 protected:
  void values_of(const EpisodeView&, std::span<const Viewpoint>,
                 std::span<double> values) const override {
    std::fill(values.begin(), values.end(), value_);
  }

 private:
  double value_;
};

TEST(Neighbours, AreNineAlongTheCamerasAxes) {
  const Viewpoint view{{1, 2, 3}, 0.5, -0.2};
  const std::vector<Viewpoint> next = neighbours_of(view, 2.5, 0.4);
  ASSERT_EQ(next.size(), 9u);
  const CameraAxes<double> axes = camera_axes(0.5, -0.2);
  EXPECT_NEAR((next[4].position - view.position - 2.5 * axes.forward).norm(), 0, 1e-12);
  EXPECT_NEAR((next[1].position - view.position + 2.5 * axes.right).norm(), 0, 1e-12);
  EXPECT_NEAR(next[6].yaw, 0.9, 1e-12);
  EXPECT_NEAR(std::abs(std::remainder(next[8].yaw - 0.5, 2 * EIGEN_PI)), EIGEN_PI, 1e-12);
  for (const Viewpoint& one : next) EXPECT_EQ(one.pitch, -0.2);
}

// Every viewpoint of a growing set asked anew at each step: what lazy values must come to.
TEST(Episode, TheOracleTakesTheBestOfAllAtEveryStep) {
  YardWorld world(10);
  world.settings.show_truth = true;
  const Oracle oracle;
  ObservedSurface truth_of_test(world.truth, world.settings.sensor, YardWorld::new_map);
  const auto map = YardWorld::new_map();
  std::vector<Viewpoint> reachable{world.start};
  std::vector<int> visits{0};
  ViewpointIndex index;
  index.add(world.start);
  const EpisodeResult result = world.run(oracle, [&](const EpisodeMoment& moment) {
    double best = 0;
    for (std::size_t k = 0; k < reachable.size(); ++k)
      if (visits[k] < 2) best = std::max(best, truth_of_test.gain(reachable[k]));
    EXPECT_DOUBLE_EQ(moment.taken.value, best) << "step " << moment.step;
    const auto place = static_cast<std::size_t>(index.find(moment.taken.view));
    ASSERT_LT(place, reachable.size());
    EXPECT_NEAR(truth_of_test.gain(moment.taken.view), best, 1e-9 * best);
    ++visits[place];
    map->integrate(world.settings.sensor.look(world.truth.scene(), moment.taken.view, 1));
    truth_of_test.update(*map, moment.taken.view);
    EXPECT_NEAR(moment.taken.observed, truth_of_test.observed(), 1e-6);
    for (const Viewpoint& next : moment.neighbours)
      if (index.add(next) == static_cast<int>(reachable.size())) {
        reachable.push_back(next);
        visits.push_back(0);
      }
  });
  ASSERT_EQ(result.steps.size(), 10u);
  EXPECT_EQ(result.end, EpisodeEnd::steps);
  for (const int count : visits) EXPECT_LE(count, 2);
}

TEST(Episode, EfficiencyIsTheSumOfWhatWasObserved) {
  YardWorld world(5);
  world.settings.show_truth = true;
  const EpisodeResult result = world.run(Oracle());
  double sum = 0;
  for (const EpisodeStep& step : result.steps) sum += step.observed;
  EXPECT_DOUBLE_EQ(result.efficiency(5), sum);
  EXPECT_DOUBLE_EQ(result.efficiency(7), sum + 2 * result.observed());  // it stays as it is
  EXPECT_DOUBLE_EQ(result.efficiency(1), result.steps.front().observed);
}

// Flown ways lie in what was known to be free before the image at their end.
TEST(Episode, TravelsThroughKnownFreeSpaceAlone) {
  YardWorld world(25);
  world.settings.show_truth = true;
  const auto map = YardWorld::new_map();
  const Eigen::AlignedBox3d cleared = cleared_box(map->grid(), world.start.position, 6);
  std::vector<VoxelLeaf> leaves;
  for (double x = cleared.min().x() + 0.2; x < cleared.max().x(); x += 0.4)
    for (double y = cleared.min().y() + 0.2; y < cleared.max().y(); y += 0.4)
      for (double z = cleared.min().z() + 0.2; z < cleared.max().z(); z += 0.4)
        leaves.push_back({map->grid().key({x, y, z}), 0, 0, -2});
  map->import(leaves);
  Viewpoint at = world.start;
  double length = 0;
  world.run(Oracle(), [&](const EpisodeMoment& moment) {
    for (const Viewpoint& next : moment.taken.way) {
      EXPECT_TRUE(map->swept_box_free(at.position, next.position, Eigen::Vector3d::Constant(0.5)))
          << "step " << moment.step;
      length += (next.position - at.position).norm();
      at = next;
    }
    EXPECT_EQ(at.position, moment.taken.view.position);
    EXPECT_NEAR(moment.taken.length, length, 1e-9);
    map->integrate(world.settings.sensor.look(world.truth.scene(), moment.taken.view, 1));
  });
  EXPECT_GT(length, 10);
}

TEST(Episode, IsTheSameForAnyNumberOfThreads) {
  YardWorld world(6);
  world.settings.show_truth = true;
  const EpisodeResult one = world.run(Oracle());
  world.settings.threads = 4;
  const EpisodeResult four = world.run(Oracle());
  ASSERT_EQ(one.steps.size(), four.steps.size());
  for (std::size_t k = 0; k < one.steps.size(); ++k) {
    EXPECT_EQ(one.steps[k].value, four.steps[k].value);
    EXPECT_EQ(one.steps[k].observed, four.steps[k].observed);
    EXPECT_EQ(one.steps[k].view.position, four.steps[k].view.position);
  }
  ASSERT_EQ(one.candidates.size(), four.candidates.size());
  for (std::size_t k = 0; k < one.candidates.size(); ++k)
    EXPECT_EQ(one.candidates[k].value, four.candidates[k].value);
}

TEST(Episode, EndsAndSaysWhy) {
  YardWorld world(30);
  EXPECT_EQ(world.run(Constant(0)).end, EpisodeEnd::nothing_to_gain);
  EXPECT_EQ(world.run(Constant(0)).steps.size(), 1u);  // the first look is always taken
  world.settings.budget = 4;
  const EpisodeResult short_flight = world.run(Constant(1));
  EXPECT_EQ(short_flight.end, EpisodeEnd::budget);
  EXPECT_LE(short_flight.steps.back().time, 4);
  world.settings.budget.reset();
  CancellationToken token;
  token.cancel();
  world.settings.cancellation = &token;
  EXPECT_EQ(world.run(Constant(1)).end, EpisodeEnd::cancelled);
  world.settings.cancellation = nullptr;
  world.settings.wall_clock_guard = 0;
  EXPECT_EQ(world.run(Constant(1)).end, EpisodeEnd::time);
}

// Worth nothing but straight ahead, then nothing at all, then much: as nobody's upper bounds are.
TEST(Episode, AsksAllThatAreLeftBeforeItEnds) {
  YardWorld world(4);
  int images = 0;
  class Rising final : public ViewUtility {
   public:
    explicit Rising(const int& images) : images_(images) {}

   private:
    void values_of(const EpisodeView&, std::span<const Viewpoint> views,
                   std::span<double> values) const override {
      for (std::size_t k = 0; k < views.size(); ++k)
        values[k] = images_ > 1 ? 5 : images_ == 1 ? 0 : views[k].position.x() > 2 ? 2 : -1;
    }
    const int& images_;
  };
  const EpisodeResult result =
      world.run(Rising(images), [&](const EpisodeMoment& moment) { images = moment.step + 1; });
  EXPECT_EQ(result.end, EpisodeEnd::steps);
  ASSERT_EQ(result.steps.size(), 4u);
  EXPECT_EQ(result.steps[1].value, 2);
  EXPECT_EQ(result.steps[2].value, 5);
}

// A corridor of three places; then the way to the last one is closed.
TEST(ViewpointGraph, KnowsWhatCanBeReached) {
  const auto map = YardWorld::new_map();
  const auto set = [&](double x, float log_odds) {
    const std::vector<VoxelLeaf> leaves{{map->grid().key({x, 0.2, 0.2}), 0, 1, log_odds}};
    map->import(leaves);
  };
  for (double x = 0.2; x < 6; x += 0.4) set(x, -2);
  ViewpointGraph graph(*map, Eigen::Vector3d::Constant(0.1), {1, 1});
  for (const double x : {0.6, 2.6, 4.6}) graph.add({{x, 0.2, 0.2}, 0, 0});
  graph.join(0, 1);
  graph.join(1, 2);
  EXPECT_EQ(graph.reached_from(0), (std::vector<bool>{true, true, true}));
  set(3.8, 2);
  EXPECT_EQ(graph.reached_from(0), (std::vector<bool>{true, true, false}));
  EXPECT_EQ(graph.reached_from(2), (std::vector<bool>{false, false, true}));
}

// In a box that nothing leaves there are no more than so many viewpoints.
TEST(Episode, EndsWhereNoViewIsLeft) {
  YardWorld world(2000);
  world.start.pitch = 0;
  world.settings.turn = EIGEN_PI / 2;  // 27 places, four ways to look, twice each
  world.settings.bounds =
      Eigen::AlignedBox3d(world.start.position.array() - 0.1, world.start.position.array() + 0.1);
  EXPECT_NE(refusal([&] { world.run(Constant(1)); }).find("no neighbour"), std::string::npos);
  world.settings.bounds->translate(Eigen::Vector3d(1, 0, 0));
  EXPECT_NE(refusal([&] { world.run(Constant(1)); }).find("outside the bounds"), std::string::npos);
  world.settings.bounds =
      Eigen::AlignedBox3d(world.start.position.array() - 2.6, world.start.position.array() + 2.6);
  world.settings.sensor.pinhole = {8, 6, 4, 4, 3.5, 2.5};
  const EpisodeResult result = world.run(Constant(1));
  EXPECT_EQ(result.end, EpisodeEnd::no_way);
  EXPECT_LE(result.steps.size(), 27u * 4 * 2);
  EXPECT_GE(result.steps.size(), 9u * 4 * 2);
}

TEST(Episode, RefusesWhatMakesNoSense) {
  YardWorld world(3);
  const auto run = [&] { world.run(Constant(1)); };
  world.start.position = {8, -6, 3};  // the box reaches into a house
  EXPECT_NE(refusal(run).find("obstacle"), std::string::npos);
  world.start.position = {0, 0, 4};
  world.settings.step = 5;
  EXPECT_NE(refusal(run).find("no neighbour"), std::string::npos);
  world.settings.step = 2.5;
  world.settings.sensor.range = 15;
  EXPECT_NE(refusal(run).find("maximum_range"), std::string::npos);
  world.settings.sensor.range = 20;
  world.settings.steps = 0;
  EXPECT_NE(refusal(run).find("at least one"), std::string::npos);
}

TEST(Episode, NamesTheViewWhoseValueIsNoNumber) {
  const YardWorld world(3);
  const std::string message = refusal([&] { world.run(Constant(std::nan(""))); });
  EXPECT_NE(message.find("(0, 0, 4)"), std::string::npos) << message;
  EXPECT_NE(message.find("nan"), std::string::npos);
}

TEST(Episode, AUtilityGetsTheTruthOnlyWhenShown) {
  const YardWorld world(2);
  class Curious final : public ViewUtility {
    void values_of(const EpisodeView& known, std::span<const Viewpoint>,
                   std::span<double> values) const override {
      std::fill(values.begin(), values.end(), known.truth ? 1.0 : 2.0);
    }
  };
  EXPECT_EQ(world.run(Curious()).steps.front().value, 2);
}

// However many views are asked for, a call has a few, so that none looks as if it hung.
TEST(Utility, ViewsAreValuedAFewAtATime) {
  class Counting final : public ViewUtility {
   public:
    mutable std::size_t most = 0, calls = 0;

   private:
    void values_of(const EpisodeView&, std::span<const Viewpoint> views,
                   std::span<double> values) const override {
      most = std::max(most, views.size());
      ++calls;
      for (std::size_t k = 0; k < views.size(); ++k) values[k] = views[k].position.x();
    }
  };
  const auto map = YardWorld::new_map();
  const MapMeans means(*map);
  EpisodeView known;
  known.map = map.get();
  known.means = &means;
  std::vector<Viewpoint> views(1001);
  for (std::size_t k = 0; k < views.size(); ++k) views[k].position.x() = static_cast<double>(k);
  std::vector<double> values(views.size());
  const Counting utility;
  utility.score(known, views, values);
  EXPECT_LE(utility.most, 64u);
  EXPECT_GE(utility.calls, views.size() / 64);
  for (std::size_t k = 0; k < views.size(); ++k) ASSERT_EQ(values[k], views[k].position.x());
}

TEST(Episode, NoiseIsReplayedWithoutIt) {
  YardWorld world(4);
  world.settings.sensor.noise = DepthNoise{0.4, 0.5};
  world.settings.show_truth = true;
  const EpisodeResult noisy = world.run(Oracle());
  ObservedSurface observed(world.truth, world.settings.sensor, YardWorld::new_map);
  const auto map = YardWorld::new_map();
  const std::vector<double> curve = replay(world.settings, noisy, world.truth, observed, *map);
  ASSERT_EQ(curve.size(), noisy.steps.size());
  world.settings.sensor.noise.reset();
  ObservedSurface again(world.truth, world.settings.sensor, YardWorld::new_map);
  const auto clean = YardWorld::new_map();
  double sum = 0;
  for (const EpisodeStep& step : noisy.steps) {
    sum += again.gain(step.view);
    clean->integrate(world.settings.sensor.look(world.truth.scene(), step.view, 1));
    again.update(*clean, step.view);
  }
  EXPECT_NEAR(curve.back(), sum, 1e-6 * sum);
}

// The surface of the map is nearer to that of the world, by several times.
TEST(Episode, SmoothedDepthIsMappedInPlaceOfTheNoisyOne) {
  YardWorld world(3);
  world.settings.sensor.noise = DepthNoise{0.4, 1};
  world.settings.show_truth = true;
  const MeshDistance surface(world.truth.shared_scene(), 20);
  const auto share_astray = [&](double smooth_to) {
    world.settings.sensor.smooth_to = smooth_to;
    ObservedSurface observed(world.truth, world.settings.sensor, YardWorld::new_map);
    const auto map = YardWorld::new_map();
    explore(world.settings, world.start, world.truth, observed, Oracle(), *map);
    double occupied = 0, astray = 0;
    map->for_each_leaf([&](const VoxelLeaf& leaf) {
      if (leaf.log_odds <= 0) return;
      ++occupied;
      if (surface.distance(map->grid().center(leaf.key), nullptr) > 1) ++astray;
    });
    EXPECT_GT(occupied, 500);
    return astray / occupied;
  };
  const double noisy = share_astray(0), smooth = share_astray(0.2);
  EXPECT_GT(noisy, 0.1);
  EXPECT_LT(smooth, noisy / 4);
}

// What noise blocks today may be free tomorrow, and where the body is nothing else can be.
TEST(Episode, NoiseDoesNotWallItIn) {
  YardWorld world(80);
  world.settings.sensor.noise = DepthNoise{0.4, 0.5};
  world.settings.show_truth = true;
  for (const std::uint64_t seed : {1, 2, 3}) {
    world.settings.seed = seed;
    EXPECT_EQ(world.run(Oracle()).end, EpisodeEnd::steps) << seed;
  }
}

// The first way leads to a neighbour of the start, or stays there.
TEST(Explore, TakesTheLargestValueForEachSecondIfAsked) {
  YardWorld world(2);
  world.settings.show_truth = true;
  world.settings.per_second = true;
  world.settings.speed = 0.3;
  world.settings.turn_rate = 3;
  ObservedSurface observed(world.truth, world.settings.sensor, YardWorld::new_map);
  const auto map = YardWorld::new_map();
  const MoveTimes times{world.settings.speed, world.settings.turn_rate};
  double best = 0, largest = 0;
  Viewpoint expected, greedy;
  const auto look = [&](const EpisodeMoment& moment) {
    if (moment.step > 0) return;
    std::vector<Viewpoint> views(moment.neighbours.begin(), moment.neighbours.end());
    views.push_back(moment.taken.view);
    for (const Viewpoint& view : views) {
      const double gain = observed.gain(view);
      const double rate = gain / (times.of(world.start, view) + world.settings.pause);
      if (rate > best) {
        best = rate;
        expected = view;
      }
      if (gain > largest) {
        largest = gain;
        greedy = view;
      }
    }
  };
  const EpisodeResult result =
      explore(world.settings, world.start, world.truth, observed, Oracle(), *map, look);
  ASSERT_EQ(result.steps.size(), 2u);
  EXPECT_EQ(result.steps[1].view.position, expected.position);
  EXPECT_EQ(result.steps[1].view.yaw, expected.yaw);
  EXPECT_FALSE(expected.position == greedy.position && expected.yaw == greedy.yaw)
      << "the test tells nothing";
}

TEST(Explore, SecondsAreWorthMoreToWhoCountsThem) {
  YardWorld world(60);
  world.settings.show_truth = true;
  world.settings.speed = 0.5;
  const auto flown = [&](bool per_second) {
    world.settings.per_second = per_second;
    return world.run(Oracle());
  };
  const EpisodeResult images = flown(false), seconds = flown(true);
  const double until = std::min(images.time(), seconds.time());
  EXPECT_GT(seconds.efficiency_in_time(until), images.efficiency_in_time(until));
  EXPECT_GE(images.efficiency(60), seconds.efficiency(60));
}

TEST(Explore, EfficiencyInTimeIsTheMeanOverTheFlight) {
  EpisodeResult result;
  for (const auto& [time, seen] : {std::pair{2.0, 10.0}, {3.0, 40.0}, {7.0, 50.0}}) {
    EpisodeStep& step = result.steps.emplace_back();
    step.time = time;
    step.observed = seen;
  }
  EXPECT_DOUBLE_EQ(result.efficiency_in_time(2), 0);
  EXPECT_DOUBLE_EQ(result.efficiency_in_time(4), (10 * 1 + 40 * 1) / 4.0);
  EXPECT_DOUBLE_EQ(result.efficiency_in_time(10), (10 * 1 + 40 * 4 + 50 * 3) / 10.0);
  EXPECT_DOUBLE_EQ(result.efficiency_in_time(0), 0);
  EXPECT_DOUBLE_EQ(EpisodeResult().efficiency_in_time(5), 0);
}

// Who hears of a view before its image sees the map that it was chosen by, and changes nothing.
TEST(Episode, ChoicesAreToldBeforeTheirImages) {
  const YardWorld world(4);
  const auto flown = [&](const ChoiceObserver& before, std::vector<std::uint64_t>* known) {
    const auto map = YardWorld::new_map();
    ObservedSurface observed(world.truth, world.settings.sensor, YardWorld::new_map);
    return explore(
        world.settings, world.start, world.truth, observed, Constant(1), *map,
        [&](const EpisodeMoment& moment) {
          if (known) known->push_back(moment.known.map->counts().known);
        },
        before);
  };
  std::vector<std::uint64_t> before, after;
  std::vector<Viewpoint> chosen;
  const EpisodeResult told = flown(
      [&](const EpisodeChoice& choice) {
        EXPECT_EQ(choice.step, static_cast<int>(chosen.size()));
        before.push_back(choice.known.map->counts().known);
        chosen.push_back(choice.view);
      },
      &after);
  const EpisodeResult untold = flown({}, nullptr);
  ASSERT_EQ(told.steps.size(), 4u);
  ASSERT_EQ(chosen.size(), 4u);
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    EXPECT_EQ(chosen[k].position, told.steps[k].view.position);
    EXPECT_EQ(told.steps[k].view.position, untold.steps[k].view.position);
    EXPECT_LE(before[k], after[k]);
    if (k > 0) {
      EXPECT_EQ(before[k], after[k - 1]);
    }
  }
  EXPECT_LT(before.front(), after.front());
}

}  // namespace
}  // namespace lapwing
