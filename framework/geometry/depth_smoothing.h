// SPDX-License-Identifier: Apache-2.0
// Noisy depth, smoothed.
#pragma once

#include "framework/geometry/depth_image.h"

namespace lapwing {

// A window is at most 2 kMostSmoothingReach + 1 pixels wide: beyond, few surfaces are planes.
inline constexpr int kMostSmoothingReach = 5;

// How many pixels a window must reach to each side, so that the mean of the measured ones has a
// standard deviation of at most `wanted` metres; `measured` is their share. Each errs by itself,
// with standard deviation `sigma` (m). 0: no smoothing is needed. At most kMostSmoothingReach.
int smoothing_reach(double sigma, double wanted, double measured);

// Replaces every measured depth by that of a plane through the pixels around it, as far as they
// belong to the same surface: least squares in a window of smoothing_reach(), over the pixels
// within 2.5 sigma of the plane, from the pixel's own depth on. With too few pixels their mean is
// taken. Pixels without a measurement, and those that found nothing, stay as they are.
//
// Errors that neighbouring pixels share, as those of stereo, do not shrink. Rows are shared among
// `threads`; the result is the same for any number. Throws InputError for a sigma or a `wanted`
// that is negative or not finite. A `wanted` of 0 m smooths nothing.
void smooth_depth(DepthImage& image, double sigma, double wanted, int threads);

}  // namespace lapwing
