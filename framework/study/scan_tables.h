// SPDX-License-Identifier: Apache-2.0
// What a study of scan tours comes to: tables as in thesis 4.2 to 4.7 and 4.9, curves as in figure
// 4.12, as text, CSV and a page.
#pragma once

#include <string>
#include <vector>

#include "framework/export/report.h"
#include "framework/study/scan_study.h"

namespace lapwing {

struct MeanOf {
  double mean = 0, error = 0;  // standard error; 0 for a single one
};

// One method with one budget on one mission, over all seeds.
struct ScanSummary {
  std::string mission, method;
  double budget = 0;
  int rows = 0;     // asked for
  int counted = 0;  // of them with a tour that counts
  bool reproducible = true;
  double surface_share = 1;     // of the region's surface, that recall is measured against
  MeanOf precision, recall, f;  // with the first flight's images
  MeanOf precision_alone, recall_alone, f_alone;  // without
  MeanOf score, score_share, seconds, images, gap;
};

// In the order of the rows.
std::vector<ScanSummary> summarise(const std::vector<ScanRow>& rows);

// Tables of a fixed width, one for each mission and budget.
std::string tables_text(const std::vector<ScanSummary>& summaries);
std::string tables_csv(const std::vector<ScanSummary>& summaries);
std::string rows_csv(const std::vector<ScanRow>& rows);
Report study_report(const std::vector<ScanSummary>& summaries, const std::vector<ScanRow>& rows);

// What each method takes (table 4.9), from the files that a study leaves in its folder `times`.
// The wall clock has a part in it.
std::string times_text(const std::filesystem::path& folder);

// How many photographs COLMAP registered, from the folder `photos` of a study.
std::string photos_text(const std::filesystem::path& folder);

}  // namespace lapwing
