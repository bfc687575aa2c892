// SPDX-License-Identifier: Apache-2.0
#include "framework/survey/reference_system.h"

#include "framework/core/error.h"

#ifdef LAPWING_HAS_PROJ

#include <proj.h>

#include <cmath>
#include <mutex>
#include <utility>

#include "framework/core/number_text.h"

namespace lapwing {
namespace {

constexpr double kBeyond = 1;  // degrees, beyond the area of use

struct ContextEnd {
  void operator()(PJ_CONTEXT* context) const { proj_context_destroy(context); }
};
struct ObjectEnd {
  void operator()(PJ* object) const { proj_destroy(object); }
};
using Context = std::unique_ptr<PJ_CONTEXT, ContextEnd>;
using Object = std::unique_ptr<PJ, ObjectEnd>;

InputError refusal(const std::string& text, const std::string& why) {
  return InputError("reference system '" + text + "': " + why);
}

std::string point_text(const Eigen::Vector3d& p) {
  return "(" + plain_number(p.x(), 10) + ", " + plain_number(p.y(), 10) + ", " +
         plain_number(p.z(), 10) + ")";
}

// The reason that PROJ gives, or nothing.
std::string reason(PJ_CONTEXT* context) {
  const int number = proj_context_errno(context);
  return number == 0 ? "" : std::string(" (") + proj_context_errno_string(context, number) + ")";
}

// A PROJ string is an operation, unless it says that it is a system.
std::string definition_of(const std::string& text) {
  const bool steps = text.find("+proj=pipeline") != std::string::npos;
  const bool proj = text.find("+proj=") != std::string::npos || text.starts_with("proj=");
  return proj && !steps && text.find("type=crs") == std::string::npos ? text + " +type=crs" : text;
}

// Of a system that is bound to a transformation, the system.
Object unbound(PJ_CONTEXT* context, const PJ* system) {
  if (proj_get_type(system) == PJ_TYPE_BOUND_CRS)
    return Object(proj_get_source_crs(context, system));
  return Object(proj_clone(context, system));
}

struct Axis {
  double factor = 0;  // to metres, or radians
  std::string unit;
  std::string direction;
};

Axis axis_of(PJ_CONTEXT* context, const PJ* axes, int index) {
  Axis axis;
  const char *unit = nullptr, *direction = nullptr;
  if (!proj_cs_get_axis_info(context, axes, index, nullptr, nullptr, &direction, &axis.factor,
                             &unit, nullptr, nullptr))
    return axis;
  axis.unit = unit ? unit : "";
  axis.direction = direction ? direction : "";
  return axis;
}

}  // namespace

struct ReferenceSystem::Impl {
  explicit Impl(const std::string& stated);
  PJ_COORD moved(PJ_DIRECTION way, double x, double y, double z) const;
  void read_parts(const PJ* system);
  void read_horizontal(const PJ* system);
  void check_area(const GeodeticPoint& point, const std::string& what) const;

