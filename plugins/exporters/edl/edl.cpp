// SPDX-License-Identifier: Apache-2.0
// What is kept of the footage, as an edit decision list (CMX 3600).
//
//   lapwing export out/hello/plan.json --format edl:frame_rate=24 -o hello.edl
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/export/camera_track.h"
#include "framework/export/exporter.h"
#include "framework/export/map_features.h"
#include "framework/export/shot_list.h"
#include "framework/plugin/plugin.h"

namespace lapwing {
namespace {

constexpr std::size_t kMostEvents = 999;  // numbers have three digits
constexpr std::size_t kLongest = 70;      // characters of a title or a comment

// The format is ASCII, a line a statement.
std::string line_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if ((byte & 0xc0) == 0x80) continue;  // the rest of a character
    out += byte >= 0x20 && byte < 0x7f ? c : '_';
  }
  return out.substr(0, kLongest);
}

class Edl final : public Exporter {
 public:
  static constexpr PluginText kText{
      "edl", "1.0.0", "footage that is kept, as an edit decision list (.edl)", "CMX 3600"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .integer("frame_rate", 24, "frames per second, non-drop", between(1, 99))
        .integer("source_hour", 0, "hour at which the camera's time code begins", between(0, 23))
        .integer("record_hour", 1, "hour at which the edited film begins", between(0, 23));
  }
  explicit Edl(const Parameters& parameters)
      : rate_(parameters.integer("frame_rate")),
        source_(parameters.integer("source_hour")),
        record_(parameters.integer("record_hour")) {}

  std::string file_extension() const override { return ".edl"; }

  std::string write(const Plan& plan) const override {
    filming_camera(plan, "edl");  // without one there is no footage
    const std::vector<Event> events = events_of(plan);
    if (events.size() > kMostEvents)
      throw InputError("edl: " + std::to_string(events.size()) +
                       " events, and the format numbers 999; fewer changes of subject or cuts are "
                       "needed");
    std::string out = "TITLE: " + line_text(stated_name(plan)) + "\nFCM: NON-DROP FRAME\n\n";
    std::int64_t recorded = record_ * 3600 * rate_;
    const std::int64_t begun = source_ * 3600 * rate_;
    int number = 0;
    for (const Event& event : events) {
      char head[64];
      std::snprintf(head, sizeof head, "%03d  AX       V     C        ", ++number);
      out += head + code(begun + event.first) + ' ' + code(begun + event.last) + ' ' +
             code(recorded) + ' ' + code(recorded + event.last - event.first) + '\n' +
             "* FROM CLIP NAME: " + line_text(plan.mission) + '\n' +
             line_text("* COMMENT: " + event.content) + '\n';
      recorded += event.last - event.first;
    }
    return out;
  }

  std::vector<std::string> losses(const Plan& plan, const std::string& written) const override {
    double kept = 0, worst = 0;
    std::size_t events = 0;
    std::vector<double> ends;
    for (const Shot& shot : shot_list(plan, "edl"))
      for (const double end : {shot.span.start, shot.span.finish})
        ends.push_back(end - plan.trajectory.samples.front().time);
    for (std::size_t at = 0; (at = written.find("  AX ", at)) != std::string::npos;
         ++at, ++events) {
      const double in = seconds_in(written, at + 26), out = seconds_in(written, at + 38);
      kept += out - in;
      for (const double end : {in - 3600.0 * static_cast<double>(source_),
                               out - 3600.0 * static_cast<double>(source_)}) {
        double nearest = INFINITY;
        for (const double wanted : ends) nearest = std::min(nearest, std::abs(wanted - end));
        worst = std::max(worst, nearest);
      }
    }
    return {std::to_string(events) + " events at " + std::to_string(rate_) + " frames/s keep " +
                plain_number(kept, 5) + " s of " + plain_number(plan.trajectory.duration(), 5) +
                " s; their ends are at most " + plain_number(worst, 3) +
                " s from those of the plan",
            "the camera is expected to record from the start of the flight on; where it begins "
            "earlier, `source_hour` or an offset in the editor shifts it"};
  }

 private:
  struct Event {
    std::int64_t first, last;  // frames of the flight
    std::string content;
  };

  // What is kept, an event for every change of what is in the shot.
  std::vector<Event> events_of(const Plan& plan) const {
    std::vector<Event> events;
    const double start = plan.trajectory.samples.empty() ? 0 : plan.trajectory.samples[0].time;
    const auto frame = [&](double time) {
      return std::llround((time - start) * static_cast<double>(rate_));
    };
    for (const Shot& shot : shot_list(plan, "edl")) {
      if (shot.cut) continue;
      std::string names;
      for (const std::string& name : shot.subjects) names += (names.empty() ? "" : ", ") + name;
      const Event event{frame(shot.span.start), frame(shot.span.finish),
                        names.empty() ? "nobody in the shot" : "in the shot: " + names};
      if (event.last > event.first) events.push_back(event);
    }
    return events;
  }

  std::string code(std::int64_t frames) const {
    const std::int64_t seconds = frames / rate_;
    char text[48];
    std::snprintf(text, sizeof text, "%02d:%02d:%02d:%02d", static_cast<int>(seconds / 3600 % 24),
                  static_cast<int>(seconds / 60 % 60), static_cast<int>(seconds % 60),
                  static_cast<int>(frames % rate_));
    return text;
  }

  // Of a time code that was written.
  double seconds_in(const std::string& text, std::size_t at) const {
    const auto two = [&](std::size_t k) { return std::atof(text.substr(at + k, 2).c_str()); };
    return two(0) * 3600 + two(3) * 60 + two(6) + two(9) / static_cast<double>(rate_);
  }

  std::int64_t rate_, source_, record_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Edl)
