// SPDX-License-Identifier: Apache-2.0
// Places of a plan on the earth, for formats that want latitude, longitude and height.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/geometry/geodetic_origin.h"
#include "framework/trajectory/plan.h"

namespace lapwing {

struct EarthPoint {
  double latitude_deg = 0, longitude_deg = 0;
  double height = 0;  // m, above what the frame's `heights` says
};

class EarthFrame {
 public:
  // Heights of its points are above `heights`; absent: above what the plan's origin says. Throws
  // InputError, beginning with `format`, for a plan without an origin, and for heights that the
  // origin does not tell: only those above ellipsoid and sea can be converted into each other, by
  // the geoid's height at the origin.
  EarthFrame(const Plan& plan, std::optional<HeightOf> heights, std::string format);

  // Of a point of the world, m. Throws InputError for one that is not finite.
  EarthPoint at(const Eigen::Vector3d& p_W) const;
  Eigen::Vector3d local(const EarthPoint& point) const;

  const GeodeticOrigin& origin() const { return origin_; }
  HeightOf heights() const { return heights_; }

  // What every export says: "WGS 84, origin 46.5191, 6.5668 at 395 m above the sea; 81 points,
  // heights from 397 m to 402 m above the sea".
  std::string sentence(const std::vector<EarthPoint>& points) const;
  // "the sea", "the ground at the origin"
  static std::string in_words(HeightOf reference);

 private:
  std::string format_;
  GeodeticOrigin origin_;
  HeightOf heights_;
  double offset_ = 0;  // m, of a height above `heights_` to one above the frame's own zero
};

// The plan's path at these times as points of the world, m. Throws InputError beginning with
// `format` for fewer than two times: a flight of no length is no path.
std::vector<Eigen::Vector3d> path_at(const Plan& plan, const std::vector<double>& times,
                                     const std::string& format);

// How far straight lines through `points`, reached at `times` (s), are from the plan at most, tried
// at four places between each two.
struct PathDeviation {
  double distance = 0, time = 0;  // m, s
};
PathDeviation deviation_of_path(const Plan& plan, const std::vector<double>& times,
                                const std::vector<Eigen::Vector3d>& points);

// "46.519100000": rounded to so many decimals, without an exponent; never "-0.00".
std::string fixed_number(double value, int decimals);

}  // namespace lapwing
