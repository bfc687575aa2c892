// SPDX-License-Identifier: Apache-2.0
#include "framework/photogrammetry/photo_match.h"

#include <gtest/gtest.h>

#include <cmath>

#include "framework/core/error.h"
#include "framework/core/random.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

WantedView view_at(double x, double y = 0, double z = 0, double yaw = 0) {
  return {{x, y, z}, {std::cos(yaw), std::sin(yaw), 0}};
}
TakenPhoto photo_at(double x, double y = 0, double z = 0) {
  return {"photo", {x, y, z}, std::nullopt};
}

TEST(PhotoMatches, AsManyPairsAsCanBe) {
  // The nearest pair, 1 and 0.9, would leave the view at 0 alone.
  const auto match =
      match_photos({view_at(0), view_at(1)}, {photo_at(0.9), photo_at(1.9)}, {1, 0.2});
  EXPECT_EQ(match.photo_of_view, (std::vector<int>{0, 1}));
  EXPECT_TRUE(match.unmatched.empty());
  EXPECT_NEAR(match.distance, 0.9, 1e-12);
  EXPECT_NEAR(match.farthest, 0.9, 1e-12);
}

TEST(PhotoMatches, AChainOfPairsIsMovedAlong) {
  // Each photograph is nearer to the view before its own; the last photograph has one view only.
  std::vector<WantedView> views;
  std::vector<TakenPhoto> photos;
  for (int k = 0; k < 50; ++k) {
    views.push_back(view_at(k));
    photos.push_back(photo_at(k + 0.6));
  }
  const auto match = match_photos(views, photos, {0.7, 0.2});
  for (int k = 0; k < 50; ++k) EXPECT_EQ(match.photo_of_view[static_cast<std::size_t>(k)], k);
}

TEST(PhotoMatches, DirectionsTellViewsOfOnePlaceApart) {
  const std::vector<WantedView> views{view_at(0, 0, 0, 0), view_at(0, 0, 0, 1.5),
                                      view_at(0, 0, 0, 3)};
  std::vector<TakenPhoto> photos{photo_at(0.1), photo_at(0.2)};
  photos[0].ahead = Vector3d(std::cos(2.95), std::sin(2.95), 0);
  photos[1].ahead = Vector3d(std::cos(0.1), std::sin(0.1), 0);
  EXPECT_EQ(match_photos(views, photos, {1, 0.2}).photo_of_view, (std::vector<int>{1, -1, 0}));
  photos[1].ahead = Vector3d(std::cos(0.7), std::sin(0.7), 0);
  const auto match = match_photos(views, photos, {1, 0.2});
  EXPECT_EQ(match.photo_of_view, (std::vector<int>{-1, -1, 0}));
  EXPECT_EQ(match.unmatched, (std::vector<int>{1}));
}

// The most pairs, and of those the least sum of shares, by trying every choice.
std::pair<int, double> by_hand(const std::vector<WantedView>& views,
                               const std::vector<TakenPhoto>& photos, double distance,
                               std::size_t at, std::vector<char>& used) {
  if (at == views.size()) return {0, 0};
  auto best = by_hand(views, photos, distance, at + 1, used);
  for (std::size_t p = 0; p < photos.size(); ++p) {
    const double away = (views[at].position - photos[p].position).norm();
    if (used[p] || away > distance) continue;
    used[p] = 1;
    auto with = by_hand(views, photos, distance, at + 1, used);
    used[p] = 0;
    with = {with.first + 1, with.second + away / distance};
    if (with.first > best.first || (with.first == best.first && with.second < best.second))
      best = with;
  }
  return best;
}

TEST(PhotoMatches, AreTheBestOfAllChoices) {
  Random random(11);
  for (int trial = 0; trial < 60; ++trial) {
    std::vector<WantedView> views;
    std::vector<TakenPhoto> photos;
    for (int k = 0; k < 6; ++k)
      views.push_back(view_at(random.uniform(0, 4), random.uniform(0, 2)));
    for (int k = 0; k < 5; ++k)
      photos.push_back(photo_at(random.uniform(0, 4), random.uniform(0, 2)));
    const auto match = match_photos(views, photos, {0.8, 0.2});
    int pairs = 0;
    double cost = 0;
    for (std::size_t v = 0; v < views.size(); ++v) {
      const int p = match.photo_of_view[v];
      if (p < 0) continue;
      ++pairs;
      cost += (views[v].position - photos[static_cast<std::size_t>(p)].position).norm() / 0.8;
    }
    std::vector<char> used(photos.size(), 0);
    const auto [most, least] = by_hand(views, photos, 0.8, 0, used);
    EXPECT_EQ(pairs, most) << trial;
    EXPECT_NEAR(cost, least, 1e-9) << trial;
  }
}

TEST(PhotoMatches, NothingIsNear) {
  const auto match = match_photos({view_at(0)}, {photo_at(5)}, {1, 0.2});
  EXPECT_EQ(match.photo_of_view, (std::vector<int>{-1}));
  EXPECT_EQ(match.unmatched, (std::vector<int>{0}));
  EXPECT_EQ(match.distance, 0);
  EXPECT_TRUE(match_photos({}, {}, {1, 0.2}).photo_of_view.empty());
  EXPECT_THROW(match_photos({view_at(0)}, {photo_at(0)}, {0, 0.2}), InputError);
  EXPECT_THROW(match_photos({view_at(0)}, {photo_at(0)}, {1, std::nan("")}), InputError);
}

TEST(PhotoHeights, TheCommonOffsetIsFoundAmongOthers) {
  Random random(5);
  std::vector<WantedView> views;
  std::vector<TakenPhoto> photos;
  for (int k = 0; k < 40; ++k) {
    views.push_back(view_at(3 * (k % 8), 3 * (k / 8), random.uniform(5, 20)));
    if (k % 4 == 0) continue;  // not taken
    const Vector3d at =
        views.back().position + Vector3d(0.3 * random.normal(), 0.3 * random.normal(), 46.2);
    photos.push_back({"p", at + Vector3d(0, 0, 0.2 * random.normal()), std::nullopt});
  }
  EXPECT_NEAR(common_height_offset(views, photos, 2), 46.2, 0.3);
  EXPECT_EQ(common_height_offset(views, {}, 2), 0);
}

// Layers of views above each other, of which the upper ones alone were photographed: pairs of
// different layers must not pull the offset between them.
TEST(PhotoHeights, LayersAreNotMerged) {
  for (const double spacing : {1.5, 4.0})
    for (const double offset : {0.0, 0.6, -0.5}) {
      Random random(7);
      std::vector<WantedView> views;
      std::vector<TakenPhoto> photos;
      for (int k = 0; k < 30; ++k)
        for (int layer = 0; layer < 3; ++layer) {
          views.push_back(view_at(10 * (k % 6), 10 * (k / 6), 10 + spacing * layer));
          if (layer == 0) continue;  // not taken
          const Vector3d noise(0.2 * random.normal(), 0.2 * random.normal(), 0.1 * random.normal());
          photos.push_back({"p", views.back().position + noise + Vector3d(0, 0, offset), {}});
        }
      EXPECT_NEAR(common_height_offset(views, photos, 3), offset, 0.1) << spacing;
    }
}

}  // namespace
}  // namespace lapwing
