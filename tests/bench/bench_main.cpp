// SPDX-License-Identifier: Apache-2.0
// Runs the benchmarks and prints the ratios that the READMEs claim, each with its bound and whether
// it holds: from medians of repetitions that are taken in turn, so that what else the machine does
// disturbs both sides of a ratio alike. All but one are single-threaded, so that processor time is
// compared. The bounds leave a margin: each holds in nine of ten runs at least.
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <map>
#include <set>
#include <string>

#include <benchmark/benchmark.h>

namespace {

// Prints as usual and keeps the medians.
class Medians final : public benchmark::ConsoleReporter {
 public:
  struct Entry {
    double milliseconds = 0;       // of the processor
    double wall_milliseconds = 0;  // on the clock
    std::map<std::string, double> counters;
  };

  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    for (const Run& run : runs) {
      if (run.error_occurred) {
        if (run.error_message.find("LAPWING_DATA") != std::string::npos)
          absent_.insert(run.run_name.function_name);
        else
          failed_ = true;
      }
      if (run.aggregate_name != "median") continue;
      Entry& entry = entries_[run.run_name.function_name];
      entry.milliseconds = run.GetAdjustedCPUTime();
      entry.wall_milliseconds = run.GetAdjustedRealTime();
      for (const auto& [name, counter] : run.counters) entry.counters[name] = counter.value;
    }
  }

  const Entry* find(const std::string& name) const {
    const auto found = entries_.find(name);
    return found == entries_.end() ? nullptr : &found->second;
  }
  bool failed() const { return failed_; }
  // Those whose inputs, which are no part of the project, are not there.
  const std::set<std::string>& absent() const { return absent_; }

 private:
  std::map<std::string, Entry> entries_;
  std::set<std::string> absent_;
  bool failed_ = false;
};

bool filtered = false;  // by --benchmark_filter: what was not asked for is no claim that fails

// What a claim is worth that rests on benchmarks of which some were not measured: nothing is
// claimed of those left out on purpose or for want of inputs; any other one has failed.
bool unmeasured(const Medians& medians, std::initializer_list<const char*> names) {
  bool excused = true;
  for (const char* name : names) {
    if (medians.find(name) || filtered || medians.absent().contains(name)) continue;
    std::printf("%s: not measured: DOES NOT HOLD\n", name);
    excused = false;
  }
  return excused;
}

// What a line ends with.
bool verdict(bool holds) {
  std::printf("%s\n", holds ? ": holds" : ": DOES NOT HOLD");
  return holds;
}

// "A is N times as fast as B", with the bound that is claimed. False when it is not met.
bool ratio(const Medians& medians, const char* ours, const char* opponent, double at_least) {
  const Medians::Entry* a = medians.find(ours);
  const Medians::Entry* b = medians.find(opponent);
  if (!a || !b) return unmeasured(medians, {ours, opponent});
  const double times = b->milliseconds / a->milliseconds;
  const double cost = a->counters.at("cost"), other = b->counters.at("cost");
  const double difference = std::abs(cost - other) / std::max(1.0, std::abs(other));
  std::printf(
      "%s: %.1f times as fast as %s (claimed: %.0f); costs differ by %.1e (allowed: 1e-06), "
      "relative residual %.1e (allowed: 1e-08)",
      ours, times, opponent, at_least, difference, a->counters.at("residual"));
  return verdict(times >= at_least && difference <= 1e-6 && a->counters.at("residual") <= 1e-8);
}

// The same for solvers that stop at the same quality, whatever their costs.
bool faster(const Medians& medians, const char* ours, const char* opponent, double at_least) {
  const Medians::Entry* a = medians.find(ours);
  const Medians::Entry* b = medians.find(opponent);
  if (!a || !b) return unmeasured(medians, {ours, opponent});
  const double times = b->milliseconds / a->milliseconds;
  std::printf("%s: %.1f ms in %.0f iterations, %.1f times as fast as %s with %.0f (claimed: %g)",
              ours, a->milliseconds, a->counters.at("iterations"), times, opponent,
              b->counters.at("iterations"), at_least);
  return verdict(times >= at_least);
}

// How many programs are solved on the way, in place of how many.
bool fewer_programs(const Medians& medians, const char* ours, const char* opponent,
                    double at_most) {
  const Medians::Entry* a = medians.find(ours);
  const Medians::Entry* b = medians.find(opponent);
  if (!a || !b) return unmeasured(medians, {ours, opponent});
  const double mine = a->counters.at("iterations"), other = b->counters.at("iterations");
  std::printf("%s: %.0f programs in place of the %.0f of %s (claimed: at most %g of them)", ours,
              mine, other, opponent, at_most);
  return verdict(mine <= at_most * other);
}

bool growth(const Medians& medians, const char* small, const char* large, double at_most) {
  const Medians::Entry* a = medians.find(small);
  const Medians::Entry* b = medians.find(large);
  if (!a || !b) return unmeasured(medians, {small, large});
  const double times = b->milliseconds / a->milliseconds;
  std::printf("%s: %.1f times the time of %s (claimed: at most %g)", large, times, small, at_most);
  return verdict(times <= at_most);
}

