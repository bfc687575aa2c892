// SPDX-License-Identifier: Apache-2.0
#include "framework/flight_review/flown_series.h"

#include <algorithm>

#include "framework/core/error.h"
#include "framework/export/earth_frame.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

Vector3d row_of(const LogSeries& series, std::size_t i) {
  return {series.values[3 * i], series.values[3 * i + 1], series.values[3 * i + 2]};
}

std::string in_words(const char* what, const LogSeries& series) {
  return what + (series.source.empty() ? std::string() : " (" + series.source + ")");
}

// Whether heights above one can be told as heights above the other.
bool comparable(HeightOf a, HeightOf b) {
  return a == b || (a != HeightOf::ground && b != HeightOf::ground);
}

// Heights that cannot be told are taken as those of the plan: their offset is estimated.
EarthFrame frame_of(const FlightLog& log, const Plan& plan, bool& unknown) {
  const HeightOf own = plan.geodetic_origin->height_of;
  unknown = !log.heights || !comparable(*log.heights, own);
  if (!unknown) try {
      return EarthFrame(plan, *log.heights, "flight log");
    } catch (const InputError&) {  // no geoid is installed
      unknown = true;
    }
  return EarthFrame(plan, own, "flight log");
}

// A point of the log's local frame, which stands upright on the earth at its reference.
FlownSeries placed(const FlightLog& log, const LogSeries& series, const Plan& plan) {
  FlownSeries flown;
  const EarthFrame frame = frame_of(log, plan, flown.height_unknown);
  flown.times = series.times;
  flown.source = in_words("the local position and its reference", series);
  const GeodeticPoint& reference = *log.reference;
  for (std::size_t i = 0; i < series.size(); ++i) {
    const GeodeticPoint point = to_geodetic(reference, row_of(series, i));
    flown.positions.push_back(
        frame.local({point.latitude_deg, point.longitude_deg, point.altitude}));
  }
  return flown;
}

FlownSeries geodetic(const FlightLog& log, const LogSeries& series, const Plan& plan,
                     const char* what) {
  FlownSeries flown;
  const EarthFrame frame = frame_of(log, plan, flown.height_unknown);
  flown.times = series.times;
  flown.source = in_words(what, series);
  for (std::size_t i = 0; i < series.size(); ++i) {
    const Vector3d row = row_of(series, i);
    flown.positions.push_back(frame.local({row.x(), row.y(), row.z()}));
  }
  return flown;
}

FlownSeries local(const FlightLog& log, const LogSeries& series) {
  FlownSeries flown;
  flown.times = series.times;
  flown.source = in_words("the local position", series);
  // Lapwing's own files are in the world of the plan.
  flown.local = log.recorder != "Lapwing";
  for (std::size_t i = 0; i < series.size(); ++i) flown.positions.push_back(row_of(series, i));
  return flown;
}

FlownSeries chosen(const FlightLog& log, const Plan& plan) {
  const LogSeries* position = log.find("position");
  const bool origin = plan.geodetic_origin.has_value();
  if (position && origin && log.reference) return placed(log, *position, plan);
  for (const auto& [name, what] : {std::pair{"place", "the estimated latitude and longitude"},
                                   {"gps", "the receiver's latitude and longitude"}})
    if (const LogSeries* series = log.find(name); series && origin)
      return geodetic(log, *series, plan, what);
  if (position) return local(log, *position);
  if (log.find("place") || log.find("gps"))
    throw InputError(
        "the log holds latitudes and longitudes, and the plan has no origin; state it as `origin` "
        "in the mission or with --origin LAT,LON,HEIGHT,OF");
  throw InputError("the log holds no position");
}

}  // namespace

std::optional<Vector3d> FlownSeries::at(double time, double longest_gap) const {
  if (!(time >= times.front() && time <= times.back())) return std::nullopt;
  const auto after = std::upper_bound(times.begin(), times.end(), time);
  if (after == times.end()) return positions.back();
  const std::size_t j = static_cast<std::size_t>(after - times.begin());
  const double step = times[j] - times[j - 1];
  if (step > longest_gap) return std::nullopt;
  const double share = (time - times[j - 1]) / step;
  return positions[j - 1] + share * (positions[j] - positions[j - 1]);
}

FlownSeries flown_series(const FlightLog& log, const Plan& plan) {
  FlownSeries flown = chosen(log, plan);
  if (flown.times.size() < 2) throw InputError("the log holds a single position: no flight");
  return flown;
}

}  // namespace lapwing
