// SPDX-License-Identifier: Apache-2.0
// lapwing race.
#include <charconv>
#include <cstdio>

#include "framework/app/command_line.h"
#include "framework/app/output_target.h"
#include "framework/app/provenance.h"
#include "framework/core/files.h"
#include "framework/core/parameters.h"
#include "framework/core/visible_text.h"
#include "framework/export/race_report.h"
#include "framework/verify/verify.h"

namespace lapwing {
namespace {

double number_of(const std::string& key, std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size())
    throw InputError("--pilot: " + key + " must be a number, got '" + std::string(text) + "'");
  return value;
}

void set(Pilot& pilot, const std::string& key, std::string_view text) {
  if (key == "name")
    pilot.name = text;
  else if (key == "weight")
    pilot.weight = number_of(key, text);
  else if (key == "strength")
    pilot.strength = number_of(key, text);
  else if (key == "reach")
    pilot.reach = number_of(key, text);
  else if (key == "speed")
    pilot.speed = number_of(key, text);
  else if (key == "handicap")
    pilot.handicap = number_of(key, text);
  else {
    const std::vector<std::string> known = {"name",  "weight", "strength",
                                            "reach", "speed",  "handicap"};
    const std::string nearest = nearest_name(key, known);
    std::string all;
    for (const std::string& name : known) all += (all.empty() ? "" : ", ") + name;
    throw InputError("--pilot: unknown '" + key + "'; " +
                     (nearest.empty() ? "" : "did you mean '" + nearest + "'?; ") + "a pilot has " +
                     all);
  }
}

}  // namespace

Pilot pilot_from(const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::filesystem::path file = text.substr(0, colon);
  Pilot pilot{.name = file.stem().string(), .log = read_stick_log(file)};
  std::string_view rest =
      colon == std::string::npos ? "" : std::string_view(text).substr(colon + 1);
  while (!rest.empty()) {
    const std::string_view entry = rest.substr(0, rest.find(','));
    rest.remove_prefix(std::min(rest.size(), entry.size() + 1));
    const std::size_t equal = entry.find('=');
    if (equal == std::string_view::npos)
      throw InputError("--pilot: expected LOG[:key=value,...], got '" + std::string(entry) + "'");
    set(pilot, std::string(entry.substr(0, equal)), entry.substr(equal + 1));
  }
  return pilot;
}

ExitStatus race_plan(const std::filesystem::path& file, const std::vector<std::string>& pilots,
                     const RaceRules& rules, const std::filesystem::path& target,
                     const Invocation& invocation) {
  if (pilots.empty()) throw InputError("race: name at least one pilot: --pilot LOG");
  if (!(rules.deviation_price >= 0 && rules.gate_price >= 0))
    throw InputError("race: prices must be at least 0 s");
  if (!target.empty()) require_output(target, {file});
  const Plan plan = read_plan_file(file);
  const Certificate certificate = verify(plan, file.parent_path());
  if (const Check* document = certificate.find("document"); !document->pass)
    throw InputError("the plan is inconsistent: " + document->detail);
  const Vehicle vehicle = vehicle_from_value(plan.vehicle);
  std::vector<RacedPilot> raced;
  for (const std::string& text : pilots) {
    Pilot pilot = pilot_from(text);
    RaceFlight flight =
        fly_race(plan.trajectory, vehicle, pilot, race_limits(plan.trajectory, plan.task.gates));
    RaceScore score = score_of(flight, plan.trajectory, plan.task.gates, pilot.handicap, rules);
    raced.push_back({std::move(pilot), std::move(flight), std::move(score)});
  }
  if (!target.empty()) write_file_atomically(target, render_html(race_report(plan, raced, rules)));
  if (invocation.json) {
    Value object = Value::map();
    object.set("plan", file.string());
    object.set("mission", plan.mission);
    object.set("game", to_value(raced));
    print_json(object);
  } else {
    std::printf("%s\n%s", visible_line(plan.mission).c_str(),
                visible_text(race_result(raced)).c_str());
  }
  return winner_of(raced) < 0 ? ExitStatus::not_certified : ExitStatus::done;
}

}  // namespace lapwing
