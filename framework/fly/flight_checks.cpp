// SPDX-License-Identifier: Apache-2.0
#include "framework/fly/flight_checks.h"

#include <algorithm>
#include <cmath>

#include "framework/core/number_text.h"
#include "framework/mavlink/vocabulary.h"

namespace lapwing {

using namespace mavlink;

namespace {

constexpr double kReserve = 20;         // percent of the battery, left at the end
constexpr double kOffHome = 10;         // m across the ground, of the plan's home
constexpr double kOffHomeHeight = 10;   // m; heights by satellite alone are this uncertain
constexpr double kFarFromHome = 10000;  // m, of the plan's start

bool hovers(std::uint8_t type) {
  constexpr std::uint8_t kHovering[] = {kQuadrotor, kCoaxial,   kHelicopter,  kHexarotor,
                                        kOctorotor, kTricopter, kDodecarotor, kDecarotor};
  return std::find(std::begin(kHovering), std::end(kHovering), type) != std::end(kHovering);
}

std::string metres(double distance) {
  return plain_number(distance, distance < 10 ? 2 : 3) + " m";
}

std::string too_old(double at, double now, double allowed) {
  return "for " + plain_number(now - at, 3) + " s; it must be told at least every " +
         plain_number(allowed) + " s";
}

void check_place(const VehicleReport& report, const LiveFlight& flight, double tolerance,
                 double now, std::vector<std::string>& missing) {
  if (!report.position) {
    missing.push_back("the vehicle does not tell where it is");
    return;
  }
  if (now - report.position_at >= VehicleReport::kFresh)
    missing.push_back("the vehicle has not told its place " +
                      too_old(report.position_at, now, VehicleReport::kFresh));
  const Eigen::Vector3d off = report.position->value - flight.trajectory().samples.front().position;
  if (off.norm() > tolerance)
    missing.push_back("the vehicle is " + place_in_words(off) + "; it must be within " +
                      metres(tolerance) + " of it (--start-tolerance)");
}

void check_home(const VehicleReport& report, const FlightFrame& frame, const LiveFlight& flight,
                std::vector<std::string>& missing) {
  if (frame.kind() == FlightFrameKind::local) return;
  if (!report.home) {
    missing.push_back("the vehicle has no home position (HOME_POSITION)");
    return;
  }
  const auto distance_to = [&](const Eigen::Vector3d& place) {
    const auto there = frame.on_earth(place);
    return to_local({report.home->latitude_deg, report.home->longitude_deg, 0},
                    {there->latitude_deg, there->longitude_deg, 0})
        .head<2>()
        .norm();
  };
  const double start = distance_to(flight.trajectory().samples.front().position);
  if (start > kFarFromHome)
    missing.push_back("the plan begins " + plain_number(start / 1000, 3) +
                      " km from the vehicle's home: is this the plan's origin?");
  if (start > kFarFromHome || !flight.plan.home) return;
  const char* reason = " of it, because the plan's limits count from there";
  const double off = distance_to(flight.plan.home->position);
  if (off > kOffHome)
    missing.push_back("the vehicle's home is " + metres(off) +
                      " from the plan's; it must be within " + metres(kOffHome) + reason);
  // Heights above the ground count from the vehicle's home itself, wherever that is.
  if (frame.heights_above_home()) return;
  const double higher = report.home->height - frame.on_earth(flight.plan.home->position)->height;
  if (std::abs(higher) > kOffHomeHeight)
    missing.push_back("the vehicle's home is " + metres(std::abs(higher)) +
                      (higher > 0 ? " above" : " below") + " the plan's; it must be within " +
                      metres(kOffHomeHeight) + reason);
}

void check_battery(const VehicleReport& report, const LiveFlight& flight,
                   std::vector<std::string>& missing) {
  if (!report.battery_percent) {
    missing.push_back("the vehicle does not tell its battery (SYS_STATUS)");
    return;
  }
  const double needed =
      100 * flight.trajectory().duration() / flight.vehicle.flight_time + kReserve;
  if (*report.battery_percent >= needed) return;
  missing.push_back("the battery has " + std::to_string(*report.battery_percent) +
                    " %; the flight of " + plain_number(flight.trajectory().duration(), 3) +
                    " s needs " + plain_number(std::ceil(needed), 3) +
                    " %, a fifth of the battery left");
}

}  // namespace

std::string place_in_words(const Eigen::Vector3d& off) {
  return metres(off.norm()) + " from the plan's start: " + metres(std::abs(off.x())) +
         (off.x() < 0 ? " west, " : " east, ") + metres(std::abs(off.y())) +
         (off.y() < 0 ? " south, " : " north, ") + metres(std::abs(off.z())) +
         (off.z() < 0 ? " below it" : " above it");
}

std::vector<std::string> missing_before_flight(const VehicleReport& report,
                                               const FlightFrame& frame, const LiveFlight& flight,
                                               const VehicleClock& clock, double start_tolerance,
                                               double now) {
  std::vector<std::string> missing;
  if (report.second_system)
    missing.push_back("two vehicles answer: " + std::to_string(report.system) + " and " +
                      std::to_string(*report.second_system) + "; name one with --system");
  if (!report.autopilot_name())
    missing.push_back("the vehicle's autopilot is neither PX4 nor ArduPilot (MAV_AUTOPILOT " +
                      std::to_string(report.autopilot) + ")");
  if (!hovers(report.type))
    missing.push_back("the vehicle is no multirotor (MAV_TYPE " + std::to_string(report.type) +
                      ")");
  if (!clock.known()) missing.push_back("the vehicle does not tell its time");
  if (!report.yaw) missing.push_back("the vehicle does not tell its heading (ATTITUDE)");
  if (report.yaw && now - report.yaw_at >= VehicleReport::kFresh)
    missing.push_back("the vehicle has not told its heading " +
                      too_old(report.yaw_at, now, VehicleReport::kFresh));
  check_place(report, flight, start_tolerance, now, missing);
  check_home(report, frame, flight, missing);
  if (!report.estimator_good(frame.kind() == FlightFrameKind::global))
    missing.push_back(report.estimator || report.attitude_healthy
                          ? "the vehicle's estimate of its state is not valid"
                          : "the vehicle does not tell whether its estimate is valid "
                            "(ESTIMATOR_STATUS)");
  else if (!report.tells_estimate(now))
    missing.push_back("the vehicle has not told whether its estimate is valid " +
                      too_old(report.estimator_at, now, VehicleReport::kFreshEstimate));
  check_battery(report, flight, missing);
  return missing;
}

}  // namespace lapwing
