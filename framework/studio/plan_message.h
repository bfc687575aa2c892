// SPDX-License-Identifier: Apache-2.0
// Plans, certificates and surroundings as a page draws them (PROTOCOL.md). SI, radians.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "framework/solve/trajectory_solver.h"
#include "framework/trajectory/plan.h"
#include "framework/vehicle/closed_loop.h"
#include "framework/verify/certificate.h"

namespace lapwing {

struct ExplorationRecord;  // export/exploration_report.h
struct TakenImage;         // likewise
struct ScanRecord;         // export/scan_report.h

// `plan` of an answer. `distances`: with the distance to the nearest obstacle, whose shapes are
// then open. Numbers have 7 digits, times 9. A plan whose vehicle cannot be read has no camera and
// no limits.
std::string plan_message(const Plan& plan, const SolveReport& report, bool distances);

// `certificate` of an answer.
std::string certificate_message(const Certificate& certificate);

// `samples` of a flight: the columns time, x, y, z, qw to qz of the camera, position_error.
std::string flown_message(const FlownPath& flown, const Trajectory& planned);

// `image` without its type, revision and `sights`.
std::string image_message(const TakenImage& image);

// What a mission was planned on beside its plan, each null where there is none.
struct PlannedOn {
  const ScanRecord* scan = nullptr;
  const ExplorationRecord* exploration = nullptr;
  std::vector<const Plan*> tours = {};  // of several batteries: all of them
  // Small enough for a page that is a file: a coarse surface in place of maps and meshes.
  bool coarse = false;
};

// The message `world`, and the blobs that it names. Surfaces that were drawn before are taken from
// `drawn`, by what states them.
struct WorldMessage {
  std::string text;
  std::map<std::string, std::string> blobs;  // by name
};
using DrawnSurfaces = std::map<std::string, std::string>;  // what states it, and its blob
WorldMessage world_message(const Plan& plan, const std::filesystem::path& folder,
                           const PlannedOn& on, DrawnSurfaces& drawn);

}  // namespace lapwing
