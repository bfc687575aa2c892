// SPDX-License-Identifier: Apache-2.0
#include "framework/study/scan_study.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <set>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/portable.h"
#include "framework/items/statement.h"
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

// What the rows of one case share.
struct PreparedCase {
  ScanCase scan;
  std::vector<TourProblem> problems;  // by budget: shortest ways serve all methods
  std::unique_ptr<SurfaceSample> surface;
  double seconds = 0;  // that the preparation took
};

class StudyRun {
 public:
  StudyRun(const ScanStudy& study, fs::path folder, int threads, const Registry& registry,
           const CancellationToken* cancellation,
           const std::function<void(const std::string&)>& say)
      : study_(study),
        folder_(std::move(folder)),
        threads_(threads),
        registry_(registry),
        cancellation_(cancellation),
        say_(say),
        mark_(made_by(study.program, statement())) {
    for (std::size_t m = 0; m < study_.missions.size(); ++m)
      for (std::size_t s = 0; s < study_.seeds.size(); ++s)
        for (std::size_t b = 0; b < budgets(); ++b)
          for (std::size_t k = 0; k < study_.methods.size(); ++k) places_.push_back({m, b, k, s});
  }

  void open(const ItemOptions& options) const {
    if (!fs::exists(folder_ / "study.json") && fs::exists(folder_ / "rows"))
      throw InputError("'" + folder_.string() + "' has rows, but no study");
    open_statement(folder_ / "study.json", statement(), options, "study");
  }

  ItemList list() const {
    ItemList list;
    list.folder = folder_;
    list.groups = study_.missions.size() * study_.seeds.size();
    for (const RowPlace& at : places_) {
      const std::string& method = study_.methods[at.method].name;
      list.items.push_back({name_of(at, "rows").string(),
                            at.mission * study_.seeds.size() + at.seed,
                            {method + " for " + study_.missions[at.mission] + budget_text(at),
                             method + " for " + study_.missions[at.mission], method}});
    }
    list.is_made = [this](std::size_t item) {
      return has_item(folder_ / name_of(places_[item], "rows"), mark_);
    };
    list.prepare = [this](std::size_t group) {
      return prepare(group / study_.seeds.size(), group % study_.seeds.size());
    };
    list.make = [this](std::size_t item, const void* prepared) {
      make(places_[item], *static_cast<const PreparedCase*>(prepared));
    };
    return list;
  }

  // All of them are there.
  std::vector<ScanRow> rows() const {
    std::vector<ScanRow> rows;
    for (std::size_t m = 0; m < study_.missions.size(); ++m) {
      for (std::size_t b = 0; b < budgets(); ++b) {
        for (std::size_t k = 0; k < study_.methods.size(); ++k) {
          for (std::size_t s = 0; s < study_.seeds.size(); ++s) {
            const fs::path file = folder_ / name_of({m, b, k, s}, "rows");
            rows.push_back(scan_row_from(from_json(read_file(file), file.string())));
          }
        }
      }
    }
    return rows;
  }

