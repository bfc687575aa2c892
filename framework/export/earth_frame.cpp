// SPDX-License-Identifier: Apache-2.0
#include "framework/export/earth_frame.h"

#include <charconv>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/trajectory/interpolate.h"

namespace lapwing {
namespace {

const GeodeticOrigin& required_origin(const Plan& plan, const std::string& format) {
  if (!plan.geodetic_origin)
    throw InputError(format + ": '" + plan.mission +
                     "' has no origin on the earth. State `origin = { latitude_deg =, "
                     "longitude_deg =, height =, height_of = }` in the mission, or "
                     "`--origin LAT,LON,HEIGHT,OF`");
  return *plan.geodetic_origin;
}

// m, of a height above `heights` to one above the zero that the origin's point counts from.
double offset_between(const GeodeticOrigin& origin, HeightOf heights, const std::string& format) {
  if (origin.height_of == heights) return heights == HeightOf::sea ? origin.geoid_height : 0;
  if (origin.height_of == HeightOf::ground || heights == HeightOf::ground)
    throw InputError(format + ": heights in the file are above " + EarthFrame::in_words(heights) +
                     ", and the origin states one above " + EarthFrame::in_words(origin.height_of) +
                     "; state an origin of that kind, or the parameter `heights`");
  if (heights == HeightOf::ellipsoid) return 0;
  try {
    return geoid_height_at(origin.latitude_deg, origin.longitude_deg, format);
  } catch (const InputError& error) {
    throw InputError(error.what() + std::string("; or write heights above the ellipsoid, as ") +
                     "`--format gpx:heights=ellipsoid` and `--format geojson` do");
  }
}

}  // namespace

std::string EarthFrame::in_words(HeightOf reference) {
  return reference == HeightOf::ellipsoid ? "the ellipsoid"
         : reference == HeightOf::sea     ? "the sea"
                                          : "the ground at the origin";
}

EarthFrame::EarthFrame(const Plan& plan, std::optional<HeightOf> heights, std::string format)
    : format_(std::move(format)),
      origin_(required_origin(plan, format_)),
      heights_(heights.value_or(origin_.height_of)),
      offset_(offset_between(origin_, heights_, format_)) {}

EarthPoint EarthFrame::at(const Eigen::Vector3d& p_W) const {
  if (!p_W.allFinite()) throw InputError(format_ + ": a place of the plan is not finite");
  const GeodeticPoint point = to_geodetic(origin_.point(), p_W);
  return {point.latitude_deg, point.longitude_deg, point.altitude - offset_};
}

Eigen::Vector3d EarthFrame::local(const EarthPoint& point) const {
  return to_local(origin_.point(),
                  {point.latitude_deg, point.longitude_deg, point.height + offset_});
}

std::string EarthFrame::sentence(const std::vector<EarthPoint>& points) const {
  std::string said =
      "WGS 84, origin " + plain_number(origin_.latitude_deg, 10) + ", " +
      plain_number(origin_.longitude_deg, 10) + " at " + plain_number(origin_.height) +
      " m above " +
      (origin_.height_of == HeightOf::ground ? "the ground there" : in_words(origin_.height_of)) +
      "; " + std::to_string(points.size()) + " points";
  if (points.empty()) return said;
  double lowest = points.front().height, highest = lowest;
  for (const EarthPoint& point : points) {
    lowest = std::min(lowest, point.height);
    highest = std::max(highest, point.height);
  }
  return said + ", heights from " + plain_number(lowest, 5) + " m to " + plain_number(highest, 5) +
         " m above " + in_words(heights_);
}

std::vector<Eigen::Vector3d> path_at(const Plan& plan, const std::vector<double>& times,
                                     const std::string& format) {
  if (times.size() < 2)
    throw InputError(format + ": the flight of '" + plan.mission +
                     "' has no length: a path needs two points");
  std::vector<Eigen::Vector3d> points;
  for (const double time : times) points.push_back(sample_at(plan.trajectory, time).position);
  return points;
}

PathDeviation deviation_of_path(const Plan& plan, const std::vector<double>& times,
                                const std::vector<Eigen::Vector3d>& points) {
  constexpr int kTried = 4;
  PathDeviation worst;
  const std::size_t count = std::min(times.size(), points.size());
  for (std::size_t i = 0; i + 1 < count; ++i)
    for (int k = 0; k <= kTried; ++k) {
      const double share = static_cast<double>(k) / kTried;
      const double time = times[i] + share * (times[i + 1] - times[i]);
      const Eigen::Vector3d shown = points[i] + share * (points[i + 1] - points[i]);
      const double distance = (sample_at(plan.trajectory, time).position - shown).norm();
      if (distance > worst.distance) worst = {distance, time};
    }
  return worst;
}

std::string fixed_number(double value, int decimals) {
  char buffer[400];
  const auto result =
      std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::fixed, decimals);
  std::string text(buffer, result.ptr);
  if (text.front() == '-' && text.find_first_of("123456789") == std::string::npos) text.erase(0, 1);
  return text;
}

}  // namespace lapwing
