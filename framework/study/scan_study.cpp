// SPDX-License-Identifier: Apache-2.0
#include "framework/study/scan_study.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <set>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/parallel.h"
#include "framework/study/counted_surface.h"
#include "framework/study/scan_photos.h"
#include "framework/study/stopwatch.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

// A file's name of what a row is called.
std::string file_name(const std::string& text) {
  std::string name = text;
  for (char& c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '-' || c == '.' || c == '+' || c == '=' || c == ',';
    if (!plain) c = '_';
  }
  return name;
}

// Places in a study.
struct RowPlace {
  std::size_t mission, budget, method, seed;
};

class StudyRun {
 public:
  StudyRun(const ScanStudy& study, fs::path folder, const Registry& registry,
           const CancellationToken* cancellation,
           const std::function<void(const std::string&)>& say)
      : study_(study),
        folder_(std::move(folder)),
        registry_(registry),
        cancellation_(cancellation),
        say_(say) {}

  void begin(bool resume) const {
    const std::string stated = to_json(statement()) + "\n";
    const fs::path file = folder_ / "study.json";
    if (!fs::exists(file)) {
      if (fs::exists(folder_ / "rows")) {
        throw InputError("'" + folder_.string() + "' has rows, but no study");
      }
      write_file_atomically(file, stated);
      return;
    }
    if (!resume) {
      throw InputError(
          "'" + folder_.string() +
          "' contains a study: continue it with --resume, or name another folder with --out");
    }
    if (read_file(file) != stated) {
      throw InputError("'" + file.string() +
                       "' states another study (missions, methods, seeds, budgets, options or "
                       "scripts differ): --resume continues the same one only");
    }
  }

  std::vector<ScanRow> run() const {
    for (std::size_t m = 0; m < study_.missions.size(); ++m) {
      for (std::size_t s = 0; s < study_.seeds.size(); ++s) run_case(m, s);
    }
    std::vector<ScanRow> rows;
    for (std::size_t m = 0; m < study_.missions.size(); ++m) {
      for (std::size_t b = 0; b < budgets(); ++b) {
        for (std::size_t k = 0; k < study_.methods.size(); ++k) {
          for (std::size_t s = 0; s < study_.seeds.size(); ++s) {
            const fs::path file = file_of({m, b, k, s}, "rows");
            rows.push_back(scan_row_from(from_json(read_file(file), file.string())));
          }
        }
      }
    }
    return rows;
  }

 private:
  std::size_t budgets() const { return std::max<std::size_t>(1, study_.budgets.size()); }

  Value statement() const {
    Value value = Value::map();
    value.set("format", 2);
    const auto list = [&](const char* key, const auto& entries, const auto& entry_of) {
      Value& made = value.set(key, Value::list());
      for (const auto& entry : entries) made.push_back(entry_of(entry));
    };
    list("missions", study_.missions, [](const std::string& name) { return Value(name); });
    list("seeds", study_.seeds,
         [](std::uint64_t seed) { return Value(static_cast<std::int64_t>(seed)); });
    list("budgets", study_.budgets, [](double budget) { return Value(budget); });
    list("methods", study_.methods, [](const ScanMethod& method) { return Value(method.name); });
    if (study_.noise) {
      Value& noise = value.set("noise", Value::map());
      noise.set("dropped", study_.noise->dropped);
      noise.set("sigma", study_.noise->sigma);
    }
    if (study_.range) value.set("range", *study_.range);
    if (study_.incidence) value.set("incidence", *study_.incidence);
    if (study_.guard) value.set("guard", *study_.guard);
    if (study_.photos) value.set("photos", true);
    value.set("from", study_.statement);
    return value;
  }

  fs::path file_of(const RowPlace& at, const char* kind) const {
    std::string name =
        study_.missions[at.mission] + "_seed" + std::to_string(study_.seeds[at.seed]);
    if (!study_.budgets.empty()) {
      char text[40];
      std::snprintf(text, sizeof text, "_%gs", study_.budgets[at.budget]);
      name += text;
    }
    return folder_ / kind / (file_name(name + "_" + study_.methods[at.method].name) + ".json");
  }

