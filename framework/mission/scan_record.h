// SPDX-License-Identifier: Apache-2.0
// What the report of a scan shows, beside its plan.
#pragma once

#include <span>

#include "framework/export/scan_report.h"
#include "framework/mission/scan_objects.h"

namespace lapwing {

struct MissionRun;

// `pixel_error`: standard deviation of a point in an image, pixels.
std::shared_ptr<const ScanRecord> record_of_scan(const TourObject& tour, double pixel_error,
                                                 int threads);
// Of one tour of a fleet, for tour_sections.
std::shared_ptr<const ScanRecord> record_of_tour(const TourObject& tour);
// What all tours of a fleet show together, for fleet_sections. They are of one graph, one at least.
std::shared_ptr<const ScanRecord> record_of_fleet(std::span<const TourObject> tours,
                                                  double pixel_error, int threads);

// Of a result: where it holds what the images will show.
struct ToldScan {
  Value& block;                     // figures, for --json; null or a map
  std::vector<std::string>& notes;  // sentences for the user
  std::vector<std::string>& told;   // likewise, that stand in no plan
};
// Adds what a record with a prediction says; keeps prediction.ply and prediction.glb among the
// files of the run.
void tell_scan(const ScanRecord& record, MissionRun& run, const ToldScan& result);
// Of the prior's triangles that are `counted`, with images at the graph's `views`.
ScanPrediction prediction_of_scan(const ScanWork& work, const std::vector<int>& views,
                                  std::vector<char> counted, double pixel_error, int threads);

// What images at the graph's `views` see of the prior mesh.
SurfaceAreas areas_seen(const ScanWork& work, const std::vector<int>& views, int threads);

// m^2 of the prior mesh in the region, and of it what images at the graph's `views` locate with a
// standard deviation of at most `accuracy` (m) in the worst direction.
struct AccurateArea {
  double known = 0, accurate = 0;
};
AccurateArea accurate_area(const ScanWork& work, const std::vector<int>& views, double accuracy,
                           double pixel_error, int threads);

}  // namespace lapwing
