// SPDX-License-Identifier: Apache-2.0
#include "framework/app/scan_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <map>

#include "framework/app/provenance.h"
#include "framework/core/files.h"
#include "framework/core/units.h"
#include "framework/core/visible_text.h"
#include "framework/geometry/depth_camera.h"
#include "framework/geometry/mesh_file.h"
#include "framework/photogrammetry/colmap_model.h"
#include "framework/photogrammetry/exif_position.h"
#include "framework/photogrammetry/model_placement.h"
#include "framework/photogrammetry/photo_match.h"
#include "framework/photogrammetry/surface_prediction.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr double kIncidence = 75;       // deg, at which an image still shows a surface
constexpr double kNoticedOffset = 0.5;  // m of height that are worth a note
constexpr std::size_t kMostNamed = 20;  // photographs of no view that are named

// The photographs of a flight, in the frame of the plan.
struct TakenFlight {
  std::vector<TakenPhoto> photos;
  std::vector<Pose> poses;         // of each where they are known, else empty
  std::vector<std::string> notes;  // sentences for the user
};

struct CheckedScan {
  const ScanTask* scan = nullptr;
  TakenFlight taken;
  double height_offset = 0;
  PhotoMatch match;
  std::vector<std::size_t> missing;  // places of views
  std::vector<std::size_t> unsure;   // likewise, with a photograph that may be of a missing one
  double planned_area = -1, taken_area = -1;  // m^2 that images locate; below 0: no mesh
};

bool holds_model(const fs::path& folder) {
  for (const char* name : {"cameras.bin", "cameras.txt"})
    for (const char* inside : {"", "sparse", "sparse/0"})
      if (fs::exists(folder / inside / name)) return true;
  return false;
}

GeodeticPoint origin_of(const Plan& plan, const ScanCheckRequest& asked) {
  if (!plan.geodetic_origin)
    throw InputError("'" + asked.plan.string() +
                     "' has no origin on the earth, so that positions of photographs say nothing "
                     "about it: plan with `origin`, or give a COLMAP model in its frame and "
                     "--placed");
  return plan.geodetic_origin->point();
}

// Positions of photographs, as the frame of the plan has them.
std::vector<PlacedPoint> positions_in(const fs::path& folder, const GeodeticPoint& origin,
                                      std::vector<std::string>& notes) {
  std::size_t without = 0;
  std::vector<PlacedPoint> placed;
  for (const PhotoPosition& p : exif_positions(folder, without))
    placed.push_back({p.name, Vector3d::Zero(), to_local(origin, p.point)});
  if (placed.empty())
    throw InputError("'" + folder.string() + "': none of its " + std::to_string(without) +
                     " photographs states a GPS position (EXIF): give those of the camera, not "
                     "processed copies, or a COLMAP model");
  if (without > 0)
    notes.push_back(std::to_string(without) + " of " + std::to_string(without + placed.size()) +
                    " photographs state no position and are left out");
  return placed;
}

TakenFlight taken_by_positions(const Plan& plan, const ScanCheckRequest& asked) {
  TakenFlight taken;
  for (const PlacedPoint& p : positions_in(asked.folder, origin_of(plan, asked), taken.notes))
    taken.photos.push_back({p.name, p.world, std::nullopt});
  taken.notes.push_back(
      "by positions alone: photographs do not state where the camera looked, so that views of one "
      "place are not told apart");
  return taken;
}

// How a model lies in the frame of the plan.
Similarity placement_of_model(const ColmapModel& model, const Plan& plan,
                              const ScanCheckRequest& asked, std::vector<std::string>& notes) {
  if (asked.placed && !asked.photos.empty())
    throw InputError("--placed and --photos both place the model: give one of them");
  if (asked.placed) return {};
  if (asked.photos.empty())
    throw InputError("'" + asked.folder.string() +
                     "': a COLMAP model has no scale and place of its own: give --photos, the "
                     "folder of its photographs with GPS positions, or --placed, if it is in "
                     "metres in the frame of the plan");
  std::map<std::string, Vector3d> known;
  for (const PlacedPoint& p : positions_in(asked.photos, origin_of(plan, asked), notes))
    known[p.name] = p.world;
  std::vector<PlacedPoint> points;
  for (const ColmapImage& image : model.images)
    if (const auto found = known.find(fs::path(image.name).filename().string());
        found != known.end())
      points.push_back({image.name, image.pose.position, found->second});
  if (points.size() < 3)
    throw InputError("'" + asked.photos.string() + "': " + std::to_string(points.size()) +
                     " of the model's " + std::to_string(model.images.size()) +
                     " images have a photograph with a GPS position there; 3 are needed");
  const PlacementFit fit = fit_placement(points, asked.gps_accuracy);
  char text[200];
  std::snprintf(text, sizeof text,
                "the model is placed by %zu of %zu positions: %.3g m root mean square, %.6g m per "
                "unit",
                fit.used, fit.given, fit.residual, fit.to_world.scale);
  notes.push_back(text);
  return fit.to_world;
}

