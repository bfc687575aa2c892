// SPDX-License-Identifier: Apache-2.0
#include "framework/export/film_charts.h"

#include <algorithm>
#include <cmath>

#include "framework/core/units.h"
#include "framework/export/film_strip.h"
#include "framework/export/film_view.h"
#include "framework/export/time_charts.h"

namespace lapwing {
namespace {

constexpr double kGap = std::numeric_limits<double>::quiet_NaN();

Chart gimbal_angles(const TimeCharts& charts, const Vehicle& vehicle) {
  Chart chart = charts.chart(
      "Gimbal angles", "angle", "\u00b0",
      {charts.series("yaw", [](const Sample& s) { return degrees(s.gimbal_yaw); }),
       charts.series("pitch", [](const Sample& s) { return degrees(s.gimbal_pitch); })});
  if (vehicle.gimbal) {
    chart.limits = {{"pitch at most", degrees(vehicle.gimbal->pitch_max)},
                    {"pitch at least", degrees(vehicle.gimbal->pitch_min)}};
    if (vehicle.gimbal->yaw_max > vehicle.gimbal->yaw_min) {
      chart.limits.push_back({"yaw at most", degrees(vehicle.gimbal->yaw_max)});
      chart.limits.push_back({"yaw at least", degrees(vehicle.gimbal->yaw_min)});
    }
  }
  return chart;
}

Chart gimbal_rates(const TimeCharts& charts, const Vehicle& vehicle) {
  Chart chart = charts.chart(
      "Gimbal rates", "rate", "\u00b0/s",
      {charts.series(
           "yaw", [](const Sample& s) { return degrees(s.gimbal_yaw_rate); }, true),
       charts.series(
           "pitch", [](const Sample& s) { return degrees(s.gimbal_pitch_rate); }, true)});
  if (!vehicle.gimbal) return chart;
  const double pitch = degrees(vehicle.gimbal->pitch_rate_max);
  const double yaw = degrees(vehicle.gimbal->yaw_rate_max);
  const bool turns = vehicle.gimbal->yaw_max > vehicle.gimbal->yaw_min;
  if (!turns || yaw == pitch) {
    chart.limits = both_ways(pitch);
  } else {
    chart.limits = {{"pitch at most", pitch},
                    {"pitch at least", -pitch},
                    {"yaw at most", yaw},
                    {"yaw at least", -yaw}};
  }
  return chart;
}

// The angle between where the camera looks and a point, (3.7).
double camera_error(const Sample& s, const Eigen::Vector3d& point) {
  const Eigen::Vector3d forward = camera_axes(s.yaw + s.gimbal_yaw, s.gimbal_pitch).forward;
  const Eigen::Vector3d to_point = point - s.position;
  return degrees(std::atan2(forward.cross(to_point).norm(), forward.dot(to_point)));
}

// (3.9), reading 3.5: how much nearer the camera is to one end of the subject than to the other;
// negative from above.
double skewness(const Sample& s, const Eigen::Vector3d& middle, double height) {
  const Eigen::Vector3d d = middle - s.position;
  const double denominator = d.squaredNorm() + height / 2 * std::abs(d.z());
  return denominator > 0 ? height * d.z() / denominator : kGap;
}

// Charts of what the camera is asked to film.
class SubjectCharts {
 public:
  SubjectCharts(const Plan& plan, const Vehicle& vehicle)
      : plan_(plan), pinhole_(vehicle.camera.pinhole()), charts_(plan) {
    for (const Sample& s : plan.trajectory.samples) {
      asked_.push_back(in_cut(plan, s.time) ? std::vector<std::size_t>()
                                            : subjects_at(plan, s.time));
    }
    for (std::size_t i = 0; i < plan.environment.subjects.size(); ++i) {
      const auto asks = [i](const auto& places) {
        return std::find(places.begin(), places.end(), i) != places.end();
      };
      if (std::any_of(asked_.begin(), asked_.end(), asks)) shown_.push_back(i);
    }
  }

