// SPDX-License-Identifier: Apache-2.0
#include "framework/trajectory/fleet.h"

#include <set>

#include "framework/core/error.h"
#include "framework/core/fields.h"
#include "framework/core/json.h"
#include "framework/trajectory/plan_digest.h"

namespace lapwing {
namespace {

constexpr int kMostBatteries = 1'000'000;
constexpr const char* kFleetKey = "fleet_format";

// Whether a text names a file in the folder of the document, and nothing elsewhere.
bool is_plain_name(const std::string& file) {
  return !file.empty() && file != "." && file != ".." &&
         file.find_first_of(std::string_view("/\\\0", 3)) == file.npos;
}

FleetTour tour_from(Fields& fields) {
  FleetTour tour;
  tour.drone = fields.text("drone");
  tour.battery = fields.integer("battery", 1, kMostBatteries);
  tour.start = fields.number("start");
  tour.file = fields.text("file");
  tour.sha256 = fields.text("sha256");
  fields.finish();
  return tour;
}

}  // namespace

std::string name_of_tour(const FleetTour& tour) {
  return "drone " + tour.drone + ", battery " + std::to_string(tour.battery);
}

int swaps_of(const Fleet& fleet) {
  std::set<std::string> drones;
  for (const FleetTour& tour : fleet.tours) drones.insert(tour.drone);
  return static_cast<int>(fleet.tours.size() - drones.size());
}

std::string fleet_plan_name(std::size_t tour) {
  return "plan_" + std::to_string(tour + 1) + ".json";
}

Value to_value(const Fleet& fleet) {
  Value value = Value::map();
  value.set(kFleetKey, std::int64_t{Fleet::kFormat});
  value.set("mission", fleet.mission);
  value.set("kind", fleet.kind);
  value.set("separation", fleet.separation);
  value.set("swap", fleet.swap);
  value.set("reserve", fleet.reserve);
  value.set("seen", fleet.seen);
  value.set("seen_share", fleet.seen_share);
  Value& tours = value.set("tours", Value::list());
  for (const FleetTour& tour : fleet.tours) {
    Value row = Value::map();
    row.set("drone", tour.drone);
    row.set("battery", std::int64_t{tour.battery});
    row.set("start", tour.start);
    row.set("file", tour.file);
    row.set("sha256", tour.sha256);
    tours.push_back(std::move(row));
  }
  if (!fleet.solver.is_null()) value.set("solver", fleet.solver);
  if (!fleet.certificate.is_null()) value.set("certificate", fleet.certificate);
  return value;
}

Fleet fleet_from_value(const Value& value) {
  Diagnostics errors;
  Fields fields(value, "", errors);
  const std::int64_t format = fields.integer(kFleetKey);
  if (fields.has(kFleetKey) && format != Fleet::kFormat)
    throw InputError(value.origin(), std::string(kFleetKey) + " " + std::to_string(format) +
                                         "; this version reads " + std::to_string(Fleet::kFormat));
  Fleet fleet;
  fleet.mission = fields.text("mission");
  fleet.kind = fields.text("kind");
  fleet.separation = fields.number("separation");
  fleet.swap = fields.number("swap");
  fleet.reserve = fields.number("reserve");
  fleet.seen = fields.integer("seen");
  fleet.seen_share = fields.number("seen_share");
  std::vector<Fields> tours = fields.tables("tours");
  if (tours.size() > Fleet::kMostTours)
    throw InputError(value.origin(), "tours: expected at most " +
                                         std::to_string(Fleet::kMostTours) + ", got " +
                                         std::to_string(tours.size()));
  for (Fields& tour : tours) {
    fleet.tours.push_back(tour_from(tour));
    const std::string& file = fleet.tours.back().file;
    if (!file.empty() && !is_plain_name(file))
      errors.add(value.origin(), "tours.file",
                 "expected the name of a file beside the fleet document, got '" + file + "'");
  }
  fleet.solver = fields.opaque("solver");
  fleet.certificate = fields.opaque("certificate");
  fields.opaque("digest");
  fields.finish();
  errors.throw_if_any();
  return fleet;
}

std::string fleet_text(const Fleet& fleet) {
  Value document = to_value(fleet);
  document.set("digest", digest_of(document));
  return to_json(document) + "\n";
}

bool is_fleet(const Value& document) {
  return document.is_map() && document.find(kFleetKey) != nullptr;
}

}  // namespace lapwing