TakenFlight taken_by_model(const Plan& plan, const ScanCheckRequest& asked) {
  const ColmapModel model = read_colmap_model(asked.folder);
  TakenFlight taken;
  const Similarity to_world = placement_of_model(model, plan, asked, taken.notes);
  for (const ColmapImage& image : model.images) {
    const Pose pose = to_world.apply(image.pose);
    taken.photos.push_back(
        {image.name, pose.position, Vector3d(pose.orientation * Vector3d::UnitZ())});
    taken.poses.push_back(pose);
  }
  return taken;
}

// Views whose photograph could as well be that of a missing view: by positions alone nobody knows
// which of them was taken.
std::vector<std::size_t> unsure_views(const std::vector<WantedView>& views,
                                      const CheckedScan& checked, double within) {
  std::vector<std::size_t> unsure;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (checked.match.photo_of_view[v] < 0) continue;
    const TakenPhoto& photo =
        checked.taken.photos[static_cast<std::size_t>(checked.match.photo_of_view[v])];
    const bool other = std::any_of(
        checked.missing.begin(), checked.missing.end(),
        [&](std::size_t m) { return (views[m].position - photo.position).norm() <= within; });
    if (!photo.ahead && other) unsure.push_back(v);
  }
  return unsure;
}

Pose pose_of(const PlannedView& view) {
  return camera_pose(view.position, view.yaw, view.pitch);
}

// m^2 of the mesh in the region that the images locate: two at least, from different places.
double area_located(const std::shared_ptr<const MeshScene>& surface, const ScanTask& scan,
                    std::vector<Pose> cameras) {
  const ImageSet images(surface, std::move(cameras),
                        {scan.camera, scan.range, radians(kIncidence), 0.5});
  const TriangleMesh& mesh = surface->mesh();
  double area = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vector3d middle = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3;
    if (scan.region.contains(middle) && images.locates(t)) area += mesh.area(t);
  }
  return area;
}

// By the mesh of the run, where it still lies beside the plan. Photographs of unknown direction
// count as their views.
void compare_surface(const fs::path& plan, CheckedScan& checked) {
  const fs::path file = plan.parent_path() / "prior.ply";
  if (!fs::exists(file)) return;
  const auto surface = std::make_shared<const MeshScene>(read_mesh(file).mesh, file.string());
  std::vector<Pose> planned, taken = checked.taken.poses;
  for (std::size_t v = 0; v < checked.scan->views.size(); ++v) {
    planned.push_back(pose_of(checked.scan->views[v]));
    if (checked.taken.poses.empty() && checked.match.photo_of_view[v] >= 0)
      taken.push_back(planned.back());
  }
  checked.planned_area = area_located(surface, *checked.scan, std::move(planned));
  checked.taken_area = area_located(surface, *checked.scan, std::move(taken));
}

CheckedScan checked_scan(const Plan& plan, const ScanCheckRequest& asked) {
  CheckedScan checked;
  checked.scan = &*plan.task.scan;
  checked.taken =
      holds_model(asked.folder) ? taken_by_model(plan, asked) : taken_by_positions(plan, asked);
  std::vector<WantedView> views;
  for (const PlannedView& view : checked.scan->views)
    views.push_back({view.position, pose_of(view).orientation * Vector3d::UnitZ()});
  std::vector<TakenPhoto>& photos = checked.taken.photos;
  if (asked.height_offset)
    checked.height_offset = *asked.height_offset;
  else if (!asked.placed)
    checked.height_offset = common_height_offset(views, photos, asked.within);
  for (TakenPhoto& photo : photos) photo.position.z() -= checked.height_offset;
  for (Pose& pose : checked.taken.poses) pose.position.z() -= checked.height_offset;
  checked.match = match_photos(views, photos, {asked.within, radians(asked.angle_deg)});
  for (std::size_t v = 0; v < views.size(); ++v)
    if (checked.match.photo_of_view[v] < 0) checked.missing.push_back(v);
  checked.unsure = unsure_views(views, checked, asked.within);
  if (std::abs(checked.height_offset) > kNoticedOffset && !asked.height_offset) {
    char text[200];
    std::snprintf(text, sizeof text,
                  "the photographs lie %.2f m %s the plan by a constant, which was taken off; "
                  "--height-offset states it",
                  std::abs(checked.height_offset), checked.height_offset > 0 ? "above" : "below");
    checked.taken.notes.push_back(text);
  }
  compare_surface(asked.plan, checked);
  return checked;
}

// "3, 5-9, 12", counted from 1
std::string ranges_in_words(const std::vector<std::size_t>& places) {
  std::string text;
  for (std::size_t i = 0; i < places.size();) {
    std::size_t last = i;
    while (last + 1 < places.size() && places[last + 1] == places[last] + 1) ++last;
    text += (text.empty() ? "" : ", ") + std::to_string(places[i] + 1);
    if (last > i) text += (last > i + 1 ? "-" : ", ") + std::to_string(places[last] + 1);
    i = last + 1;
  }
  return text;
}

