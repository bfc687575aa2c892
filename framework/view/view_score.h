// SPDX-License-Identifier: Apache-2.0
// How good a set of views is: saturated coverage, summed over voxels (thesis 4.2, 4.4 to 4.6).
//
//   f(S) = sum over voxels of min(capacity, sum of what the views in S contribute)
//
// Contributions are at least 0, so f is monotone and submodular. An additive score, as of the
// orienteering problem, is the case of one voxel a view. Amounts are kept as whole multiples of a
// unit, a power of two: sums are exact, do not depend on the order of adding and removing, and
// views may be taken back.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lapwing {

class ViewScore {
 public:
  using Amount = std::int32_t;
  struct Contribution {
    std::uint32_t voxel = 0;
    float amount = 0;  // at least 0; more than the voxel's weight is the weight
  };

  int views() const { return static_cast<int>(first_.size()) - 1; }
  std::size_t voxels() const { return capacities_.size(); }
  // By voxel, each voxel once.
  std::span<const std::uint32_t> voxels_of(int view) const {
    return {voxels_.data() + first_[view], first_[view + 1] - first_[view]};
  }
  std::span<const Amount> amounts_of(int view) const {
    return {amounts_.data() + first_[view], first_[view + 1] - first_[view]};
  }
  std::span<const Amount> capacities() const { return capacities_; }
  double unit() const { return unit_; }
  // f of one view alone.
  double alone(int view) const { return static_cast<double>(alone_[view]) * unit_; }
  // f of all views together.
  double total() const;
  std::size_t bytes() const;

 private:
  friend class ViewScoreBuilder;
  friend ViewScore additive_score(std::span<const double> scores);
  friend ViewScore with_bonus(const ViewScore& score, std::span<const int> views);
  std::vector<std::size_t> first_{0};
  std::vector<std::uint32_t> voxels_;
  std::vector<Amount> amounts_;
  std::vector<Amount> capacities_;
  std::vector<std::int64_t> alone_;  // per view
  double unit_ = 1;
};

// Takes the views one after the other, so that nothing is held twice.
class ViewScoreBuilder {
 public:
  // `weights`: what a voxel counts when it is seen fully; empty for 1 each. At least 0, finite.
  // Amounts are rounded to 2^-20 of the largest weight's next power of two. InputError otherwise.
  explicit ViewScoreBuilder(std::size_t voxels, std::span<const double> weights = {});

  // Without voxels so far, and with weights of up to `largest` to come: above 0, finite.
  static ViewScoreBuilder growing(double largest);

  // One more voxel, behind those that there are. InputError for too many, and for a weight that is
  // larger than those that the amounts are rounded for.
  void add_voxel(double weight = 1);

  // The next view. Voxels in any order, each at most once. InputError names view and voxel.
  void add_view(std::span<const ViewScore::Contribution> contributions);

  ViewScore take() &&;

 private:
  ViewScore score_;
  double largest_ = 1;              // of all weights
  std::vector<std::int64_t> sums_;  // per voxel, of all views
  std::vector<ViewScore::Contribution> sorted_;
};

// A score per view that does not depend on the others: at least 0 and finite; whole numbers below
// 2^30 stay exact.
ViewScore additive_score(std::span<const double> scores);

// The same, but that each of `views`, ascending, counts more than everything that there is to see:
// a set that holds one more of them is always better. What one counts more is `bonus_over`.
ViewScore with_bonus(const ViewScore& score, std::span<const int> views);
double bonus_over(const ViewScore& score);

// The score of a growing and shrinking set of views, evaluated step by step. Every look at a view's
// voxels counts as one evaluation: a gain, a loss, an adding, a removing. Copyable.
class ScoreState {
 public:
  explicit ScoreState(const ViewScore& score);  // which outlives this object

  double score() const { return static_cast<double>(sum_) * score_->unit(); }
  bool contains(int view) const { return included_[view] != 0; }
  int size() const { return size_; }
  // What adding `view` would bring; 0 for one that is included.
  double gain(int view);
  // What removing `view` would cost; 0 for one that is not included.
  double loss(int view);
  void add(int view);     // does nothing for one that is included
  void remove(int view);  // likewise for one that is not

  const ViewScore& of() const { return *score_; }
  std::int64_t evaluations() const { return evaluations_; }
  // For a copy that takes the place of another one: the work goes on.
  void set_evaluations(std::int64_t evaluations) { evaluations_ = evaluations; }

 private:
  const ViewScore* score_;
  std::vector<ViewScore::Amount> seen_;  // per voxel, not saturated
  std::vector<char> included_;
  std::int64_t sum_ = 0;
  int size_ = 0;
  std::int64_t evaluations_ = 0;
};

}  // namespace lapwing
