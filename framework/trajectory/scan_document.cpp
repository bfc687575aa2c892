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

}  // namespace

Value scan_to_value(const ScanTask& scan) {
  Value value = Value::map(), views = Value::list();
  Value& region = value.set("region", Value::map());
  region.set("lower", list_of(scan.region.min()));
  region.set("upper", list_of(scan.region.max()));
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
  Fields region = fields.table("region");
  scan.region = {region.vector3("lower"), region.vector3("upper")};
  region.finish();
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
