// SPDX-License-Identifier: Apache-2.0
#include "framework/flight_review/flight_review.h"

#include <algorithm>
#include <cmath>

#include "framework/core/number_text.h"
#include "framework/core/units.h"
#include "framework/flight_log/log_time.h"

namespace lapwing {
namespace {

std::string seconds(double value) {
  return plain_number(value, 6) + " s";
}

std::string spread(double value, double sigma, int digits) {
  char text[64];
  // No smaller than what is shown: "0.000" would be a claim.
  const double least = std::pow(10.0, -digits);
  std::snprintf(text, sizeof text, "%.*f \u00b1 %.*f", digits, value, digits,
                std::max(sigma, least));
  return text;
}

std::string offset_text(const FlightAlignment& a) {
  return spread(a.offset.x(), a.offset_sigma.x(), 3) + " m east, " +
         spread(a.offset.y(), a.offset_sigma.y(), 3) + " m north, " +
         spread(a.offset.z(), a.offset_sigma.z(), 3) + " m up";
}

void say_space(const FlightReview& review, std::vector<std::string>& said) {
  const FlightAlignment& a = review.alignment;
  if (review.asked.estimate_offset)
    said.push_back("positions of the log are corrected by " + offset_text(a));
  else
    said.emplace_back("positions of the log stand as they are");
  if (review.height_unknown)
    said.push_back("the log does not tell what its heights count from: they are corrected by " +
                   spread(a.offset.z(), a.offset_sigma.z(), 3) + " m");
  if (review.asked.estimate_turn)
    said.push_back("the log's local frame is turned by " +
                   spread(degrees(a.turn), degrees(a.turn_sigma), 2) + " degrees");
  if (review.beside > review.beside_limit)
    said.push_back("the flight was " + plain_number(review.beside, 3) +
                   " m beside the plan throughout, more than the " +
                   plain_number(review.beside_limit, 3) +
                   " m of the plan's margin or of a receiver");
  if (a.confounded)
    said.emplace_back(
        "the flight is so straight and even that a later clock and an offset along the path look "
        "the same: the smaller offset was taken; --no-offset or --time-offset settles it");
}

void say_loss(const FlightReview& review, std::vector<std::string>& said) {
  const FlightLog& log = review.log;
  if (!log.damage.empty())
    said.push_back("the log is damaged: " + log.damage + "; " + std::to_string(log.bytes_read) +
                   " of " + std::to_string(log.bytes) + " bytes were read (" +
                   plain_number(100.0 * static_cast<double>(log.bytes_read) /
                                    static_cast<double>(std::max<std::size_t>(1, log.bytes)),
                                3) +
                   " %)");
  if (review.missing_before > 0.05)
    said.push_back("the first " + seconds(review.missing_before) +
                   " of the plan are not in the log");
  if (review.missing_after > 0.05)
    said.push_back("the last " + seconds(review.missing_after) + " of the plan are not in the log");
  if (review.flown.longest_gap > 1)
    said.push_back("positions are missing for up to " + seconds(review.flown.longest_gap) +
                   "; the flown path is bridged there");
  double lost = 0;
  for (const LogGap& gap : log.gaps) lost += gap.duration;
  if (lost > 0)
    said.push_back("the recorder lost data in " + std::to_string(log.gaps.size()) + " spans, " +
                   seconds(lost) + " together");
  for (const std::string& remark : log.remarks) said.push_back(remark);
  for (const std::string& sentence : review.certificate.not_judged) said.push_back(sentence);
}

std::string rounded_up(double value, double to) {
  return plain_number(std::ceil(value / to - 1e-9) * to, 4);
}

// What helps against one broken check.
std::string cure_of(const FlownCheck& check, const Plan& plan, const FlightReview& review) {
  const Check& c = check.flown;
  const double worst = c.worst.value_or(NAN);
  if (c.name == "clearance" || c.name == "flight_zone") {
    const double lack = c.name == "clearance" ? c.limit - worst : worst - c.limit;
    return "plan with `margin` = " + rounded_up(plan.environment.margin + std::abs(lack), 0.05) +
           " m or more: the flight came " + plain_number(std::abs(lack), 3) +
           " m nearer than the plan allows";
  }
  if (c.name == "subject_distance")
    return "keep " + rounded_up(c.limit - worst, 0.1) + " m more distance from the subject";
  if (c.name == "height_above_home" || c.name == "distance_from_home") {
    const char* option = c.name == "height_above_home" ? "home.max_height" : "home.max_distance";
    return std::string("plan with `") + option +
           "` = " + plain_number(c.limit - (worst - c.limit)) + " m: the flight went " +
           plain_number(worst - c.limit, 3) + " m beyond it";
  }
  if (c.name == "pilot_distance")
    return "plan with `pilot.range` = " + plain_number(c.limit - (worst - c.limit)) +
           " m: the flight went " + plain_number(worst - c.limit, 3) + " m beyond it";
  if (c.name == "pilot_sight")
    return "place the pilot where more of the flight is seen, or plan with a larger `margin`: the "
           "vehicle was hidden for " +
           plain_number(worst, 3) + " s";
  if (c.name == "framing" || c.name == "line_of_sight") {
    const ErrorSeries* camera = find_error(review.errors, "camera");
    return "frame the subject with more room: " +
           (camera ? "the camera was up to " + plain_number(degrees(camera->quantile(0.95)), 3) +
                         " degrees (95 %) off"
                   : std::string("the vehicle was not where the plan has it"));
  }
  const bool limit = c.name.find("speed") != c.name.npos ||
                     c.name.find("acceleration") != c.name.npos ||
                     c.name.find("rate") != c.name.npos || c.name == "jerk";
  if (limit && worst > 0)
    return "plan with " + c.name + " at most " + plain_number(100 * c.limit / worst, 3) +
           " % of the vehicle's limit, so that what the controller adds stays within it";
  return "see " + c.name + " of the certificate";
}

}  // namespace

std::vector<std::string> alignment_sentences(const FlightReview& review) {
  const FlightAlignment& a = review.alignment;
  std::vector<std::string> said;
  said.push_back("positions are " + review.source + ", " +
                 std::to_string(review.flown.poses.size()) + " of them within the plan");
  said.push_back("time 0 of the plan is " + moment_in_words(review.log, a.clock, 3) +
                 (review.asked.clock
                      ? ", as stated"
                      : ", \u00b1 " + plain_number(std::max(a.clock_sigma, 0.001), 2) + " s") +
                 "; the log's clock counts from " + review.log.clock);
  if (a.stretched)
    said.emplace_back(
        "the flight took another time than the plan: the clocks are brought together "
        "at its beginning");
  say_space(review, said);
  say_loss(review, said);
  return said;
}

std::vector<std::string> advice_of(const Plan& plan, const FlightReview& review) {
  std::vector<std::string> advice;
  for (const FlownCheck& check : review.certificate.broken())
    advice.push_back(check.flown.name + ": " + cure_of(check, plan, review));
  if (const ErrorSeries* late = find_error(review.errors, "late")) {
    const double worst = late->values[late->worst()];
    if (worst > 0.5)
      advice.push_back("the flight fell behind by up to " + plain_number(worst, 3) + " s (at " +
                       plain_number(late->times[late->worst()], 4) +
                       " s): plan with the limits that it showed, `lapwing vehicle from LOG`");
  }
  if (const ErrorSeries* height = find_error(review.errors, "height");
      height && !review.asked.estimate_offset && std::abs(height->mean()) > 0.5)
    advice.push_back("the flight was " + plain_number(std::abs(height->mean()), 3) + " m too " +
                     (height->mean() > 0 ? "high" : "low") +
                     " throughout: check what the heights of the mission count from");
  Eigen::Vector3d offset = review.alignment.offset;
  if (review.height_unknown) offset.z() = 0;
  if (review.asked.estimate_offset && offset.norm() > 1)
    advice.push_back("the log is " + plain_number(offset.norm(), 3) +
                     " m from the plan throughout: check the origin, or correct the receiver");
  return advice;
}

}  // namespace lapwing
