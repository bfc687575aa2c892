// SPDX-License-Identifier: Apache-2.0
// Where the coordinates of a surveyor's data lie: what the data, the user and the mission say of
// it, brought together.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "framework/geometry/geodetic_origin.h"
#include "framework/survey/site_frame.h"

namespace lapwing {

struct StatedReference {
  std::string name;    // of the data, in messages
  std::string option;  // of the table in which the user states the next four: "cloud"
  std::string system;  // "" where the user states none
  std::optional<Eigen::Vector3d> zero;       // in the data's coordinates: the world's origin
  std::optional<double> unit, height_unit;   // m, of x, y and z without a system; of z with one
  std::string system_of_data, note_of_data;  // "" where the data say nothing
  double height_unit_of_data = 0;            // m; 0 where they do not say
  Eigen::Vector3d sample = Eigen::Vector3d::Zero();  // a place of the data, near their middle
  double lowest = 0;                                 // z of the data, about
  std::optional<GeodeticOrigin> origin;              // of the mission
  // The world's origin as other data of the site have settled it, in place of all other sources.
  std::optional<GeodeticPoint> world = std::nullopt;
};

struct SiteReference {
  SiteFrame frame;
  std::vector<std::string> notes;        // sentences for the user
  std::optional<GeodeticOrigin> origin;  // of the world, where the mission has none and data tell
  std::optional<GeodeticPoint> world;    // the world's origin as the frame has it, with a system
};

// Without a system: coordinates are in `unit`, m where that is not stated, and `zero`, or their own
// zero, is the world's origin.
//
// With one: the mission's origin is the world's. Without that the sample's place is, rounded to
// 1e-5 degrees, at the lowest height, rounded down to metres; it is the origin of the mission where
// the system has a vertical part. Heights of such a system become heights above the ellipsoid.
// Where PROJ lacks the grid for them, and for a system without a vertical part, heights are taken
// to be above the same surface as origin.height, in `height_unit`, what the data say, or the unit
// of x and y; a note says so.
//
// InputError, naming the data and what to state: coordinates without a system that lie more than
// 1e5 m from the world's origin; a zero or a unit beside a system; an origin whose height is above
// the ground, which does not tell how high the data are; and all that ReferenceSystem::of refuses.
SiteReference refer_site(const StatedReference& stated);

// InputError where data without a reference system look like degrees of longitude and latitude:
// their x and y lie within 180 and 90, extend over less than 0.5, and over less than 0.2 of their
// extent in z.
void require_no_degrees(const StatedReference& stated, const Eigen::AlignedBox3d& bounds);

// m from the world's origin; coordinates beyond are refused.
inline constexpr double kFarthestSite = 1e5;

}  // namespace lapwing
