// SPDX-License-Identifier: Apache-2.0
// What the report of a scan shows, beside its plan.
#pragma once

#include "framework/export/scan_report.h"
#include "framework/mission/scan_objects.h"

namespace lapwing {

// `pixel_error`: standard deviation of a point in an image, pixels.
std::shared_ptr<const ScanRecord> record_of_scan(const TourObject& tour, double pixel_error,
                                                 int threads);
// Of the prior's triangles that are `counted`, with images at the graph's `views`.
ScanPrediction prediction_of_scan(const ScanWork& work, const std::vector<int>& views,
                                  std::vector<char> counted, double pixel_error, int threads);

}  // namespace lapwing
