// SPDX-License-Identifier: Apache-2.0
#include "framework/export/scan_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>

#include "framework/core/png.h"
#include "framework/export/map_pictures.h"
#include "framework/export/prediction_report.h"
#include "framework/export/region_drawing.h"
#include "framework/export/scan_colors.h"
#include "framework/export/surroundings.h"
#include "framework/geometry/depth_camera.h"
#include "framework/geometry/mesh_builder.h"
#include "framework/picture/mesh_picture.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr Pinhole kOverview{720, 450, 720, 720, 359.5, 224.5};
constexpr int kMostMapPixels = 700, kMostMotions = 2500, kMostCubes = 60'000;
constexpr Rgb kCameraLines = {214, 60, 40}, kOpening = {226, 62, 205};
constexpr double kMuchUnknown = 0.1;   // of what is known
constexpr double kMuchOutside = 0.03;  // likewise
const Vector3d kGap = Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());

Image overview_image(const MeshScene& scene, const Eigen::AlignedBox3d& box, double yaw,
                     const std::string& caption) {
  return {encode_png(mesh_picture(scene, overview(box, kOverview, yaw, -0.6), 0)), caption};
}

Section known_section(const ScanRecord& record, const Eigen::AlignedBox3d& region) {
  Section section{record.surveyed ? "Knowledge before the tour" : "Knowledge of the first flight",
                  {}};
  if (record.scene)
    section.blocks.push_back(
        Image{encode_png(mesh_picture(*record.scene->scene, record.scene->view, 0)),
              "The scene of the simulation; the planner does not know it"});
  const MapPicture heights = height_picture(*record.map, kMostMapPixels);
  section.blocks.push_back(
      Image{encode_png(heights.picture), "The map from above: highest occupied voxels from " +
                                             number_text(heights.lowest, 3) + " m (blue) to " +
                                             number_text(heights.highest, 3) +
                                             " m (yellow); free is light, unknown is dark"});
  const double low = region.min().z() + 0.25 * region.sizes().z();
  section.blocks.push_back(
      Image{encode_png(cut_picture(*record.map, low, kMostMapPixels).picture),
            "The map at " + number_text(low, 3) +
                " m: black is occupied, light is free to fly, grey and dark are unknown"});
  section.blocks.push_back(overview_image(*record.prior, region, 1.05,
                                          record.surveyed
                                              ? "The prior mesh, from the surveyor's data"
                                              : "The prior mesh, from the images of the first "
                                                "flight"));
  return section;
}

// What the flight was asked to see, and what it keeps.
void add_site(const Plan& plan, Drawing& drawing) {
  add_region(plan.task.scan->region, drawing);
  add_surroundings(plan, {}, drawing);
  if (const auto& pilot = plan.environment.pilot) drawing.points.push_back({"pilot", pilot->eye});
}

Section candidates_section(const Plan& plan, const ScanRecord& record) {
  Polyline motions{"motions", {}, {}, {}}, first{"first flight", {}, {}, {}};
  const std::size_t every = record.motions.size() / kMostMotions + 1;
  for (std::size_t k = 0; k < record.motions.size(); k += every) {
    const auto [a, b] = record.motions[k];
    for (const Vector3d& p : {record.candidates[static_cast<std::size_t>(a)],
                              record.candidates[static_cast<std::size_t>(b)], kGap})
      motions.points.push_back(p);
  }
  first.points = record.first_views;
  Drawing drawing;
  drawing.lines.push_back(std::move(motions));
  if (first.points.size() > 1) drawing.lines.push_back(std::move(first));
  add_site(plan, drawing);
  std::string title = std::to_string(record.candidates.size()) + " candidates and " +
                      (every > 1 ? "one in " + std::to_string(every) + " of the " : "the ") +
                      std::to_string(record.motions.size()) + " motions between them";
  return {"Candidates",
          {PathView{title + ", from above", Projection::above, drawing},
           PathView{"The same from the south", Projection::from_south, drawing}}};
}

