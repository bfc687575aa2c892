// SPDX-License-Identifier: Apache-2.0
// The camera of a plan as a track of Nuke: a line a frame.
//
//   lapwing export out/hello/plan.json --format chan:frame_rate=25 -o hello.chan
#include <charconv>
#include <cmath>
#include <sstream>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/core/units.h"
#include "framework/export/camera_track.h"
#include "framework/export/exporter.h"
#include "framework/plugin/plugin.h"
#include "framework/trajectory/interpolate.h"

namespace lapwing {
namespace {

// A line as compositing programs read it: y up, the camera looks along -z, degrees. They turn it
// about z, then x, then y; without roll the order of z does not matter.
struct ChanFrame {
  double number = 0;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();
  double view = 0;
};

std::vector<ChanFrame> frames_in(const std::string& text) {
  std::vector<ChanFrame> frames;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('#')) continue;
    std::istringstream words(line);
    ChanFrame f;
    words >> f.number >> f.place.x() >> f.place.y() >> f.place.z() >> f.turn.x() >> f.turn.y() >>
        f.turn.z() >> f.view;
    if (words) frames.push_back(f);
  }
  return frames;
}

// What a program shows, in the world of the plan.
Pose shown_pose(const ChanFrame& frame) {
  const auto about = [&](int axis) {
    return Eigen::AngleAxisd(radians(frame.turn[axis]), Eigen::Vector3d::Unit(axis));
  };
  return from_y_up(frame.place, about(1) * about(0) * about(2));
}

class Chan final : public Exporter {
 public:
  static constexpr PluginText kText{
      "chan", "1.0.0", "camera as a track of Nuke (.chan), y up, one line per frame",
      "https://learn.foundry.com/nuke/content/comp_environment/3d_compositing/"
      "import_export_cameras.html"};
  static ParameterTable parameters() {
    return ParameterTable{}
        .number("frame_rate", 24, "1/s", "frames per second", between(1, 1000))
        .integer("first_frame", 1, "number of the frame at which the flight begins",
                 between(0, 100000000));
  }
  explicit Chan(const Parameters& parameters)
      : rate_(parameters.number("frame_rate")), first_(parameters.integer("first_frame")) {}

  std::string file_extension() const override { return ".chan"; }

  std::string write(const Plan& plan) const override {
    const Pinhole camera = filming_camera(plan, "chan");
    const double view = degrees(2 * std::atan(camera.height / (2 * camera.focal_y)));
    std::string out;
    if (!states_certified(plan)) out += "# not certified\n";
    std::int64_t number = first_;
    for (const double time : frame_times(plan.trajectory, rate_, "chan")) {
      const Sample s = sample_at(plan.trajectory, time);
      out += std::to_string(number++);
      for (const double value :
           {s.position.x(), s.position.z(), -s.position.y(), degrees(s.gimbal_pitch),
            degrees(s.yaw + s.gimbal_yaw) - 90, 0.0, view}) {
        out += '\t';
        put(out, value);
      }
      out += '\n';
    }
    return out;
  }

  std::vector<std::string> losses(const Plan& plan, const std::string& written) const override {
    const std::vector<ChanFrame> frames = frames_in(written);
    const double start = plan.trajectory.samples.front().time;
    const double finish = start + static_cast<double>(frames.size() - 1) / rate_;
    const auto played = [&](double time) {
      const double at = std::max(0.0, (time - start) * rate_);
      const auto i = std::min(static_cast<std::size_t>(at), frames.size() - 1);
      const ChanFrame& next = frames[std::min(i + 1, frames.size() - 1)];
      const double share = at - static_cast<double>(i);
      ChanFrame f = frames[i];
      f.place += share * (next.place - f.place);
      f.turn += share * (next.turn - f.turn);
      return shown_pose(f);
    };
    const double end = std::min(finish, plan.trajectory.samples.back().time);
    std::vector<std::string> said{
        std::to_string(frames.size()) + " frames at " + plain_number(rate_) +
            " frames/s, y up (x east, y up, z south), in metres",
        sentence_of(deviation_of(plan, start, end, 4 * static_cast<int>(frames.size()), played)) +
            ", between frames included"};
    const double rest = plan.trajectory.samples.back().time - finish;
    if (rest > 1e-6)
      said.push_back("the last " + plain_number(rest, 3) + " s of the flight are after the last " +
                     "frame");
    if (!plan.cuts.empty()) said.push_back("cuts are not marked: their frames are in it");
    const Pinhole camera = filming_camera(plan, "chan");
    const Eigen::Vector2d shift(camera.principal_x + 0.5 - camera.width / 2.0,
                                camera.principal_y + 0.5 - camera.height / 2.0);
    if (shift.norm() > 0.01)
      said.push_back("the shift of the principal point, " + plain_number(shift.norm(), 3) +
                     " px, is not in it");
    return said;
  }

 private:
  // The shortest text that reads back as the same number, without exponents that readers stumble
  // over.
  static void put(std::string& out, double number) {
    char buffer[400];
    const auto result =
        std::to_chars(buffer, buffer + sizeof buffer, number + 0.0, std::chars_format::fixed);
    out.append(buffer, result.ptr);
  }

  double rate_;
  std::int64_t first_;
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Chan)
