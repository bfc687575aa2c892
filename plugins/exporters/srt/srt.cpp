// SPDX-License-Identifier: Apache-2.0
// What is in the shot when, and how it is flown, as subtitles (SubRip).
//
//   lapwing export out/hello/plan.json --format srt:every=0.5 -o hello.srt
#include <algorithm>
#include <cmath>
#include <set>

#include "framework/core/error.h"
#include "framework/core/json.h"
#include "framework/core/number_text.h"
#include "framework/core/units.h"
#include "framework/export/camera_track.h"
#include "framework/export/earth_frame.h"
#include "framework/export/exporter.h"
#include "framework/export/shot_list.h"
#include "framework/plugin/plugin.h"
#include "framework/trajectory/interpolate.h"

namespace lapwing {
namespace {

constexpr double kShortest = 0.001;  // s: times have milliseconds

// "00:01:02,345"
std::string clock_text(double seconds) {
  const auto all = static_cast<long long>(std::llround(seconds * 1000));
  char text[32];
  std::snprintf(text, sizeof text, "%02lld:%02lld:%02lld,%03lld", all / 3600000, all / 60000 % 60,
                all / 1000 % 60, all % 1000);
  return text;
}

// One line that no player takes for a tag, an arrow or the end of an entry.
std::string line_text(const std::string& text) {
  std::string out;
  for (const char c : as_utf8(text)) {
    if (c == '<')
      out += "\xe2\x80\xb9";
    else if (c == '>')
      out += "\xe2\x80\xba";
    else if (c == '{' || c == '}')
      out += c == '{' ? '(' : ')';
    else
      out += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? ' ' : c;
  }
  return out;
}

class Srt final : public Exporter {
 public:
  static constexpr PluginText kText{"srt", "1.0.0", "what is in the shot when, as subtitles (.srt)",
                                    "https://www.matroska.org/technical/subtitles.html"};
  static ParameterTable parameters() {
    return ParameterTable{}.number("every", 1, "s", "longest time between two entries",
                                   between(0.05, 3600));
  }
  explicit Srt(const Parameters& parameters) : every_(parameters.number("every")) {}

  std::string file_extension() const override { return ".srt"; }

  std::string write(const Plan& plan) const override {
    const std::vector<Shot> shots = shot_list(plan, "srt");
    const std::vector<Moment> moments = moments_of(plan);
    const double start = plan.trajectory.samples.front().time;
    std::string out;
    int number = 0;
    for (const Shot& shot : shots)
      for (const TimeSpan& span : parts_of(shot.span, moments)) {
        out += std::to_string(++number) + '\n' + clock_text(span.start - start) + " --> " +
               clock_text(span.finish - start) + '\n' +
               line_text(content_of(plan, shot, span, moments)) + '\n' +
               figures_of(sample_at(plan.trajectory, span.start)) + '\n';
        if (!states_certified(plan)) out += "not certified\n";
        out += '\n';
      }
    return out;
  }

  std::vector<std::string> losses(const Plan& plan, const std::string& written) const override {
    const auto arrows = [&] {
      std::size_t count = 0;
      for (std::size_t at = 0; (at = written.find(" --> ", at)) != std::string::npos; ++at) ++count;
      return count;
    }();
    std::vector<std::string> said{
        std::to_string(arrows) + " entries over " + plain_number(plan.trajectory.duration(), 5) +
        " s, from the start of the flight; times are rounded to 1 ms, what is in the image is "
        "looked at every 50 ms"};
    if (plan.trajectory.has_gimbal && !plan.environment.subjects.empty())
      said.emplace_back("subjects behind obstacles count as in the shot");
    return said;
  }

 private:
  // The span, divided where something happens and where it is longer than `every_`.
  std::vector<TimeSpan> parts_of(const TimeSpan& span, const std::vector<Moment>& moments) const {
    std::set<double> ends{span.start, span.finish};
    for (const Moment& moment : moments)
      if (moment.time > span.start + kShortest && moment.time < span.finish - kShortest)
        ends.insert(moment.time);
    std::vector<TimeSpan> parts;
    for (auto at = ends.begin(); std::next(at) != ends.end(); ++at) {
      const double from = *at, to = *std::next(at);
      const int count = std::max(1, static_cast<int>(std::ceil((to - from) / every_ - 1e-9)));
      for (int i = 0; i < count; ++i)
        parts.push_back({from + (to - from) * i / count, from + (to - from) * (i + 1) / count});
    }
    return parts;
  }

  static std::string content_of(const Plan& plan, const Shot& shot, const TimeSpan& span,
                                const std::vector<Moment>& moments) {
    std::string text;
    const auto add = [&](const std::string& more) { text += (text.empty() ? "" : "; ") + more; };
    if (shot.cut) add("cut");
    std::string names;
    for (const std::string& name : shot.subjects) names += (names.empty() ? "" : ", ") + name;
    if (!names.empty())
      add("in the shot: " + names);
    else if (!plan.environment.subjects.empty() && plan.trajectory.has_gimbal)
      add("nobody in the shot");
    if (shot.lit) add("light on");
    for (const Moment& moment : moments)
      if (moment.time >= span.start - kShortest && moment.time < span.finish - kShortest)
        add(moment.what);
    return text.empty() ? "flight" : text;
  }

  static std::string figures_of(const Sample& s) {
    double heading = std::fmod(90 - degrees(s.yaw + s.gimbal_yaw), 360);
    if (heading < 0) heading += 360;
    return "height " + fixed_number(s.position.z(), 1) + " m, speed " +
           fixed_number(s.velocity.norm(), 1) + " m/s, heading " + fixed_number(heading, 0) +
           " deg, pitch " + fixed_number(degrees(s.gimbal_pitch), 0) + " deg";
  }

  double every_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Srt)
