// SPDX-License-Identifier: Apache-2.0
// The studio's page as the viewer of a report.
#pragma once

#include <optional>

#include "framework/export/report.h"
#include "framework/mission/mission.h"
#include "framework/verify/certificate.h"

namespace lapwing {

// Of a scan or an exploration: a coarse surface, and at most 1500 samples of the flight. None of
// other missions, and where the program has no page built in.
std::optional<Viewer> viewer_of(const MissionResult& result, const Certificate& certificate);

}  // namespace lapwing
