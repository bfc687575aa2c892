// SPDX-License-Identifier: Apache-2.0
// The fleet document: several plans that are flown as one, by several drones or with several
// batteries.
//
// `fleet.json` lies beside the plans that it names (plan_1.json, ...). It states who flies each of
// them and when. Like a plan it holds no wall-clock figure, so that the same mission and seed give
// the same bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "framework/core/value.h"

namespace lapwing {

// A plan, who flies it, and when.
struct FleetTour {
  std::string drone;   // a name; tours of one name are flown by one vehicle
  int battery = 1;     // from 1; a drone flies its tours in this order
  double start = 0;    // s after the fleet begins: time 0 of the plan
  std::string file;    // in the folder of the fleet document
  std::string sha256;  // of the bytes of that file
};

struct Fleet {
  static constexpr int kFormat = 1;
  static constexpr std::size_t kMostTours = 1000;
  std::string mission;    // name as the script gave it
  std::string kind;       // scan
  double separation = 0;  // m, least distance between two drones in flight
  double swap = 0;        // s, least time between two tours of one drone: landing, swap, climb
  double reserve = 0;     // s of flight, least that is left of a battery after its tour
  std::int64_t seen = 0;  // voxels of the region that the views of all tours together see
  double seen_share = 1;  // of them that must be seen again when the views are cast anew
  std::vector<FleetTour> tours;  // in the order of their starts
  Value solver;       // what the solver of the tours said of all of them together; opaque
  Value certificate;  // as verify writes it
};

// "drone 1, battery 2"
std::string name_of_tour(const FleetTour& tour);

// How often a battery is changed: once before every tour of a drone but its first.
int swaps_of(const Fleet& fleet);
// "plan_2.json": the file of the tour at this place among the tours, from 0.
std::string fleet_plan_name(std::size_t tour);

// The document, its digest left out.
Value to_value(const Fleet& fleet);
// InputError listing every missing, misspelt, mistyped or non-finite field, and another format
// number. It judges form alone: whether tours overlap is for the verifier to report.
Fleet fleet_from_value(const Value& value);

// The bytes of fleet.json, with its digest last (plan_digest.h).
std::string fleet_text(const Fleet& fleet);

// Whether a JSON document is a fleet's rather than a plan's.
bool is_fleet(const Value& document);

}  // namespace lapwing