// The corners of what a view has in its image, `deep` metres away, and where it is.
void add_camera(const PlannedView& view, const Pinhole& camera, double deep, MeshBuilder& builder) {
  builder.set_color(kCameraLines);
  const Pose pose = camera_pose(view.position, view.yaw, view.pitch);
  std::array<Vector3d, 4> corners;
  const double right = camera.width - 0.5, bottom = camera.height - 0.5;
  const std::array<std::pair<double, double>, 4> pixels = {
      {{-0.5, -0.5}, {right, -0.5}, {right, bottom}, {-0.5, bottom}}};
  for (std::size_t i = 0; i < 4; ++i)
    corners[i] = pose.position +
                 deep * (pose.orientation * pixel_ray(camera, pixels[i].first, pixels[i].second));
  const double thick = 0.012 * deep;
  for (std::size_t i = 0; i < 4; ++i) {
    builder.tube(view.position, corners[i], thick, thick, 5);
    builder.tube(corners[i], corners[(i + 1) % 4], thick, thick, 5);
  }
}

// Without its colours.
void append(const TriangleMesh& more, TriangleMesh& mesh) {
  const auto first = static_cast<std::int32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
  for (const auto& t : more.triangles)
    mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

// The prior in grey, and cubes in the colours of their shares.
MeshScene colored_voxels(const ScanRecord& record, const std::vector<VoxelShare>& voxels,
                         const ScanTask& scan) {
  const VoxelGrid& grid = record.map->grid();
  const Vector3d half = Vector3d::Constant(0.55 * grid.resolution());
  MeshBuilder builder;
  const std::size_t every = voxels.size() / kMostCubes + 1;
  for (std::size_t k = 0; k < voxels.size(); k += every) {
    builder.set_color(color_of_share(3 * voxels[k].share));  // a third is what one view may tell
    const Vector3d middle = grid.center(voxels[k].voxel);
    builder.box(middle - half, middle + half);
  }
  add_camera(record.shown, scan.camera, 0.12 * scan.region.bounds().diagonal().norm(), builder);
  TriangleMesh mesh = builder.take();
  append(record.prior->mesh(), mesh);
  mesh.colors.resize(mesh.triangles.size(), kPlainSurface);
  return MeshScene(std::move(mesh));
}

Section view_section(const ScanRecord& record, const ScanTask& scan) {
  const double yaw = record.shown.yaw + 0.7;
  return {
      "One view",
      {overview_image(colored_voxels(record, record.told, scan), scan.region.bounds(), yaw,
                      "The view of the tour with the most information (red), and the voxels "
                      "that its rays meet: from none (violet) to a third of the full information "
                      "about a voxel (yellow); grey is the prior mesh")}};
}

// The prior mesh, every triangle by what the tour tells of it, and openings to what nobody saw.
MeshScene colored_surface(const ScanRecord& record) {
  TriangleMesh mesh = record.prior->mesh();
  mesh.colors.assign(mesh.triangles.size(), kPlainSurface);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const float share = record.shares[t];
    if (share > 0) mesh.colors[t] = color_of_share(0.2 + 0.8 * share);
    if (share == 0) mesh.colors[t] = kNotSeen;
    if (share == kNeverVisible) mesh.colors[t] = kNeverSeen;
  }
  const VoxelGrid& grid = record.map->grid();
  const Vector3d half = Vector3d::Constant(0.5 * grid.resolution());
  MeshBuilder builder;
  std::size_t count = 0;
  for (const Opening& opening : record.openings) count += opening.voxels.size();
  const std::size_t every = count / kMostCubes + 1;
  for (const Opening& opening : record.openings)
    for (std::size_t k = 0; k < opening.voxels.size(); k += every) {
      const Vector3d middle = grid.center(opening.voxels[k]);
      builder.box(middle - half, middle + half);
    }
  append(builder.take(), mesh);
  mesh.colors.resize(mesh.triangles.size(), kOpening);
  return MeshScene(std::move(mesh));
}

