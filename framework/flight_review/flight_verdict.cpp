// SPDX-License-Identifier: Apache-2.0
// The review of a flight, and what it comes to.
#include <algorithm>
#include <array>
#include <cmath>

#include "framework/core/number_text.h"
#include "framework/flight_review/flight_review.h"

namespace lapwing {
namespace {

constexpr double kLongGap = 2;          // s between positions, above which the part is missing
constexpr double kMissing = 1;          // s, that may be missing,
constexpr double kMissingShare = 0.01;  // or this share of the plan

bool judges_a_place(const std::string& check) {
  constexpr std::array<std::string_view, 8> names{
      "clearance",           "flight_zone",        "subject_distance", "height_above_home",
      "height_above_ground", "distance_from_home", "pilot_distance",   "pilot_sight"};
  return std::find(names.begin(), names.end(), check) != names.end();
}

bool is_worse(const Check& check, const Check& than) {
  if (check.pass != than.pass) return than.pass;
  if (!check.worst || !than.worst) return false;
  return check.at_least ? *check.worst < *than.worst : *check.worst > *than.worst;
}

// Without the correction that has no cause but the alignment. Heights that count from something
// unknown stay corrected.
FlightAlignment standing(FlightAlignment alignment, bool height_unknown) {
  alignment.offset.head<2>().setZero();
  if (!height_unknown) alignment.offset.z() = 0;
  return alignment;
}

// The checks of places, by the positions as the log states them: the worse of both counts.
void judge_standing(const Plan& plan, const FlightLog& log, const FlownSeries& series,
                    const std::filesystem::path& folder, FlightReview& review) {
  const FlightAlignment alignment = standing(review.alignment, series.height_unknown);
  if ((alignment.offset - review.alignment.offset).norm() < 1e-6) return;
  const FlownTrack flown = flown_track(plan, log, series, alignment);
  const FlownCertificate certificate = judge_flown(plan, flown, folder);
  for (FlownCheck& check : review.certificate.checks) {
    const FlownCheck* other = certificate.find(check.flown.name);
    if (!other || !judges_a_place(check.flown.name) || !is_worse(other->flown, check.flown))
      continue;
    check = *other;
    check.flown.detail += std::string(check.flown.detail.empty() ? "" : ", ") +
                          "by the positions as the log states them";
  }
}

// Positions that stand as they are and lie too far from the plan to be matched: the match is made
// with an offset, of which only the clock is kept.
FlightAlignment aligned(const Plan& plan, const FlownSeries& series, AlignmentRequest asked,
                        double& beside) {
  const auto distance = [&](const FlightAlignment& found) {
    return (found.offset - standing(found, series.height_unknown).offset).norm();
  };
  if (asked.estimate_offset || series.local) {
    const FlightAlignment found = align_flight(plan.trajectory, series, asked);
    beside = series.local ? 0 : distance(found);
    return found;
  }
  AlignmentRequest free = asked;
  free.estimate_offset = true;
  try {
    const FlightAlignment found = align_flight(plan.trajectory, series, asked);
    free.clock = found.clock;
    try {
      beside = distance(align_flight(plan.trajectory, series, free));
    } catch (const AnotherFlight&) {  // it took another time: its places were matched as they are
      beside = 0;
    }
    return found;
  } catch (const AnotherFlight&) {
    const FlightAlignment found = align_flight(plan.trajectory, series, free);
    beside = distance(found);
    return standing(found, series.height_unknown);
  }
}

// What of the plan the log does not hold.
void find_missing(const Plan& plan, const FlownSeries& series, FlightReview& review) {
  const auto& samples = plan.trajectory.samples;
  const double first = review.alignment.plan_time(series.start());
  const double last = review.alignment.plan_time(series.finish());
  review.duration = samples.back().time - samples.front().time;
  review.missing_before = std::max(0.0, first - samples.front().time);
  review.missing_after = std::max(0.0, samples.back().time - last);
  const auto& poses = review.flown.poses;
  for (std::size_t i = 1; i < poses.size(); ++i)
    if (const double gap = poses[i].time - poses[i - 1].time; gap > kLongGap)
      review.missing_between += gap;
}

}  // namespace

bool FlightReview::broke() const {
  return std::any_of(certificate.checks.begin(), certificate.checks.end(), [](const FlownCheck& c) {
    return c.flown.required && !c.flown.pass && c.planned_pass;
  });
}

double FlightReview::share() const {
  const double missing = missing_before + missing_after + missing_between;
  return duration > 0 ? std::clamp(1 - missing / duration, 0.0, 1.0) : 0;
}

bool FlightReview::complete() const {
  return (1 - share()) * duration <= std::max(kMissing, kMissingShare * duration);
}

bool FlightReview::kept() const {
  return !broke() && !certificate.checks.empty() && beside <= beside_limit && complete();
}

std::string verdict_of(const FlightReview& review) {
  std::string said;
  const auto say = [&](const std::string& what) { said += (said.empty() ? "" : ", ") + what; };
  if (review.broke()) say("broke limits that the plan keeps");
  if (review.beside > review.beside_limit)
    say(plain_number(review.beside, 3) + " m beside the plan");
  if (review.certificate.checks.empty()) say("the limits could not be judged");
  if (!review.complete())
    say((said.empty() ? "kept as far as the log goes (" : "the log holds a part (") +
        plain_number(std::floor(100 * review.share()), 3) + " %)");
  return said.empty() ? "flown as planned" : said;
}

FlightReview review_flight(const Plan& plan, FlightLog log, const AlignmentRequest& asked,
                           const std::filesystem::path& folder) {
  FlightReview review;
  review.asked = asked;
  const FlownSeries series = flown_series(log, plan);
  review.asked.estimate_turn = asked.estimate_turn && series.local;
  review.source = series.source;
  review.height_unknown = series.height_unknown;
  review.alignment = aligned(plan, series, review.asked, review.beside);
  review.beside_limit = std::max(plan.environment.margin, kReceiverOffset);
  review.flown = flown_track(plan, log, series, review.alignment);
  review.errors = flight_errors(plan, review.flown);
  review.certificate = judge_flown(plan, review.flown, folder);
  if (!series.local) judge_standing(plan, log, series, folder, review);
  if (series.local)
    review.certificate.not_judged.emplace_back(
        "nothing places the log's local frame in the world: clearance, flight zones and distances "
        "are judged as if the flight began where the plan has it");
  find_missing(plan, series, review);
  review.log = std::move(log);
  return review;
}

}  // namespace lapwing
