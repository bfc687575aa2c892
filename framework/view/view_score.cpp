// SPDX-License-Identifier: Apache-2.0
// How: amounts are integers, multiples of a power of two. `seen_` holds the sum of each voxel over
// the included views. It is not clamped, so that a view can be removed again. The score is the sum
// of min(seen, capacity). A gain reads only the voxels of one view: the sum of min(amount, capacity
// left).
#include "framework/view/view_score.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "framework/core/error.h"

namespace lapwing {
namespace {

using Amount = ViewScore::Amount;

constexpr int kCoverageBits = 20, kAdditiveBits = 30;

// A power of two that divides the next power of two above `largest` into 2^bits.
double unit_for(double largest, int bits) {
  return largest > 0 ? std::ldexp(1.0, static_cast<int>(std::ceil(std::log2(largest))) - bits) : 1;
}

bool sound_amount(double amount) {
  return std::isfinite(amount) && amount >= 0;
}

}  // namespace

double ViewScore::total() const {
  std::vector<std::int64_t> sums(voxels(), 0);
  for (std::size_t i = 0; i < voxels_.size(); ++i) sums[voxels_[i]] += amounts_[i];
  std::int64_t total = 0;
  for (std::size_t v = 0; v < sums.size(); ++v) {
    total += std::min<std::int64_t>(sums[v], capacities_[v]);
  }
  return static_cast<double>(total) * unit_;
}

std::size_t ViewScore::bytes() const {
  return first_.size() * sizeof(std::size_t) + voxels_.size() * sizeof(std::uint32_t) +
         (amounts_.size() + capacities_.size()) * sizeof(Amount);
}

ViewScoreBuilder::ViewScoreBuilder(std::size_t voxels, std::span<const double> weights) {
  if (voxels > std::numeric_limits<std::uint32_t>::max()) {
    throw InputError("a view score has fewer than 2^32 voxels, not " + std::to_string(voxels));
  }
  if (!weights.empty() && weights.size() != voxels) {
    throw InputError("a view score of " + std::to_string(voxels) +
                     " voxels needs as many weights, not " + std::to_string(weights.size()));
  }
  double largest = weights.empty() ? 1 : 0;
  for (std::size_t v = 0; v < weights.size(); ++v) {
    if (!sound_amount(weights[v])) {
      throw InputError("the weight of voxel " + std::to_string(v) +
                       " must be a finite number of at least 0");
    }
    largest = std::max(largest, weights[v]);
  }
  largest_ = largest;
  score_.unit_ = unit_for(largest, kCoverageBits);
  score_.capacities_.resize(voxels);
  for (std::size_t v = 0; v < voxels; ++v) {
    const double weight = weights.empty() ? 1 : weights[v];
    score_.capacities_[v] = static_cast<Amount>(std::lround(weight / score_.unit_));
  }
  sums_.resize(voxels);
}

ViewScoreBuilder ViewScoreBuilder::growing(double largest) {
  if (!(largest > 0) || !sound_amount(largest))
    throw InputError("the largest weight of a voxel must be a finite number above 0");
  ViewScoreBuilder builder(0);
  builder.largest_ = largest;
  builder.score_.unit_ = unit_for(largest, kCoverageBits);
  return builder;
}

void ViewScoreBuilder::add_voxel(double weight) {
  if (score_.voxels() >= std::numeric_limits<std::uint32_t>::max())
    throw InputError("a view score has fewer than 2^32 voxels");
  if (!sound_amount(weight) || weight > largest_)
    throw InputError("the weight of voxel " + std::to_string(score_.voxels()) +
                     " must be a finite number from 0 to " + std::to_string(largest_));
  score_.capacities_.push_back(static_cast<Amount>(std::lround(weight / score_.unit_)));
  sums_.push_back(0);
}

void ViewScoreBuilder::add_view(std::span<const ViewScore::Contribution> contributions) {
  sorted_.assign(contributions.begin(), contributions.end());
  std::sort(sorted_.begin(), sorted_.end(),
            [](const auto& a, const auto& b) { return a.voxel < b.voxel; });
  const auto refuse = [&](const ViewScore::Contribution& c, const std::string& what) {
    throw InputError("view " + std::to_string(score_.views()) + ", voxel " +
                     std::to_string(c.voxel) + ": " + what);
  };
  for (std::size_t i = 0; i < sorted_.size(); ++i) {
    const ViewScore::Contribution& c = sorted_[i];
    if (c.voxel >= score_.voxels()) {
      refuse(c, "there are " + std::to_string(score_.voxels()) + " voxels");
    }
    if (!sound_amount(c.amount)) refuse(c, "a contribution must be a finite number of at least 0");
    if (i > 0 && sorted_[i - 1].voxel == c.voxel) refuse(c, "is contributed to twice");
  }
  for (const ViewScore::Contribution& c : sorted_) {
    const double units = std::min<double>(c.amount / score_.unit_, score_.capacities_[c.voxel]);
    const Amount amount = static_cast<Amount>(std::lround(units));
    if (amount == 0) continue;
    sums_[c.voxel] += amount;
    if (sums_[c.voxel] > std::numeric_limits<Amount>::max()) {
      refuse(c, "more than 2,000 views see it fully; remove some of them");
    }
    score_.voxels_.push_back(c.voxel);
    score_.amounts_.push_back(amount);
  }
  score_.first_.push_back(score_.voxels_.size());
  const auto amounts = score_.amounts_of(score_.views() - 1);
  score_.alone_.push_back(std::accumulate(amounts.begin(), amounts.end(), std::int64_t{0}));
}

ViewScore ViewScoreBuilder::take() && {
  score_.voxels_.shrink_to_fit();
  score_.amounts_.shrink_to_fit();
  return std::move(score_);
}

ViewScore additive_score(std::span<const double> scores) {
  double largest = 0;
  for (std::size_t v = 0; v < scores.size(); ++v) {
    if (!sound_amount(scores[v])) {
      throw InputError("the score of view " + std::to_string(v) +
                       " must be a finite number of at least 0");
    }
    largest = std::max(largest, scores[v]);
  }
  ViewScore result;
  result.unit_ = unit_for(largest, kAdditiveBits);
  for (std::size_t v = 0; v < scores.size(); ++v) {
    result.voxels_.push_back(static_cast<std::uint32_t>(v));
    result.amounts_.push_back(static_cast<Amount>(std::lround(scores[v] / result.unit_)));
    result.first_.push_back(v + 1);
    result.alone_.push_back(result.amounts_.back());
  }
  result.capacities_ = result.amounts_;
  return result;
}

namespace {

// Voxels of this capacity, that one view alone tells of, are its bonus.
constexpr Amount kBonusCapacity = Amount{1} << 30;

std::size_t bonus_voxels(const ViewScore& score) {
  const double total = std::accumulate(score.capacities().begin(), score.capacities().end(), 0.0);
  return static_cast<std::size_t>(total / kBonusCapacity) + 1;
}

}  // namespace

double bonus_over(const ViewScore& score) {
  return static_cast<double>(bonus_voxels(score)) * kBonusCapacity * score.unit();
}

ViewScore with_bonus(const ViewScore& score, std::span<const int> views) {
  const std::size_t each = bonus_voxels(score);
  ViewScore result;
  result.unit_ = score.unit_;
  result.capacities_ = score.capacities_;
  result.capacities_.resize(score.voxels() + each * views.size(), kBonusCapacity);
  result.voxels_.reserve(score.voxels_.size() + each * views.size());
  result.amounts_.reserve(result.voxels_.capacity());
  std::size_t next = 0;
  for (int view = 0; view < score.views(); ++view) {
    const auto voxels = score.voxels_of(view);
    const auto amounts = score.amounts_of(view);
    result.voxels_.insert(result.voxels_.end(), voxels.begin(), voxels.end());
    result.amounts_.insert(result.amounts_.end(), amounts.begin(), amounts.end());
    std::int64_t alone = score.alone_[static_cast<std::size_t>(view)];
    if (next < views.size() && views[next] == view) {
      for (std::size_t k = 0; k < each; ++k) {
        result.voxels_.push_back(static_cast<std::uint32_t>(score.voxels() + each * next + k));
        result.amounts_.push_back(kBonusCapacity);
        alone += kBonusCapacity;
      }
      ++next;
    }
    result.first_.push_back(result.voxels_.size());
    result.alone_.push_back(alone);
  }
  return result;
}

ScoreState::ScoreState(const ViewScore& score)
    : score_(&score), seen_(score.voxels(), 0), included_(score.views(), 0) {}

double ScoreState::gain(int view) {
  ++evaluations_;
  if (included_[view]) return 0;
  const auto voxels = score_->voxels_of(view);
  const auto amounts = score_->amounts_of(view);
  const Amount* capacities = score_->capacities().data();
  std::int64_t gain = 0;
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const std::uint32_t v = voxels[i];
    gain += std::min(amounts[i], std::max(0, capacities[v] - seen_[v]));
  }
  return static_cast<double>(gain) * score_->unit();
}

