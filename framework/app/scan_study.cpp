#include "framework/app/scan_study.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <set>

#include "framework/app/progress_line.h"
#include "framework/app/scan_photos.h"
#include "framework/config/overrides.h"
#include "framework/core/checksum.h"
#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/parallel.h"
#include "framework/view/fixed_rewards.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

// A solver of fixed rewards is no rival where it does not even reach what another one reaches of
// them.
constexpr const char* kOfRewards = "milp";
constexpr const char* kLeastRival = "greedy";

std::vector<std::string> parts_of(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (;;) {
    const std::size_t end = text.find(separator, begin);
    parts.push_back(text.substr(begin, end - begin));
    if (end == text.npos) return parts;
    begin = end + 1;
  }
}

bool names_pattern(const std::string& text) {
  const std::string kind = text.substr(0, text.find('_'));
  return kind == "circle" || kind == "ellipse" || kind == "meander" || kind == "hemisphere";
}

ScanMethod::Solver solver_from(const std::string& text, const Registry& registry) {
  const std::size_t colon = text.find(':');
  ScanMethod::Solver solver{.name = text.substr(0, colon)};
  if (colon != text.npos) {
    std::vector<std::string> overrides = parts_of(text.substr(colon + 1), ',');
    solver.parameters = Value::map();
    for (const std::string& entry : overrides) apply_override(solver.parameters, entry);
  }
  registry.create<TourSolver>(solver.name, solver.parameters, "method " + text);
  return solver;
}

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

Value to_value(const ReconstructionScore& score) {
  Value value = Value::map();
  value.set("precision", score.precision);
  value.set("recall", score.recall);
  value.set("f", score.f);
  value.set("points", score.points);
  value.set("surface_points", score.surface_points);
  return value;
}

ReconstructionScore reconstruction_from(const Value& value) {
  ReconstructionScore score;
  score.precision = value.at("precision").as_number();
  score.recall = value.at("recall").as_number();
  score.f = value.at("f").as_number();
  score.points = value.at("points").as_integer();
  score.surface_points = value.at("surface_points").as_integer();
  return score;
}

}  // namespace

ScanMethod scan_method(const std::string& text, const Registry& registry) {
  ScanMethod method{.name = text};
  if (names_pattern(text)) {
    pattern_named(text, 1);
    method.pattern = true;
    return method;
  }
  for (const std::string& part : parts_of(text, '+')) {
    method.solvers.push_back(solver_from(part, registry));
  }
  return method;
}

Value to_value(const ScanRow& row) {
  Value value = Value::map();
  value.set("mission", row.mission);
  value.set("seed", static_cast<std::int64_t>(row.seed));
  value.set("budget", row.budget);
  value.set("method", row.method);
  value.set("status", row.status);
  value.set("message", row.message);
  value.set("found", row.found);
  value.set("reproducible", row.reproducible);
  value.set("counts", row.counts);
  value.set("score", row.score);
  value.set("score_share", row.score_share);
  if (row.upper_bound) value.set("upper_bound", *row.upper_bound);
  value.set("seconds", row.seconds);
  value.set("images", row.images);
  value.set("first_images", row.first_images);
  value.set("candidates", row.candidates);
  value.set("evaluations", row.evaluations);
  value.set("with_first", to_value(row.with_first));
  value.set("alone", to_value(row.alone));
  return value;
}

