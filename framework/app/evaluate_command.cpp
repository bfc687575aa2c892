// SPDX-License-Identifier: Apache-2.0
// lapwing evaluate scan: rivals on the same candidates, judged by what their images would make.
#include <algorithm>
#include <iostream>

#include "framework/app/command_line.h"
#include "framework/app/input_checksums.h"
#include "framework/app/item_command.h"
#include "framework/app/mission_loading.h"
#include "framework/app/progress_line.h"
#include "framework/app/version.h"
#include "framework/config/shipped.h"
#include "framework/core/checksum.h"
#include "framework/core/file_set.h"
#include "framework/core/files.h"
#include "framework/core/visible_text.h"
#include "framework/mission/data_files.h"
#include "framework/mission/scan_objects.h"
#include "framework/study/scan_photos.h"
#include "framework/study/scan_study.h"
#include "framework/study/scan_tables.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

// Ours first, then its rivals, then the patterns in the two sizes of thesis table 4.3.
constexpr const char* kMethods[] = {"cost_benefit+recursive_greedy+local_search",
                                    "recursive_greedy",
                                    "cost_benefit",
                                    "greedy",
                                    "milp",
                                    "hemisphere_60",
                                    "hemisphere_75",
                                    "circle_50",
                                    "circle_75",
                                    "meander_85x100",
                                    "meander_100x115"};
constexpr double kFirstSpeed = 3, kFirstView = 3;  // m/s and s a view, of a first flight
constexpr double kAboveRegion = 5;  // m, where patterns fly that no first flight tells a height

// Thrown where a mission is about to solve its tour: all that a study needs of it is there.
class TourStated : public Error {
 public:
  TourStated() : Error("a tour was stated") {}
};

double height_of_patterns(const ScanCase& scan) {
  const double floor = scan.region.min().z();
  if (scan.first_flight.empty()) return scan.region.max().z() + kAboveRegion - floor;
  double sum = 0;
  for (const Pose& camera : scan.first_flight) sum += camera.position.z();
  return sum / static_cast<double>(scan.first_flight.size()) - floor;
}

double seconds_of_first_flight(const std::vector<Pose>& cameras) {
  double length = 0;
  for (std::size_t i = 1; i < cameras.size(); ++i) {
    length += (cameras[i].position - cameras[i - 1].position).norm();
  }
  return length / kFirstSpeed + kFirstView * static_cast<double>(cameras.size());
}

// Runs a mission as far as its first tour problem.
ScanCase case_of(const fs::path& script, std::uint64_t seed, const Invocation& given,
                 const Registry& registry, const CancellationToken& cancellation) {
  Invocation invocation = given;
  invocation.seed = seed;
  invocation.quiet = true;
  std::optional<ScanCase> found;
  std::shared_ptr<const MeshScene> surface;
  MissionObservers observers;
  observers.surface = [&](std::shared_ptr<const MeshScene> seen) { surface = std::move(seen); };
  observers.tour = [&](const ScanWork& work, const TourDefinition& definition) {
    ScanCase& scan = found.emplace();
    scan.definition = definition;
    scan.viewpoints = work.graph.candidates.viewpoints;
    for (const Viewpoint& view : work.prior->views) scan.first_flight.push_back(view.camera());
    scan.first_seconds = seconds_of_first_flight(scan.first_flight);
    scan.camera = work.visible->settings().pinhole;
    const InterestRegion& region = work.visible->settings().region;
    if (!region.is_box())
      throw InputError(script.string() +
                       ": evaluate scan compares methods in a box: state region = {lower, upper} "
                       "in place of regions");
    scan.region = region.bounds();
    scan.pattern_height = height_of_patterns(scan);
    const SightSettings& sight = work.visible->settings();
    scan.usable_range = std::min(sight.range, sight.usable_range);
    scan.usable_incidence = sight.usable_incidence;
    scan.viewing.emplace();
    scan.viewing->room = work.allowed;
    scan.viewing->body = work.body;
    scan.leg_seconds = [flight = LegFlight(work)](const Viewpoint& from, const Viewpoint& to) {
      return flight.seconds({from.position, to.position}, from, to);
    };
    throw TourStated();
  };
  const auto mission =
      load_mission(script, invocation, registry, &cancellation, nullptr, {}, observers);
  if (mission->kind() != "scan") {
    throw InputError(script.string() + ": a mission of kind " + mission->kind() +
                     "; evaluate scan takes scans");
  }
  try {
    mission->plan();
  } catch (const TourStated&) {
  }
  if (cancellation.cancelled()) throw Cancelled();
  if (!found) throw InputError(script.string() + ": the mission states no tour");
  if (!surface) {
    throw InputError(script.string() +
                     ": the true surface is not known, only files of a flight; a study "
                     "needs a scene or a mesh");
  }
  found->surface = surface;
  return std::move(*found);
}

