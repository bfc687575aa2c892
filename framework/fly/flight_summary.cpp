// SPDX-License-Identifier: Apache-2.0
#include "framework/fly/flight_summary.h"

#include "framework/verify/tolerances.h"

namespace lapwing {
namespace {

Value vehicle_value(const VehicleReport& report) {
  Value value = Value::map();
  value.set("system", static_cast<int>(report.system));
  value.set("autopilot", report.autopilot_name().value_or("unknown"));
  value.set("armed", report.armed());
  value.set("mode", report.found() ? report.mode_name() : "unknown");
  if (report.battery_percent) value.set("battery_percent", *report.battery_percent);
  if (report.software) value.set("software", static_cast<std::int64_t>(*report.software));
  value.set("signed", report.has_signatures);
  return value;
}

Value link_value(const mavlink::ParserCounts& counts, const VehicleClock& clock) {
  Value value = Value::map();
  value.set("packets", static_cast<std::int64_t>(counts.packets));
  value.set("lost", static_cast<std::int64_t>(counts.lost));
  value.set("bad_checksums", static_cast<std::int64_t>(counts.bad_checksums));
  value.set("garbage_bytes", static_cast<std::int64_t>(counts.garbage));
  value.set("unknown_messages", static_cast<std::int64_t>(counts.unknown));
  value.set("delay", clock.delay());
  value.set("clock_jumps", clock.jumps());
  return value;
}

}  // namespace

bool followed_within(const FlightSession& session, double tolerance) {
  return session.end() == FlightEnd::flown && session.record().measured() > 0 &&
         session.record().place_worst().error <= tolerance &&
         session.record().yaw_worst().error <= tolerances::kTrackingYaw;
}

Value flight_summary(const FlightSession& session, const LiveFlight& flight, double tolerance,
                     const mavlink::ParserCounts& counts) {
  const FlightRecord& record = session.record();
  Value value = Value::map();
  value.set("mission", flight.plan.mission);
  value.set("end", std::string(to_string(session.end())));
  value.set("reason", session.reason());
  value.set("within_tolerance", followed_within(session, tolerance));
  value.set("tolerance", tolerance);
  value.set("plan_time", session.plan_time());
  value.set("plan_duration", flight.trajectory().duration());
  value.set("frame", session.frame().in_words());
  value.set("setpoints", static_cast<std::int64_t>(record.setpoints()));
  value.set("measured", static_cast<std::int64_t>(record.measured()));
  value.set("position_error_worst", record.place_worst().error);
  value.set("position_error_at", record.place_worst().plan_time);
  value.set("position_error_mean", record.place_mean());
  value.set("yaw_error_worst", record.yaw_worst().error);
  value.set("yaw_error_at", record.yaw_worst().plan_time);
  value.set("fence_items", static_cast<std::int64_t>(session.fence_items()));
  value.set("vehicle", vehicle_value(session.report()));
  value.set("link", link_value(counts, session.clock()));
  return value;
}

}  // namespace lapwing
