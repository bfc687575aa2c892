#include "framework/app/evaluate_explore.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <map>

#include "framework/app/exploration_settings.h"
#include "framework/app/interruption.h"
#include "framework/config/overrides.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/number_text.h"
#include "framework/core/parallel.h"
#include "framework/export/report.h"
#include "framework/mission/explore_library.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

struct Trial {
  std::string world, utility;
  std::int64_t episode = 0;

  std::string name() const {
    return file_text(world + "_" + utility + "_" + std::to_string(episode));
  }
};

// Student's t of 97.5 %: of 1 degree of freedom, of 2, ...
constexpr double kStudent[] = {12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306,
                               2.262,  2.228, 2.201, 2.179, 2.160, 2.145, 2.131, 2.120,
                               2.110,  2.101, 2.093, 2.086, 2.080, 2.074, 2.069, 2.064,
                               2.060,  2.056, 2.052, 2.048, 2.045, 2.042};

struct Mean {
  double mean = std::nan(""), deviation = std::nan("");
  std::size_t count = 0;
  // Half the width of the 95 % interval of the mean; beyond 31 values by the normal distribution.
  double interval() const {
    if (count < 2) return std::nan("");
    const double t = count - 2 < std::size(kStudent) ? kStudent[count - 2] : 1.96;
    return t * deviation / std::sqrt(static_cast<double>(count));
  }
};

Mean mean_of(const std::vector<double>& values) {
  Mean result;
  result.count = values.size();
  if (values.empty()) return result;
  result.mean = 0;
  for (const double v : values) result.mean += v / static_cast<double>(values.size());
  double squares = 0;
  for (const double v : values) squares += (v - result.mean) * (v - result.mean);
  result.deviation =
      values.size() > 1 ? std::sqrt(squares / static_cast<double>(values.size() - 1)) : 0;
  return result;
}

void run_trial(const Trial& trial, const World& world, const GroundTruth& truth,
               const ExplorationSetup& setup, const Registry& registry, const Value& parameters,
               std::uint64_t seed, const fs::path& folder) {
  Random random = Random(seed).split(static_cast<std::uint64_t>(trial.episode));
  const Viewpoint start =
      random_start(truth, setup.episode.clear, setup.episode.sensor.range / 2, setup.pitch, random);
  EpisodeSettings settings = setup.episode;
  settings.show_truth = needs_truth(registry, trial.utility);
  settings.seed = seed + static_cast<std::uint64_t>(trial.episode) * 1'000'003;
  const auto new_map = setup.new_map(registry);
  const Value* given = parameters.find(trial.utility);
  const auto utility =
      registry.create<ViewUtility>(trial.utility, given ? *given : Value::map(), trial.utility);
  ObservedSurface observed(truth, settings.sensor, new_map);
  const auto map = new_map();
  EpisodeResult result = explore(settings, start, truth, observed, *utility, *map);
  if (result.end == EpisodeEnd::cancelled) return;
  std::vector<double> curve;
  double seconds = 0;
  for (const EpisodeStep& step : result.steps) {
    curve.push_back(step.observed);
    seconds += step.seconds;
  }
  if (settings.sensor.noise || settings.sensor.stereo) {
    ObservedSurface anew(truth, settings.sensor, new_map);
    const auto clean = new_map();
    curve = replay(settings, result, truth, anew, *clean);
  }
  Value object = Value::map();
  object.set("world", world.name);
  object.set("utility", trial.utility);
  object.set("episode", trial.episode);
  object.set("end", to_string(result.end));
  object.set("surface", result.surface);
  object.set("length", result.length());
  object.set("observed", Value(Value::List(curve.begin(), curve.end())));
  Value time = Value::map();
  time.set("seconds_per_step",
           seconds / static_cast<double>(std::max<std::size_t>(1, curve.size())));
  write_file_atomically(folder / "seconds" / (trial.name() + ".json"), to_json(time) + "\n");
  write_file_atomically(folder / "episodes" / (trial.name() + ".json"), to_json(object) + "\n");
}

// An episode as its files have it.
struct Flown {
  std::vector<double> curve;  // observed after each image; it stays as it is after an early end
  std::string end;            // empty: after all images
  double length = 0;          // m
  double seconds = std::nan("");  // wall clock of a step; there or not

  double efficiency() const {
    double sum = 0;
    for (const double v : curve) sum += v;
    return sum;
  }
};

