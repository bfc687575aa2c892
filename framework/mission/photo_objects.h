// SPDX-License-Identifier: Apache-2.0
// Images of a real first flight as Lua holds them.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "framework/mission/run.h"
#include "framework/photogrammetry/image_overview.h"
#include "framework/surface/point_fusion.h"

namespace lapwing {

struct FlightImages {
  std::string name;                           // of their folder
  std::shared_ptr<const DepthSource> source;  // in the world's frame
  std::vector<FusedPoint> points;             // of the surface beside the depth images, world
  Similarity to_world;                        // from the frame of the files
  ImageOverview overview;                     // in the world's frame
  std::vector<std::string> notes;             // sentences for the user
  bool dense = true;  // most pixels of the depth images measure; false: they are of points
};

// The parameters of run:read_colmap, and what it reads; the overview is left to the caller.
ParameterTable colmap_table();
FlightImages read_colmap_images(const Parameters& given, const MissionRun& run);

struct FlightImagesObject {
  std::shared_ptr<const FlightImages> images;
};

inline constexpr const char* kFlightImagesType = "flight images";

// Adds the type above; after open_lapwing_library.
void open_photo_library(lua_State* state);
std::span<const Binding> photo_methods_of_run();    // read_depth_images, read_colmap
std::span<const Binding> photo_methods_of_prior();  // take_images, free_views

}  // namespace lapwing
