// SPDX-License-Identifier: Apache-2.0
// The numbers of a report as the JSON that its page script draws from.
#pragma once

#include <string>

#include "framework/export/report.h"

namespace lapwing {

// {"arrays": [[...]], "blocks": [...]}: charts, path views and scenes in the order of the report.
// A vector that occurs several times (time, mostly) is written once, as an index into `arrays`;
// numbers have seven significant digits; null stands for a gap. ASCII, safe inside <script>.
// Throws Error as render_html does.
std::string report_data(const Report& report);

}  // namespace lapwing