ScanRow scan_row_from(const Value& value) {
  ScanRow row;
  row.mission = value.at("mission").as_text();
  row.seed = static_cast<std::uint64_t>(value.at("seed").as_integer());
  row.budget = value.at("budget").as_number();
  row.method = value.at("method").as_text();
  row.status = value.at("status").as_text();
  row.message = value.at("message").as_text();
  row.found = value.at("found").as_boolean();
  row.reproducible = value.at("reproducible").as_boolean();
  row.counts = value.at("counts").as_boolean();
  row.score = value.at("score").as_number();
  row.score_share = value.at("score_share").as_number();
  if (const Value* bound = value.find("upper_bound")) row.upper_bound = bound->as_number();
  row.seconds = value.at("seconds").as_number();
  row.images = static_cast<int>(value.at("images").as_integer());
  row.first_images = static_cast<int>(value.at("first_images").as_integer());
  row.candidates = static_cast<int>(value.at("candidates").as_integer());
  row.evaluations = value.at("evaluations").as_integer();
  row.with_first = reconstruction_from(value.at("with_first"));
  row.alone = reconstruction_from(value.at("alone"));
  return row;
}

namespace {

// A row in the making.
class Measuring {
 public:
  Measuring(const ScanCase& scan, const TourProblem& problem, const ScanMethod& method,
            const ScanStudy& study, std::uint64_t seed, const Registry& registry,
            const CancellationToken* cancellation)
      : scan_(scan),
        problem_(problem),
        method_(method),
        study_(study),
        seed_(seed),
        registry_(registry),
        cancellation_(cancellation) {
    row_.method = method.name;
    row_.seed = seed;
    row_.budget = problem.budget();
    row_.candidates = problem.views();
    row_.first_images = static_cast<int>(scan.first_flight.size());
  }

  void plan() {
    if (method_.pattern) {
      lay_pattern();
    } else {
      ask_solvers();
    }
    if (cancellation_ && cancellation_->cancelled()) throw Cancelled();
    row_.found = !walk_.empty();
    if (!row_.found) return;
    row_.score = problem_.score_of(walk_);
    row_.score_share = row_.score / problem_.score().total();
    row_.seconds = problem_.seconds_of(walk_);
    row_.images = TourProblem::images_of(walk_);
  }

  void judge(const SurfaceSample& surface) {
    if (!row_.found) return;
    ReconstructionSettings settings = study_.reconstruction;
    settings.region = scan_.region;
    Reconstruction made(settings);
    made.add(*scan_.surface, cameras(), scan_.camera, study_.noise, seed_, 1, cancellation_);
    row_.alone = surface.score(made.points(1), 1);
    row_.with_first = row_.alone;
    if (one_shot()) return;
    made.add(*scan_.surface, scan_.first_flight, scan_.camera, study_.noise, seed_, 1,
             cancellation_);
    row_.with_first = surface.score(made.points(1), 1);
  }

  ScanRow row() && { return std::move(row_); }

  // Each view of the walk takes one image, when it is first there.
  std::vector<Pose> cameras() const {
    std::vector<Pose> poses;
    std::set<int> taken;
    for (const int view : walk_) {
      if (taken.insert(view).second) poses.push_back(scan_.viewpoints[view].camera());
    }
    return poses;
  }

 private:
  // A pattern at a safe height needs no first flight, and has no images of one (tables 4.2 to 4.7).
  bool one_shot() const { return method_.pattern && !method_.name.starts_with("hemisphere"); }

  void lay_pattern() {
    const Pattern pattern = pattern_named(method_.name, scan_.pattern_height);
    PatternTour tour =
        fly_pattern(problem_, scan_.viewpoints, pattern_viewpoints(pattern, scan_.region));
    walk_ = std::move(tour.walk);
    row_.status = walk_.empty() ? "infeasible" : "feasible";
    row_.message = tour.message;
  }

