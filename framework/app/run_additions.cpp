// SPDX-License-Identifier: Apache-2.0
#include "framework/app/run_additions.h"

#include "framework/core/png.h"
#include "framework/export/light_painting.h"
#include "framework/export/race_report.h"
#include "framework/vehicle/closed_loop.h"

namespace lapwing {
namespace {

std::vector<RacedPilot> flown_by_pilots(const MissionResult& result,
                                        const CancellationToken& token) {
  const Plan& plan = result.plan;
  const Vehicle vehicle = vehicle_from_value(plan.vehicle);
  std::vector<RacedPilot> raced;
  const RaceFlightLimits limits = race_limits(plan.trajectory, plan.task.gates);
  for (const Pilot& pilot : result.pilots) {
    RaceFlight flight = fly_race(plan.trajectory, vehicle, pilot, limits, &token);
    RaceScore score = score_of(flight, plan.trajectory, plan.task.gates, pilot.handicap);
    raced.push_back({pilot, std::move(flight), std::move(score)});
  }
  return raced;
}

RunAddition not_flown(const std::string& why) {
  RunAddition made;
  made.failure = "the players did not fly: " + why;
  TextBlock text;
  text.text = made.failure;
  made.sections = {Section{"Game", {text}}};
  made.key = "game";
  made.figures.set("not_flown", why);
  return made;
}

std::optional<RunAddition> game(const MissionResult& result, const Certificate& certificate,
                                const CancellationToken& token) {
  if (result.pilots.empty()) return std::nullopt;
  const Check* document = certificate.find("document");
  if (document && !document->pass)
    return not_flown("the plan is inconsistent: " + document->detail);
  try {
    if (token.cancelled()) throw Cancelled();
    const std::vector<RacedPilot> raced = flown_by_pilots(result, token);
    RunAddition made;
    made.sections = race_sections(result.plan, raced, {});
    made.key = "game";
    made.figures = to_value(raced);
    made.summary = race_result(raced);
    return made;
  } catch (const Cancelled&) {
    return not_flown("interrupted; fly them with lapwing race PLAN --pilot LOG");
  } catch (const Error& error) {
    return not_flown(error.what());
  }
}

// Of the flight under control.
std::optional<RunAddition> photograph(const MissionResult& result, const Certificate&,
                                      const CancellationToken&) {
  constexpr int kWidth = 1000;  // pixels
  const Plan& plan = result.plan;
  if (plan.lights.empty()) return std::nullopt;
  const FlownPath flown = fly(plan.trajectory, vehicle_from_value(plan.vehicle));
  RunAddition made;
  made.long_exposure = encode_png(long_exposure(plan, flown, kWidth));
  const Image image{*made.long_exposure, "What a camera with an open shutter sees of the flight"};
  made.sections = {Section{"Long exposure", {image}}};
  return made;
}

}  // namespace

std::vector<RunAddition> run_additions(const MissionResult& result, const Certificate& certificate,
                                       const CancellationToken& token) {
  std::vector<RunAddition> all;
  for (const auto add : {&photograph, &game})
    if (std::optional<RunAddition> made = add(result, certificate, token))
      all.push_back(std::move(*made));
  return all;
}

}  // namespace lapwing
