// SPDX-License-Identifier: Apache-2.0
// What the images of a scan will show, as meshes in its colours.
#pragma once

#include <string>
#include <vector>

#include "framework/export/scan_report.h"

namespace lapwing {

// Of the located area, the value that `share` of it does not exceed; NaN without such area.
double area_quantile(const ScanPrediction& prediction, float TrianglePrediction::*value,
                     double share);

// From where to where colours of accuracies reach, m.
struct PredictionColors {
  double best = 0, worst = 0;
};
PredictionColors prediction_colors(const ScanPrediction& prediction);
// Triangles in the colours of their accuracy, on a logarithmic scale, or of why they have none.
std::vector<Rgb> triangle_colors(const ScanPrediction& prediction, const PredictionColors& range);

// Binary PLY of the surface, coloured by accuracy. Every face has `images`, `incidence_deg`,
// `mm_per_pixel`, `parallax_deg` and `accuracy_mm`; -1 where there is no such figure. Outside the
// region `images` is -1, too.
std::string prediction_ply(const ScanPrediction& prediction);
// A coarse stand-in for pages that are files: at most `most` triangles, the corners within a cell
// of a grid drawn as one. Each has the colour and the figures of one triangle of the surface. The
// text "WLP1", counts of corners and triangles (32-bit little-endian), the lower corner and the
// size of the box (six floats, m); three 16-bit shares of the box a corner; and of each triangle
// its three corners and `images` (16-bit), its colour (three bytes), a 0, and its four figures
// without the lowest of their four bytes. InputError for fewer than 1 triangle or more than
// kMostCoarse.
inline constexpr std::size_t kMostCoarse = 60000;
std::string coarse_prediction(const ScanPrediction& prediction, std::size_t most);
// The same as binary glTF 2.0, y up. Corners have the colour of their triangle, and its figures as
// attributes `_IMAGES`, `_INCIDENCE_DEG`, `_MM_PER_PIXEL`, `_PARALLAX_DEG` and `_ACCURACY_MM`.
std::string prediction_glb(const ScanPrediction& prediction);

}  // namespace lapwing
