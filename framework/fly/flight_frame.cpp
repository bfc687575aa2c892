// SPDX-License-Identifier: Apache-2.0
#include "framework/fly/flight_frame.h"

#include <cmath>
#include <numbers>

#include "framework/core/error.h"
#include "framework/mavlink/vocabulary.h"

namespace lapwing {

using Eigen::Vector3d;
using namespace mavlink;

namespace {

constexpr double kDegrees = 1e7;  // degE7

std::int32_t degrees_e7(double degrees) {
  return static_cast<std::int32_t>(std::llround(degrees * kDegrees));
}

std::optional<HeightOf> heights_of(const Plan& plan) {
  if (plan.geodetic_origin && plan.geodetic_origin->height_of == HeightOf::ground)
    return HeightOf::ground;
  return HeightOf::sea;
}

// The fields that both messages have.
template <class Target>
Target common_fields(const Setpoint& setpoint, double vehicle_time, std::uint8_t system,
                     std::uint8_t component) {
  Target target;
  target.template set<"time_boot_ms">(
      static_cast<std::uint32_t>(std::llround(std::max(0.0, vehicle_time) * 1000)));
  target.template set<"target_system">(system);
  target.template set<"target_component">(component);
  const auto single = [](double number) { return static_cast<float>(number); };
  target.template set<"vx">(single(setpoint.velocity.y()));
  target.template set<"vy">(single(setpoint.velocity.x()));
  target.template set<"vz">(single(-setpoint.velocity.z()));
  target.template set<"afx">(single(setpoint.acceleration.y()));
  target.template set<"afy">(single(setpoint.acceleration.x()));
  target.template set<"afz">(single(-setpoint.acceleration.z()));
  target.template set<"yaw">(single(turned_yaw(setpoint.yaw)));
  target.template set<"yaw_rate">(single(-setpoint.yaw_rate));
  return target;
}

Plan placed_above_home(const Plan& plan) {
  Plan placed;
  placed.mission = plan.mission;
  placed.geodetic_origin = origin_above_home(plan);
  return placed;
}

}  // namespace

std::optional<GeodeticOrigin> origin_above_home(const Plan& plan) {
  std::optional<GeodeticOrigin> origin = plan.geodetic_origin;
  if (origin && plan.home && origin->height_of == HeightOf::ground)
    origin->height -= to_geodetic(origin->point(), plan.home->position).altitude;
  return origin;
}

double turned_yaw(double yaw) {
  const double turned = std::remainder(std::numbers::pi / 2 - yaw, 2 * std::numbers::pi);
  return turned <= -std::numbers::pi ? std::numbers::pi : turned;
}

Vector3d east_north_up(double north, double east, double down) {
  return {east, north, -down};
}

FlightFrame::FlightFrame(const Plan& plan, FlightFrameKind kind) : kind_(kind) {
  if (kind != FlightFrameKind::global) return;
  if (!plan.geodetic_origin)
    throw InputError("'" + plan.mission +
                     "' has no origin on the earth. State `origin` in the mission, or `--origin "
                     "LAT,LON,HEIGHT,OF`, or `--frame local` where the plan's world is the "
                     "vehicle's own local frame");
  earth_.emplace(placed_above_home(plan), heights_of(plan), "fly");
}

std::string FlightFrame::in_words() const {
  if (kind_ == FlightFrameKind::local)
    return "the vehicle's local frame: x east, y north, z up of its origin";
  return earth_->heights() == HeightOf::ground
             ? "latitude and longitude, heights above the vehicle's home"
             : "latitude and longitude, heights above the sea";
}

Packet FlightFrame::packet(const Setpoint& setpoint, double vehicle_time, std::uint8_t system,
                           std::uint8_t component) const {
  if (kind_ == FlightFrameKind::local) {
    auto target = common_fields<Message<kLocalTarget>>(setpoint, vehicle_time, system, component);
    target.set<"coordinate_frame">(kFrameLocalNed)
        .set<"x">(static_cast<float>(setpoint.position.y()))
        .set<"y">(static_cast<float>(setpoint.position.x()))
        .set<"z">(static_cast<float>(-setpoint.position.z()));
    return target.packet();
  }
  const EarthPoint point = earth_->at(setpoint.position);
  auto target = common_fields<Message<kGlobalTarget>>(setpoint, vehicle_time, system, component);
  target
      .set<"coordinate_frame">(earth_->heights() == HeightOf::ground ? kFrameRelativeInt
                                                                     : kFrameGlobalInt)
      .set<"lat_int">(degrees_e7(point.latitude_deg))
      .set<"lon_int">(degrees_e7(point.longitude_deg))
      .set<"alt">(static_cast<float>(point.height));
  return target.packet();
}

void FlightFrame::place_local_frame(double latitude_deg, double longitude_deg, double height) {
  if (std::abs(latitude_deg) <= 90 && std::abs(longitude_deg) <= 180)
    local_origin_ = GeodeticPoint{latitude_deg, longitude_deg, height};
}

std::optional<EarthPoint> FlightFrame::on_earth(const Vector3d& p_W) const {
  if (earth_) return earth_->at(p_W);
  if (!local_origin_) return std::nullopt;
  const GeodeticPoint point = to_geodetic(*local_origin_, p_W);
  return EarthPoint{point.latitude_deg, point.longitude_deg, point.altitude};
}

Vector3d FlightFrame::position_of(const Message<kLocalPosition>& message) const {
  return east_north_up(message.get<"x">(), message.get<"y">(), message.get<"z">());
}

Vector3d FlightFrame::position_of(const Message<kGlobalPosition>& message) const {
  const double height = earth_->heights() == HeightOf::ground
                            ? message.get<"relative_alt">() / 1000.0
                            : message.get<"alt">() / 1000.0;
  return earth_->local({message.get<"lat">() / kDegrees, message.get<"lon">() / kDegrees, height});
}

}  // namespace lapwing
