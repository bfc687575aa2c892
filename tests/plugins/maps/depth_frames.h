// SPDX-License-Identifier: Apache-2.0
// Depth images to build maps from: real ones, where they are, and of a street.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "framework/geometry/depth_image.h"

namespace lapwing {

// The folder of test inputs that are not part of the project; none where it is absent.
std::optional<std::filesystem::path> data_folder();

// The first `count` frames of depth/, at most 50.
std::vector<PosedDepthImage> real_frames(int count);

// The shipped scene `street`, about 100 m long, seen by cameras that fly along it at several
// heights and look all around. What no ray hits within 60 m is infinite.
std::vector<PosedDepthImage> street_frames(int count, int width, int height);

}  // namespace lapwing
