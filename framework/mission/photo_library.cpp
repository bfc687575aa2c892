// SPDX-License-Identifier: Apache-2.0
// Images of a real first flight: what scan missions ask of `run` and of their prior.
#include <algorithm>
#include <cmath>

#include <lua.hpp>

#include "framework/core/units.h"
#include "framework/mission/guard.h"
#include "framework/mission/lua_value.h"
#include "framework/mission/photo_objects.h"
#include "framework/mission/scan_objects.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr int kOverviewStride = 8;        // pixels
constexpr double kUpright = radians(10);  // a world whose z is so near to up stays as it is

std::string vector_text(const Vector3d& v) {
  char text[120];
  std::snprintf(text, sizeof text, "{%.4f, %.4f, %.4f}", v.x(), v.y(), v.z());
  return text;
}

ParameterTable depth_images_table() {
  const DepthLayout standard;
  ParameterTable table;
  table.required_text("folder", "folder of the files")
      .text("depth", standard.depth, "names of the depth images, 16-bit PNG")
      .text("pose", standard.pose, "names of the poses, 4 x 4 numbers")
      .text("intrinsics", standard.intrinsics, "file of the camera, 3 x 3 numbers")
      .optional_numbers("camera", 4, "px", "focal lengths x and y, principal point x and y")
      .number("unit", standard.unit, "m", "metres that 1 in a depth image is", above(0))
      .boolean("poses_to_camera", false, "poses take the world to the camera")
      .optional_numbers("up", 3, "", "direction in the world of the poses that points up");
  return table;
}

DepthLayout layout_of(const Parameters& given) {
  DepthLayout layout;
  layout.depth = given.text("depth");
  layout.pose = given.text("pose");
  layout.intrinsics = given.text("intrinsics");
  layout.unit = given.number("unit");
  layout.poses_to_camera = given.boolean("poses_to_camera");
  if (given.has("camera")) {
    const auto camera = given.numbers("camera");
    layout.camera = Eigen::Vector4d(camera[0], camera[1], camera[2], camera[3]);
  }
  return layout;
}

// The turn that takes what points up in the files to z.
Similarity turned_upright(const DepthSource& source, const Parameters& given, int threads,
                          const CancellationToken* cancellation, std::vector<std::string>& notes) {
  Similarity turn;
  if (given.has("up")) {
    const auto up = given.numbers("up");
    const Vector3d stated(up[0], up[1], up[2]);
    if (!(stated.norm() > 0)) throw InputError(given.origin("up"), "up has no direction");
    turn.rotation.setFromTwoVectors(stated.normalized(), Vector3d::UnitZ());
    return turn;
  }
  const UpEstimate found = estimate_up(source, kOverviewStride, threads, cancellation);
  if (std::acos(std::min(1.0, found.up.z())) < kUpright) return turn;
  turn.rotation.setFromTwoVectors(found.up, Vector3d::UnitZ());
  char text[300];
  std::snprintf(text, sizeof text,
                "the world of the images does not have z up: it is turned so that %s of theirs is "
                "up, as %s; images.up = %s keeps this",
                vector_text(found.up).c_str(),
                found.level_share > 0 ? "cameras and level surfaces have it" : "cameras have it",
                vector_text(found.up).c_str());
  notes.push_back(text);
  return turn;
}

void look_over(FlightImages& images, int stride, const MissionRun& run) {
  try {
    images.overview =
        overview_of(*images.source, stride, run.settings.threads, run.settings.cancellation);
  } catch (const InputError& error) {
    throw InputError("'" + images.name + "': " + error.what());
  }
}

// run:read_colmap{folder =, ...}
int read_colmap(lua_State* state) {
  MissionRun& run = run_of(state);
  const Parameters given = table_argument(state, 2, colmap_table(), "read_colmap");
  const Sandbox::ClockPause pause(Sandbox::of(state));
  auto images = std::make_shared<FlightImages>(read_colmap_images(given, run));
  look_over(*images, images->dense ? kOverviewStride : 1, run);
  new_object(state, kFlightImagesType, FlightImagesObject{std::move(images)});
  return 1;
}