std::string square_metres(double area) {
  return number_text(area, 4);
}
std::string percent(double part, double whole) {
  return number_text(whole > 0 ? 100 * part / whole : 0, 3);
}

// Two significant digits, rounded down: "at least" stays true.
std::string lower_bound_text(double area) {
  if (!(area > 0)) return "0";
  const double unit = std::pow(10, std::floor(std::log10(area)) - 1);
  return number_text(unit * std::floor(area / unit * (1 + 1e-12)), 2);
}

// "14 m^2 at (12.3, -4, 1.5)"
std::string opening_in_words(const Opening& opening) {
  const auto at = [](double metres) {
    char text[40];
    std::snprintf(text, sizeof text, "%.1f", std::round(10 * metres) / 10 + 0.0);  // no "-0.0"
    return std::string(text);
  };
  const Vector3d& p = opening.place;
  return lower_bound_text(opening.area) + " m^2 at (" + at(p.x()) + ", " + at(p.y()) + ", " +
         at(p.z()) + ")";
}

// "3 openings, the largest of 14 m^2 at (12.3, -4.0, 1.5)"
std::string openings_in_words(const std::vector<Opening>& openings) {
  const std::string largest = opening_in_words(openings.front());
  if (openings.size() == 1) return "an opening of " + largest;
  return std::to_string(openings.size()) + " openings, the largest of " + largest;
}

// What a flight can do about it, "" where there is no need.
std::string unknown_warning(const ScanRecord& record) {
  std::string text;
  if (unknown_area(record) > kMuchUnknown * record.areas.known)
    text += record.surveyed ? ". This is a large share: the data do not show what is behind it"
                            : ". This is a large share: the first flight did not see behind it";
  const auto passable = std::find_if(record.openings.begin(), record.openings.end(),
                                     [](const Opening& o) { return o.passable; });
  if (passable != record.openings.end()) {
    const bool largest = passable == record.openings.begin();
    text += ". The vehicle (" + number_text(record.body_width, 3) + " m wide) would pass through " +
            (largest ? "the largest opening" : "the opening of " + opening_in_words(*passable)) +
            ": the hidden surface behind it may be far larger";
  }
  if (text.empty()) return "";
  if (record.surveyed)
    return text + ". Data that were measured from other sides, such as from the ground, show more";
  return text +
         ". Fly the first flight lower, more obliquely or wider (flights), or plan again with "
         "the images of " +
         (record.tours == 1 ? "this tour" : "these tours") + " (rounds = 2)";
}

// What nobody looked from is not considered: other free places may show more.
std::string visible_in_words(const ScanRecord& record) {
  return "visible from any of the " + std::to_string(record.candidates.size()) + " candidate views";
}

// "12 m^2 of the known surface lie outside the region (above it) and are not counted", or "".
std::string outside_in_words(const SurfaceAreas& areas) {
  const double outside = areas.above + areas.below;
  if (outside == 0 || outside < kMuchOutside * areas.known) return "";
  const char* where = areas.below < 0.1 * outside   ? "above it"
                      : areas.above < 0.1 * outside ? "below it"
                                                    : "above and below it";
  return square_metres(outside) + " m^2 of the known surface lie outside the region (" + where +
         ") and are not counted";
}

