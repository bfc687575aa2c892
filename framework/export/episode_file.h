// SPDX-License-Identifier: Apache-2.0
// The episode of an exploration in its run's folder, so that it can be shown image by image without
// planning it again.
//
// episode.json states the format, the program that wrote it, and the checksums of plan.json and of
// the two binary files beside it. A reader shows only what this very program wrote: what an image
// was chosen by depends on the program.
#pragma once

#include <filesystem>
#include <string>

#include "framework/core/folders.h"
#include "framework/core/value.h"
#include "framework/export/exploration_report.h"
#include "framework/trajectory/plan.h"

namespace lapwing {

// An exploration as pages show it: `exploration` of studio/PROTOCOL.md without its blobs.
Value exploration_value(const ExplorationRecord& record);

// One of its images.
Value image_value(const ExplorationImage& image, double observed);

// The voxels of the map by the image after which they were occupied: the text "WLG1", then as
// 32-bit little-endian numbers their count, their edge (m), and for each its middle (three floats,
// m) and its image.
std::string growth_bytes(const ExplorationRecord& record);

// What each image was chosen by: the text "WLE1", then as 32-bit little-endian numbers the counts
// of images, of points along an edge of a slice, of levels and of rays; the edges of the levels
// (floats, m). Then of each image a byte for each point of the slices of occupancy, level by level,
// north-west corner first (0: 0, 255: 1), the same of certainty, and its rays: the end (three
// floats, m), the share of the length where it first meets an unknown voxel (float), and how many
// of these it meets.
std::string sights_bytes(const std::vector<ExplorationSight>& sights);

// episode.json and the files that it names. `plan`: the bytes of plan.json.
NamedContents episode_files(const ExplorationRecord& record, const std::string& plan,
                            const std::string& program);

struct ShownEpisode {
  Plan plan;
  Value exploration;  // as exploration_value
  std::string growth, sights;
};
// Of the folder of a run of an exploration. InputError naming folder and file: what is no such
// folder; an episode of another program or format, with both versions; files that do not belong
// together or are damaged.
ShownEpisode read_episode(const std::filesystem::path& folder, const std::string& program);

}  // namespace lapwing
