// SPDX-License-Identifier: Apache-2.0
// The library lapwing_projection: reference systems by PROJ.
#include "framework/survey/projection.h"

#include <proj.h>

#include <cmath>
#include <mutex>

namespace lapwing {
namespace {

struct ContextEnd {
  void operator()(PJ_CONTEXT* context) const { proj_context_destroy(context); }
};
struct ObjectEnd {
  void operator()(PJ* object) const { proj_destroy(object); }
};
using Context = std::unique_ptr<PJ_CONTEXT, ContextEnd>;
using Object = std::unique_ptr<PJ, ObjectEnd>;

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

class ProjProjection final : public Projection {
 public:
  explicit ProjProjection(const std::string& stated);
  const ProjectedSystem& system() const override { return system_; }
  Eigen::Vector3d to_earth(const Eigen::Vector3d& p) const override { return moved(PJ_FWD, p); }
  Eigen::Vector3d from_earth(const Eigen::Vector3d& p) const override { return moved(PJ_INV, p); }

 private:
  Eigen::Vector3d moved(PJ_DIRECTION way, const Eigen::Vector3d& p) const;
  void read_parts(const PJ* system);
  void read_horizontal(const PJ* system);

  std::string text_;
  ProjectedSystem system_;
  mutable std::mutex mutex_;  // of PROJ's objects, which serve one thread at a time
  Context context_;
  Object transform_;
};

ProjProjection::ProjProjection(const std::string& stated)
    : text_(stated), context_(proj_context_create()) {
  if (!context_) throw Error("PROJ gives no context");
  PJ_CONTEXT* context = context_.get();
  proj_log_level(context, PJ_LOG_NONE);
  proj_context_set_enable_network(context, 0);
  const Object system(proj_create(context, definition_of(text_).c_str()));
  if (!system)
    throw reference_refusal(text_,
                            "PROJ does not know it" + reason(context) +
                                "; expected a code such as EPSG:28992, a PROJ string or WKT");
  if (!proj_is_crs(system.get()))
    throw reference_refusal(text_,
                            "it is no system of coordinates but an operation or a part of a "
                            "system; expected a code such as EPSG:28992, a PROJ string or WKT");
  system_.name = proj_get_name(system.get()) ? proj_get_name(system.get()) : text_;
  read_parts(system.get());
  double west = 0, south = 0, east = 0, north = 0;
  if (proj_get_area_of_use(context, system.get(), &west, &south, &east, &north, nullptr) &&
      west > -1000)
    system_.west = west, system_.south = south, system_.east = east, system_.north = north;
  const Object earth(proj_create(context, system_.vertical ? "EPSG:4979" : "EPSG:4326"));
  if (!earth) throw Error("PROJ finds no data of its own" + reason(context));
  // A ballpark transformation leaves out the difference of datums or heights, silently.
  const char* const options[] = {"ALLOW_BALLPARK=NO", nullptr};
  const Object plain(
      proj_create_crs_to_crs_from_pj(context, system.get(), earth.get(), nullptr, options));
  if (plain) transform_.reset(proj_normalize_for_visualization(context, plain.get()));
  if (!transform_)
    throw reference_refusal(
        text_, "PROJ knows no transformation to WGS 84, or lacks its grid" + reason(context) +
                   (system_.vertical ? "; its horizontal part alone may do" : "; state a datum"));
}

void ProjProjection::read_parts(const PJ* system) {
  PJ_CONTEXT* context = context_.get();
  const Object whole = unbound(context, system);
  if (proj_get_type(whole.get()) != PJ_TYPE_COMPOUND_CRS) return read_horizontal(whole.get());
  const Object part(proj_crs_get_sub_crs(context, whole.get(), 0));
  const Object up(proj_crs_get_sub_crs(context, whole.get(), 1));
  if (!part || !up) throw reference_refusal(text_, "PROJ cannot take it apart");
  if (const char* wkt = proj_as_wkt(context, part.get(), PJ_WKT2_2019, nullptr))
    system_.across = wkt;
  read_horizontal(unbound(context, part.get()).get());
  const Object up_alone = unbound(context, up.get());
  const Object axes(proj_crs_get_coordinate_system(context, up_alone.get()));
  if (!axes || proj_get_type(up_alone.get()) != PJ_TYPE_VERTICAL_CRS)
    throw reference_refusal(text_, "its second part is no system of heights");
  const Axis axis = axis_of(context, axes.get(), 0);
  if (axis.direction != "up")
    throw reference_refusal(text_, "it counts depths, and heights are expected");
  system_.vertical = true;
  system_.metres_per_height = axis.factor;
}

void ProjProjection::read_horizontal(const PJ* system) {
  PJ_CONTEXT* context = context_.get();
  const PJ_TYPE type = proj_get_type(system);
  system_.geographic = type == PJ_TYPE_GEOGRAPHIC_2D_CRS || type == PJ_TYPE_GEOGRAPHIC_3D_CRS;
  if (!system_.geographic && type != PJ_TYPE_PROJECTED_CRS)
    throw reference_refusal(
        text_, type == PJ_TYPE_GEOCENTRIC_CRS
                   ? "it counts from the middle of the earth; expected a geographic or a "
                     "projected system"
                   : "it has no places on the earth; expected a geographic or a projected system");
  const Object axes(proj_crs_get_coordinate_system(context, system));
  if (!axes) throw reference_refusal(text_, "PROJ does not know its axes");
  const Axis first = axis_of(context, axes.get(), 0);
  system_.unit = first.unit;
  system_.metres_per_unit = system_.geographic ? 0 : first.factor;
  if (system_.geographic && first.unit != "degree")
    throw reference_refusal(text_, "its unit is '" + first.unit + "', and degrees are expected");
  if (proj_cs_get_axis_count(context, axes.get()) < 3) return;
  system_.vertical = true;
  system_.metres_per_height = axis_of(context, axes.get(), 2).factor;
}

Eigen::Vector3d ProjProjection::moved(PJ_DIRECTION way, const Eigen::Vector3d& p) const {
  const std::lock_guard lock(mutex_);
  proj_errno_reset(transform_.get());
  const PJ_COORD out = proj_trans(transform_.get(), way, proj_coord(p.x(), p.y(), p.z(), 0));
  const int number = proj_errno(transform_.get());
  const Eigen::Vector3d place(out.xyz.x, out.xyz.y, out.xyz.z);
  if (number == 0 && place.allFinite()) return place;
  const char* words = proj_context_errno_string(context_.get(), number);
  throw reference_refusal(
      text_, "PROJ cannot transform " + reference_point(p) +
                 (number != 0 && words ? std::string(" (") + words + ")" : "") +
                 (system_.vertical
                      ? "; where a grid of its heights is missing, install it (PROJ looks in its "
                        "data folder), or use its horizontal part alone"
                      : ""));
}

}  // namespace
}  // namespace lapwing

extern "C" __attribute__((visibility("default"))) lapwing::Projection* lapwing_projection(
    const std::string& text) {
  return new lapwing::ProjProjection(text);
}