  std::string text, name, unit;
  std::string across;  // the system without its vertical part as WKT, of one that has both
  bool geographic = false, vertical = false;
  double metres_per_unit = 0, metres_per_height = 1;
  double west = -180, south = -90, east = 180, north = 90;  // degrees, the area of use
  mutable std::mutex mutex;  // of PROJ's objects, which serve one thread at a time
  Context context;
  Object transform;
};

ReferenceSystem::Impl::Impl(const std::string& stated)
    : text(stated), context(proj_context_create()) {
  if (!context) throw Error("PROJ gives no context");
  proj_log_level(context.get(), PJ_LOG_NONE);
  proj_context_set_enable_network(context.get(), 0);
  const Object system(proj_create(context.get(), definition_of(text).c_str()));
  if (!system)
    throw refusal(text, "PROJ does not know it" + reason(context.get()) +
                            "; expected a code such as EPSG:28992, a PROJ string or WKT");
  if (!proj_is_crs(system.get()))
    throw refusal(text,
                  "it is no system of coordinates but an operation or a part of a system; "
                  "expected a code such as EPSG:28992, a PROJ string or WKT");
  name = proj_get_name(system.get()) ? proj_get_name(system.get()) : text;
  read_parts(system.get());
  double w = 0, s = 0, e = 0, n = 0;
  if (proj_get_area_of_use(context.get(), system.get(), &w, &s, &e, &n, nullptr) && w > -1000)
    west = w, south = s, east = e, north = n;
  const Object earth(proj_create(context.get(), vertical ? "EPSG:4979" : "EPSG:4326"));
  if (!earth) throw Error("PROJ finds no data of its own" + reason(context.get()));
  // A ballpark transformation leaves out the difference of datums or heights, silently.
  const char* const options[] = {"ALLOW_BALLPARK=NO", nullptr};
  const Object plain(
      proj_create_crs_to_crs_from_pj(context.get(), system.get(), earth.get(), nullptr, options));
  if (plain) transform.reset(proj_normalize_for_visualization(context.get(), plain.get()));
  if (!transform)
    throw refusal(text, "PROJ knows no transformation to WGS 84, or lacks its grid" +
                            reason(context.get()) +
                            (vertical ? "; its horizontal part alone may do" : "; state a datum"));
}

void ReferenceSystem::Impl::read_parts(const PJ* system) {
  const Object whole = unbound(context.get(), system);
  if (proj_get_type(whole.get()) != PJ_TYPE_COMPOUND_CRS) return read_horizontal(whole.get());
  const Object part(proj_crs_get_sub_crs(context.get(), whole.get(), 0));
  const Object up(proj_crs_get_sub_crs(context.get(), whole.get(), 1));
  if (!part || !up) throw refusal(text, "PROJ cannot take it apart");
  if (const char* wkt = proj_as_wkt(context.get(), part.get(), PJ_WKT2_2019, nullptr)) across = wkt;
  read_horizontal(unbound(context.get(), part.get()).get());
  const Object up_alone = unbound(context.get(), up.get());
  const Object axes(proj_crs_get_coordinate_system(context.get(), up_alone.get()));
  if (!axes || proj_get_type(up_alone.get()) != PJ_TYPE_VERTICAL_CRS)
    throw refusal(text, "its second part is no system of heights");
  const Axis axis = axis_of(context.get(), axes.get(), 0);
  if (axis.direction != "up") throw refusal(text, "it counts depths, and heights are expected");
  vertical = true;
  metres_per_height = axis.factor;
}

void ReferenceSystem::Impl::read_horizontal(const PJ* system) {
  const PJ_TYPE type = proj_get_type(system);
  geographic = type == PJ_TYPE_GEOGRAPHIC_2D_CRS || type == PJ_TYPE_GEOGRAPHIC_3D_CRS;
  if (!geographic && type != PJ_TYPE_PROJECTED_CRS)
    throw refusal(text, type == PJ_TYPE_GEOCENTRIC_CRS
                            ? "it counts from the middle of the earth; expected a geographic or a "
                              "projected system"
                            : "it has no places on the earth; expected a geographic or a "
                              "projected system");
  const Object axes(proj_crs_get_coordinate_system(context.get(), system));
  if (!axes) throw refusal(text, "PROJ does not know its axes");
  const Axis first = axis_of(context.get(), axes.get(), 0);
  unit = first.unit;
  metres_per_unit = geographic ? 0 : first.factor;
  if (geographic && unit != "degree")
    throw refusal(text, "its unit is '" + unit + "', and degrees are expected");
  if (proj_cs_get_axis_count(context.get(), axes.get()) < 3) return;
  vertical = true;
  metres_per_height = axis_of(context.get(), axes.get(), 2).factor;
}

PJ_COORD ReferenceSystem::Impl::moved(PJ_DIRECTION way, double x, double y, double z) const {
  const std::lock_guard lock(mutex);
  proj_errno_reset(transform.get());
  const PJ_COORD out = proj_trans(transform.get(), way, proj_coord(x, y, z, 0));
  const int number = proj_errno(transform.get());
  if (number == 0 && std::isfinite(out.xyz.x) && std::isfinite(out.xyz.y) &&
      std::isfinite(out.xyz.z))
    return out;
  const char* words = proj_context_errno_string(context.get(), number);
  throw refusal(text, "PROJ cannot transform " + point_text({x, y, z}) +
                          (number != 0 && words ? std::string(" (") + words + ")" : "") +
                          (vertical ? "; where a grid of its heights is missing, install it (PROJ "
                                      "looks in its data folder), or use its horizontal part alone"
                                    : ""));
}

void ReferenceSystem::Impl::check_area(const GeodeticPoint& point, const std::string& what) const {
  const double width = east < west ? east + 360 - west : east - west;
  // From the western edge, 0 to 360 degrees.
  double along = std::fmod(point.longitude_deg - west + kBeyond, 360);
  if (along < 0) along += 360;
  const bool within = along <= width + 2 * kBeyond && point.latitude_deg >= south - kBeyond &&
                      point.latitude_deg <= north + kBeyond;
  if (within) return;
  throw refusal(text, what + " lies at latitude " + plain_number(point.latitude_deg, 6) +
                          ", longitude " + plain_number(point.longitude_deg, 6) +
                          ", outside of the area where '" + name + "' is in use (latitude " +
                          plain_number(south, 6) + " to " + plain_number(north, 6) +
                          ", longitude " + plain_number(west, 6) + " to " + plain_number(east, 6) +
                          "); are x and y in this order?");
}

ReferenceSystem ReferenceSystem::of(const std::string& text) {
  return ReferenceSystem(std::make_shared<const Impl>(text));
}

bool ReferenceSystem::available() {
  return true;
}

ReferenceSystem ReferenceSystem::horizontal() const {
  return impl_->across.empty() ? *this : of(impl_->across);
}

GeodeticPoint ReferenceSystem::to_geodetic(const Eigen::Vector3d& p) const {
  const Impl& in = *impl_;
  if (!p.allFinite()) throw refusal(in.text, "expected finite numbers, got " + point_text(p));
  const bool swapped = in.geographic && std::abs(p.y()) > 90;
  if (swapped || (in.geographic && std::abs(p.x()) > 360))
    throw refusal(in.text, "latitude " + plain_number(p.y(), 10) + ", longitude " +
                               plain_number(p.x(), 10) +
                               " is no place on the earth; are they in this order?");
  const PJ_COORD out = in.moved(PJ_FWD, p.x(), p.y(), in.vertical ? p.z() : 0);
  GeodeticPoint point{out.lpz.phi, std::remainder(out.lpz.lam, 360),
                      in.vertical ? out.lpz.z : p.z()};
  in.check_area(point, point_text(p));
  return point;
}

Eigen::Vector3d ReferenceSystem::from_geodetic(const GeodeticPoint& point) const {
  const Impl& in = *impl_;
  check_geodetic(point, "geodetic point");
  in.check_area(point, "the point");
  const PJ_COORD out =
      in.moved(PJ_INV, point.longitude_deg, point.latitude_deg, in.vertical ? point.altitude : 0);
  return {out.xyz.x, out.xyz.y, in.vertical ? out.xyz.z : point.altitude};
}

}  // namespace lapwing