  void ask_solvers() {
    // CBC's promise to be used by several threads at once is none; and its clock is to run for it
    // alone. Whoever waits here has not begun.
    static std::mutex one_at_a_time;
    const bool of_rewards = method_.solvers.back().name == kOfRewards;
    std::unique_lock lock(one_at_a_time, std::defer_lock);
    if (of_rewards) lock.lock();
    for (const ScanMethod::Solver& solver : method_.solvers) {
      TourRequest request;
      request.seed = seed_;
      request.wall_clock_guard = study_.guard;
      request.cancellation = cancellation_;
      if (!walk_.empty()) request.initial = walk_;
      TourResult result =
          registry_.create<TourSolver>(solver.name, solver.parameters)->solve(problem_, request);
      walk_ = std::move(result.walk);
      row_.status = to_string(result.report.status);
      row_.message = result.report.message;
      row_.evaluations += result.report.evaluations;
      row_.upper_bound.reset();
      if (std::isfinite(result.report.upper_bound)) row_.upper_bound = result.report.upper_bound;
      if (result.report.status == TourStatus::time_limit) row_.reproducible = false;
    }
    if (of_rewards) row_.counts = counts_as_rival();
  }

  bool counts_as_rival() const {
    if (walk_.empty()) return false;
    const TourRequest request;
    TourWork work(request);
    const FixedRewards rewards = fix_rewards(problem_, work);
    const auto sum = [&](const std::vector<int>& walk) {
      double total = 0;
      for (const int view : std::set<int>(walk.begin(), walk.end())) {
        total += rewards.of_view[view];
      }
      return total;
    };
    const TourResult least =
        registry_.create<TourSolver>(kLeastRival, Value::map())->solve(problem_, request);
    return sum(walk_) >= sum(least.walk);
  }

  const ScanCase& scan_;
  const TourProblem& problem_;
  const ScanMethod& method_;
  const ScanStudy& study_;
  std::uint64_t seed_;
  const Registry& registry_;
  const CancellationToken* cancellation_;
  ScanRow row_;
  std::vector<int> walk_;
};

}  // namespace

ScanRow measure(const ScanCase& scan, const TourProblem& problem, const SurfaceSample& surface,
                const ScanMethod& method, const ScanStudy& study, std::uint64_t seed,
                const Registry& registry, const CancellationToken* cancellation,
                double& work_seconds, std::vector<Pose>& cameras) {
  Measuring measuring(scan, problem, method, study, seed, registry, cancellation);
  const double begin = steady_seconds();
  measuring.plan();
  work_seconds = steady_seconds() - begin;
  measuring.judge(surface);
  cameras = measuring.cameras();
  return std::move(measuring).row();
}

namespace {

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
        throw InputError("'" + folder_.string() + "' holds rows of no study");
      }
      write_file_atomically(file, stated);
      return;
    }
    if (!resume) {
      throw InputError("'" + folder_.string() +
                       "' holds a study: go on with --resume, or name another folder with --out");
    }
    if (read_file(file) != stated) {
      throw InputError("'" + file.string() +
                       "' states another study (missions, methods, seeds, budgets, options or "
                       "scripts differ): --resume goes on with the same one only");
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
    value.set("format", 1);
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
    const double begun = steady_seconds();
    const ScanCase scan = study_.prepare(m, s);
    const double prepared = steady_seconds() - begun;
    ReconstructionSettings settings = study_.reconstruction;
    settings.region = scan.region;
    const SurfaceSample surface(scan.surface->mesh(), settings, study_.threads);
    // One problem for each budget: its shortest ways serve all methods.
    std::vector<TourProblem> problems;
    for (std::size_t b = 0; b < budgets(); ++b) {
      TourDefinition definition = scan.definition;
      if (!study_.budgets.empty()) definition.budget = study_.budgets[b];
      problems.emplace_back(std::move(definition));
    }
    say_(name + ": " + std::to_string(scan.viewpoints.size()) + " candidates, " +
         std::to_string(problems.back().reachable().size()) +
         " of them joined to the start within the budget; " + std::to_string(missing.size()) +
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
      char text[120];
      std::snprintf(text, sizeof text, ": F %.2f %%, score %.1f %%, %d images, %.0f s",
                    100 * row.with_first.f, 100 * row.score_share, row.images, row.seconds);
      say_(name + ", " + row.method + (row.found ? text : ": no tour (" + row.message + ")"));
    });
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