  void run_case(std::size_t m, std::size_t s) const {
    std::vector<RowPlace> missing;
    for (std::size_t b = 0; b < budgets(); ++b) {
      for (std::size_t k = 0; k < study_.methods.size(); ++k) {
        if (!fs::exists(file_of({m, b, k, s}, "rows"))) missing.push_back({m, b, k, s});
      }
    }
    if (missing.empty()) return;
    const std::string name = study_.missions[m] + ", seed " + std::to_string(study_.seeds[s]);
    say_(name + ": candidates and motions");
    const Stopwatch preparing;
    const ScanCase scan = study_.prepare(m, s);
    const double prepared = preparing.seconds();
    const SurfaceSample surface = ground_truth(scan, study_.missions[m]);
    // One problem for each budget: its shortest ways serve all methods.
    std::vector<TourProblem> problems;
    for (std::size_t b = 0; b < budgets(); ++b) {
      TourDefinition definition = scan.definition;
      if (!study_.budgets.empty()) definition.budget = study_.budgets[b];
      problems.emplace_back(std::move(definition));
    }
    say_(name + ": " + std::to_string(scan.viewpoints.size()) + " candidates, " +
         std::to_string(problems.back().reachable().size()) +
         " of them connected to the start within the budget; " + std::to_string(missing.size()) +
         " rows");
    parallel_for(missing.size(), study_.threads, [&](std::size_t i) {
      if (cancellation_ && cancellation_->cancelled()) throw Cancelled();
      const RowPlace& at = missing[i];
      double seconds = 0;
      std::vector<Pose> cameras;
      ScanRow row = measure(scan, problems[at.budget], surface, study_.methods[at.method], study_,
                            study_.seeds[s], registry_, cancellation_, seconds, cameras);
      row.mission = study_.missions[m];
      Value time = Value::map();
      time.set("mission", row.mission);
      time.set("method", row.method);
      time.set("budget", row.budget);
      time.set("seed", static_cast<std::int64_t>(row.seed));
      time.set("first_flight", scan.first_seconds);
      time.set("flight", row.seconds);
      time.set("prepare", prepared);
      time.set("plan", seconds);
      write_file_atomically(file_of(at, "times"), to_json(time) + "\n");
      if (study_.photos && row.found) take_photos(at, scan, cameras, row);
      write_file_atomically(file_of(at, "rows"), to_json(to_value(row)) + "\n");
      char score[40] = "", text[120];
      if (std::isfinite(row.score_share))
        std::snprintf(score, sizeof score, ", score %.1f %%", 100 * row.score_share);
      std::snprintf(text, sizeof text, ": F %.2f %%%s, %d images, %.0f s", 100 * row.with_first.f,
                    score, row.images, row.seconds);
      say_(name + ", " + row.method + (row.found ? text : ": no tour (" + row.message + ")"));
    });
  }

  SurfaceSample ground_truth(const ScanCase& scan, const std::string& mission) const {
    const ReconstructionSettings judge = judged_by(study_, scan);
    SurfaceSample surface(scan.surface->mesh(), judge, study_.threads);
    if (!scan.viewing) return surface;
    std::vector<Eigen::Vector3d> from;
    for (const Pose& camera : scan.first_flight) from.push_back(camera.position);
    count_visible(surface, scan.surface, judge, *scan.viewing, from, folder_ / "surface",
                  file_name(mission), study_.threads, say_);
    return surface;
  }

  // Before the row is written: where there is a row there is what its photographs came to.
  void take_photos(const RowPlace& at, const ScanCase& scan, const std::vector<Pose>& cameras,
                   const ScanRow& row) const {
    fs::path folder = file_of(at, "photos");
    folder.replace_extension();
    const Registered found =
        register_photos(*scan.surface, cameras, scan.camera, folder, 1, cancellation_);
    Value value = Value::map();
    value.set("mission", row.mission);
    value.set("method", row.method);
    value.set("budget", row.budget);
    value.set("seed", static_cast<std::int64_t>(row.seed));
    value.set("images", found.images);
    value.set("largest", found.largest);
    value.set("models", found.models);
    write_file_atomically(folder / "registered.json", to_json(value) + "\n");
    say_(row.mission + ", " + row.method + ": " + std::to_string(found.largest) + " of " +
         std::to_string(found.images) + " photographs in one model");
  }

  const ScanStudy& study_;
  fs::path folder_;
  const Registry& registry_;
  const CancellationToken* cancellation_;
  const std::function<void(const std::string&)>& say_;
};

template <class T>
void require_different(const std::vector<T>& entries, const std::string& what) {
  if (entries.empty()) throw InputError("evaluate: no " + what);
  if (std::set<T>(entries.begin(), entries.end()).size() != entries.size()) {
    throw InputError("evaluate: the same " + what + " twice");
  }
}

}  // namespace

std::vector<ScanRow> run_study(const ScanStudy& study, const fs::path& folder, bool resume,
                               const Registry& registry, const CancellationToken* cancellation,
                               const std::function<void(const std::string&)>& say) {
  std::vector<std::string> methods, missions;
  for (const ScanMethod& method : study.methods) methods.push_back(file_name(method.name));
  for (const std::string& mission : study.missions) missions.push_back(file_name(mission));
  require_different(missions, "mission");
  require_different(study.seeds, "seed");
  require_different(methods, "method");
  if (!study.budgets.empty()) require_different(study.budgets, "budget");
  std::mutex saying;
  const std::function<void(const std::string&)> say_alone = [&](const std::string& line) {
    const std::lock_guard lock(saying);
    say(line);
  };
  const StudyRun run(study, folder, registry, cancellation, say_alone);
  run.begin(resume);
  return run.run();
}

}  // namespace lapwing
