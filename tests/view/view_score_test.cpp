// SPDX-License-Identifier: Apache-2.0
// Views that count more than everything that there is to see.
#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "framework/view/view_score.h"

namespace lapwing {
namespace {

// Of so many views, each of which tells of some voxels.
ViewScore random_score(std::size_t voxels, int views, std::uint64_t seed) {
  Random random(seed);
  std::vector<double> weights(voxels);
  for (double& weight : weights) weight = random.uniform(0, 3);
  ViewScoreBuilder builder(voxels, weights);
  for (int view = 0; view < views; ++view) {
    std::vector<ViewScore::Contribution> told;
    for (std::uint32_t v = 0; v < voxels; ++v)
      if (random.uniform(0, 1) < 0.2) told.push_back({v, static_cast<float>(random.uniform(0, 2))});
    builder.add_view(told);
  }
  return std::move(builder).take();
}

double score_of(const ViewScore& score, const std::vector<int>& views) {
  ScoreState state(score);
  for (const int view : views) state.add(view);
  return state.score();
}

TEST(PinnedScore, OneMorePinnedViewIsWorthMoreThanAllThatThereIsToSee) {
  for (const std::size_t voxels : {40u, 5000u}) {  // the second needs several voxels a view
    const ViewScore plain = random_score(voxels, 12, voxels);
    const std::vector<int> pinned{3, 7};
    const ViewScore with = with_bonus(plain, pinned);
    const double bonus = bonus_over(plain);
    EXPECT_GT(bonus, plain.total());
    EXPECT_EQ(with.views(), plain.views());
    std::vector<int> others;
    for (int view = 0; view < 12; ++view)
      if (view != 3 && view != 7) others.push_back(view);
    EXPECT_EQ(score_of(with, others), score_of(plain, others));
    EXPECT_GT(score_of(with, {3}), score_of(with, others));
    EXPECT_EQ(score_of(with, {3}), score_of(plain, {3}) + bonus);
    EXPECT_EQ(score_of(with, {0, 3, 7}), score_of(plain, {0, 3, 7}) + 2 * bonus);
    EXPECT_EQ(with.alone(7), plain.alone(7) + bonus);
    // Taken back exactly.
    ScoreState state(with);
    state.add(3);
    state.add(0);
    state.remove(3);
    EXPECT_EQ(state.score(), score_of(plain, {0}));
  }
}

}  // namespace
}  // namespace lapwing