Value json_of_check(const CheckedScan& checked, const ScanCheckRequest& asked) {
  Value object = Value::map();
  object.set("plan", asked.plan.string());
  object.set("views", static_cast<std::int64_t>(checked.scan->views.size()));
  object.set("photographs", static_cast<std::int64_t>(checked.taken.photos.size()));
  Value& missing = object.set("missing", Value::list());
  for (const std::size_t v : checked.missing) missing.push_back(static_cast<std::int64_t>(v + 1));
  Value& pairs = object.set("pairs", Value::list());
  for (std::size_t v = 0; v < checked.scan->views.size(); ++v) {
    const int photo = checked.match.photo_of_view[v];
    if (photo < 0) continue;
    Value pair = Value::map();
    pair.set("view", static_cast<std::int64_t>(v + 1));
    pair.set("photograph", checked.taken.photos[static_cast<std::size_t>(photo)].name);
    pairs.push_back(std::move(pair));
  }
  Value& unmatched = object.set("of_no_view", Value::list());
  for (const int p : checked.match.unmatched)
    unmatched.push_back(checked.taken.photos[static_cast<std::size_t>(p)].name);
  Value& unsure = object.set("uncertain", Value::list());
  for (const std::size_t v : checked.unsure) unsure.push_back(static_cast<std::int64_t>(v + 1));
  object.set("distance", checked.match.distance);
  object.set("farthest", checked.match.farthest);
  object.set("height_offset", checked.height_offset);
  if (checked.planned_area >= 0) {
    Value& area = object.set("area", Value::map());
    area.set("planned", checked.planned_area);
    area.set("taken", checked.taken_area);
  }
  object.set("notes", Value(Value::List(checked.taken.notes.begin(), checked.taken.notes.end())));
  object.set("rest",
             asked.rest.empty() || checked.missing.empty() ? Value() : Value(asked.rest.string()));
  return object;
}

void print_scan_check(const Plan& plan, const CheckedScan& checked, const ScanCheckRequest& asked) {
  const std::size_t views = checked.scan->views.size(), missing = checked.missing.size();
  std::cout << visible_line(plan.mission) << ": " << views - missing << " of " << views
            << " views are photographed\n";
  char text[200];
  if (views > missing) {
    std::snprintf(text, sizeof text,
                  "  the photographs lie %.2f m from their views (root mean square), %.2f m at "
                  "most\n",
                  checked.match.distance, checked.match.farthest);
    std::cout << text;
  }
  if (missing > 0) std::cout << "  missing: " << ranges_in_words(checked.missing) << "\n";
  if (!checked.unsure.empty())
    std::cout << "  uncertain: " << ranges_in_words(checked.unsure)
              << ": their photographs may as well be of missing views nearby\n";
  const std::vector<int>& others = checked.match.unmatched;
  if (!others.empty()) {
    std::cout << "  of no view: " << others.size() << " of " << checked.taken.photos.size()
              << " photographs:";
    for (std::size_t k = 0; k < std::min(others.size(), kMostNamed); ++k)
      std::cout << (k ? ", " : " ")
                << visible_line(checked.taken.photos[static_cast<std::size_t>(others[k])].name);
    std::cout << (others.size() > kMostNamed ? ", ...\n" : "\n");
  }
  if (checked.planned_area >= 0) {
    std::snprintf(
        text, sizeof text,
        "  known surface in images from at least two places: %.4g m^2, planned %.4g m^2\n",
        checked.taken_area, checked.planned_area);
    std::cout << text;
  }
  for (const std::string& note : checked.taken.notes)
    std::cout << "  " << visible_text(note) << "\n";
  if (missing == 0 || asked.rest.empty()) return;
  const fs::path beside = asked.plan.parent_path().empty() ? "." : asked.plan.parent_path();
  std::cout << "  a tour of them: lapwing run " << visible_line(asked.rest.string()) << " --data "
            << visible_line(beside.string()) << "\n";
}

// The missing views, and those that are uncertain.
std::vector<std::size_t> wanted_again(const CheckedScan& checked) {
  std::vector<std::size_t> views = checked.missing;
  views.insert(views.end(), checked.unsure.begin(), checked.unsure.end());
  std::sort(views.begin(), views.end());
  return views;
}

}  // namespace

ExitStatus check_scan(const ScanCheckRequest& asked, const Invocation& invocation) {
  const Plan plan = read_plan_file(asked.plan);
  if (!plan.task.scan)
    throw InputError("'" + asked.plan.string() + "' is a plan of a " + plan.kind +
                     ", which has no views: expected that of a scan");
  if (plan.trajectory.samples.empty())
    throw InputError("'" + asked.plan.string() + "' has no flight");
  const CheckedScan checked = checked_scan(plan, asked);
  if (!asked.rest.empty() && !checked.missing.empty())
    write_file_atomically(asked.rest, rest_mission(plan, wanted_again(checked)));
  if (invocation.json)
    print_json(json_of_check(checked, asked));
  else
    print_scan_check(plan, checked, asked);
  return checked.missing.empty() ? ExitStatus::done : ExitStatus::not_certified;
}

}  // namespace lapwing