  Chart error() const {
    std::vector<Series> series;
    for (const std::size_t i : shown_) {
      series.push_back(over_time(i, subject(i).name, [](const Sample& s, const auto& middle) {
        return camera_error(s, middle);
      }));
    }
    if (plan_.trajectory.has_target) {
      series.push_back(charts_.series("target", [this](const Sample& s) {
        return in_cut(plan_, s.time) ? kGap : camera_error(s, s.target);
      }));
    }
    return charts_.chart("Camera error", "angle", "\u00b0", std::move(series));
  }

  Chart skew() const {
    std::vector<Series> series;
    for (const std::size_t i : shown_) {
      const double height = subject(i).height;
      if (!(height > 0)) continue;
      series.push_back(over_time(i, subject(i).name, [height](const Sample& s, const auto& middle) {
        return skewness(s, middle, height);
      }));
    }
    return charts_.chart("Skewness, negative from above", "skewness", "", std::move(series));
  }

  Chart box(bool up) const {
    const char* names[] = {up ? "top" : "right", "middle", up ? "bottom" : "left"};
    std::vector<Series> series;
    for (const std::size_t i : shown_) {
      const std::string prefix = shown_.size() > 1 ? subject(i).name + " " : "";
      for (int k = 0; k < 3; ++k) {
        series.push_back(over_time(i, prefix + names[k], [&](const Sample& s, const auto& middle) {
          return share(s, middle, subject(i), up, k);
        }));
      }
    }
    return up ? charts_.chart("Subject in the image, from its lower edge up", "share", "%",
                              std::move(series), {{"upper edge", 100}, {"lower edge", 0}})
              : charts_.chart("Subject in the image, from its left edge across", "share", "%",
                              std::move(series), {{"right edge", 100}, {"left edge", 0}});
  }

 private:
  const Subject& subject(std::size_t i) const { return plan_.environment.subjects[i]; }

  template <class Read>
  Series over_time(std::size_t i, const std::string& name, Read read) const {
    std::size_t index = 0;
    return charts_.series(name, [&](const Sample& s) {
      const auto& places = asked_[index++];
      const bool asked = std::find(places.begin(), places.end(), i) != places.end();
      return asked ? read(s, subject(i).position(s.time)) : kGap;
    });
  }

  // Of the image's height from below, or width from the left: the far end, middle or near end.
  double share(const Sample& s, const Eigen::Vector3d& middle, const Subject& subject, bool up,
               int which) const {
    const CameraView view = view_of(s, pinhole_);
    const auto box = view.box_of(middle, subject.height, subject.width);
    const auto pixel = view.project(middle);
    if (!box || !pixel) return kGap;
    const double across[] = {box->right, pixel->x(), box->left};
    const double down[] = {box->top, pixel->y(), box->bottom};
    const double value =
        up ? 1 - (down[which] + 0.5) / pinhole_.height : (across[which] + 0.5) / pinhole_.width;
    // A subject far outside would leave no room for the image itself.
    return std::abs(value - 0.5) > 1.5 ? kGap : 100 * value;
  }

  const Plan& plan_;
  const Pinhole pinhole_;
  const TimeCharts charts_;
  std::vector<std::vector<std::size_t>> asked_;  // per sample
  std::vector<std::size_t> shown_;
};

}  // namespace

Section camera_section(const Plan& plan, const Vehicle& vehicle) {
  Section section{"Camera", {}};
  FilmStrip strip = film_strip(plan, vehicle, strip_times(plan));
  if (!strip.frames.empty()) section.blocks.push_back(std::move(strip));
  const TimeCharts charts(plan);
  section.blocks.push_back(gimbal_angles(charts, vehicle));
  section.blocks.push_back(gimbal_rates(charts, vehicle));
  const SubjectCharts subjects(plan, vehicle);
  const auto add = [&section](Chart chart) {
    if (!chart.series.empty()) section.blocks.push_back(std::move(chart));
  };
  add(subjects.error());
  add(subjects.skew());
  add(subjects.box(true));
  add(subjects.box(false));
  return section;
}

}  // namespace lapwing