Flown flown(const Trial& trial, const fs::path& folder, int steps) {
  const fs::path path = folder / "episodes" / (trial.name() + ".json");
  Flown result;
  try {
    const Value object = from_json(read_file(path), path.string());
    for (const Value& value : object.at("observed").as_list())
      result.curve.push_back(value.as_number());
    result.length = object.at("length").as_number();
    result.end = object.at("end").as_text();
  } catch (const InputError& error) {
    throw InputError("'" + path.string() + "' is no whole episode: delete it, and --resume flies " +
                     "it again (" + error.what() + ")");
  }
  if (result.curve.size() >= static_cast<std::size_t>(steps)) result.end.clear();
  if (result.curve.empty()) result.curve.push_back(0);
  result.curve.resize(static_cast<std::size_t>(steps), result.curve.back());
  const fs::path time = folder / "seconds" / (trial.name() + ".json");
  if (fs::exists(time))
    result.seconds =
        from_json(read_file(time), time.string()).at("seconds_per_step").as_number();
  return result;
}

// Episodes that ended before all images: how many, and by what ("nothing_to_gain 2", "no_way 1").
struct EarlyEnds {
  int count = 0;
  std::vector<std::string> kinds;

  std::string kinds_with(const char* between) const {
    std::string text;
    for (const std::string& kind : kinds) text += (text.empty() ? "" : between) + kind;
    return text;
  }
};

EarlyEnds early_ends(const std::vector<Flown>& episodes) {
  std::map<std::string, int> ends;
  EarlyEnds found;
  for (const Flown& episode : episodes)
    if (!episode.end.empty()) ++ends[episode.end], ++found.count;
  for (const auto& [end, times] : ends) found.kinds.push_back(end + " " + std::to_string(times));
  return found;
}

std::string number(double value) {
  if (!std::isfinite(value)) return "";
  return plain_number(value);
}

struct Summary {
  std::string table =
      "world,utility,episodes,efficiency,efficiency_deviation,relative,"
      "relative_deviation,relative_interval,below_learned,below_learned_interval,length,"
      "ended_early,ends,compared\n";
  std::string seconds = "world,utility,episodes,seconds_per_step\n";  // table 5.3
  std::string curves = "world,utility,images,observed,observed_deviation\n";
  Report report;
  Table shown;
  std::vector<double> step_seconds;  // by row
};

void summarise_world(Summary& summary, const std::string& world,
                     const std::vector<std::string>& utilities, const ExploreEvaluation& request) {
  Chart chart;
  chart.title = world;
  chart.x = {"images", "", false, true};
  chart.y = {"observed surface", "voxels"};
  const auto curves = [&](const std::string& utility) {
    std::vector<Flown> all;
    for (std::int64_t e = 1; e <= request.episodes; ++e)
      all.push_back(flown({world, utility, e}, request.folder, request.steps));
    return all;
  };
  const auto efficiencies_of = [&](const char* utility) {
    std::vector<double> found;
    if (std::find(utilities.begin(), utilities.end(), utility) != utilities.end())
      for (const Flown& episode : curves(utility)) found.push_back(episode.efficiency());
    return found;
  };
  const std::vector<double> oracle = efficiencies_of("oracle"),
                            learned = efficiencies_of("learned");
  for (const std::string& utility : utilities) {
    const std::vector<Flown> all = curves(utility);
    std::vector<double> raw, relative, below, lengths, seconds;
    for (std::size_t e = 0; e < all.size(); ++e) {
      raw.push_back(all[e].efficiency());
      lengths.push_back(all[e].length);
      if (std::isfinite(all[e].seconds)) seconds.push_back(all[e].seconds);
      if (e >= oracle.size() || !(oracle[e] > 0)) continue;
      relative.push_back(raw.back() / oracle[e]);
      if (!learned.empty()) below.push_back((learned[e] - raw.back()) / oracle[e]);
    }
    const Mean efficiencies = mean_of(raw), shares = mean_of(relative), lacks = mean_of(below);
    summary.table += world + "," + utility + "," + std::to_string(raw.size()) + "," +
                     number(efficiencies.mean) + "," + number(efficiencies.deviation) + "," +
                     number(shares.mean) + "," + number(shares.deviation) + "," +
                     number(shares.interval()) + "," + number(lacks.mean) + "," +
                     number(lacks.interval()) + "," + number(mean_of(lengths).mean);
    const EarlyEnds ends = early_ends(all);
    const std::string count = std::to_string(ends.count);
    std::string early = ends.count > 0 ? count + ": " + ends.kinds_with(", ") : count;
    // Where the oracle saw nothing there is no ratio.
    if (!oracle.empty() && relative.size() < raw.size())
      early += "; relative: " + std::to_string(relative.size()) + " episodes";
    summary.table += "," + count + "," + ends.kinds_with("; ") + "," +
                     std::to_string(relative.size()) + "\n";
    summary.step_seconds.push_back(mean_of(seconds).mean);
    summary.seconds += world + "," + utility + "," + std::to_string(seconds.size()) + "," +
                       number(summary.step_seconds.back()) + "\n";
    summary.shown.rows.push_back(
        {{world, utility, efficiencies.mean, efficiencies.deviation, shares.mean, shares.deviation,
          shares.interval(), lacks.mean, lacks.interval(), mean_of(lengths).mean,
          early}});
    Series series{utility, {0}, {0}};
    for (int t = 0; t < request.steps; ++t) {
      std::vector<double> at;
      for (const Flown& episode : all) at.push_back(episode.curve[static_cast<std::size_t>(t)]);
      const Mean mean = mean_of(at);
      summary.curves += world + "," + utility + "," + std::to_string(t + 1) + "," +
                        number(mean.mean) + "," + number(mean.deviation) + "\n";
      series.x.push_back(t + 1);
      series.y.push_back(mean.mean);
    }
    chart.series.push_back(std::move(series));
  }
  summary.report.sections.push_back({world, {chart}});
}