// run:read_depth_images{folder =, ...}
int read_depth_images(lua_State* state) {
  MissionRun& run = run_of(state);
  const Parameters given = table_argument(state, 2, depth_images_table(), "read_depth_images");
  const Sandbox::ClockPause pause(Sandbox::of(state));
  auto images = std::make_shared<FlightImages>();
  images->name = given.text("folder");
  const auto read =
      depth_of_folder(DepthFolder(run.files.find_folder(images->name), layout_of(given)));
  const int threads = run.settings.threads;
  images->to_world =
      turned_upright(*read, given, threads, run.settings.cancellation, images->notes);
  images->source = placed(read, images->to_world);
  look_over(*images, kOverviewStride, run);
  if (images->overview.empty > 0)
    images->notes.push_back(std::to_string(images->overview.empty) + " of " +
                            std::to_string(images->overview.images) +
                            " depth images have no measurement");
  new_object(state, kFlightImagesType, FlightImagesObject{std::move(images)});
  return 1;
}

constexpr BoundField kFlightImagesFields[] = {
    {"name", "string", "name of their folder"},
    {"images", "integer", "number of depth images"},
    {"lower", "number[]", "lowest corner of the box of what they measured, m, world"},
    {"upper", "number[]", "highest corner of that box, m, world"},
    {"camera_lower", "number[]", "lowest corner of the box of the cameras, m, world"},
    {"camera_upper", "number[]", "highest corner of that box, m, world"},
    {"median_depth", "number", "median of the measured depths, m"},
    {"far_depth", "number", "depth that 98 % of the measurements do not exceed, m"},
    {"views", "table[]", "places of the cameras: {position, yaw, pitch}, m, rad"},
    {"notes", "string[]", "sentences for the user"}};

// Where a camera is and looks, without its roll.
Viewpoint view_of(const Pose& camera) {
  const Vector3d forward = camera.orientation * Vector3d::UnitZ();
  return {camera.position, std::atan2(forward.y(), forward.x()),
          std::atan2(forward.z(), forward.head<2>().norm())};
}

Value views_of(const DepthSource& source) {
  Value::List views;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const Viewpoint view = view_of(source.camera(i));
    Value entry = Value::map();
    entry.set("position", list_of(view.position));
    entry.set("yaw", view.yaw);
    entry.set("pitch", view.pitch);
    views.push_back(std::move(entry));
  }
  return Value(std::move(views));
}

int images_field(lua_State* state) {
  const FlightImages& images =
      *object_argument<FlightImagesObject>(state, 1, kFlightImagesType).images;
  const std::string field = text_argument(state, 2, "flight images");
  const ImageOverview& seen = images.overview;
  Value fields = Value::map();
  fields.set("name", images.name);
  fields.set("images", static_cast<std::int64_t>(seen.images));
  fields.set("lower", list_of(seen.surface.min()));
  fields.set("upper", list_of(seen.surface.max()));
  fields.set("camera_lower", list_of(seen.cameras.min()));
  fields.set("camera_upper", list_of(seen.cameras.max()));
  fields.set("median_depth", seen.median_depth);
  fields.set("far_depth", seen.far_depth);
  fields.set("views", field == "views" ? views_of(*images.source) : Value());
  Value::List notes;
  for (const std::string& note : images.notes) notes.emplace_back(note);
  fields.set("notes", Value(std::move(notes)));
  return push_field(state, "flight images", field, fields, kFlightImagesFields);
}

constexpr BoundField kImagesObject[] = {{"images", "lapwing.flight_images", "read images"}};

ParameterTable take_table() {
  ParameterTable table;
  table.number("range", 60, "m", "largest depth; larger ones are no measurement", above(0));
  return table;
}

// What is farther than the range is known too badly to be used.
void cut(DepthImage& image, double range) {
  for (float& depth : image.depth)
    if (std::isfinite(depth) && static_cast<double>(depth) > range) depth = 0;
}

// m, between the lines of sight to the points of an image, at a depth: were they spread evenly.
double gap_of_points(const DepthImage& image, double depth) {
  const auto points = static_cast<double>(
      std::count_if(image.depth.begin(), image.depth.end(), [](float d) { return d > 0; }));
  const Pinhole& p = image.pinhole;
  const double area = p.width / p.focal_x * p.height / p.focal_y * depth * depth;
  return std::sqrt(2 * area / std::max(points, 1.0));
}

