// SPDX-License-Identifier: Apache-2.0
#include "framework/export/prediction_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "framework/core/png.h"
#include "framework/core/units.h"
#include "framework/export/prediction_mesh.h"
#include "framework/picture/mesh_picture.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr Pinhole kPredictionView{720, 450, 720, 720, 359.5, 224.5};
constexpr std::size_t kMostHoles = 12;  // in the report and in --json
constexpr double kSmallHole = 1e-3;     // of the counted surface: smaller ones are only summed up
constexpr int kClasses = 5;             // of numbers of images: 0, 1, 2, 3 and more

const char* reason_in_words(HoleReason reason) {
  switch (reason) {
    case HoleReason::not_chosen:
      return "not chosen: two candidate views from different places show it, too few of them are "
             "planned";
    case HoleReason::zone:
      return "zone: views from two places would show it, and zones or the pilot's sight forbid "
             "them";
    case HoleReason::no_view:
      break;
  }
  return "no view: no two candidate views from different places show it";
}

double counted_area(const ScanPrediction& p) {
  return area_shown(p, 0);
}

double area_of_holes(const ScanPrediction& p, HoleReason reason) {
  double area = 0;
  for (const SurfaceHole& hole : p.holes)
    if (hole.reason == reason) area += hole.area;
  return area;
}

// The number of holes that are listed, the largest ones.
std::size_t listed_holes(const ScanPrediction& p) {
  std::size_t count = 0;
  while (count < std::min(kMostHoles, p.holes.size()) &&
         p.holes[count].area >= kSmallHole * counted_area(p))
    ++count;
  return count;
}

std::string share_in_percent(double part, double whole) {
  return number_text(whole > 0 ? 100 * part / whole : 0, 3);
}

std::string place_in_words(const Vector3d& p) {
  char text[100];
  std::snprintf(text, sizeof text, "(%.1f, %.1f, %.1f)", p.x() + 0.0, p.y() + 0.0, p.z() + 0.0);
  return text;
}

Table table_of_images(const ScanPrediction& p) {
  Table table{"Known surface of the region by the number of images that show it",
              {{"images", ""}, {"area", "m^2"}, {"share", "%"}},
              {}};
  const double all = counted_area(p);
  for (int k = 0; k < kClasses; ++k) {
    const bool last = k + 1 == kClasses;
    const double area = area_shown(p, k) - (last ? 0 : area_shown(p, k + 1));
    table.rows.push_back(
        {{std::to_string(k) + (last ? " and more" : ""), area, all > 0 ? 100 * area / all : 0}});
  }
  return table;
}

Table table_of_figures(const ScanPrediction& p) {
  Table table{"Where images from at least two places show it",
              {{"", ""}, {"median", ""}, {"90 % of the area at most", ""}, {"unit", ""}},
              {}};
  const auto add = [&](const char* name, float TrianglePrediction::*value, double factor,
                       const char* unit) {
    table.rows.push_back({{std::string(name), factor * area_quantile(p, value, 0.5),
                           factor * area_quantile(p, value, 0.9), std::string(unit)}});
  };
  add("surface in a pixel of the finest image", &TrianglePrediction::pixel_size, 1000, "mm");
  add("smallest angle of a ray against the normal", &TrianglePrediction::incidence, degrees(1),
      "deg");
  add("largest angle between two rays", &TrianglePrediction::parallax, degrees(1), "deg");
  add("accuracy, worst direction", &TrianglePrediction::accuracy, 1000, "mm");
  return table;
}

Table table_of_holes(const ScanPrediction& p) {
  const std::size_t listed = listed_holes(p);
  Table table{"Holes: surface without images from two places (rays at least 1 degree apart)",
              {{"area", "m^2"}, {"at", "m"}, {"why", ""}},
              {}};
  for (std::size_t k = 0; k < listed; ++k)
    table.rows.push_back({{p.holes[k].area, place_in_words(p.holes[k].place),
                           std::string(reason_in_words(p.holes[k].reason))}});
  if (listed < p.holes.size()) {
    double rest = 0;
    for (std::size_t k = listed; k < p.holes.size(); ++k) rest += p.holes[k].area;
    table.rows.push_back(
        {{rest, std::to_string(p.holes.size() - listed) + " smaller ones", std::string("")}});
  }
  return table;
}

Image picture_of(const MeshScene& scene, const Eigen::AlignedBox3d& box, double yaw,
                 const std::string& caption) {
  return {encode_png(mesh_picture(scene, overview(box, kPredictionView, yaw, -0.6), 0)), caption};
}

}  // namespace

double area_shown(const ScanPrediction& prediction, int images) {
  double area = 0;
  for (std::size_t t = 0; t < prediction.triangles.size(); ++t)
    if (prediction.counted[t] && prediction.triangles[t].images >= images)
      area += prediction.surface->mesh().area(t);
  return area;
}

