// SPDX-License-Identifier: Apache-2.0
#include "framework/survey/reference_system.h"

#include <cmath>
#include <utility>

#include "framework/core/number_text.h"
#include "framework/core/side_library.h"
#include "framework/survey/projection.h"

namespace lapwing {
namespace {

constexpr double kBeyond = 1;  // degrees, beyond the area of use

ProjectionMaker* projection_maker() {
  static ProjectionMaker* const maker =
      reinterpret_cast<ProjectionMaker*>(side_function(kProjectionLibrary, kProjectionMaker));
  return maker;
}

}  // namespace

InputError reference_refusal(const std::string& text, const std::string& why) {
  return InputError("reference system '" + text + "': " + why);
}

std::string reference_point(const Eigen::Vector3d& p) {
  return "(" + plain_number(p.x(), 10) + ", " + plain_number(p.y(), 10) + ", " +
         plain_number(p.z(), 10) + ")";
}

struct ReferenceSystem::Impl {
  explicit Impl(const std::string& stated);
  void check_area(const GeodeticPoint& point, const std::string& what) const;

  std::string text;
  std::unique_ptr<const Projection> projection;
  const ProjectedSystem* system = nullptr;  // the projection's
};

ReferenceSystem::Impl::Impl(const std::string& stated) : text(stated) {
  ProjectionMaker* const maker = projection_maker();
  if (!maker)
    throw reference_refusal(
        text,
        "Lapwing was built without PROJ. On Debian, as root: apt-get install libproj-dev, then "
        "build again (cmake --fresh --preset release). Or state latitudes and longitudes of WGS "
        "84");
  projection.reset(maker(text));
  system = &projection->system();
}

void ReferenceSystem::Impl::check_area(const GeodeticPoint& point, const std::string& what) const {
  const double west = system->west, south = system->south;
  const double east = system->east, north = system->north;
  const double width = east < west ? east + 360 - west : east - west;
  // From the western edge, 0 to 360 degrees.
  double along = std::fmod(point.longitude_deg - west + kBeyond, 360);
  if (along < 0) along += 360;
  const bool within = along <= width + 2 * kBeyond && point.latitude_deg >= south - kBeyond &&
                      point.latitude_deg <= north + kBeyond;
  if (within) return;
  throw reference_refusal(
      text, what + " lies at latitude " + plain_number(point.latitude_deg, 6) + ", longitude " +
                plain_number(point.longitude_deg, 6) + ", outside of the area where '" +
                system->name + "' is in use (latitude " + plain_number(south, 6) + " to " +
                plain_number(north, 6) + ", longitude " + plain_number(west, 6) + " to " +
                plain_number(east, 6) + "); are x and y in this order?");
}

ReferenceSystem ReferenceSystem::of(const std::string& text) {
  return ReferenceSystem(std::make_shared<const Impl>(text));
}

bool ReferenceSystem::available() {
  return projection_maker() != nullptr;
}

ReferenceSystem ReferenceSystem::horizontal() const {
  return impl_->system->across.empty() ? *this : of(impl_->system->across);
}

GeodeticPoint ReferenceSystem::to_geodetic(const Eigen::Vector3d& p) const {
  const Impl& in = *impl_;
  const bool geographic = in.system->geographic, vertical = in.system->vertical;
  if (!p.allFinite())
    throw reference_refusal(in.text, "expected finite numbers, got " + reference_point(p));
  const bool swapped = geographic && std::abs(p.y()) > 90;
  if (swapped || (geographic && std::abs(p.x()) > 360))
    throw reference_refusal(in.text, "latitude " + plain_number(p.y(), 10) + ", longitude " +
                                         plain_number(p.x(), 10) +
                                         " is no place on the earth; are they in this order?");
  const Eigen::Vector3d out = in.projection->to_earth({p.x(), p.y(), vertical ? p.z() : 0});
  GeodeticPoint point{out.y(), std::remainder(out.x(), 360), vertical ? out.z() : p.z()};
  in.check_area(point, reference_point(p));
  return point;
}

Eigen::Vector3d ReferenceSystem::from_geodetic(const GeodeticPoint& point) const {
  const Impl& in = *impl_;
  check_geodetic(point, "geodetic point");
  in.check_area(point, "the point");
  const bool vertical = in.system->vertical;
  const Eigen::Vector3d out = in.projection->from_earth(
      {point.longitude_deg, point.latitude_deg, vertical ? point.altitude : 0});
  return {out.x(), out.y(), vertical ? out.z() : point.altitude};
}

const std::string& ReferenceSystem::text() const {
  return impl_->text;
}
const std::string& ReferenceSystem::name() const {
  return impl_->system->name;
}
bool ReferenceSystem::geographic() const {
  return impl_->system->geographic;
}
double ReferenceSystem::metres_per_unit() const {
  return impl_->system->metres_per_unit;
}
std::string ReferenceSystem::unit() const {
  return impl_->system->unit;
}
bool ReferenceSystem::vertical() const {
  return impl_->system->vertical;
}
double ReferenceSystem::metres_per_height() const {
  return impl_->system->metres_per_height;
}

}  // namespace lapwing