Section coverage_section(const ScanRecord& record, const ScanTask& scan) {
  double sum = 0;
  for (const VoxelShare& v : record.coverage) sum += v.share;
  const auto all = static_cast<double>(std::max<std::size_t>(record.coverage.size(), 1));
  const SurfaceAreas& areas = record.areas;
  const std::string whole = record.tours == 1 ? "the tour" : "all tours";
  Facts facts{{
      {"known surface of the region", square_metres(areas.known), "m^2"},
      {"of it seen by " + whole, square_metres(areas.seen),
       "m^2, " + percent(areas.seen, areas.known) + " %"},
      {"of it " + visible_in_words(record), square_metres(areas.visible),
       "m^2, " + percent(areas.visible, areas.known) + " %"},
      {"unknown, not counted: behind openings of the measured space, at least",
       lower_bound_text(unknown_area(record)), "m^2"},
      {"mean information of " + whole, number_text(100 * sum / all, 3),
       "% of the full information about a voxel that any candidate sees"},
  }};
  if (!record.openings.empty())
    facts.facts.push_back({"behind", openings_in_words(record.openings), ""});
  if (!outside_in_words(areas).empty())
    facts.facts.push_back({"known above or below the region, not counted",
                           square_metres(areas.above + areas.below), "m^2"});
  if (record.truth) {
    const TrueAreas& truth = *record.truth;
    facts.facts.push_back(
        {"true surface that could be seen (simulation)", square_metres(truth.open), "m^2"});
    facts.facts.push_back({"of it seen by the first flight", square_metres(truth.first),
                           "m^2, " + percent(truth.first, truth.open) + " %"});
    facts.facts.push_back({"of it seen by " + whole, square_metres(truth.seen),
                           "m^2, " + percent(truth.seen, truth.open) + " %"});
  }
  const MeshScene scene = colored_surface(record);
  const std::string caption =
      "Information of " + whole +
      " about the known surface, from little (violet) to all (yellow)." +
      " Red: seen from a candidate view, but " + (record.tours == 1 ? "not by the" : "by no") +
      " tour. Dark: seen from no candidate. Light grey: outside the region. Magenta: openings to "
      "space that nobody measured. No surface is known elsewhere";
  TextBlock words;
  words.text = areas_in_words(record);
  if (record.truth) words.text += "\n\n" + truth_in_words(record);
  return {"Coverage",
          {std::move(words), std::move(facts),
           overview_image(scene, scan.region.bounds(), 1.05, caption),
           overview_image(scene, scan.region.bounds(), 1.05 + 3.14159,
                          "The same from the other side")}};
}

Section tour_section(const Plan& plan, const ScanRecord& record) {
  const ScanTask& scan = *plan.task.scan;
  Drawing drawing;
  drawing.along = {"time", "s"};
  drawing.value = {"time", "s"};
  Polyline path{"tour", {}, {}, {}};
  for (const Sample& s : plan.trajectory.samples) {
    path.points.push_back(s.position);
    path.along.push_back(s.time);
    path.values.push_back(s.time);
  }
  drawing.lines.push_back(std::move(path));
  const double length = 0.02 * scan.region.bounds().diagonal().norm();
  for (const ViewKind kind : {ViewKind::planned, ViewKind::matching}) {
    Polyline views{kind == ViewKind::planned ? "planned views" : "matching views", {}, {}, {}};
    for (const PlannedView& view : scan.views) {
      if (view.kind != kind) continue;
      const Vector3d ahead(std::cos(view.pitch) * std::cos(view.yaw),
                           std::cos(view.pitch) * std::sin(view.yaw), std::sin(view.pitch));
      for (const Vector3d& p : {view.position, Vector3d(view.position + length * ahead), kGap})
        views.points.push_back(p);
    }
    if (!views.points.empty()) drawing.lines.push_back(std::move(views));
  }
  add_site(plan, drawing);
  const auto planned = std::count_if(scan.views.begin(), scan.views.end(), [](const auto& view) {
    return view.kind == ViewKind::planned;
  });
  Chart chart;
  chart.title = "Information over the budget";
  chart.x = {"time", "s"};
  chart.y = {"score", "voxels"};
  chart.series = {{"tour", record.seconds, record.score, true}};
  chart.limits = {{"all views within the budget", record.reachable}};
  if (std::isfinite(record.upper_bound))
    chart.limits.push_back({"upper bound of any tour", record.upper_bound});
  Facts facts{{{"images", std::to_string(scan.views.size()), ""},
               {"planned for their information", std::to_string(planned), ""},
               {"planned to keep images matchable",
                std::to_string(static_cast<long>(scan.views.size()) - planned), ""}}};
  return {"Tour",
          {std::move(facts), PathView{"The tour from above", Projection::above, drawing},
           PathView{"The tour from the south", Projection::from_south, drawing},
           Scene3D{"The tour in space", drawing}, std::move(chart)}};
}

