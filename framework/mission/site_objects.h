// SPDX-License-Identifier: Apache-2.0
// Sites as Lua holds them, and what functions that read them share.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "framework/mission/run.h"
#include "framework/mission/site_work.h"

namespace lapwing {

struct SiteObject {
  std::shared_ptr<const Site> site;
};

inline constexpr const char* kSiteType = "site";

// Adds the type above; after open_lapwing_library.
void open_site_library(lua_State* state);
std::span<const Binding> site_methods_of_run();    // read_cloud, read_terrain
std::span<const Binding> site_methods_of_prior();  // add_site
std::span<const Binding> city_methods_of_run();    // read_city

// What every reader of a site takes.
ParameterTable site_reference_table();
StatedReference stated_reference(const Parameters& given, const MissionRun& run);
std::optional<Eigen::AlignedBox2d> kept_box(const Parameters& given);
MapWork site_work_of(const MissionRun& run);
// Prints what it is, takes its origin where the mission has none, and leaves it on the stack.
int push_site(lua_State* state, Site site);

}  // namespace lapwing
