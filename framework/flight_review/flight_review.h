// SPDX-License-Identifier: Apache-2.0
// A flown flight against its plan: all that `lapwing compare` says.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/core/error.h"
#include "framework/core/value.h"
#include "framework/export/report.h"
#include "framework/flight_review/flight_errors.h"
#include "framework/flight_review/flown_certificate.h"

namespace lapwing {

struct FlightReview {
  FlightLog log;
  std::string source;           // of the positions, in words
  bool height_unknown = false;  // what the log's heights count from: their offset is no error
  AlignmentRequest asked;
  FlightAlignment alignment;
  FlownTrack flown;
  std::vector<ErrorSeries> errors;
  FlownCertificate certificate;
  double missing_before = 0, missing_after = 0;  // s of the plan that the log does not hold
  double missing_between = 0;                    // s, in gaps of the positions longer than 2 s
  double duration = 0;                           // s, of the plan
  // m: how far the flight was beside the plan throughout; 0 where nothing places the log in the
  // world. Up to `beside_limit` the receiver explains it.
  double beside = 0, beside_limit = 0;

  // Whether the flight broke a required check that the plan keeps.
  bool broke() const;
  bool complete() const;  // at most 1 s, or 1 % of the plan, is missing
  double share() const;   // of the plan that the log holds
  // All of the plan was flown, at its place, and nothing was broken.
  bool kept() const;
};

// "flown as planned", or what is wrong, as a few words.
std::string verdict_of(const FlightReview& review);

// m: what the position of a receiver without corrections may be off throughout. u-blox states 2.5 m
// for half of the positions of the NEO-M8 (data sheet UBX-15031086).
inline constexpr double kReceiverOffset = 3;

// Clearance, flight zones and distances from subjects are judged on the positions as the log states
// them as well, where it places them in the world; the worse counts. Throws as flown_series,
// align_flight and flown_track do. `folder`: where the plan is.
FlightReview review_flight(const Plan& plan, FlightLog log, const AlignmentRequest& asked,
                           const std::filesystem::path& folder);

// How both were brought together, and what of the log is missing, as sentences.
std::vector<std::string> alignment_sentences(const FlightReview& review);
// What would have to change so that the next flight keeps the plan; empty: nothing.
std::vector<std::string> advice_of(const Plan& plan, const FlightReview& review);

// SI and radians.
Value to_value(const Plan& plan, const FlightReview& review);

// The page: paths, errors over time, broken limits, views.
Report review_report(const Plan& plan, const FlightReview& review,
                     const std::filesystem::path& folder);

}  // namespace lapwing
