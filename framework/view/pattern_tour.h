// SPDX-License-Identifier: Apache-2.0
// The regular patterns that planned tours are measured against (thesis 4.5.4, 4.8; reading 4.10):
// circle, ellipse, meander and hemisphere.
//
// A pattern is a list of wanted viewpoints. Circle, ellipse and meander are flown freely at a safe
// height, where nothing need be known. A hemisphere comes down between what stands there: it is
// laid on the views of a tour problem. Each of its viewpoints takes the candidate nearest to it, in
// place and in direction; those are joined by shortest ways, whose views cost and count like all
// others. Where that is more than the budget fewer of the viewpoints are taken, evenly.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "framework/view/tour_problem.h"
#include "framework/view/viewpoint.h"

namespace lapwing {

enum class PatternKind { circle, ellipse, meander, hemisphere };
const char* to_string(PatternKind kind);

struct Pattern {
  PatternKind kind = PatternKind::circle;
  // m. Circle and hemisphere: the radius twice. Ellipse: half axes along x and y. Meander: edges of
  // the rectangle.
  double along_x = 50, along_y = 50;
  int views = 120;  // wanted
  // m above the region's floor, of circle, ellipse and meander; a hemisphere stands on that floor.
  double height = 30;
};

// "circle_50", "meander_85x100:views=256": as tables name it.
std::string name_of(const Pattern& pattern);
// What `name_of` writes. Without `:views=N`, N from 1 to 10,000, the thesis's numbers of views:
// circles 120, ellipses and hemispheres 160, meanders 144. InputError otherwise, saying what is
// known.
Pattern pattern_named(const std::string& name, double height);

// In the order in which they are flown. Circle and ellipse look at the region's middle, so does the
// hemisphere from rings between 10 and 80 degrees above its floor; the meander looks straight down
// and goes there and back along y. InputError for a pattern without views or size, and for an empty
// region.
std::vector<Viewpoint> pattern_viewpoints(const Pattern& pattern,
                                          const Eigen::AlignedBox3d& region);

// Whether it stays at its height, where the air is free.
bool flown_freely(PatternKind kind);

// Of a way straight from view to view, the view at its end included, s.
using LegSeconds = std::function<double(const Viewpoint& from, const Viewpoint& to)>;

struct FreePattern {
  std::vector<Viewpoint> views;  // in the order in which images are taken; empty: none fits
  double seconds = 0;            // from the first view to the last one
  std::string message;           // one sentence: whether the budget sufficed
};

// The pattern's viewpoints straight one after the other, as many of them, evenly, as the budget in
// s allows; it may begin and end anywhere. InputError for a pattern without viewpoints.
FreePattern fly_freely(const std::vector<Viewpoint>& pattern, double budget,
                       const LegSeconds& leg_seconds);

struct PatternTour {
  // A tour of the problem; empty where not even one viewpoint of the pattern fits.
  std::vector<int> walk;
  int asked = 0;     // viewpoints of the pattern
  int wanted = 0;    // different candidates that these take
  double moved = 0;  // m, by which candidates are off their viewpoints, on average
  int flown = 0;     // of those
  // s: what the whole pattern takes.
  double whole_seconds = std::numeric_limits<double>::infinity();
  std::string message;  // one sentence: whether the budget sufficed
};

// `metres_per_radian`: what a difference of direction counts beside one of place. Views that cannot
// be reached from start and end are no candidates. A pattern is begun at one of its ends or at its
// viewpoint nearest to the start, as is quickest. InputError when `viewpoints` has not one entry
// per view.
PatternTour fly_pattern(const TourProblem& problem, const std::vector<Viewpoint>& viewpoints,
                        const std::vector<Viewpoint>& pattern, double metres_per_radian = 10);

}  // namespace lapwing