std::vector<Section> shown_sections(const Plan& plan, const ScanRecord& record) {
  std::vector<Section> sections{coverage_section(record, *plan.task.scan)};
  if (record.prediction) sections.push_back(prediction_section(*record.prediction));
  return sections;
}

// "the tour sees", "the 4 tours see"
std::string tour_sees(const ScanRecord& record) {
  return record.tours == 1 ? "the tour sees" : "the " + std::to_string(record.tours) + " tours see";
}

}  // namespace

double unknown_area(const ScanRecord& record) {
  double area = 0;
  for (const Opening& opening : record.openings) area += opening.area;
  return area;
}

std::string areas_in_words(const ScanRecord& record) {
  const SurfaceAreas& areas = record.areas;
  std::string text = "surface: " + tour_sees(record) + " " + percent(areas.seen, areas.known) +
                     " % of the " + square_metres(areas.known) + " m^2 that are known; " +
                     percent(areas.visible, areas.known) + " % are " + visible_in_words(record) +
                     "; unknown and not counted: ";
  if (record.openings.empty())
    text += "none was found";
  else
    text += "at least " + lower_bound_text(unknown_area(record)) + " m^2, behind " +
            openings_in_words(record.openings);
  if (const std::string outside = outside_in_words(areas); !outside.empty()) text += "; " + outside;
  return text + unknown_warning(record);
}

std::string truth_in_words(const ScanRecord& record) {
  if (!record.truth) return "";
  const TrueAreas& truth = *record.truth;
  return "true surface (simulation): of the " + square_metres(truth.open) +
         " m^2 that could be seen, the first flight sees " + percent(truth.first, truth.open) +
         " %, " + tour_sees(record) + " " + percent(truth.seen, truth.open) + " %";
}

Value areas_as_value(const ScanRecord& record) {
  const SurfaceAreas& areas = record.areas;
  const auto share = [](double part, double whole) { return whole > 0 ? part / whole : 0; };
  Value value = Value::map();
  value.set("known", areas.known);
  value.set("visible", areas.visible);
  value.set("seen", areas.seen);
  value.set("unknown", unknown_area(record));
  value.set("openings", static_cast<std::int64_t>(record.openings.size()));
  if (!record.openings.empty()) {
    const Opening& largest = record.openings.front();
    const Vector3d& p = largest.place;
    Value& opening = value.set("largest_opening", Value::map());
    opening.set("area", largest.area);
    opening.set("position", Value(Value::List{p.x(), p.y(), p.z()}));
    opening.set("passable", largest.passable);
  }
  value.set("outside", areas.above + areas.below);
  value.set("visible_share", share(areas.visible, areas.known));
  value.set("seen_share", share(areas.seen, areas.known));
  if (!record.truth) return value;
  Value& truth = value.set("true", Value::map());
  truth.set("open", record.truth->open);
  truth.set("first_flight", record.truth->first);
  truth.set("tour", record.truth->seen);
  truth.set("first_flight_share", share(record.truth->first, record.truth->open));
  truth.set("tour_share", share(record.truth->seen, record.truth->open));
  return value;
}

std::vector<Section> scan_sections(const Plan& plan, const ScanRecord& record) {
  std::vector<Section> sections{known_section(record, plan.task.scan->region.bounds()),
                                candidates_section(plan, record)};
  for (auto more : {tour_sections(plan, record), shown_sections(plan, record)})
    std::move(more.begin(), more.end(), std::back_inserter(sections));
  return sections;
}

std::vector<Section> tour_sections(const Plan& plan, const ScanRecord& record) {
  return {view_section(record, *plan.task.scan), tour_section(plan, record)};
}

std::vector<Section> fleet_sections(const Plan& plan, const ScanRecord& record) {
  std::vector<Section> sections = shown_sections(plan, record);
  sections.push_back(known_section(record, plan.task.scan->region.bounds()));
  sections.push_back(candidates_section(plan, record));
  return sections;
}

}  // namespace lapwing