// Maps: times of `ours` and of `opponent`, each in milliseconds for so many things.
bool map_ratio(const Medians& medians, const char* ours, const char* opponent, double at_least) {
  const Medians::Entry* a = medians.find(ours);
  const Medians::Entry* b = medians.find(opponent);
  if (!a || !b) return unmeasured(medians, {ours, opponent});
  const double times = b->milliseconds / a->milliseconds;
  std::printf("%s: %.1f times as fast as %s (claimed: %.0f)", ours, times, opponent, at_least);
  return verdict(times >= at_least);
}

bool at_most(const Medians& medians, const char* name, double parts, double most, bool wall) {
  const Medians::Entry* a = medians.find(name);
  if (!a) return unmeasured(medians, {name});
  const double each = (wall ? a->wall_milliseconds : a->milliseconds) / parts;
  std::printf("%s: %.2f ms each (claimed: at most %g)", name, each, most);
  return verdict(each <= most);
}

bool memory(const Medians& medians, const char* ours, const char* opponent, double at_most) {
  const Medians::Entry* a = medians.find(ours);
  const Medians::Entry* b = medians.find(opponent);
  if (!a || !b) return unmeasured(medians, {ours, opponent});
  const double mine = a->counters.at("MB"), other = b->counters.at("MB");
  std::printf("%s: %.2f MB, %.2f times those of %s (claimed: at most %g)", ours, mine, mine / other,
              opponent, at_most);
  return verdict(mine <= at_most * other);
}

// Terms read blocks through named handles: the ratio to the same term that reads them by number.
bool names_hold(const Medians& medians) {
  constexpr double kMost = 1.05;
  bool held = true;
  for (const char* name : {"reading/camera_angle", "reading/skewness", "reading/input_effort"}) {
    const Medians::Entry* a = medians.find(name);
    if (!a) {
      held &= unmeasured(medians, {name});
      continue;
    }
    const double times = a->counters.at("ratio");
    std::printf("%s: %.1f us by name, %.1f us by number: %.3f times (claimed: at most %g)", name,
                a->counters.at("named_us"), a->counters.at("numbered_us"), times, kMost);
    held &= verdict(times <= kMost);
  }
  return held;
}

bool maps_hold(const Medians& medians) {
  bool held = true;
  for (const char* mode : {"discretised", "exact"}) {
    const std::string brick = std::string("map_insert/brick_") + mode;
    const std::string octomap = std::string("map_insert/octomap_") + mode;
    const bool exact = mode[0] == 'e';
    held &= map_ratio(medians, brick.c_str(), octomap.c_str(), exact ? 4 : 6);
    held &= memory(medians, brick.c_str(), octomap.c_str(), 1.5);
    if (!exact) held &= at_most(medians, brick.c_str(), 50, 3, false);
  }
  return held & map_ratio(medians, "map_cast_room/brick", "map_cast_room/octomap", 5) &
         map_ratio(medians, "map_cast_singly/brick", "map_cast_singly/octomap", 15) &
         map_ratio(medians, "map_cast_street/brick", "map_cast_street/octomap", 10) &
         map_ratio(medians, "map_cast_street/brick", "map_castRay_street", 10) &
         map_ratio(medians, "map_cast_room/brick", "map_castRay_room", 5) &
         at_most(medians, "map_view", 1, 35, true) &
         at_most(medians, "map_sweep/brick_10000", 1, 200, false);
}

}  // namespace

int main(int argc, char** argv) {
  std::string repetitions = "--benchmark_repetitions=5";
  std::string aggregates = "--benchmark_report_aggregates_only=true";
  std::string in_turn = "--benchmark_enable_random_interleaving=true";
  std::vector<char*> arguments{argv[0], repetitions.data(), aggregates.data(), in_turn.data()};
  arguments.insert(arguments.end(), argv + 1, argv + argc);
  for (int k = 1; k < argc; ++k)
    filtered |= std::string(argv[k]).rfind("--benchmark_filter", 0) == 0;
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 2;
  Medians medians;
  benchmark::RunSpecifiedBenchmarks(&medians);
  std::printf("\n");
  for (const std::string& name : medians.absent())
    std::printf("%s: not measured, for want of the real depth images (LAPWING_DATA)\n",
                name.c_str());
  const bool held =
      ratio(medians, "interior_point/flight_30s", "ipopt/flight_30s", 8) &
      ratio(medians, "interior_point/flight_30s", "ipopt/flight_30s_mehrotra", 6) &
      faster(medians, "to_half_a_percent/iqp", "to_half_a_percent/ipopt", 2) &
      faster(medians, "to_the_end/moved_warm", "to_the_end/moved_cold", 1.6) &
      fewer_programs(medians, "to_the_end/moved_warm", "to_the_end/moved_cold", 0.55) &
      growth(medians, "interior_point/flight_30s", "interior_point/flight_300s", 15) &
      growth(medians, "film_terms/plugins", "film_terms/lua", 1.3) & names_hold(medians) &
      maps_hold(medians);
  return held && !medians.failed() ? 0 : 1;
}