// What rows depend on beside the study's own lists: scripts, those that they call, the options that
// come of them and of configurations, mesh files, the program's version.
Value statement_of(const std::vector<fs::path>& scripts, const Invocation& invocation,
                   const Registry& registry) {
  Value value = Value::map();
  value.set("version", LAPWING_VERSION);
  value.set("shipped", checksum_of_folder(shipped_folder("scripts")));
  Value& list = value.set("missions", Value::list());
  for (const fs::path& script : scripts) {
    Value entry = Value::map();
    entry.set("script", sha256(read_file(script)));
    const auto mission = load_mission(script, invocation, registry);
    entry.set("options", mission->configuration());
    const Value* input = mission->configuration().find("input");
    if (input && input->is_text()) {
      std::vector<fs::path> folders{script.parent_path()};
      folders.insert(folders.end(), invocation.data.begin(), invocation.data.end());
      DataFiles files(folders);
      if (fs::exists(input->as_text())) files.allow(input->as_text());
      entry.set("input", sha256(read_file(files.find(input->as_text(), "meshes"))));
    }
    list.push_back(std::move(entry));
  }
  return value;
}

// What is to be measured. `cancellation` ends the preparation of a case.
ScanStudy study_of(const ScanEvaluation& asked, const Invocation& invocation,
                   const Registry& registry, const CancellationToken& cancellation) {
  ScanStudy study;
  std::vector<std::string> methods = asked.methods;
  if (methods.empty()) methods.assign(std::begin(kMethods), std::end(kMethods));
  for (const std::string& method : methods) {
    study.methods.push_back(scan_method(method, registry));
  }
  for (const fs::path& script : asked.missions) {
    if (!fs::is_regular_file(script)) throw InputError("'" + script.string() + "' not found");
    study.missions.push_back(script.stem().string());
  }
  study.seeds = asked.seeds;
  study.budgets = asked.budgets;
  for (const double budget : asked.budgets) {
    if (!(budget > 0)) throw InputError("--budgets: a budget must be above 0 s");
  }
  study.noise = asked.noise;
  study.range = asked.range;
  study.incidence = asked.incidence;
  study.guard = asked.guard;
  study.photos = asked.photos;
  if (asked.photos) require_colmap();
  study.program = std::string("lapwing ") + program_version();
  study.statement = statement_of(asked.missions, invocation, registry);
  study.prepare = [&asked, &invocation, &registry, &cancellation](std::size_t mission,
                                                                  std::size_t seed) {
    return case_of(asked.missions[mission], asked.seeds[seed], invocation, registry, cancellation);
  };
  return study;
}

void write_results(const std::vector<ScanRow>& rows, const fs::path& folder, bool photos,
                   const Invocation& invocation) {
  const std::vector<ScanSummary> summaries = summarise(rows);
  const std::string tables = tables_text(summaries);
  FileSet results{{{"rows.csv", rows_csv(rows)},
                   {"tables.csv", tables_csv(summaries)},
                   {"tables.txt", tables},
                   {"times.txt", times_text(folder / "times")},
                   {"report.html", render_html(study_report(summaries, rows))}}};
  if (photos) results.files.emplace_back("photos.txt", photos_text(folder / "photos"));
  write_files_together(folder, results);
  if (invocation.json) {
    Value object = Value::map();
    object.set("status", "ok");
    object.set("report", (folder / "report.html").string());
    Value& list = object.set("rows", Value::list());
    for (const ScanRow& row : rows) list.push_back(to_value(row));
    print_json(object);
  } else if (!invocation.quiet) {
    std::cout << visible_text(tables)
              << "\nreport: " << visible_line((folder / "report.html").string()) << std::endl;
  }
}

}  // namespace

ExitStatus evaluate_scan(const ScanEvaluation& asked, const Invocation& invocation) {
  const Registry registry = invocation.registry();
  return run_items(
      asked.items, invocation, registry, [&](ItemRun& run, const CancellationToken& cancellation) {
        const ScanStudy study = study_of(asked, invocation, registry, cancellation);
        const fs::path folder =
            invocation.out.empty() ? fs::path("out") / "evaluate_scan" : invocation.out;
        std::optional<FolderClaim> claim;
        const auto rows = run_study(
            study, folder, run, registry, &cancellation,
            [&] { claim.emplace(folder, claim_for(asked.items)); },
            [&](const std::string& line) {
              if (!invocation.quiet) std::cerr << visible_text(line) << std::endl;
            });
        if (!rows) return print_answer(run, invocation);
        write_results(*rows, folder, asked.photos, invocation);
        return ExitStatus::done;
      });
}

}  // namespace lapwing
