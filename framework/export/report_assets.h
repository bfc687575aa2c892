// SPDX-License-Identifier: Apache-2.0
// Style and scripts of the report page, as the build embeds them (embed_assets.cmake).
#pragma once

#include <string_view>

namespace lapwing {

extern const std::string_view kReportStyle;   // report.css
extern const std::string_view kReportScript;  // report_*.js in the order of the build list

}  // namespace lapwing