double ScoreState::loss(int view) {
  ++evaluations_;
  if (!included_[view]) return 0;
  const auto voxels = score_->voxels_of(view);
  const auto amounts = score_->amounts_of(view);
  const Amount* capacities = score_->capacities().data();
  std::int64_t loss = 0;
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const std::uint32_t v = voxels[i];
    loss += std::min(amounts[i], std::max(0, capacities[v] - (seen_[v] - amounts[i])));
  }
  return static_cast<double>(loss) * score_->unit();
}

void ScoreState::add(int view) {
  if (included_[view]) return;
  ++evaluations_;
  const auto voxels = score_->voxels_of(view);
  const auto amounts = score_->amounts_of(view);
  const Amount* capacities = score_->capacities().data();
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const std::uint32_t v = voxels[i];
    sum_ += std::min(amounts[i], std::max(0, capacities[v] - seen_[v]));
    seen_[v] += amounts[i];
  }
  included_[view] = 1;
  ++size_;
}

void ScoreState::remove(int view) {
  if (!included_[view]) return;
  ++evaluations_;
  const auto voxels = score_->voxels_of(view);
  const auto amounts = score_->amounts_of(view);
  const Amount* capacities = score_->capacities().data();
  for (std::size_t i = 0; i < voxels.size(); ++i) {
    const std::uint32_t v = voxels[i];
    seen_[v] -= amounts[i];
    sum_ -= std::min(amounts[i], std::max(0, capacities[v] - seen_[v]));
  }
  included_[view] = 0;
  --size_;
}

}  // namespace lapwing
