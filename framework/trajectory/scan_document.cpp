// SPDX-License-Identifier: Apache-2.0
// The region and the views of a scan in plan.json.
#include "framework/trajectory/plan_sections.h"

namespace lapwing {
namespace {

const std::vector<std::string> kViewKinds{"planned", "matching"};

Value to_value(const PlannedView& view) {
  Value value = Value::map();
  value.set("time", view.time);
  value.set("position", list_of(view.position));
  value.set("yaw", view.yaw);
  value.set("pitch", view.pitch);
  value.set("kind", kViewKinds[static_cast<std::size_t>(view.kind)]);
  return value;
}

PlannedView view_from(Fields& fields) {
  PlannedView view;
  view.time = fields.number("time");
  view.position = fields.vector3("position");
  view.yaw = fields.number("yaw");
  view.pitch = fields.number("pitch");
  view.kind = static_cast<ViewKind>(fields.choice("kind", kViewKinds));
  return view;
}

Value to_value(const Pinhole& camera) {
  Value value = Value::map();
  value.set("image_size", Value(Value::List{camera.width, camera.height}));
  value.set("focal_length", list_of({camera.focal_x, camera.focal_y}));
  value.set("principal_point", list_of({camera.principal_x, camera.principal_y}));
  return value;
}

// Whole numbers of pixels that an image can have; 0 stands for what is none.
int pixels_of(double number) {
  return number >= 1 && number <= 1e5 && number == static_cast<int>(number)
             ? static_cast<int>(number)
             : 0;
}

Pinhole camera_from(Fields fields) {
  Pinhole camera;
  const std::vector<double> size = fields.numbers("image_size", 2);
  const std::vector<double> focal = fields.numbers("focal_length", 2);
  const std::vector<double> principal = fields.numbers("principal_point", 2);
  camera.width = pixels_of(size[0]);
  camera.height = pixels_of(size[1]);
  if (fields.has("image_size") && (camera.width == 0 || camera.height == 0))
    fields.add_error("image_size", "expected whole numbers of pixels, from 1 to 100,000");
  camera.focal_x = focal[0];
  camera.focal_y = focal[1];
  camera.principal_x = principal[0];
  camera.principal_y = principal[1];
  fields.finish();
  return camera;
}

Value rows_of(const GroundPolygon& corners) {
  Value list = Value::list();
  for (const Eigen::Vector2d& corner : corners) list.push_back(list_of({corner.x(), corner.y()}));
  return list;
}

// A box by its corners, everything else by its prisms.
Value to_value(const InterestRegion& region) {
  Value value = Value::map();
  if (region.is_box()) {
    value.set("lower", list_of(region.bounds().min()));
    value.set("upper", list_of(region.bounds().max()));
    return value;
  }
  Value& prisms = value.set("prisms", Value::list());
  for (const RegionPrism& prism : region.prisms()) {
    Value entry = Value::map();
    if (!prism.name.empty()) entry.set("name", prism.name);
    entry.set("corners", rows_of(prism.outline));
    if (!prism.holes.empty()) {
      Value& holes = entry.set("holes", Value::list());
      for (const GroundPolygon& corners : prism.holes) {
        Value hole = Value::map();
        hole.set("corners", rows_of(corners));
        holes.push_back(std::move(hole));
      }
    }
    entry.set("low", prism.low);
    entry.set("high", prism.high);
    entry.set("weight", prism.weight);
    prisms.push_back(std::move(entry));
  }
  return value;
}

GroundPolygon polygon_from(Fields& fields) {
  GroundPolygon corners;
  for (const std::vector<double>& corner : fields.rows("corners", 2))
    corners.emplace_back(corner[0], corner[1]);
  return corners;
}

RegionPrism prism_from(Fields& fields) {
  RegionPrism prism;
  prism.name = fields.optional_text("name");
  prism.outline = polygon_from(fields);
  for (Fields& hole : fields.optional_tables("holes")) {
    prism.holes.push_back(polygon_from(hole));
    hole.finish();
  }
  prism.low = fields.number("low");
  prism.high = fields.number("high");
  prism.weight = fields.number("weight");
  return prism;
}

// What bounds no region is an error, so that a region that was read can be asked.
InterestRegion region_from(Fields fields) {
  if (!fields.has("prisms")) {
    const Eigen::AlignedBox3d box(fields.vector3("lower"), fields.vector3("upper"));
    fields.finish();
    return box;
  }
  std::vector<RegionPrism> prisms;
  bool sound = true;
  for (Fields& entry : fields.tables("prisms")) {
    prisms.push_back(prism_from(entry));
    if (const std::string fault = region_fault(prisms.back()); !fault.empty()) {
      entry.add_error("corners", fault);
      sound = false;
    }
    entry.finish();
  }
  if (prisms.empty()) fields.add_error("prisms", "expected at least one");
  fields.finish();
  if (prisms.empty() || !sound) return {};
  return InterestRegion(std::move(prisms));
}

}  // namespace

Value scan_to_value(const ScanTask& scan) {
  Value value = Value::map(), views = Value::list();
  value.set("region", to_value(scan.region));
  value.set("camera", to_value(scan.camera));
  value.set("range", scan.range);
  value.set("map", scan.map);
  value.set("seen", scan.seen);
  value.set("seen_share", scan.seen_share);
  value.set("tolerance", scan.tolerance);
  value.set("angle_tolerance", scan.angle_tolerance);
  for (const PlannedView& view : scan.views) views.push_back(to_value(view));
  value.set("views", std::move(views));
  return value;
}

ScanTask scan_from(Fields fields) {
  ScanTask scan;
  scan.region = region_from(fields.table("region"));
  scan.camera = camera_from(fields.table("camera"));
  scan.range = fields.number("range");
  scan.map = fields.text("map");
  scan.seen = fields.integer("seen");
  scan.seen_share = fields.number("seen_share");
  scan.tolerance = fields.number("tolerance");
  scan.angle_tolerance = fields.number("angle_tolerance");
  for (Fields& entry : fields.tables("views")) {
    scan.views.push_back(view_from(entry));
    entry.finish();
  }
  fields.finish();
  return scan;
}

}  // namespace lapwing
