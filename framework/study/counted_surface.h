// SPDX-License-Identifier: Apache-2.0
// The ground truth of a study of scans: which points of a true surface count. That takes long, so
// it is kept as a file for all seeds, methods and continuations of a study.
//
// A file is one line, "lapwing counted surface 1 KEY POINTS COUNTED SHA256", and a bit for each
// point, the lowest of each byte first. KEY is the SHA-256 of all that it follows from: the mesh,
// the region, the judge's grid, range and incidence, the room and the vehicle's body. SHA256 is
// that of the bits.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "framework/surface/reconstruction.h"
#include "framework/surface/viewing_space.h"

namespace lapwing {

// Makes `sample` count what can be seen from free places that are joined to `from` (m), and says in
// one line what share that is. Reads the file `NAME_<first digits of KEY>.counted` of the folder,
// or makes and writes it. InputError for a file that is damaged, and as ViewingSpace.
void count_visible(SurfaceSample& sample, const std::shared_ptr<const MeshScene>& surface,
                   const ReconstructionSettings& judge, const ViewingSettings& viewing,
                   std::span<const Eigen::Vector3d> from, const std::filesystem::path& folder,
                   const std::string& name, int threads,
                   const std::function<void(const std::string&)>& say);

}  // namespace lapwing
