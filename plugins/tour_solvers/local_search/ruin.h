// SPDX-License-Identifier: Apache-2.0
// Taking a part of a tour out, so that something better may come in.
#pragma once

#include <vector>

#include "framework/core/random.h"
#include "framework/view/working_tour.h"

namespace lapwing {

// Which voxels views share, roughly: a bit for every stretch of voxels. Voxels that lie near each
// other have near numbers, so views that share no bit share no voxel, and many shared bits mean
// many shared voxels.
class Overlaps {
 public:
  explicit Overlaps(const ViewScore& score);
  struct Shared {
    int view;
    double share;  // of the stretches that the first view sees, in (0, 1]
  };
  // The other views that see some of what `view` sees. Made when first asked for.
  const std::vector<Shared>& of(int view);

 private:
  struct List {
    bool known = false;
    std::vector<Shared> shared;
  };
  static constexpr int kWords = 8;
  std::vector<std::uint64_t> bits_;  // kWords per view
  std::vector<List> lists_;
};

// What views would bring, as far as it is known, while the tour shrinks and grows.
struct KnownGains {
  std::vector<double> gains;  // per view
  Overlaps* overlaps;         // outlives this object

  // `view` left the tour, whose score fell by `loss`: views that share voxels with it gain.
  void left(const ViewScore& score, int view, double loss);
};

// Takes `view` out of the tour at every place but the ends.
void take_out_view(WorkingTour& tour, int view, KnownGains& known);

// Takes out what is worth least per second that it saves, what was `added` last, until the tour is
// within its budget or nothing more can go.
void shrink_to_budget(WorkingTour& tour, const std::vector<int>& added, KnownGains& known,
                      Random& random);

// Puts up to `count` neighbouring views that are not on the tour in, at least one and over the
// budget if need be, and takes out what is worth least per second that it saves until the tour fits
// again: the way into a cluster that no single view is worth. False where there is none to put in.
bool exchange(WorkingTour& tour, int count, KnownGains& known, Random& random);

// Takes about `count` views out: a stretch of the walk, views near one another, or any.
void ruin(WorkingTour& tour, int count, KnownGains& known, Random& random);

}  // namespace lapwing