double area_located(const ScanPrediction& prediction) {
  double area = 0;
  for (std::size_t t = 0; t < prediction.triangles.size(); ++t)
    if (prediction.counted[t] && prediction.triangles[t].located())
      area += prediction.surface->mesh().area(t);
  return area;
}

std::string prediction_in_words(const ScanPrediction& p) {
  const double all = counted_area(p), shown = area_located(p);
  std::string text = "Images from at least two places will show " + number_text(shown, 4) +
                     " m^2 (" + share_in_percent(shown, all) + " %) of " + number_text(all, 4) +
                     " m^2 of known surface";
  if (shown > 0) {
    text += "; there, the median is " +
            number_text(1000 * area_quantile(p, &TrianglePrediction::pixel_size, 0.5), 3) +
            " mm a pixel and an accuracy of " +
            number_text(1000 * area_quantile(p, &TrianglePrediction::accuracy, 0.5), 3) +
            " mm, with an error of " + number_text(p.pixel_error, 3) +
            " pixels in each image and exact camera poses";
  }
  const double no_view = area_of_holes(p, HoleReason::no_view);
  const double not_chosen = area_of_holes(p, HoleReason::not_chosen);
  const double zone = area_of_holes(p, HoleReason::zone);
  if (no_view + not_chosen + zone > 0) {
    text +=
        ". Not reconstructed: " + number_text(not_chosen, 4) + " m^2 for want of planned images, ";
    if (zone > 0) text += number_text(zone, 4) + " m^2 because of zones or the pilot's sight, ";
    text += "and " + number_text(no_view, 4) + " m^2 for want of candidate views from two places";
  }
  return text;
}

Value prediction_as_value(const ScanPrediction& p) {
  Value value = Value::map();
  value.set("known", counted_area(p));
  value.set("one_image", area_shown(p, 1));
  value.set("two_images", area_shown(p, 2));
  value.set("three_images", area_shown(p, 3));
  value.set("located", area_located(p));
  value.set("pixel_error", p.pixel_error);
  const auto figures = [&](const char* name, float TrianglePrediction::*member, double factor) {
    Value& entry = value.set(name, Value::map());
    for (const auto& [key, share] : {std::pair("median", 0.5), std::pair("most", 0.9)}) {
      const double figure = factor * area_quantile(p, member, share);
      entry.set(key, std::isfinite(figure) ? Value(figure) : Value());
    }
  };
  figures("pixel_size", &TrianglePrediction::pixel_size, 1);
  figures("incidence_deg", &TrianglePrediction::incidence, degrees(1));
  figures("parallax_deg", &TrianglePrediction::parallax, degrees(1));
  figures("accuracy", &TrianglePrediction::accuracy, 1);
  Value& reasons = value.set("holes", Value::map());
  reasons.set("no_view", area_of_holes(p, HoleReason::no_view));
  reasons.set("zone", area_of_holes(p, HoleReason::zone));
  reasons.set("not_chosen", area_of_holes(p, HoleReason::not_chosen));
  Value& largest = reasons.set("largest", Value::list());
  for (std::size_t k = 0; k < listed_holes(p); ++k) {
    const SurfaceHole& hole = p.holes[k];
    Value entry = Value::map();
    entry.set("area", hole.area);
    entry.set("position", Value(Value::List{hole.place.x(), hole.place.y(), hole.place.z()}));
    entry.set("why", to_string(hole.reason));
    largest.push_back(std::move(entry));
  }
  return value;
}

Section prediction_section(const ScanPrediction& p) {
  Section section{"What the images will show", {}};
  TextBlock words;
  words.text = prediction_in_words(p);
  section.blocks.push_back(std::move(words));
  section.blocks.push_back(table_of_images(p));
  if (area_located(p) > 0) section.blocks.push_back(table_of_figures(p));
  if (!p.holes.empty()) section.blocks.push_back(table_of_holes(p));
  const PredictionColors range = prediction_colors(p);
  TriangleMesh mesh = p.surface->mesh();
  mesh.colors = triangle_colors(p, range);
  Eigen::AlignedBox3d box;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int corner = 0; p.counted[t] && corner < 3; ++corner) box.extend(mesh.corner(t, corner));
  if (box.isEmpty()) return section;
  const MeshScene scene(std::move(mesh));
  Image first = picture_of(
      scene, box, 1.05,
      "Predicted accuracy, from " + number_text(1000 * range.best, 2) + " mm (yellow) to " +
          number_text(1000 * range.worst, 2) +
          " mm (violet), on a logarithmic scale. Red: images of one place alone. Dark: no image. "
          "Light grey: outside the region");
  first.viewed = true;
  section.blocks.push_back(std::move(first));
  section.blocks.push_back(picture_of(scene, box, 1.05 + 3.14159, "The same from the other side"));
  return section;
}

}  // namespace lapwing
