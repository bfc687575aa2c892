// SPDX-License-Identifier: Apache-2.0
// Measuring scan tours as the thesis does (4.5, 4.9): methods against each other on the same
// candidates, by what their images would make of the true surface.
//
// A study is a list of cases (a mission and a seed), budgets and methods; a row is what one method
// did in one case with one budget. Every row is an item (framework/items): a file, written whole. A
// study that was ended at any moment goes on from those that are there, and ends with the same
// bytes.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/progress.h"
#include "framework/core/value.h"
#include "framework/items/item_run.h"
#include "framework/plugin/registry.h"
#include "framework/study/scan_row.h"
#include "framework/surface/viewing_space.h"
#include "framework/view/pattern_tour.h"
#include "framework/view/tour_solver.h"

namespace lapwing {

// All that methods may know, and the truth for judging them.
struct ScanCase {
  TourDefinition definition;  // of which the budget is the mission's own
  std::vector<Viewpoint> viewpoints;
  std::vector<Pose> first_flight;  // cameras
  double first_seconds = 0;        // of the first flight
  Pinhole camera;
  Eigen::AlignedBox3d region;
  double pattern_height = 30;                // m above the region's floor
  LegSeconds leg_seconds;                    // of patterns flown freely: as of every other tour
  std::shared_ptr<const MeshScene> surface;  // the true one
  // m and rad, of what planning takes to be of use to a model.
  double usable_range = ReconstructionSettings{}.range;
  double usable_incidence = ReconstructionSettings{}.incidence;
  // Where vehicles fly; absent: all of the surface counts. Its range and incidence are the judge's.
  std::optional<ViewingSettings> viewing;
};

struct ScanStudy {
  std::vector<std::string> missions;  // names, each once
  std::vector<std::uint64_t> seeds;
  std::vector<double> budgets;  // s; empty: each mission's own
  std::vector<ScanMethod> methods;
  std::optional<DepthNoise> noise;         // of the judged depth; absent: ideal
  std::optional<double> guard = 300;       // s of wall clock for one solver
  ReconstructionSettings reconstruction;   // its region, range and incidence are the case's
  std::optional<double> range, incidence;  // m and rad, that are judged by in place of the case's
  Value statement;      // of all else that rows depend on: scripts, configurations
  bool photos = false;  // whether COLMAP is asked to register photographs (study/scan_photos.h)
  std::string program;  // name and version, for the rows' marks (items/statement.h)
  // Makes a case: mission and seed, by their places. A process calls it when it begins rows of the
  // case.
  std::function<ScanCase(std::size_t mission, std::size_t seed)> prepare;
};

// What a case is judged by.
ReconstructionSettings judged_by(const ScanStudy& study, const ScanCase& scan);

// One row; `work_seconds` is set to what planning took, `cameras` to the tour's images.
ScanRow measure(const ScanCase& scan, const TourProblem& problem, const SurfaceSample& surface,
                const ScanMethod& method, const ScanStudy& study, std::uint64_t seed,
                const Registry& registry, const CancellationToken* cancellation,
                double& work_seconds, std::vector<Pose>& cameras);

// Rows of the whole study in their order: mission, budget, method, seed. Files go to `folder`:
// study.json, rows/, times/, surface/ (study/counted_surface.h) and, with photographs, photos/. The
// rows are the items of `run`, and those of one case are a group; nothing where `run` leaves no
// results to this process. `claim` is called in process 0 before the folder is used. Without an
// option that continues a study, a folder with another study's rows is refused, with it one of a
// study that differs. InputError; Cancelled when told to stop, rows so far are kept.
std::optional<std::vector<ScanRow>> run_study(const ScanStudy& study,
                                              const std::filesystem::path& folder, ItemRun& run,
                                              const Registry& registry,
                                              const CancellationToken* cancellation,
                                              const std::function<void()>& claim,
                                              const std::function<void(const std::string&)>& say);

}  // namespace lapwing