  Value statement() const {
    Value value = Value::map();
    value.set("format", 2);
    value.set(kMachineEntry, machine_of_numbers());
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

 private:
  std::size_t budgets() const { return std::max<std::size_t>(1, study_.budgets.size()); }

  std::string budget_text(const RowPlace& at) const {
    if (study_.budgets.empty()) return "";
    char text[40];
    std::snprintf(text, sizeof text, "_%gs", study_.budgets[at.budget]);
    return text;
  }

  // Of a file, within the folder.
  fs::path name_of(const RowPlace& at, const char* kind) const {
    const std::string name = study_.missions[at.mission] + "_seed" +
                             std::to_string(study_.seeds[at.seed]) + budget_text(at) + "_" +
                             study_.methods[at.method].name;
    return fs::path(kind) / (file_name(name) + ".json");
  }

  std::shared_ptr<const PreparedCase> prepare(std::size_t mission, std::size_t seed) const {
    const std::string name =
        study_.missions[mission] + ", seed " + std::to_string(study_.seeds[seed]);
    say_(name + ": candidates and motions");
    const auto made = std::make_shared<PreparedCase>();
    const Stopwatch preparing;
    made->scan = study_.prepare(mission, seed);
    made->seconds = preparing.seconds();
    made->surface =
        std::make_unique<SurfaceSample>(ground_truth(made->scan, study_.missions[mission]));
    for (std::size_t b = 0; b < budgets(); ++b) {
      TourDefinition definition = made->scan.definition;
      if (!study_.budgets.empty()) definition.budget = study_.budgets[b];
      made->problems.emplace_back(std::move(definition));
    }
    say_(name + ": " + std::to_string(made->scan.viewpoints.size()) + " candidates, " +
         std::to_string(made->problems.back().reachable().size()) +
         " of them connected to the start within the budget");
    return made;
  }

  void make(const RowPlace& at, const PreparedCase& prepared) const {
    if (cancellation_ && cancellation_->cancelled()) throw Cancelled();
    double seconds = 0;
    std::vector<Pose> cameras;
    ScanRow row = measure(prepared.scan, prepared.problems[at.budget], *prepared.surface,
                          study_.methods[at.method], study_, study_.seeds[at.seed], registry_,
                          cancellation_, seconds, cameras);
    row.mission = study_.missions[at.mission];
    Value time = Value::map();
    time.set("mission", row.mission);
    time.set("method", row.method);
    time.set("budget", row.budget);
    time.set("seed", static_cast<std::int64_t>(row.seed));
    time.set("first_flight", prepared.scan.first_seconds);
    time.set("flight", row.seconds);
    time.set("prepare", prepared.seconds);
    time.set("plan", seconds);
    write_file_atomically(folder_ / name_of(at, "times"), to_json(time) + "\n");
    if (study_.photos && row.found) take_photos(at, prepared.scan, cameras, row);
    Value value = to_value(row);
    value.set(kMadeByEntry, mark_);
    write_file_atomically(folder_ / name_of(at, "rows"), to_json(value) + "\n");
    char score[40] = "", text[120];
    if (std::isfinite(row.score_share))
      std::snprintf(score, sizeof score, ", score %.1f %%", 100 * row.score_share);
    std::snprintf(text, sizeof text, ": F %.2f %%%s, %d images, %.0f s", 100 * row.with_first.f,
                  score, row.images, row.seconds);
    say_(row.mission + ", seed " + std::to_string(row.seed) + ", " + row.method +
         (row.found ? text : ": no tour (" + row.message + ")"));
  }

  SurfaceSample ground_truth(const ScanCase& scan, const std::string& mission) const {
    const ReconstructionSettings judge = judged_by(study_, scan);
    SurfaceSample surface(scan.surface->mesh(), judge, threads_);
    if (!scan.viewing) return surface;
    std::vector<Eigen::Vector3d> from;
    for (const Pose& camera : scan.first_flight) from.push_back(camera.position);
    count_visible(surface, scan.surface, judge, *scan.viewing, from, folder_ / "surface",
                  file_name(mission), threads_, say_);
    return surface;
  }

  // Before the row is written: where there is a row there is what its photographs came to.
  void take_photos(const RowPlace& at, const ScanCase& scan, const std::vector<Pose>& cameras,
                   const ScanRow& row) const {
    fs::path folder = folder_ / name_of(at, "photos");
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
  int threads_;
  const Registry& registry_;
  const CancellationToken* cancellation_;
  const std::function<void(const std::string&)>& say_;
  Value mark_;
  std::vector<RowPlace> places_;  // by item
};

template <class T>
void require_different(const std::vector<T>& entries, const std::string& what) {
  if (entries.empty()) throw InputError("evaluate: no " + what);
  if (std::set<T>(entries.begin(), entries.end()).size() != entries.size()) {
    throw InputError("evaluate: the same " + what + " twice");
  }
}

}  // namespace

std::optional<std::vector<ScanRow>> run_study(const ScanStudy& study, const fs::path& folder,
                                              ItemRun& run, const Registry& registry,
                                              const CancellationToken* cancellation,
                                              const std::function<void()>& claim,
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
  const StudyRun rows(study, folder, run.threads(), registry, cancellation, say_alone);
  const bool whole = run.make(rows.list(), rows.statement(), [&] {
    claim();
    rows.open(run.options());
  });
  if (!whole) return std::nullopt;
  return rows.rows();
}

}  // namespace lapwing
