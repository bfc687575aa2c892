// SPDX-License-Identifier: Apache-2.0
// A COLMAP model as the images of a first flight: its scale, its place, its depths.
#include <cmath>

#include <lua.hpp>

#include "framework/mission/guard.h"
#include "framework/mission/photo_objects.h"
#include "framework/photogrammetry/colmap_depth.h"
#include "framework/photogrammetry/exif_position.h"
#include "framework/photogrammetry/model_placement.h"

namespace lapwing {

ParameterTable colmap_table() {
  ParameterTable distance;
  distance.text("from_image", "", "name of an image")
      .text("to_image", "", "name of another image")
      .optional_numbers("from", 3, "", "place in the model's coordinates")
      .optional_numbers("to", 3, "", "another place in these")
      .required_number("metres", "m", "distance of the two", above(0));
  ParameterTable table;
  table.required_text("folder", "folder of the model")
      .text("photos", "", "folder of the photographs with GPS positions in their EXIF data")
      .number("gps_accuracy", 5, "m", "accuracy of these positions", above(0))
      .tables("distances", distance, "measured distances")
      .optional_number("scale", "m", "metres per unit of the model", above(0))
      .optional_numbers("up", 3, "", "direction in the model that points up")
      .number("spacing", 0.4, "m", "distance between points of the surface", above(0));
  return table;
}

namespace {

using Eigen::Vector3d;

std::string base_name(const std::string& name) {
  return name.substr(name.rfind('/') == std::string::npos ? 0 : name.rfind('/') + 1);
}

// By the positions that the photographs state.
Similarity placed_by_photos(const ColmapModel& model, const Parameters& given,
                            const MissionRun& run, std::vector<std::string>& notes) {
  const std::string photos = given.text("photos");
  std::size_t without = 0;
  const std::vector<PhotoPosition> positions =
      exif_positions(run.files.find_folder(photos), without);
  std::map<std::string, GeodeticPoint> by_name;
  for (const PhotoPosition& p : positions) by_name[p.name] = p.point;
  GeodeticPoint origin{0, 0, std::numeric_limits<double>::infinity()};
  std::vector<std::pair<const ColmapImage*, GeodeticPoint>> known;
  for (const ColmapImage& image : model.images)
    if (const auto found = by_name.find(base_name(image.name)); found != by_name.end())
      known.emplace_back(&image, found->second);
  for (const auto& [image, point] : known) {
    origin.latitude_deg += point.latitude_deg / static_cast<double>(known.size());
    origin.longitude_deg += point.longitude_deg / static_cast<double>(known.size());
    origin.altitude = std::min(origin.altitude, point.altitude);
  }
  if (known.size() < 3)
    throw InputError(given.origin("photos"),
                     "'" + photos + "': " + std::to_string(known.size()) + " of the model's " +
                         std::to_string(model.images.size()) +
                         " images have a photograph with a GPS position there (" +
                         std::to_string(without) + " photographs state none); 3 are needed");
  if (run.origin)
    origin = {run.origin->latitude_deg, run.origin->longitude_deg, run.origin->height};
  std::vector<PlacedPoint> points;
  for (const auto& [image, point] : known)
    points.push_back({image->name, image->pose.position, to_local(origin, point)});
  const PlacementFit fit = fit_placement(points, given.number("gps_accuracy"));
  char text[400];
  std::snprintf(text, sizeof text,
                "placed by the GPS positions of %zu of %zu photographs: %.3g m root mean square, "
                "%.3g m at most, %.6g m per unit; the world's origin is at %.7f, %.7f, and z = 0 "
                "is %.2f m of the photographs' altitude",
                fit.used, fit.given, fit.residual, fit.largest, fit.to_world.scale,
                origin.latitude_deg, origin.longitude_deg, origin.altitude);
  notes.push_back(text);
  if (!fit.left_out.empty())
    notes.push_back("farther than three times colmap.gps_accuracy from the model and left out: '" +
                    fit.left_out.front() + "'" +
                    (fit.left_out.size() > 1
                         ? " and " + std::to_string(fit.left_out.size() - 1) + " more"
                         : ""));
  return fit.to_world;
}

// A place that a distance names.
Vector3d place_of(const ColmapModel& model, const Parameters& given, const std::string& end) {
  const std::string name = given.text(end + "_image");
  if (given.has(end) == !name.empty())
    throw InputError(given.origin(),
                     "colmap.distances: give either " + end + " or " + end + "_image");
  if (given.has(end)) {
    const auto p = given.numbers(end);
    return {p[0], p[1], p[2]};
  }
  for (const ColmapImage& image : model.images)
    if (image.name == name || base_name(image.name) == name) return image.pose.position;
  throw InputError(given.origin(end + "_image"),
                   "colmap.distances: the model has no image '" + name + "'");
}

double scale_by_distances(const ColmapModel& model, const std::vector<Parameters>& given,
                          std::vector<std::string>& notes) {
  std::vector<StatedDistance> distances;
  for (const Parameters& d : given)
    distances.push_back({place_of(model, d, "from"), place_of(model, d, "to"), d.number("metres")});
  const ScaleFit fit = fit_scale(distances);
  char text[200];
  std::snprintf(text, sizeof text, "scaled by %zu distance%s: %.6g m per unit, %s",
                distances.size(), distances.size() == 1 ? "" : "s", fit.scale,
                distances.size() == 1 ? "which nothing checks" : "the worst is wrong by ");
  std::string note = text;
  if (distances.size() > 1) {
    std::snprintf(text, sizeof text, "%.2g %%", 100 * fit.worst);
    note += text;
  }
  notes.push_back(note);
  return fit.scale;
}

Eigen::Quaterniond upright(const ColmapModel& model, const std::vector<FusedPoint>& surface,
                           const Parameters& given, std::vector<std::string>& notes) {
  Vector3d up;
  if (given.has("up")) {
    const auto stated = given.numbers("up");
    up = {stated[0], stated[1], stated[2]};
    if (!(up.norm() > 0)) throw InputError(given.origin("up"), "colmap.up has no direction");
  } else {
    std::vector<Pose> cameras;
    std::vector<Vector3d> normals;
    for (const ColmapImage& image : model.images) cameras.push_back(image.pose);
    for (const FusedPoint& point : surface) normals.push_back(point.normal);
    up = estimate_up(cameras, normals).up;
    char text[200];
    std::snprintf(text, sizeof text,
                  "up is {%.4f, %.4f, %.4f} of the model, as cameras and surfaces have it; "
                  "colmap.up states it",
                  up.x(), up.y(), up.z());
    notes.push_back(text);
  }
  Eigen::Quaterniond turn;
  turn.setFromTwoVectors(up.normalized(), Vector3d::UnitZ());
  return turn;
}

Similarity placement_of(const ColmapModel& model, const std::vector<FusedPoint>& surface,
                        const Parameters& given, const MissionRun& run,
                        std::vector<std::string>& notes) {
  const bool photos = !given.text("photos").empty(), scale = given.has("scale");
  const bool distances = !given.tables("distances").empty();
  if (photos + scale + distances == 0)
    throw InputError(given.origin(),
                     "the COLMAP model has no scale: give colmap.photos, a folder of its "
                     "photographs with GPS positions; colmap.distances, some measured distances; "
                     "or colmap.scale, the metres per unit of the model");
  if (photos + scale + distances > 1)
    throw InputError(given.origin(),
                     "give one of colmap.photos, colmap.distances and colmap.scale");
  if (photos) {
    if (given.has("up"))
      throw InputError(given.origin("up"), "colmap.up: the GPS positions determine what is up");
    return placed_by_photos(model, given, run, notes);
  }
  Similarity to_world;
  to_world.scale =
      scale ? given.number("scale") : scale_by_distances(model, given.tables("distances"), notes);
  to_world.rotation = upright(model, surface, given, notes);
  return to_world;
}

}  // namespace

FlightImages read_colmap_images(const Parameters& given, const MissionRun& run) {
  FlightImages images;
  images.name = given.text("folder");
  const std::filesystem::path folder = run.files.find_folder(images.name);
  const ColmapModel model = read_colmap_model(folder);
  const ColmapDepth depth = depth_of_colmap(model, folder);
  if (!depth.source)
    throw InputError(given.origin("folder"),
                     "'" + images.name +
                         "': the COLMAP model has neither points nor depth maps; a model that "
                         "states cameras alone shows no surface");
  const std::filesystem::path fused = folder / "fused.ply";
  const bool has_fused = std::filesystem::exists(fused);
  const std::vector<FusedPoint> surface =
      has_fused ? read_fused_points(fused) : surface_of_colmap(model);
  images.to_world = placement_of(model, surface, given, run, images.notes);
  images.source = placed(depth.source, images.to_world);
  images.dense = depth.dense;
  if (has_fused || !depth.dense) {
    for (FusedPoint point : surface) {
      point.position = images.to_world.apply(point.position);
      point.normal = images.to_world.rotation * point.normal;
      images.points.push_back(point);
    }
    images.points = thinned(images.points, given.number("spacing"));
  }
  images.notes.insert(images.notes.begin(),
                      depth.described + (has_fused ? ", surface from fused.ply" : ""));
  if (!depth.dense)
    images.notes.push_back(
        "only lines of sight to points are free: dense depth maps, or a safe_height above which "
        "the air is free, make more room known");
  return images;
}

}  // namespace lapwing
