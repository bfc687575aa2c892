// SPDX-License-Identifier: Apache-2.0
#include "framework/trajectory/fleet.h"

#include "framework/core/error.h"
#include "framework/core/fields.h"
#include "framework/core/json.h"
#include "framework/trajectory/plan_digest.h"

namespace lapwing {
namespace {

constexpr int kMostBatteries = 1'000'000;
constexpr const char* kFleetKey = "fleet_format";

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
  value.set("coverage", fleet.coverage);
  if (fleet.coverage_asked) value.set("coverage_asked", *fleet.coverage_asked);
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
  fleet.coverage = fields.number("coverage");
  fleet.coverage_asked = fields.optional_number("coverage_asked");
  for (Fields& tour : fields.tables("tours")) fleet.tours.push_back(tour_from(tour));
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