void print_table(const Summary& summary) {
  std::printf("%-22s %-18s %10s %9s %8s %9s %8s %8s %8s %7s %7s  %s\n", "world", "utility",
              "efficiency", "deviation", "relative", "deviation", "95 % +-", "below", "95 % +-",
              "m flown", "s/step", "ended early");
  for (std::size_t r = 0; r < summary.shown.rows.size(); ++r) {
    const std::vector<TableCell>& cells = summary.shown.rows[r].cells;
    const auto text = [&](std::size_t k) { return std::get<std::string>(cells[k]).c_str(); };
    const auto at = [&](std::size_t k) { return std::get<double>(cells[k]); };
    std::printf("%-22s %-18s %10.0f %9.0f %8.3f %9.3f %8.3f %8.3f %8.3f %7.0f %7.3f  %s\n", text(0),
                text(1), at(2), at(3), at(4), at(5), at(6), at(7), at(8), at(9),
                summary.step_seconds[r], text(10));
  }
}

// Makes the folder ready: settings.json says what the episodes in it are. Nothing is taken away
// from a folder that is not an evaluation's.
void claim_folder(const ExploreEvaluation& request, Value stated) {
  const fs::path settings = request.folder / "settings.json";
  const fs::path episodes = request.folder / "episodes";
  if (fs::exists(episodes) && !fs::is_empty(episodes)) {
    if (!fs::exists(settings))
      throw InputError("'" + episodes.string() + "' is there, but no settings.json that says " +
                       "what it holds: choose another folder with -o");
    const Value there = from_json(read_file(settings), settings.string());
    if (!there.is_map() || !there.find("steps") || !there.find("lookahead"))
      throw InputError("'" + settings.string() +
                       "' is not of an evaluation of explorations: choose another folder with -o");
    if (!request.resume)
      throw InputError("'" + request.folder.string() + "' holds an evaluation: go on with " +
                       "--resume, or choose another folder with -o");
    if (const std::string difference = settings_difference(there, stated); !difference.empty()) {
      throw InputError("'" + settings.string() +
                       "': the evaluation there has other settings: " + difference);
    } else if (const Value* files = there.find("files")) {
      for (const auto& [name, sum] : files->as_map())
        if (!stated.at("files").find(name)) stated.find("files")->set(name, sum);
    }
  }
  write_file_atomically(settings, to_json(stated) + "\n");
}

}  // namespace

