// SPDX-License-Identifier: Apache-2.0
// Values of ways of several views, in place of one (thesis 6.1).
#pragma once

#include <functional>

#include "framework/explore/view_utility.h"

namespace lapwing {

// The views that one move from a view leads to and that are still worth something.
using NextViews = std::function<std::vector<Viewpoint>(const Viewpoint&)>;

// The value of each view is the highest mean, over ways of `length` views that begin with it, of
// the utility's values; a way holds no view twice, and what is missing of it counts 0. All are of
// the map as it is: what the first image of a way will show is not foreseen. How many different
// views the utility was asked for.
int score_ahead(const ViewUtility& utility, const EpisodeView& known,
                std::span<const Viewpoint> views, int length, const NextViews& next,
                std::span<double> values);

}  // namespace lapwing
