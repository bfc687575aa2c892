// SPDX-License-Identifier: Apache-2.0
// One row of a study: a tour by one method, and what its images make of the true surface.
#include <cmath>
#include <limits>
#include <mutex>
#include <set>

#include "framework/core/error.h"
#include "framework/study/scan_study.h"
#include "framework/study/stopwatch.h"
#include "framework/view/fixed_rewards.h"

namespace lapwing {
namespace {

// A solver of fixed rewards is no rival where it does not even reach what another one reaches of
// them.
constexpr const char* kOfRewards = "milp";
constexpr const char* kLeastRival = "greedy";

// Adds its own lifetime in s.
class Timed {
 public:
  explicit Timed(double& sum) : sum_(sum) {}
  ~Timed() { sum_ += watch_.seconds(); }
  Timed(const Timed&) = delete;
  Timed& operator=(const Timed&) = delete;

 private:
  double& sum_;
  Stopwatch watch_;
};

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
    if (freely()) {
      fly_over();
    } else {
      if (method_.pattern) {
        lay_pattern();
      } else {
        ask_solvers();
      }
      describe_walk();
    }
    if (cancellation_ && cancellation_->cancelled()) throw Cancelled();
    row_.found = !views_.empty();
    row_.images = static_cast<int>(views_.size());
  }

  void judge(const SurfaceSample& surface) {
    if (!row_.found) return;
    Reconstruction made(judged_by(study_, scan_));
    row_.surface_share = surface.counted_share();
    made.add(*scan_.surface, cameras(), scan_.camera, study_.noise, seed_, 1, cancellation_);
    row_.alone = surface.score(made.points(1), 1);
    row_.with_first = row_.alone;
    if (freely()) return;
    made.add(*scan_.surface, scan_.first_flight, scan_.camera, study_.noise, seed_, 1,
             cancellation_);
    row_.with_first = surface.score(made.points(1), 1);
  }

  ScanRow row() && { return std::move(row_); }

  std::vector<Pose> cameras() const {
    std::vector<Pose> poses;
    for (const Viewpoint& view : views_) poses.push_back(view.camera());
    return poses;
  }
  double work_seconds() const { return work_seconds_; }

 private:
  // A pattern at a safe height needs no first flight, and has no images of one (tables 4.2 to 4.7);
  // its views are no candidates.
  bool freely() const { return method_.pattern && flown_freely(pattern().kind); }
  Pattern pattern() const { return pattern_named(method_.name, scan_.pattern_height); }

  void fly_over() {
    const Timed timed(work_seconds_);
    FreePattern flown = fly_freely(pattern_viewpoints(pattern(), scan_.region), problem_.budget(),
                                   scan_.leg_seconds);
    views_ = std::move(flown.views);
    row_.status = views_.empty() ? "infeasible" : "feasible";
    row_.message = flown.message;
    if (views_.empty()) return;
    row_.seconds = flown.seconds;
    row_.score = row_.score_share = std::numeric_limits<double>::quiet_NaN();
  }

  // Each view of the walk takes one image, when it is first there.
  void describe_walk() {
    if (walk_.empty()) return;
    row_.score = problem_.score_of(walk_);
    row_.score_share = row_.score / problem_.score().total();
    row_.seconds = problem_.seconds_of(walk_);
    std::set<int> taken;
    for (const int view : walk_)
      if (taken.insert(view).second) views_.push_back(scan_.viewpoints[view]);
  }

  void lay_pattern() {
    const Timed timed(work_seconds_);
    PatternTour tour =
        fly_pattern(problem_, scan_.viewpoints, pattern_viewpoints(pattern(), scan_.region));
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
      const Timed timed(work_seconds_);
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
  std::vector<int> walk_;         // in the problem
  std::vector<Viewpoint> views_;  // that take images, in order
  double work_seconds_ = 0;
};

}  // namespace

ReconstructionSettings judged_by(const ScanStudy& study, const ScanCase& scan) {
  ReconstructionSettings settings = study.reconstruction;
  settings.region = scan.region;
  settings.range = study.range.value_or(scan.usable_range);
  settings.incidence = study.incidence.value_or(scan.usable_incidence);
  return settings;
}

ScanRow measure(const ScanCase& scan, const TourProblem& problem, const SurfaceSample& surface,
                const ScanMethod& method, const ScanStudy& study, std::uint64_t seed,
                const Registry& registry, const CancellationToken* cancellation,
                double& work_seconds, std::vector<Pose>& cameras) {
  Measuring measuring(scan, problem, method, study, seed, registry, cancellation);
  measuring.plan();
  work_seconds = measuring.work_seconds();
  measuring.judge(surface);
  cameras = measuring.cameras();
  return std::move(measuring).row();
}

}  // namespace lapwing
