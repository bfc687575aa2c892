// SPDX-License-Identifier: Apache-2.0
// What the images of a scan will show, for its report, its answer and its folder.
#pragma once

#include <string>

#include "framework/core/value.h"
#include "framework/export/report.h"
#include "framework/export/scan_report.h"

namespace lapwing {

// m^2 of the counted surface that at least `images` images show.
double area_shown(const ScanPrediction& prediction, int images);
// m^2 of it that the images locate, from two places at least.
double area_located(const ScanPrediction& prediction);

// "Images from at least two places will show 812 m^2 (93 %) of the known surface; there, the median
// is ...".
std::string prediction_in_words(const ScanPrediction& prediction);
// For --json: m^2, m, degrees.
Value prediction_as_value(const ScanPrediction& prediction);
// The words, areas by number of images, figures of the surface, the largest holes with why, and two
// pictures of the accuracy.
Section prediction_section(const ScanPrediction& prediction);

}  // namespace lapwing
