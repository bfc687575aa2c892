// SPDX-License-Identifier: Apache-2.0
// The report page of a map.
#pragma once

#include <string>
#include <vector>

#include "framework/export/report.h"
#include "framework/map/map.h"

namespace lapwing {

struct MapReport {
  std::string title;
  std::string plugin;                        // "brick"
  std::string source;                        // what went in, for the summary; may be empty
  std::size_t scans = 0;                     // 0: it was read from a file
  const Map* map = nullptr;                  // outlives the call
  std::vector<PosedDepthImage> images = {};  // a few of those that went in
  bool cancelled = false;
};

Report map_report(const MapReport& given);

}  // namespace lapwing
