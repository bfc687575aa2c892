// SPDX-License-Identifier: Apache-2.0
// What the report of a scan shows, beside its plan.
#pragma once

#include "framework/export/scan_report.h"
#include "framework/mission/scan_objects.h"

namespace lapwing {

std::shared_ptr<const ScanRecord> record_of_scan(const TourObject& tour, int threads);

}  // namespace lapwing