ExitStatus evaluate_explore(const ExploreEvaluation& request, const Invocation& invocation) {
  const Registry registry = invocation.registry();
  const Interruption interruption;
  std::vector<std::string> utilities = request.utilities;
  if (utilities.empty())
    for (const PluginEntry& entry : registry.entries())
      if (entry.kind == ViewUtility::kKind) utilities.push_back(entry.name);
  for (std::size_t k = 0; k < utilities.size(); ++k) {
    registry.find("utility", utilities[k]);
    if (std::find(utilities.begin(), utilities.begin() + static_cast<std::ptrdiff_t>(k),
                  utilities[k]) != utilities.begin() + static_cast<std::ptrdiff_t>(k))
      throw InputError("--utility " + utilities[k] + ": is named twice");
  }
  const std::vector<WorldName> names = distinct_worlds(request.worlds, "evaluate explore");
  for (const WorldName& name : names) require_world(name, request.up);
  ExplorationSetup setup;
  setup.episode.steps = request.steps;
  setup.episode.lookahead = request.lookahead;
  const Value moves = setup.set_moves(request.moves);
  setup.episode.cancellation = &interruption.token();
  if (request.sigma > 0 || request.dropped > 0)
    setup.episode.sensor.noise = DepthNoise{request.dropped, request.sigma};
  if (request.stereo > 0) {
    setup.episode.sensor.stereo.emplace();
    setup.episode.sensor.stereo->baseline = request.stereo;
  }
  Value parameters = Value::map();
  for (const std::string& text : invocation.overrides) apply_override(parameters, text);
  for (const auto& [name, given] : parameters.as_map()) {
    if (std::find(utilities.begin(), utilities.end(), name) == utilities.end())
      throw InputError("--set " + name + ": no such utility is evaluated");
    registry.create<ViewUtility>(name, given, name);
  }
  // What another run of other settings left would be taken for this one's.
  Value stated = Value::map();
  stated.set("program", std::string("lapwing ") + program_version());
  stated.set("steps", request.steps);
  stated.set("seed", static_cast<std::int64_t>(invocation.seed));
  stated.set("sigma", request.sigma);
  stated.set("dropped", request.dropped);
  stated.set("stereo", request.stereo);
  stated.set("lookahead", request.lookahead);
  stated.set("parameters", parameters);
  stated.set("moves", moves);
  stated.set("up", request.up);
  stated.set("files", checksums_of(names, utilities, parameters, registry));
  claim_folder(request, std::move(stated));

  for (const WorldName& name : names) {
    std::vector<Trial> trials;
    for (std::int64_t episode = 1; episode <= request.episodes; ++episode)
      for (const std::string& utility : utilities) {
        const Trial trial{name.text(), utility, episode};
        if (!fs::exists(request.folder / "episodes" / (trial.name() + ".json")))
          trials.push_back(trial);
      }
    if (trials.empty()) continue;
    const World world = load_world(name, request.up, registry, invocation);
    const GroundTruth truth = setup.truth_of(world);
    std::atomic<std::size_t> done{0};
    parallel_for(trials.size(), invocation.threads, [&](std::size_t k) {
      if (interruption.token().cancelled()) return;
      run_trial(trials[k], world, truth, setup, registry, parameters, invocation.seed,
                request.folder);
      const std::size_t count = ++done;
      if (!invocation.quiet)
        std::cerr << name.text() + ": " + std::to_string(count) + " of " +
                         std::to_string(trials.size()) + " episodes\n";
    });
    if (interruption.token().cancelled()) throw Cancelled();
  }
  Summary summary;
  summary.report.title = "Exploration";
  summary.report.subtitle = std::to_string(request.episodes) + " episodes of " +
                            std::to_string(request.steps) + " images in each world";
  summary.shown.title = "Efficiency (5.6), and relative to the oracle's from the same start";
  summary.shown.columns = {{"world", ""},
                           {"utility", ""},
                           {"efficiency", ""},
                           {"deviation", ""},
                           {"relative", ""},
                           {"deviation", ""},
                           {"95 % interval, half", ""},
                           {"below learned", ""},
                           {"95 % interval, half", ""},
                           {"length", "m"},
                           {"ended early", ""}};
  for (const WorldName& name : names) summarise_world(summary, name.text(), utilities, request);
  summary.report.sections.insert(summary.report.sections.begin(), {"Table", {summary.shown}});
  write_file_atomically(request.folder / "table.csv", summary.table);
  write_file_atomically(request.folder / "seconds.csv", summary.seconds);
  write_file_atomically(request.folder / "curves.csv", summary.curves);
  write_file_atomically(request.folder / "report.html", render_html(summary.report));
  if (!invocation.quiet) print_table(summary);
  return ExitStatus::done;
}

}  // namespace lapwing