#else

namespace lapwing {

struct ReferenceSystem::Impl {
  std::string text, name, unit;
  bool geographic = false, vertical = false;
  double metres_per_unit = 0, metres_per_height = 1;
};

ReferenceSystem ReferenceSystem::of(const std::string& text) {
  throw InputError("reference system '" + text +
                   "': Lapwing was built without PROJ. On Debian, as root: apt-get install "
                   "libproj-dev, then build again (cmake --fresh --preset release). Or state "
                   "latitudes and longitudes of WGS 84");
}

bool ReferenceSystem::available() {
  return false;
}

ReferenceSystem ReferenceSystem::horizontal() const {
  return *this;
}

GeodeticPoint ReferenceSystem::to_geodetic(const Eigen::Vector3d&) const {
  throw Error("a reference system without PROJ");
}

Eigen::Vector3d ReferenceSystem::from_geodetic(const GeodeticPoint&) const {
  throw Error("a reference system without PROJ");
}

}  // namespace lapwing

#endif

namespace lapwing {

const std::string& ReferenceSystem::text() const {
  return impl_->text;
}
const std::string& ReferenceSystem::name() const {
  return impl_->name;
}
bool ReferenceSystem::geographic() const {
  return impl_->geographic;
}
double ReferenceSystem::metres_per_unit() const {
  return impl_->metres_per_unit;
}
std::string ReferenceSystem::unit() const {
  return impl_->unit;
}
bool ReferenceSystem::vertical() const {
  return impl_->vertical;
}
double ReferenceSystem::metres_per_height() const {
  return impl_->metres_per_height;
}

}  // namespace lapwing