// prior:take_images{images =, range =}: depth images of a real flight.
int take_images(lua_State* state) {
  MissionRun& run = run_of(state);
  Prior& prior = *object_argument<PriorObject>(state, 1, kPriorType).prior;
  const Parameters given = table_argument(state, 2, take_table(), "take_images", kImagesObject);
  lua_getfield(state, 2, "images");
  const FlightImages& images =
      *object_argument<FlightImagesObject>(state, -1, kFlightImagesType).images;
  const double range = given.number("range");
  begin_planning(run);
  const Sandbox::ClockPause pause(Sandbox::of(state));
  prior.mapping.map->set_threads(run.settings.threads);
  const std::size_t count = images.source->size();
  double gap = 0;  // m, between the lines of sight to points
  for (std::size_t i = 0; i < count; ++i) {
    if (run.settings.cancellation && run.settings.cancellation->cancelled()) throw Cancelled();
    if (run.settings.progress)
      run.settings.progress->report(
          static_cast<double>(i) / static_cast<double>(count),
          "depth image " + std::to_string(i + 1) + " of " + std::to_string(count));
    PosedDepthImage image = images.source->read(i);
    cut(image.image, range);
    prior.mapping.map->integrate(image);
    prior.fusion->add(image);
    prior.views.push_back(view_of(image.camera));
    if (images.dense)
      prior.rays.images.push_back({image.camera, image.image.pinhole, range});
    else
      gap += gap_of_points(image.image, images.overview.median_depth) / static_cast<double>(count);
  }
  if (!images.dense) prior.rays.elsewhere = gap;
  prior.earlier.insert(prior.earlier.end(), images.points.begin(), images.points.end());
  prior.mapping.source = std::to_string(count) + " depth images of '" + images.name + "'";
  return 0;
}

ParameterTable free_views_table() {
  ParameterTable table;
  table.tables("views", viewpoint_table(), "places", true)
      .table("allowed", box_table(), "box for the centre of the vehicle")
      .numbers("body", {1, 1, 0.5}, "m", "half edges of the vehicle's box")
      .number("mesh_room", 1, "m", "additional distance from the prior mesh", at_least(0));
  return table;
}

// prior:free_views{views =, body =, mesh_room =, allowed =}: the numbers of those that are free.
int free_views(lua_State* state) {
  const Prior& prior = *object_argument<PriorObject>(state, 1, kPriorType).prior;
  const Parameters given = table_argument(state, 2, free_views_table(), "free_views");
  if (!prior.mesh) throw InputError("free_views: the prior has no mesh; reconstruct it");
  const Sandbox::ClockPause pause(Sandbox::of(state));
  const auto space = space_of(prior, given.number("mesh_room"));
  const Eigen::AlignedBox3d allowed = box_of(given.table("allowed"), "the box for the vehicle");
  const auto half = given.numbers("body");
  const Vector3d body(half[0], half[1], half[2]);
  Value::List free;
  std::int64_t number = 0;
  for (const Parameters& entry : given.tables("views")) {
    ++number;
    const Vector3d p = viewpoint_of(entry).position;
    if (allowed.contains(p) && space->swept_box_free(p, p, body)) free.emplace_back(number);
  }
  push_value(state, Value(std::move(free)));
  return 1;
}

}  // namespace

void open_photo_library(lua_State* state) {
  define_type<FlightImagesObject>(state, kFlightImagesType, {}, &guarded<images_field>);
  note_fields(state, kFlightImagesType, kFlightImagesFields);
}

std::span<const Binding> photo_methods_of_run() {
  static const Binding methods[] = {
      {"read_depth_images", &guarded<read_depth_images>, "(images: @): lapwing.flight_images",
       "depth images of a real flight with their poses, from a folder", &depth_images_table},
      {"read_colmap", &guarded<read_colmap>, "(model: @): lapwing.flight_images",
       "a COLMAP model in metres, with its depth maps or its points", &colmap_table}};
  return methods;
}

std::span<const Binding> photo_methods_of_prior() {
  static const Binding methods[] = {
      {"take_images", &guarded<take_images>, "(images: @)",
       "integrates the depth images of a real flight into its map and its points", &take_table,
       kImagesObject},
      {"free_views", &guarded<free_views>, "(views: @): integer[]",
       "the numbers of the views at which map and mesh leave the vehicle room", &free_views_table}};
  return methods;
}

}  // namespace lapwing
