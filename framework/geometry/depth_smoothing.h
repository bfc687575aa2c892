// SPDX-License-Identifier: Apache-2.0
// Noisy depth, smoothed.
#pragma once

#include <string>

#include "framework/geometry/depth_image.h"

namespace lapwing {

// A window is at most 2 kMostSmoothingReach + 1 pixels wide: beyond, few surfaces are planes.
inline constexpr int kMostSmoothingReach = 5;

// How many pixels a window must reach to each side, so that the mean of the measured ones has a
// standard deviation of at most `wanted` metres; `measured` is their share. Each errs by itself,
// with standard deviation `sigma` (m). 0: no smoothing is needed. At most kMostSmoothingReach.
int smoothing_reach(double sigma, double wanted, double measured);

// Why depth cannot be smoothed to `wanted` m, as the end of a message; "" where it can: there is
// noise, `wanted` is below `sigma`, and the largest window comes so far where a pixel is dropped
// with probability `dropped`.
std::string why_not_smoothed(double sigma, double wanted, double dropped);

// Replaces measured depths by those of planes through the pixels around them. A plane of the world
// is linear in the inverse of depth. It is fitted by least squares (Gauss-Newton, in depth) to a
// window of smoothing_reach(), without pixels that are 2.5 sigma off. Where the window is no single
// plane, the fit begins with the pixels within 3 sigma of the pixel's own depth.
//
// Surfaces that are nearer to each other than about 8 sigma may run into each other, and an
// obstacle that is thinner than half a window vanishes if it is so near to what is behind it: a map
// of smoothed depth is less careful than one of noisy depth.
//
// Pixels without a measurement, and those that found nothing, stay as they are. Errors that
// neighbouring pixels share, as those of stereo, do not shrink. Rows are shared among `threads`;
// the result is the same for any number. Throws InputError for a sigma or a `wanted` that is
// negative or not finite. A `wanted` of 0 m smooths nothing.
void smooth_depth(DepthImage& image, double sigma, double wanted, int threads);

}  // namespace lapwing
