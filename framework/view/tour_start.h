// SPDX-License-Identifier: Apache-2.0
// Which views motions join, and where a tour may begin so that it reaches many of them.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "framework/view/motions.h"
#include "framework/view/viewpoint.h"

namespace lapwing {

class ViewIslands {
 public:
  // `motions` join views below `count`.
  ViewIslands(std::size_t count, std::span<const ViewMotion> motions);

  // Views that are joined to `view`, directly or through others, itself included.
  int joined(int view) const;
  // Whether two views are joined so.
  bool joins(int a, int b) const {
    return island_[static_cast<std::size_t>(a)] == island_[static_cast<std::size_t>(b)];
  }
  // Of the first `given` views, one at least, the first that most others are joined to.
  int best_start(int given) const;

  struct Island {
    int views = 0;
    int middle = -1;  // the view nearest to the mean of their places
  };
  // The largest island that `view` is not on; nothing where all views are joined to it.
  std::optional<Island> largest_beside(int view, std::span<const Viewpoint> views) const;

 private:
  std::vector<int> island_;  // per view: the lowest number on its island
  std::vector<int> sizes_;   // per such number
};

}  // namespace lapwing
