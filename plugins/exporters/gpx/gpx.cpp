// SPDX-License-Identifier: Apache-2.0
// A flight as GPX: its path as a track, what it is for as waypoints.
//
//   lapwing export out/hello/plan.json --format gpx:heights=ground -o hello.gpx
#include <cstdlib>

#include "framework/core/error.h"
#include "framework/core/markup.h"
#include "framework/core/number_text.h"
#include "framework/export/camera_track.h"
#include "framework/export/earth_frame.h"
#include "framework/export/exporter.h"
#include "framework/export/map_features.h"
#include "framework/plugin/plugin.h"

namespace lapwing {
namespace {

// The points of the track, as a program reads them.
std::vector<EarthPoint> track_in(const std::string& text) {
  std::vector<EarthPoint> points;
  const auto number = [&](std::size_t& at, const std::string& before) {
    at = text.find(before, at) + before.size();
    return std::strtod(text.c_str() + at, nullptr);
  };
  for (std::size_t at = 0; (at = text.find("<trkpt", at)) != std::string::npos;) {
    EarthPoint point;
    point.latitude_deg = number(at, "lat=\"");
    point.longitude_deg = number(at, "lon=\"");
    point.height = number(at, "<ele>");
    points.push_back(point);
  }
  return points;
}

class Gpx final : public Exporter {
 public:
  static constexpr PluginText kText{"gpx", "1.0.0", "path and places as GPX 1.1 (.gpx)",
                                    "https://www.topografix.com/GPX/1/1/"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .number("rate", 10, "1/s", "points of the path per second", between(0.1, 1000))
        .choice("heights", "sea", {"sea", "ellipsoid", "ground"},
                "reference of heights; GPX requires the sea");
  }
  explicit Gpx(const Parameters& parameters)
      : rate_(parameters.number("rate")), heights_(*height_of_named(parameters.text("heights"))) {}

  std::string file_extension() const override { return ".gpx"; }

  std::string write(const Plan& plan) const override {
    const EarthFrame frame(plan, heights_, "gpx");
    std::string out =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<gpx xmlns=\"http://www.topografix.com/GPX/1/1\" version=\"1.1\" creator=\"Lapwing\">\n"
        "<metadata><name>" +
        markup_text(stated_name(plan)) + "</name><desc>" +
        markup_text("Heights in m above " + EarthFrame::in_words(heights_)) +
        "</desc></metadata>\n";
    for (const MapPoint& point : map_points(plan)) {
      out +=
          place("wpt", frame.at(point.position)) + "<name>" + markup_text(point.name) + "</name>";
      if (point.time) out += "<desc>" + plain_number(*point.time, 6) + " s after the start</desc>";
      out += "<type>" + point.kind + "</type></wpt>\n";
    }
    out += "<trk><name>path</name><trkseg>\n";
    for (const Eigen::Vector3d& p :
         path_at(plan, frame_times(plan.trajectory, rate_, "gpx"), "gpx"))
      out += place("trkpt", frame.at(p)) + "</trkpt>\n";
    return out + "</trkseg></trk>\n</gpx>\n";
  }

  std::vector<std::string> losses(const Plan& plan, const std::string& written) const override {
    const EarthFrame frame(plan, heights_, "gpx");
    const std::vector<EarthPoint> points = track_in(written);
    std::vector<Eigen::Vector3d> places;
    for (const EarthPoint& point : points) places.push_back(frame.local(point));
    const PathDeviation worst =
        deviation_of_path(plan, frame_times(plan.trajectory, rate_, "gpx"), places);
    std::vector<std::string> said{
        frame.sentence(points),
        "joined by straight lines, the track is at most " + plain_number(100 * worst.distance, 3) +
            " cm from the plan (at " + plain_number(worst.time, 4) + " s)",
        "times, headings, cameras, zones and obstacles are not in the file"};
    if (heights_ != HeightOf::sea)
      said.emplace_back("heights are above " + EarthFrame::in_words(heights_) +
                        "; programs take those of GPX as above the sea");
    return said;
  }

 private:
  static std::string place(const char* element, const EarthPoint& point) {
    return std::string("<") + element + " lat=\"" + fixed_number(point.latitude_deg, 9) +
           "\" lon=\"" + fixed_number(point.longitude_deg, 9) + "\"><ele>" +
           fixed_number(point.height, 4) + "</ele>";
  }

  double rate_;
  HeightOf heights_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Gpx)
