// SPDX-License-Identifier: Apache-2.0
// Means of values that come in groups, such as those of one world, and how sure they are.
#pragma once

#include <cstddef>
#include <vector>

namespace lapwing {

// Figures that there are too few values for are not a number.
class StratifiedSample {
 public:
  // To the first group.
  void add(double value);
  // The other's groups as groups of their own.
  void join(const StratifiedSample& other);

  std::size_t count() const;
  double mean() const;
  // The sample's standard deviation, whatever the group.
  double deviation() const;
  // Half the width of the 95 % interval of the mean, by Student's t. Groups are strata: what lies
  // between their means is no chance, and a group of one value leaves it open.
  double interval() const;

 private:
  std::vector<std::vector<double>> groups_;
};

}  // namespace lapwing
